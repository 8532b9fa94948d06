//! What every method of level of detail has to offer to be compared.

use crate::scenes::camera::Camera;
use crate::scenes::mesh::Drawn;
use crate::scenes::truth::Truth;

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
pub trait Baseline: Send + Sync {
    /// As it is named in tables.
    fn name(&self) -> &'static str;

    /// Its knob.
    fn knob(&self) -> Knob;

    /// What it draws with the knob at `knob`; `None` if that takes more than [`MOST_TRIANGLES`](crate::scenes::mesh::MOST_TRIANGLES)
    /// in memory.
    fn draw(&self, truth: &Truth, camera: &Camera, knob: f64) -> Option<Box<dyn Drawn>>;
}

/// A method that may draw no more than so many vertices: to learn whether it needs more, without waiting for
/// how many.
pub struct AtMost<'a> {
    /// The method.
    pub baseline: &'a dyn Baseline,
    /// The most.
    pub vertices: u64,
}

impl Baseline for AtMost<'_> {
    fn name(&self) -> &'static str {
        self.baseline.name()
    }

    fn knob(&self) -> Knob {
        self.baseline.knob()
    }

    fn draw(&self, truth: &Truth, camera: &Camera, knob: f64) -> Option<Box<dyn Drawn>> {
        let drawn = self.baseline.draw(truth, camera, knob)?;
        (drawn.vertices() <= self.vertices).then_some(drawn)
    }
}
