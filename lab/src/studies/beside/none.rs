//! Nobody else.

use super::SweepMethod;
use bevy::math::Vec3;
use dolomite_collision::Ray;

/// None.
pub const SWEEPS: &[SweepMethod] = &[];

/// There is none.
pub enum Mesh {}

impl Mesh {
    /// Nothing.
    pub fn new(_: &[Vec3], _: &[[u32; 3]]) -> Option<Self> {
        None
    }

    /// Never asked.
    pub fn first(&self, _: &Ray) -> f64 {
        match *self {}
    }
}
