//! The records that the CPU writes and the compute passes complete, byte for byte as in
//! `shaders/src/tessellation/types.wgsl` (a test compares the two).

use bytemuck::{Pod, Zeroable};

/// Marks an absent patch, edge or corner in the records below.
pub const NONE: u32 = u32::MAX;

/// Most segments that one edge can have, as in OpenGL and Vulkan (`maxTessellationGenerationLevel`).
pub const MAX_LEVEL: u32 = 64;

/// A corner of patches: one vertex, owned here, used by up to four patches.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq, Eq)]
pub struct Corner {
    /// Ground position, whole metres (x, z).
    pub cell: [i32; 2],
    /// Ground position, fraction in units of 2⁻³² m (x, z).
    pub frac: [u32; 2],
    /// The patches around it, [`NONE`] where absent.
    pub patches: [u32; 4],
    /// Written by `plan`: index of its vertex, [`NONE`] when no patch around it is drawn.
    pub vertex: u32,
    /// Keeps the stride at 48 bytes.
    pub pad: [u32; 3],
}

/// An edge between two neighbouring corners: it owns the vertices between them, so that both
/// patches beside it use the very same ones.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq, Eq)]
pub struct Edge {
    /// Its ends, in ascending x or z.
    pub corners: [u32; 2],
    /// The patches beside it, [`NONE`] where absent.
    pub patches: [u32; 2],
    /// Written by `levels`: wanted number of segments as f32 bits, 1 to 64.
    pub wanted: u32,
    /// Written by `plan`: number of segments, 1 to 64; 0 when no patch beside it is drawn.
    pub level: u32,
    /// Written by `plan`: index of its first inner vertex.
    pub vertex: u32,
    /// Keeps the stride at 32 bytes.
    pub pad: u32,
}

/// A quad patch. Side 0 lies at the least z, 1 at the greatest z (both run along +x), 2 at the
/// least x, 3 at the greatest x (both run along +z).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq)]
pub struct Patch {
    /// Corners at (x, z) = (0, 0), (1, 0), (0, 1), (1, 1).
    pub corners: [u32; 4],
    /// Two edges a side; the second is [`NONE`] where the neighbour is not finer.
    pub edges: [u32; 8],
    /// Least height of the ground in it, metres (conservative).
    pub min_height: f32,
    /// Greatest height of the ground in it, metres (conservative).
    pub max_height: f32,
    /// Written by `levels`: 1 when it meets the view frustum, 2 when only its shadow may, else 0.
    pub visible: u32,
    /// Written by `plan`: index of its first inner vertex.
    pub vertex: u32,
    /// Written by `plan`: its first triangle.
    pub triangle: u32,
    /// Written by `plan`: inner segments along x in the low half, along z in the high half.
    pub inner: u32,
    /// Keeps the stride at 80 bytes.
    pub pad: [u32; 2],
}

impl Patch {
    /// Whether the patch is emitted: it is seen, or its shadow may be.
    pub const fn drawn(&self) -> bool {
        self.visible != 0
    }
}

/// What the compute passes know of the view. Positions are relative to `anchor`, metres.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq)]
pub struct ViewParams {
    /// Frustum half-spaces (inward normal, distance): inside where dot(n, p) + d >= 0.
    pub planes: [[f32; 4]; 6],
    /// How far shadows reach from the highest ground down to the lowest, along the light, metres;
    /// 0 without shadows. Ground outside the frustum is kept where it shades what is inside.
    pub sweep: [f32; 4],
    /// The point that detail follows.
    pub eye: [f32; 3],
    /// Wanted segments of an edge are its length times this over its distance:
    /// focal length in pixels / wanted pixels an edge.
    pub segments_per_radian: f32,
    /// Whole metres (x, z) that positions are relative to.
    pub anchor: [i32; 2],
    /// Number of corners.
    pub corner_count: u32,
    /// Number of edges.
    pub edge_count: u32,
    /// Number of patches.
    pub patch_count: u32,
    /// Vertex pool, vertices.
    pub max_vertices: u32,
    /// Index pool, triangles.
    pub max_triangles: u32,
    /// Height of the sea, metres; −1e30 without a sea.
    pub sea_level: f32,
}

/// A vertex as `emit` stores it: 16 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq)]
pub struct Vertex {
    /// Position relative to the anchor, metres; y is the height of the ground (the sea bed below
    /// the sea).
    pub position: [f32; 3],
    /// Gradient (dh/dx, dh/dz) as two f16, dh/dx in the low half.
    pub gradient: u32,
}

/// What `plan` writes: the arguments of the draws, then the counters.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable, PartialEq, Eq)]
pub struct PlanResult {
    /// `draw_indexed_indirect`: index count, 1, first index 0, base vertex 0, first instance 0.
    pub indexed: [u32; 5],
    /// `draw_indirect` of the same triangles, their indices fetched by the shader.
    pub plain: [u32; 4],
    /// Vertices emitted.
    pub vertices: u32,
    /// Triangles emitted.
    pub triangles: u32,
    /// Patches in the frustum.
    pub drawn: u32,
    /// Patches outside of it.
    pub culled: u32,
    /// How often all levels were lowered by a fifth to fit the pools.
    pub lowered: u32,
    /// Keeps the size at 64 bytes.
    pub pad: [u32; 2],
}
