//! What the stage's shaders are told, byte for byte as `shaders/src/stage/api.wgsl` and
//! `draw_types.wgsl` (a test compares them).

use bytemuck::{Pod, Zeroable};

use super::Domain;

/// The view as control functions see it; see the WGSL file for units and meanings.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq)]
#[expect(missing_docs, reason = "each field is documented once, in api.wgsl")]
pub struct StageView {
    pub planes: [[f32; 4]; 6],
    pub sweep: [f32; 4],
    pub eye: [f32; 3],
    pub pixels_per_radian: f32,
    pub anchor: [f32; 3],
    pub pixels_per_edge: f32,
    pub time: f32,
    pub previous_time: f32,
    pub orthographic: f32,
    pub camera: f32,
}

/// All that the compute passes of one kind in one view depend on, beside buffers.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq)]
#[expect(missing_docs, reason = "each field is documented once, in api.wgsl")]
pub struct StageParams {
    pub view: StageView,
    pub corners: u32,
    pub edges: u32,
    pub patches: u32,
    pub max_vertices: u32,
    pub max_primitives: u32,
    pub corner_table: u32,
    pub edge_table: u32,
    pub patch_table: u32,
    pub points: u32,
    pub point_size: u32,
    pub uv_range: f32,
    pub amplified: u32,
    pub split: u32,
    pub pad: [u32; 3],
}

impl StageParams {
    /// Corners, edges and patches.
    pub const fn items(&self) -> u32 {
        self.corners + self.edges + self.patches
    }

    /// Bytes of the work buffer that have to be 0 before the first pass: head, corners, edges.
    pub const fn cleared_bytes(&self) -> u64 {
        (HEAD_WORDS + self.corners as u64 + self.edges as u64) * 4
    }

    /// Bytes of the work buffer, see `work.wgsl`.
    pub const fn work_bytes(&self) -> u64 {
        let items = self.items() as u64;
        let blocks = items.div_ceil(BLOCK as u64);
        let patches = self.patches as u64;
        let vertex_threads = self.max_vertices as u64 / VERTEX_RUN + items;
        let grid_threads = self.max_primitives as u64 / GRID_RUN + patches;
        let placed = 4 + self.split as u64;
        let words = placed * patches + 2 * blocks + 2 * (items + 1) + vertex_threads + grid_threads;
        self.cleared_bytes() + words * 4
    }

    /// Threads that join the sides of the patches: a half of a side each.
    pub const fn strip_threads(&self, domain: Domain) -> u32 {
        let sides = match domain {
            Domain::Triangles => 3,
            Domain::Quads => 4,
            Domain::Isolines => 0,
        };
        2 * sides * self.patches
    }
}

/// Words at the start of the work buffer, as `HEAD` in `work.wgsl`.
pub const HEAD_WORDS: u64 = 40;
/// Items of a block, as in `work.wgsl`.
pub const BLOCK: u32 = 256;
/// Byte offset in the work buffer of the arguments for `draw_indirect`.
pub const AMPLIFIED_ARGUMENTS: u64 = 5 * 4;
/// Byte offset in the work buffer of the arguments for the draw of lines.
pub const PLAIN_ARGUMENTS: u64 = 22 * 4;
/// Byte offset in the work buffer of the arguments for the draw of what the camera does not see.
pub const OTHERS_ARGUMENTS: u64 = 32 * 4;
/// Vertices of a thread of `emit_vertices`, as in `work.wgsl`.
const VERTEX_RUN: u64 = 4;
/// Primitives of a thread of `emit_grid` and `emit_strips` on average, as in `work.wgsl`.
const GRID_RUN: u64 = 32;
/// Byte offset in the work buffer of the arguments for the dispatch of `emit_vertices`.
pub const VERTEX_DISPATCH_ARGUMENTS: u64 = 9 * 4;
/// Byte offset in the work buffer of the arguments for the dispatch of `emit_grid`.
pub const GRID_DISPATCH_ARGUMENTS: u64 = 19 * 4;

/// The head of the work buffer as it is read back.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable, PartialEq, Eq)]
pub struct WorkHead {
    /// Arguments of the indexed draw.
    pub indexed: [u32; 5],
    /// Arguments of the amplified draw.
    pub amplified: [u32; 4],
    /// Arguments of the dispatch of `emit_vertices`.
    pub dispatch: [u32; 3],
    /// Vertices emitted.
    pub vertices: u32,
    /// Primitives emitted.
    pub primitives: u32,
    /// Patches that an outer level discarded.
    pub discarded: u32,
    /// How often all levels were lowered by a fifth to fit the pools.
    pub lowered: u32,
    /// Vertices that the pool would have to hold without lowering.
    pub wanted_vertices: u32,
    /// Primitives that the pool would have to hold without lowering.
    pub wanted_primitives: u32,
    /// What is left of every level, in 1/1024.
    pub share: u32,
    /// Arguments of the dispatch of `emit_grid`.
    pub grid_dispatch: [u32; 3],
    /// Arguments of the draw that fetches indices by itself, for lines.
    pub plain: [u32; 4],
    /// Of the level of detail: bits of what all demands were divided by so that they fit.
    pub coarsening: u32,
    /// Of the level of detail: bits of the greatest demand that the finest cells leave.
    pub left: u32,
    /// Of the level of detail: cells that are kept.
    pub kept_cells: u32,
    /// Fills up to 32 words.
    pub pad: [u32; 3],
    /// Of the level of detail: arguments of the indexed draw of what the camera does not see, for shadows.
    pub others: [u32; 5],
}

/// What the draws know; see the WGSL file for units and meanings.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq)]
#[expect(
    missing_docs,
    reason = "each field is documented once, in draw_types.wgsl"
)]
pub struct StageDraw {
    pub clip_from_stage: [[f32; 4]; 4],
    pub previous_clip_from_stage: [[f32; 4]; 4],
    pub camera: [f32; 3],
    pub time: f32,
    pub anchor: [f32; 3],
    pub uv_range: f32,
    pub viewport: [f32; 2],
    pub flags: u32,
    pub pad: u32,
    pub numbers: [[f32; 4]; 4],
}

/// Bit of [`StageDraw::flags`]: triangles are filled.
pub const FILL: u32 = 1;
/// Bit of [`StageDraw::flags`]: their edges are drawn.
pub const LINES: u32 = 2;

/// Distance between the slots of the dynamic uniform: a multiple of every device's alignment.
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

/// Bytes of a vertex that the draws evaluate: patch, u, v.
pub const EVALUATED_BYTES: u64 = 12;

/// Bytes of the smallest primitive, a segment: two indices.
pub const SEGMENT_BYTES: u64 = 8;
