//! What the stage's shaders are told and leave, byte for byte as `shaders/src/stage/api.wgsl` and
//! `work.wgsl` (a test compares them).

use bytemuck::{Pod, Zeroable};
use dolomite_geometry::layout::{GeometryHead, HEAD_WORDS, OWN};

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
    pub layers: u32,
    pub pad: [u32; 2],
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

/// Items of a block, as in `work.wgsl`.
pub const BLOCK: u32 = 256;
/// Columns of a dispatch's grid, as in `work.wgsl`: one axis allows 65535 groups.
pub const COLUMNS: u32 = 32_768;
/// Vertices of a thread of `emit_vertices`, as in `work.wgsl`.
const VERTEX_RUN: u64 = 4;
/// Primitives of a thread of `emit_grid` and `emit_strips` on average, as in `work.wgsl`.
const GRID_RUN: u64 = 32;
/// Byte offset in the work buffer of the arguments for the dispatch of `emit_vertices`.
pub const VERTEX_DISPATCH_ARGUMENTS: u64 = OWN * 4;
/// Byte offset in the work buffer of the arguments for the dispatch of `emit_grid`.
pub const GRID_DISPATCH_ARGUMENTS: u64 = (OWN + 3) * 4;

/// The head of the work buffer as it is read back: a [`GeometryHead`], whose own words have names.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable, PartialEq, Eq)]
pub struct WorkHead {
    /// Arguments of the indexed draw.
    pub indexed: [u32; 5],
    /// Arguments of the amplified draw.
    pub amplified: [u32; 4],
    /// Arguments of the draw that fetches indices by itself, for lines.
    pub plain: [u32; 4],
    /// Not used by the stage.
    pub others: [u32; 5],
    /// Vertices emitted.
    pub vertices: u32,
    /// Primitives emitted.
    pub primitives: u32,
    /// Vertices that the pool would have to hold without lowering.
    pub wanted_vertices: u32,
    /// Primitives that the pool would have to hold without lowering.
    pub wanted_primitives: u32,
    /// Patches that an outer level discarded.
    pub discarded: u32,
    /// How often all levels were lowered by a fifth to fit the pools.
    pub lowered: u32,
    /// Arguments of the dispatch of `emit_vertices`.
    pub dispatch: [u32; 3],
    /// Arguments of the dispatch of `emit_grid`.
    pub grid_dispatch: [u32; 3],
    /// What is left of every level, in 1/1024.
    pub share: u32,
    /// Fills up to [`HEAD_WORDS`].
    pub pad: [u32; 9],
}

impl From<WorkHead> for GeometryHead {
    fn from(head: WorkHead) -> Self {
        bytemuck::cast(head)
    }
}

/// Bytes of the smallest primitive, a segment: two indices.
pub const SEGMENT_BYTES: u64 = 8;
