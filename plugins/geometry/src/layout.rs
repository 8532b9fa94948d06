//! What draws are told and what producers write, byte for byte as `shaders/src/geometry/draw_types.wgsl`
//! and `head.wgsl` (a test compares them).

use bytemuck::{Pod, Zeroable};

/// Largest buffer binding that WebGPU promises, bytes.
pub const BINDING_LIMIT: u64 = 128 << 20;

/// How a producer's work buffer begins: arguments of the draws, and what is counted.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable, PartialEq, Eq)]
pub struct GeometryHead {
    /// Arguments of the indexed draw.
    pub indexed: [u32; 5],
    /// Arguments of the amplified draw: vertices of a primitive, primitives, 0, 0.
    pub amplified: [u32; 4],
    /// Arguments of the draw that fetches indices by itself, for lines.
    pub plain: [u32; 4],
    /// Arguments of the indexed draw of what the camera does not see, for shadow maps.
    pub others: [u32; 5],
    /// Vertices emitted.
    pub vertices: u32,
    /// Primitives emitted.
    pub primitives: u32,
    /// Vertices that the pool would have to hold if nothing were left out.
    pub wanted_vertices: u32,
    /// Primitives that the pool would have to hold if nothing were left out.
    pub wanted_primitives: u32,
    /// What was looked at and emits nothing.
    pub discarded: u32,
    /// By how many steps detail was lowered to fit the pools.
    pub lowered: u32,
    /// The producer's own words.
    pub own: [u32; OWN_WORDS],
}

/// Words of [`GeometryHead::own`].
pub const OWN_WORDS: usize = 16;
/// Words of the head, as `HEAD_WORDS` in `head.wgsl`.
pub const HEAD_WORDS: u64 = (size_of::<GeometryHead>() / 4) as u64;
/// Word at which the producer's own words begin, as `OWN` in `head.wgsl`.
pub const OWN: u64 = HEAD_WORDS - OWN_WORDS as u64;
/// Byte offset of [`GeometryHead::amplified`].
pub const AMPLIFIED_ARGUMENTS: u64 = 5 * 4;
/// Byte offset of [`GeometryHead::plain`].
pub const PLAIN_ARGUMENTS: u64 = 9 * 4;
/// Byte offset of [`GeometryHead::others`].
pub const OTHERS_ARGUMENTS: u64 = 13 * 4;

/// What the draws know; see the WGSL file for units and meanings.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq)]
#[expect(
    missing_docs,
    reason = "each field is documented once, in draw_types.wgsl"
)]
pub struct GeometryDraw {
    pub clip_from_anchor: [[f32; 4]; 4],
    pub previous_clip_from_anchor: [[f32; 4]; 4],
    pub camera: [f32; 3],
    pub time: f32,
    pub anchor: [f32; 3],
    pub uv_range: f32,
    pub viewport: [f32; 2],
    pub flags: u32,
    pub producer: u32,
    pub numbers: [[f32; 4]; 4],
}

/// Bit of [`GeometryDraw::flags`]: triangles are filled.
pub const FILL: u32 = 1;
/// Bit of [`GeometryDraw::flags`]: their edges are drawn.
pub const LINES: u32 = 2;

/// Distance between the slots of the dynamic uniform, bytes: a multiple of every device's alignment.
pub const DRAW_SLOT: u64 = 256;

/// A row of the table of materials.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable, PartialEq)]
#[expect(
    missing_docs,
    reason = "each field is documented once, in draw_types.wgsl"
)]
pub struct MaterialRow {
    pub base_color: [f32; 4],
    pub emissive: [f32; 4],
    pub surface: [f32; 4],
}

/// Rows of the table.
pub const MATERIAL_ROWS: usize = 16;

/// Bytes of a stored vertex, as `VERTEX_WORDS` in `vertex.wgsl`.
pub const VERTEX_BYTES: u64 = 20;

/// Bytes of a vertex that the draws evaluate: what it belongs to, and two coordinates there.
pub const EVALUATED_BYTES: u64 = 12;

/// Bytes of a place in the last frame.
pub const PREVIOUS_BYTES: u64 = 12;

const _: () = assert!(size_of::<GeometryDraw>() as u64 <= DRAW_SLOT);
const _: () = assert!(AMPLIFIED_ARGUMENTS == core::mem::offset_of!(GeometryHead, amplified) as u64);
const _: () = assert!(PLAIN_ARGUMENTS == core::mem::offset_of!(GeometryHead, plain) as u64);
const _: () = assert!(OTHERS_ARGUMENTS == core::mem::offset_of!(GeometryHead, others) as u64);
const _: () = assert!(OWN == core::mem::offset_of!(GeometryHead, own) as u64 / 4);
