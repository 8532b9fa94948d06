//! What every library is asked to do.

use dolomite_character::clip::oracle::Transform64;
pub use dolomite_testkit::cores::processor_time;

/// A clip at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Input {
    /// Number in the rig.
    pub clip: usize,
    /// Seconds.
    pub time: f32,
    /// Of all weights' sum.
    pub weight: f32,
}

/// A library that samples and blends clips.
pub trait Method {
    /// With its version.
    fn name(&self) -> &'static str;
    /// Local transforms of one blend, its inputs in this order. Not timed.
    fn blend(&mut self, inputs: &[Input]) -> Vec<Transform64>;
    /// Makes a crowd: for each figure its three inputs.
    fn crowd(&mut self, figures: &[[Input; 3]]);
    /// One frame: every figure's clips go on by `dt` seconds, are sampled and blended, and, if `model`,
    /// become matrices in the model's frame. `false`: it has no such matrices.
    fn frame(&mut self, dt: f32, model: bool) -> bool;
    /// Bytes of all clips, if it says so.
    fn bytes(&self) -> Option<usize>;
}
