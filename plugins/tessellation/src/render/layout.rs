//! The uniform of the draws, byte for byte as `shaders/src/tessellation/draw_types.wgsl` (a test
//! compares the two).

use bytemuck::{Pod, Zeroable};

/// What the draws of terrain know; see the WGSL file for units and meanings.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq)]
#[expect(
    missing_docs,
    reason = "each field is documented once, in draw_types.wgsl"
)]
pub struct DrawParams {
    pub clip_from_anchor: [[f32; 4]; 4],
    pub previous_clip_from_anchor: [[f32; 4]; 4],
    pub camera: [f32; 3],
    pub time: f32,
    pub anchor: [f32; 2],
    pub near_offset: [f32; 2],
    pub far_offset: [f32; 2],
    pub viewport: [f32; 2],
    pub sea_level: f32,
    pub tile: f32,
    pub sand_top: f32,
    pub tree_line: f32,
    pub snow_line: f32,
    pub blend: f32,
    pub rock_slope: f32,
    pub snow_slope: f32,
    pub flags: u32,
    pub relief_texel: f32,
    pub relief_offset: [f32; 2],
    pub relief_scale: [f32; 2],
    pub pad: [f32; 2],
}

/// Bit of `flags`: draw filled triangles.
pub const FILL: u32 = 1;
/// Bit of `flags`: draw the edges of triangles.
pub const LINES: u32 = 2;
/// Ratio of the far to the near texture scale, as `FAR_TILES` in `material.wgsl`.
pub const FAR_TILES: f64 = 11.3;
/// Distance between the slots of the dynamic uniform: a multiple of every device's alignment
/// (WebGPU's largest is 256), holding one [`DrawParams`].
pub const DRAW_SLOT: u64 = 512;
