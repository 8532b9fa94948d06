//! What every method of level of detail has to offer to be compared.

use super::camera::Camera;
use super::mesh::Drawn;
use super::truth::Truth;

/// The one setting of a method that trades error for vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knob {
    /// What it is, with its unit.
    pub name: &'static str,
    /// Where it draws least; above 0.
    pub coarsest: f64,
    /// Where it draws most; above 0, on either side of `coarsest`. Between the two the error falls
    /// (but for sampling) and the vertices grow.
    pub finest: f64,
}

/// A method that draws a terrain for a camera.
pub trait Rival: Send + Sync {
    /// As it is named in tables.
    fn name(&self) -> &'static str;

    /// Its knob.
    fn knob(&self) -> Knob;

    /// What it draws with the knob at `knob`; `None` if that takes more than [`MOST_TRIANGLES`]
    /// in memory.
    fn draw(&self, truth: &Truth, camera: &Camera, knob: f64) -> Option<Box<dyn Drawn>>;
}

/// Most triangles that a method keeps in memory. With its vertices, the locator and what the bisection
/// remembers, a triangle takes some 100 to 200 bytes.
pub const MOST_TRIANGLES: usize = 24_000_000;
