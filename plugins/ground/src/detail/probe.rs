//! Height queries: which are answered from what is drawn, and what the pass that answers is told.
//!
//! The pass is `shaders/src/blocks/answer.wgsl`; [`crate::blocks::locate`] is its CPU reference, and says how the bound
//! of an answer comes about.

use bevy::prelude::*;
use bytemuck::{Pod, Zeroable};

/// Threads of a workgroup of the pass.
pub const ANSWER_GROUP: u32 = 64;
/// Most places of one dispatch: 2²⁰, 16 MiB up and 20 MiB down.
pub const MOST_ASKED: u32 = 1 << 20;

/// How many ground probes are answered from what is drawn.
///
/// The view that answers is that of the active camera of least order with a [`TerrainView`](crate::TerrainView) and
/// without a [`PatchDetail`](crate::PatchDetail). Where there is none, the ground is drawn as patches or not at all,
/// and probes have their true answers alone.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Resource, Default)]
pub struct DrawnProbes {
    /// Most places that are asked for in a frame, at most [`MOST_ASKED`]; 0: none is. A larger crowd takes
    /// turns; whose turn it is not has its true answer meanwhile.
    pub per_frame: u32,
}

impl Default for DrawnProbes {
    fn default() -> Self {
        Self { per_frame: 1 << 16 }
    }
}

/// What the pass is told; byte for byte as `Asked` in `answer.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Asked {
    /// Number of the frame.
    pub frame: u32,
    /// How many places.
    pub count: u32,
    /// Fills up to 16 bytes.
    pub pad: [u32; 2],
}

/// What comes before the answers; byte for byte as `Answers` in `answer.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct AnswerHead {
    /// As they were asked.
    pub frame: u32,
    /// See `frame`.
    pub count: u32,
    /// Of the choice of vertices that was drawn.
    pub stamp: u32,
    /// What heights of answers are relative to, metres.
    pub anchor_height: f32,
}
