//! Patches with control points, and which corners and edges they share.

use bevy::platform::collections::HashMap;
pub use dolomite_geometry::layout::BINDING_LIMIT;
use thiserror::Error;

use super::Domain;
pub use super::topology::{REVERSED, Topology, WHOLE};

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
    /// [`PatchMesh::with_middles`]. OpenGL's patches have no such sides.
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

/// Patches over shared control points. Immutable: share it by `Arc` among any number of entities.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchMesh {
    layout: PatchLayout,
    points: Vec<[f32; 4]>,
    indices: Vec<u32>,
    topology: Topology,
}

impl PatchMesh {
    /// Patches of `layout`: `points` holds `point_size` vec4 each, `indices` names the control
    /// points of each patch in turn. An empty mesh is allowed: nothing is drawn.
    ///
    /// # Errors
    /// [`PatchMeshError`].
    pub fn new(
        layout: PatchLayout,
        points: Vec<[f32; 4]>,
        indices: Vec<u32>,
    ) -> Result<Self, PatchMeshError> {
        let patches = indices.len() / layout.points.max(1) as usize;
        let middles = vec![[WHOLE; 4]; if layout.split { patches } else { 0 }];
        Self::with_middles(layout, points, indices, &middles)
    }

    /// As [`Self::new`] for a layout with split sides: `middles` names for each patch the control
    /// point in the middle of each of its sides where two patches of half the length lie along it,
    /// and [`WHOLE`] for the other sides. Those two own the vertices on the side, so there is no
    /// crack and no T-junction. Control functions give the level of the whole side; each half gets
    /// half of it.
    ///
    /// # Errors
    /// [`PatchMeshError`].
    pub fn with_middles(
        layout: PatchLayout,
        points: Vec<[f32; 4]>,
        indices: Vec<u32>,
        middles: &[[u32; 4]],
    ) -> Result<Self, PatchMeshError> {
        let PatchLayout {
            points: per_patch,
            point_size,
            sides,
            domain,
            split,
        } = layout;
        let sided = sides.len() == side_count(domain)
            && sides.iter().all(|side| {
                side.len() >= 2
                    && (side.len() == 2 || !split)
                    && side.iter().all(|k| *k < per_patch)
            });
        if !(1..=255).contains(&per_patch) || !(1..=16).contains(&point_size) || !sided {
            return Err(PatchMeshError::Layout {
                points: per_patch,
                point_size,
            });
        }
        if !points.len().is_multiple_of(point_size as usize) {
            return Err(PatchMeshError::IncompletePoint {
                values: points.len(),
                point_size,
            });
        }
        if !indices.len().is_multiple_of(per_patch as usize) {
            return Err(PatchMeshError::IncompletePatch {
                indices: indices.len(),
                points: per_patch,
            });
        }
        let count = points.len() / point_size as usize;
        if let Some(place) = indices.iter().position(|index| *index as usize >= count) {
            return Err(PatchMeshError::IndexOutOfRange {
                patch: place / per_patch as usize,
                index: indices[place],
                points: count,
            });
        }
        let patches = indices.len() / per_patch as usize;
        if middles.len() != if split { patches } else { 0 } {
            return Err(PatchMeshError::Middles {
                middles: middles.len(),
                patches,
            });
        }
        let bytes = table_bytes(patches as u64, &layout);
        let point_bytes = points.len() as u64 * 16;
        if bytes.max(point_bytes) > BINDING_LIMIT {
            return Err(PatchMeshError::TooLarge {
                patches,
                bytes: bytes.max(point_bytes),
                limit: BINDING_LIMIT,
            });
        }
        let topology = Topology::new(layout, &indices, middles)?;
        Ok(Self {
            layout,
            points,
            indices,
            topology,
        })
    }

    /// Patches of `layout` from the control points of each in turn: points that are equal to the bit
    /// become one, so that patches share the edges that they have in common.
    ///
    /// # Errors
    /// [`PatchMeshError`].
    pub fn from_patches(layout: PatchLayout, patches: &[[f32; 4]]) -> Result<Self, PatchMeshError> {
        let size = layout.point_size.max(1) as usize;
        let mut known = HashMap::new();
        let mut points: Vec<[f32; 4]> = Vec::new();
        let mut indices = Vec::with_capacity(patches.len() / size);
        for point in patches.chunks(size) {
            // -0.0 + 0.0 is 0.0: both zeros are one.
            let bits: Vec<[u32; 4]> = point
                .iter()
                .map(|vec| vec.map(|x| (x + 0.0).to_bits()))
                .collect();
            indices.push(*known.entry(bits).or_insert_with(|| {
                points.extend_from_slice(point);
                (points.len() / size) as u32 - 1
            }));
        }
        Self::new(layout, points, indices)
    }

    /// What its patches are made of.
    #[must_use]
    pub const fn layout(&self) -> PatchLayout {
        self.layout
    }

    /// Control points, [`PatchLayout::point_size`] vec4 each.
    #[must_use]
    pub fn points(&self) -> &[[f32; 4]] {
        &self.points
    }

    /// Control points of each patch in turn.
    #[must_use]
    pub fn indices(&self) -> &[u32] {
        &self.indices
    }

    /// Number of patches.
    #[must_use]
    pub fn patches(&self) -> usize {
        self.topology.patches.len()
    }

    /// What the patches share.
    #[must_use]
    pub const fn topology(&self) -> &Topology {
        &self.topology
    }
}

const fn side_count(domain: Domain) -> usize {
    match domain {
        Domain::Triangles => 3,
        Domain::Quads => 4,
        Domain::Isolines => 0,
    }
}

/// The greater of what `patches` patches of one entity need in tables and in working memory when
/// they share nothing, bytes.
const fn table_bytes(patches: u64, layout: &PatchLayout) -> u64 {
    let tables = patches * (layout.patch_words() + layout.points as u64 + 8);
    // Four corners and four edges a patch: a word and an offset pair each; inner levels, segments and offsets.
    let work = patches * (8 * 3 + 5 + 2);
    4 * if tables > work { tables } else { work }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octahedron() -> PatchMesh {
        let points = [
            [1.0, 0.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
        ];
        let indices = [
            0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5,
        ];
        PatchMesh::new(
            PatchLayout::TRIANGLE,
            points.map(|[x, y, z]| [x, y, z, 1.0]).to_vec(),
            indices.to_vec(),
        )
        .expect("an octahedron")
    }

    #[test]
    fn an_octahedron_has_six_corners_and_twelve_edges() {
        let mesh = octahedron();
        let topology = mesh.topology();
        assert_eq!(
            (
                topology.corners.len(),
                topology.edges.len(),
                topology.patches.len()
            ),
            (6, 12, 8)
        );
        // Each edge is used twice, once in each direction.
        for edge in 0..12 {
            let used: Vec<u32> = topology
                .patches
                .iter()
                .flat_map(|patch| patch[4..7].iter().copied())
                .filter(|word| word & !REVERSED == edge)
                .collect();
            assert_eq!(used.len(), 2);
            assert_eq!((used[0] ^ used[1]) & REVERSED, REVERSED);
        }
    }

    #[test]
    fn a_side_without_length_is_shared_with_nobody() {
        let mesh = PatchMesh::new(
            PatchLayout::QUAD,
            vec![[0.0; 4]; 4],
            vec![0, 1, 2, 2, 2, 2, 1, 3],
        );
        let mesh = mesh.expect("folded patches are allowed");
        // Of patch 0: side 3 from 2 to 2; of patch 1: side 1 from 2 to 2.
        assert_ne!(mesh.topology.patches[0][7], mesh.topology.patches[1][5]);
    }

    #[test]
    fn a_split_side_is_the_sides_of_two_others() {
        // A quad above two smaller ones: points 0 1 2 along y = 0, 3 4 along y = 1, 5 6 7 along -0.5.
        let mesh = PatchMesh::with_middles(
            PatchLayout::QUAD.with_split_sides(),
            vec![[0.0; 4]; 8],
            vec![0, 2, 4, 3, 5, 6, 1, 0, 6, 7, 2, 1],
            &[[WHOLE, 1, WHOLE, WHOLE], [WHOLE; 4], [WHOLE; 4]],
        )
        .expect("three patches");
        let Topology {
            patches,
            halves,
            corners,
            edges,
        } = mesh.topology();
        assert_eq!((corners.len(), edges.len()), (8, 10));
        // Its first half runs against side 3 of the first small one, which comes later.
        assert_eq!(patches[0][5] & !REVERSED, patches[1][7]);
        assert_eq!(halves[0][5] & !REVERSED, patches[2][7]);
        assert_eq!(patches[0][5] & halves[0][5] & REVERSED, REVERSED);
        assert_eq!(halves[0][1], patches[1][2]);
        assert_eq!(halves[0][0], WHOLE);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let mesh = |points: usize, indices: &[u32]| {
            PatchMesh::new(
                PatchLayout::TRIANGLE,
                vec![[0.0; 4]; points],
                indices.to_vec(),
            )
        };
        assert!(mesh(0, &[]).is_ok());
        assert_eq!(
            mesh(3, &[0, 1]),
            Err(PatchMeshError::IncompletePatch {
                indices: 2,
                points: 3
            })
        );
        assert_eq!(
            mesh(3, &[0, 1, 2, 0, 1, 3]),
            Err(PatchMeshError::IndexOutOfRange {
                patch: 1,
                index: 3,
                points: 3
            })
        );
        let odd = PatchLayout::TRIANGLE.with_point_size(2);
        assert!(matches!(
            PatchMesh::new(odd, vec![[0.0; 4]; 3], vec![]),
            Err(PatchMeshError::IncompletePoint { .. })
        ));
        let halves = PatchLayout::QUAD.with_split_sides();
        let quad = |middles: &[[u32; 4]]| {
            PatchMesh::with_middles(halves, vec![[0.0; 4]; 5], vec![0, 1, 2, 3], middles)
        };
        assert!(quad(&[[WHOLE; 4]]).is_ok());
        assert_eq!(
            quad(&[]),
            Err(PatchMeshError::Middles {
                middles: 0,
                patches: 1
            })
        );
        assert_eq!(
            quad(&[[WHOLE, 4, WHOLE, WHOLE]]),
            Err(PatchMeshError::NoHalves {
                patch: 0,
                side: 1,
                middle: 4
            })
        );
        let many = PatchMesh::new(
            PatchLayout::TRIANGLE,
            vec![[0.0; 4]; 3],
            vec![0; 3 * 2_000_000],
        );
        assert!(matches!(many, Err(PatchMeshError::TooLarge { .. })));
    }
}
