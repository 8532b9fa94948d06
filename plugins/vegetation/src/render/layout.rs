//! What passes and draws are told, byte for byte as `shaders/src/vegetation/types.wgsl` and `draw_types.wgsl` (a test
//! compares them).
//!
//! Positions are relative to the anchor of the ground's view, metres, axes of the world. A *step* is 2⁻¹² m.

use bytemuck::{Pod, Zeroable};

use crate::bend::{MOST_PRESSES, Press};
use crate::density::Growth;
use crate::law::Law;
use crate::shade::FarField;
use crate::wind::WindField;

/// Kinds that are drawn at a time.
pub const MOST_LAYERS: usize = 8;
/// Rings about the eye, one a level of ranks.
pub const MOST_RINGS: usize = 8;
/// Lists of records: of each shape one a level of detail.
pub const LISTS: usize = 8;
/// Steps a metre.
pub const STEPS: f64 = 4096.0;
/// Bytes of a record.
pub const RECORD_BYTES: u64 = 16;
/// Bytes of a piece of work.
pub const PIECE_BYTES: u64 = 8;
/// Records that the part of a level of detail begins with a multiple of: 256 bytes, a storage binding's alignment.
pub const RECORD_ALIGN: u32 = 16;

/// As `Ring` in WGSL.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable, PartialEq, Eq)]
#[expect(missing_docs, reason = "each field is documented once, in types.wgsl")]
pub struct Ring {
    pub least: [i32; 2],
    pub square: [i32; 2],
    pub inner_from: [i32; 2],
    pub inner_to: [i32; 2],
    pub tiles: i32,
    pub level: u32,
    pub pad: [u32; 2],
}

/// As `Layer` in WGSL.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq)]
#[expect(missing_docs, reason = "each field is documented once, in types.wgsl")]
pub struct LayerParams {
    pub growth: Growth,
    pub tallest: f32,
    pub above: f32,
    pub ring_count: u32,
    pub list: u32,
    pub reach: Law,
    pub lods: [f32; 2],
    pub more: [u32; 2],
    pub rings: [Ring; MOST_RINGS],
}

/// As `GrowParams` in WGSL.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq)]
#[expect(missing_docs, reason = "each field is documented once, in types.wgsl")]
pub struct GrowParams {
    pub planes: [[f32; 4]; 6],
    pub eye: [f32; 3],
    pub pixels_per_radian: f32,
    pub anchor: [i32; 2],
    pub layer_count: u32,
    pub flags: u32,
    pub rooms: [u32; LISTS],
    pub bases: [u32; LISTS],
    pub vertices: [u32; LISTS],
    pub piece_room: u32,
    pub depth_range: f32,
    pub pad: [u32; 2],
    pub layers: [LayerParams; MOST_LAYERS],
}

/// Bit of [`GrowParams::flags`]: what is outside of the view is left out.
pub const CULL: u32 = 1;

/// What the passes count, as the words of `counts` in WGSL.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable, PartialEq)]
pub struct GrowCounts {
    /// Pieces of work.
    pub pieces: u32,
    /// Records of each list; more than there is room for are not kept.
    pub records: [u32; LISTS],
    /// Candidates that were looked at.
    pub looked: u32,
    /// Those that stand, whether they are drawn or not.
    pub standing: u32,
    /// The share of all ranks that is drawn: less than 1 where the pool is too small.
    pub cut: f32,
    /// Records that were wanted.
    pub wanted: u32,
    /// Pieces that were wanted.
    pub wanted_pieces: u32,
    /// To fill 64 bytes.
    pub rest: [u32; 2],
}

/// Byte of the dispatch that divides, in the buffer of arguments.
pub const DIVIDE_ARGUMENTS: u64 = 0;
/// Byte of the dispatch that grows.
pub const GROW_ARGUMENTS: u64 = 4 * 4;
/// Byte of the dispatch that grows once more.
pub const GROW_AGAIN_ARGUMENTS: u64 = 8 * 4;
/// Byte of the first draw; 16 bytes each.
pub const DRAW_ARGUMENTS: u64 = 12 * 4;
/// Byte of the first draw into shadow maps.
pub const SHADOW_ARGUMENTS: u64 = DRAW_ARGUMENTS + 16 * LISTS as u64;
/// Bytes of all arguments.
pub const ARGUMENT_BYTES: u64 = SHADOW_ARGUMENTS + 16 * SHADOW_LISTS as u64;
/// Shadow views that blades are drawn into: the nearest cascades of a sun.
pub const SHADOW_VIEWS: usize = 2;
/// Lists that cast shadows: of the nearest blades.
pub const SHADOW_LISTS: usize = 2;
/// Distance of the slots of the uniform of shadow views, bytes: a multiple of every device's alignment.
pub const SHADOW_SLOT: u64 = 256;

/// As `Look` in WGSL.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable, PartialEq)]
#[expect(
    missing_docs,
    reason = "each field is documented once, in draw_types.wgsl"
)]
pub struct LookParams {
    pub root: [f32; 4],
    pub tip: [f32; 4],
    pub dry: [f32; 4],
    pub size: [f32; 4],
    pub sway: [f32; 4],
    pub reach: Law,
    pub head: [f32; 4],
    pub middle: [f32; 4],
}

/// As `BladeView` in WGSL.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq)]
#[expect(
    missing_docs,
    reason = "each field is documented once, in draw_types.wgsl"
)]
pub struct BladeView {
    pub clip: [[f32; 4]; 4],
    pub previous_clip: [[f32; 4]; 4],
    pub camera: [f32; 3],
    pub pixels_per_radian: f32,
    pub sun: [f32; 3],
    pub press_count: u32,
    pub anchor: [i32; 2],
    pub water: f32,
    pub pad: u32,
    pub wind: WindField,
    pub previous_wind: WindField,
    pub looks: [LookParams; MOST_LAYERS],
    pub far: [FarField; MOST_LAYERS],
    pub presses: [Press; MOST_PRESSES],
}

const _: () = assert!(size_of::<Ring>() == 48);
const _: () = assert!(size_of::<LayerParams>() == 112 + 48 * MOST_RINGS);
const _: () = assert!(size_of::<GrowCounts>() == 64);
