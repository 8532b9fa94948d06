//! What a patch is made of, and why a mesh of patches cannot be.

use thiserror::Error;

use super::Domain;

/// What a patch of a kind is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PatchLayout {
    /// Parameter space.
    pub domain: Domain,
    /// Control points a patch, 1 to 255.
    pub points: u32,
    /// vec4 (four numbers) a control point, 1 to 16.
    pub point_size: u32,
    /// Control points along each side, from its start to its end, counter-clockwise from side 0 on:
    /// patches that have all points of a side in common share it, in either direction; the last
    /// point of a side is its corner. Empty for isolines.
    pub sides: &'static [&'static [u32]],
    /// Whether a side may lie along two patches of half its length, as in a balanced quadtree; see
    /// [`PatchMesh::with_middles`](super::PatchMesh::with_middles). OpenGL's patches have no such sides.
    pub split: bool,
}

impl PatchLayout {
    /// Three control points: at u = 1, at v = 1 and at w = 1, as `gl_TessCoord` weighs them.
    pub const TRIANGLE: Self = Self {
        domain: Domain::Triangles,
        points: 3,
        point_size: 1,
        sides: &[&[1, 2], &[2, 0], &[0, 1]],
        split: false,
    };

    /// Four control points: (u, v) = (0,0), (1,0), (1,1), (0,1).
    pub const QUAD: Self = Self {
        domain: Domain::Quads,
        points: 4,
        point_size: 1,
        sides: &[&[3, 0], &[0, 1], &[1, 2], &[2, 3]],
        split: false,
    };

    /// Sixteen control points, row by row: point 4 j + i stands at (i / 3, j / 3).
    pub const BICUBIC: Self = Self {
        domain: Domain::Quads,
        points: 16,
        point_size: 1,
        sides: &[
            &[12, 8, 4, 0],
            &[0, 1, 2, 3],
            &[3, 7, 11, 15],
            &[15, 14, 13, 12],
        ],
        split: false,
    };

    /// Lines of `points` control points.
    #[must_use]
    pub const fn lines(points: u32) -> Self {
        Self {
            domain: Domain::Isolines,
            points,
            point_size: 1,
            sides: &[],
            split: false,
        }
    }

    /// The same with more numbers a control point.
    #[must_use]
    pub const fn with_point_size(mut self, vec4s: u32) -> Self {
        self.point_size = vec4s;
        self
    }

    /// The same with sides that may lie along two patches each.
    #[must_use]
    pub const fn with_split_sides(mut self) -> Self {
        self.split = true;
        self
    }

    /// Words of a patch in the tables of the GPU: entity, number, first index, first point, four
    /// corners, four edges; of a layout with split sides four middles and four second edges too.
    #[must_use]
    pub const fn patch_words(&self) -> u64 {
        if self.split { 20 } else { 12 }
    }
}

/// Why patches cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PatchMeshError {
    /// Not a whole number of patches.
    #[error(
        "{indices} control point indices do not make patches of {points}; pass {points} for each patch"
    )]
    IncompletePatch {
        /// Indices given.
        indices: usize,
        /// Control points a patch.
        points: u32,
    },
    /// Not a whole number of control points.
    #[error(
        "{values} vec4 do not make control points of {point_size}; pass {point_size} for each point"
    )]
    IncompletePoint {
        /// vec4 given.
        values: usize,
        /// vec4 a control point.
        point_size: u32,
    },
    /// An index beyond the control points.
    #[error("patch {patch} uses control point {index}, but there are {points}")]
    IndexOutOfRange {
        /// Which patch.
        patch: usize,
        /// What it names.
        index: u32,
        /// How many there are.
        points: usize,
    },
    /// A layout that no patch can have.
    #[error(
        "a patch layout needs 1 to 255 control points of 1 to 16 vec4, with 2 or more of them along each side, exactly 2 where sides are split; got {points} of {point_size}"
    )]
    Layout {
        /// Control points a patch.
        points: u32,
        /// vec4 a control point.
        point_size: u32,
    },
    /// Middles for another number of patches, or for a layout whose sides are not split.
    #[error(
        "{middles} rows of middles for {patches} patches; pass one for each patch of a layout made by with_split_sides"
    )]
    Middles {
        /// Rows given.
        middles: usize,
        /// Patches there are.
        patches: usize,
    },
    /// A side is said to be split, but no patches lie along its halves.
    #[error(
        "side {side} of patch {patch} is split at control point {middle}, but no other patch has each of its halves as a side"
    )]
    NoHalves {
        /// Which patch.
        patch: usize,
        /// Which side.
        side: usize,
        /// The point in the middle.
        middle: u32,
    },
    /// More than WebGPU's default limit of 128 MiB for a buffer that a shader reads.
    #[error(
        "{patches} patches need {bytes} bytes of tables, more than the {limit} that a buffer may have; split them among several entities' meshes or use fewer"
    )]
    TooLarge {
        /// Patches given.
        patches: usize,
        /// What they need.
        bytes: u64,
        /// What there is.
        limit: u64,
    },
}
