//! The tessellation stage in Rust: any patch of triangles, quads or isolines, as OpenGL 4.6 and
//! Vulkan 1.3 specify it, in integers from the levels on, so that it gives the same bits on every
//! machine; the WGSL in `shaders/src/stage/` is the same on the GPU, integer for integer.
//!
//! ```
//! use dolomite_tessellation::{Domain, Levels, Spacing, tessellate};
//!
//! let levels = Levels { outer: [4.0; 4], inner: [4.0; 2] };
//! let mesh = tessellate(Domain::Triangles, Spacing::Equal, levels);
//! assert_eq!((mesh.coordinates.len(), mesh.primitives.len()), (19, 24));
//! ```
//!
//! Conventions. Coordinates are (u, v, w), multiples of 2⁻²⁴ in [0, 1]; quads and isolines have
//! w = 0, triangles u + v + w = 1 to the bit. The plane of the domain has u to the right and v up:
//! a triangle is counter-clockwise there where u₁v₂ − u₂v₁ > 0 for its two edges, as OpenGL has it.
//! Corners go round counter-clockwise: (0,0), (1,0), (1,1), (0,1) of a quad; w, u, v of a triangle.
//! Side `s` is the one of `outer[s]` (u = 0, v = 0, then u = 1 and v = 1, or w = 0) and goes round
//! counter-clockwise too: from corner s − 1 to corner s.
//!
//! | part | what it does |
//! |---|---|
//! | [`level`] | clamps and rounds what the control function wrote |
//! | [`place`] | where a vertex lies along an edge |
//! | [`ruler`] | in which order a strip between two rows of vertices is stitched |
//! | [`shape`] | counts; which vertices a primitive joins |
//! | [`coordinate`] | where an inner vertex lies |
//! | [`patches`] | patches with control points; which corners and edges they share |
//! | `tables`, `layout` | what the passes on the GPU read and write |
//! | `passes` | which these are |
//! | [`HostFunctions`] | functions of a kind in Rust: the stage without dispatches |
//! | [`half_edge`] | whether triangles form a manifold with the border that they should have |

mod components;
pub mod coordinate;
pub mod half_edge;
mod host;
#[doc(hidden)]
pub mod layout;
pub mod level;
mod mesh;
#[doc(hidden)]
pub mod passes;
mod patch_layout;
pub mod patches;
pub mod place;
#[cfg(feature = "render")]
pub mod render;
pub mod ruler;
pub mod shape;
pub mod shapes;
#[doc(hidden)]
pub mod tables;
mod tessellate;
mod topology;

pub use components::Patches;
pub use dolomite_geometry::GeometryCamera;
pub use host::{HostFunctions, HostPatch, HostTessellation, HostVertex, tessellate_host};
pub use level::Levels;
pub use mesh::{MeshTessellation, MeshVertex};
pub use patches::{PatchLayout, PatchMesh, PatchMeshError};
pub use tessellate::{Primitives, Tessellation, Tessellator, tessellate};

/// The parameter space of a patch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Domain {
    /// Barycentric (u, v, w): three outer levels, one inner level.
    #[default]
    Triangles,
    /// The unit square: four outer levels, two inner levels (`inner[0]` along u).
    Quads,
    /// Horizontal lines in the unit square: `outer[0]` lines of `outer[1]` segments.
    Isolines,
}

impl Domain {
    /// Sides whose levels count: 3, 4 or 2.
    #[must_use]
    pub const fn outer_levels(self) -> usize {
        match self {
            Self::Triangles => 3,
            Self::Quads => 4,
            Self::Isolines => 2,
        }
    }

    /// Inner levels that count: 1, 2 or 0.
    #[must_use]
    pub const fn inner_levels(self) -> usize {
        match self {
            Self::Triangles => 1,
            Self::Quads => 2,
            Self::Isolines => 0,
        }
    }
}

/// How levels become segments, and where the vertices between them lie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Spacing {
    /// Segments of one length; levels are rounded up.
    #[default]
    Equal,
    /// An even number of segments, two of which grow out of nothing as the level rises.
    FractionalEven,
    /// An odd number of segments, two of which grow out of nothing as the level rises.
    FractionalOdd,
}

/// The orientation of triangles in the (u, v) plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Winding {
    /// Counter-clockwise.
    #[default]
    Ccw,
    /// Clockwise.
    Cw,
}

/// Where vertices are evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Drawing {
    /// Once, in the compute pass; the draws of all views read 20 bytes a vertex. For functions that
    /// cost more than memory, and for many shadow views.
    #[default]
    Stored,
    /// In the vertex shader of every draw, from patch and coordinate, 12 bytes a vertex. For
    /// functions that follow the time while the levels rest: nothing is dispatched for those.
    Evaluated,
}

/// How exactly coordinates are placed. Both modes make the same primitives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mode {
    /// Within 2⁻²⁴ of the rational number that the spacing defines, exactly symmetric.
    #[default]
    Exact,
    /// The bits of the 16.16 fixed-point reference tessellator of Direct3D 11, which software and
    /// hardware drivers follow. Off by up to 2e-4 along edges and 2.7e-4 inside triangles; at even
    /// levels just above 6 and 30 its rounding folds the two middle segments over each other by up
    /// to 7 / 65536, as the reference does.
    D3d,
}
