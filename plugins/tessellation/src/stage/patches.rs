//! Patches with control points, and which corners and edges they share.

use std::collections::HashMap;

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
}

impl PatchLayout {
    /// Three control points: at u = 1, at v = 1 and at w = 1, as `gl_TessCoord` weighs them.
    pub const TRIANGLE: Self = Self {
        domain: Domain::Triangles,
        points: 3,
        point_size: 1,
        sides: &[&[1, 2], &[2, 0], &[0, 1]],
    };

    /// Four control points: (u, v) = (0,0), (1,0), (1,1), (0,1).
    pub const QUAD: Self = Self {
        domain: Domain::Quads,
        points: 4,
        point_size: 1,
        sides: &[&[3, 0], &[0, 1], &[1, 2], &[2, 3]],
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
    };

    /// Lines of `points` control points.
    #[must_use]
    pub const fn lines(points: u32) -> Self {
        Self {
            domain: Domain::Isolines,
            points,
            point_size: 1,
            sides: &[],
        }
    }

    /// The same with more numbers a control point.
    #[must_use]
    pub const fn with_point_size(mut self, vec4s: u32) -> Self {
        self.point_size = vec4s;
        self
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
        "a patch layout needs 1 to 255 control points of 1 to 16 vec4, with 2 or more of them along each side; got {points} of {point_size}"
    )]
    Layout {
        /// Control points a patch.
        points: u32,
        /// vec4 a control point.
        point_size: u32,
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

/// Largest storage buffer that WebGPU promises, bytes.
pub const BINDING_LIMIT: u64 = 128 << 20;

/// Patches over shared control points. Immutable: share it by `Arc` among any number of entities.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchMesh {
    layout: PatchLayout,
    points: Vec<[f32; 4]>,
    indices: Vec<u32>,
    topology: Topology,
}

/// Corners and edges of a mesh: each is owned by the first patch that has it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    /// Owner of each corner: patch · 4 + corner of the patch.
    pub corners: Vec<u32>,
    /// Owner of each edge: patch · 4 + side of the patch.
    pub edges: Vec<u32>,
    /// Of each patch: its corners, then its edges; [`REVERSED`] is set where the edge runs against
    /// the patch's side.
    pub patches: Vec<[u32; 8]>,
}

/// Marks an edge that runs against the side of the patch.
pub const REVERSED: u32 = 1 << 31;

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
        let PatchLayout {
            points: per_patch,
            point_size,
            sides,
            domain,
        } = layout;
        let sided = sides.len() == side_count(domain)
            && sides
                .iter()
                .all(|side| side.len() >= 2 && side.iter().all(|k| *k < per_patch));
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
        let bytes = table_bytes(patches as u64, per_patch);
        let point_bytes = points.len() as u64 * 16;
        if bytes.max(point_bytes) > BINDING_LIMIT {
            return Err(PatchMeshError::TooLarge {
                patches,
                bytes: bytes.max(point_bytes),
                limit: BINDING_LIMIT,
            });
        }
        let topology = Topology::new(layout, &indices);
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

/// The words of a patch in the tables of the GPU, of which the last eight are its topology.
pub const PATCH_WORDS: u64 = 12;

/// The greater of what `patches` patches of one entity need in tables and in working memory when
/// they share nothing, bytes.
const fn table_bytes(patches: u64, points: u32) -> u64 {
    let tables = patches * (PATCH_WORDS + points as u64 + 8);
    // Four corners and four edges a patch: a word and an offset pair each; inner levels, segments and offsets.
    let work = patches * (8 * 3 + 4 + 2);
    4 * if tables > work { tables } else { work }
}

impl Topology {
    fn new(layout: PatchLayout, indices: &[u32]) -> Self {
        let mut topology = Self::default();
        let mut corners = HashMap::new();
        // By the points of an edge, in the direction that sorts first: its number, and whether its
        // owner runs the other way.
        let mut edges: HashMap<Vec<u32>, (u32, bool)> = HashMap::new();
        for (patch, points) in (0_u32..).zip(indices.chunks_exact(layout.points as usize)) {
            let mut own = [0; 8];
            for (k, side) in layout.sides.iter().enumerate() {
                let mut along: Vec<u32> = side.iter().map(|k| points[*k as usize]).collect();
                let (from, to) = (along[0], along[along.len() - 1]);
                own[k] = *corners.entry(to).or_insert_with(|| {
                    topology.corners.push(patch * 4 + k as u32);
                    topology.corners.len() as u32 - 1
                });
                let backwards = from > to;
                if backwards {
                    along.reverse();
                }
                let mut new = || {
                    topology.edges.push(patch * 4 + k as u32);
                    (topology.edges.len() as u32 - 1, backwards)
                };
                // A side that starts where it ends has no direction to share it by.
                let (edge, owner_backwards) = if from == to {
                    new()
                } else {
                    *edges.entry(along).or_insert_with(new)
                };
                own[4 + k] = if owner_backwards == backwards {
                    edge
                } else {
                    edge | REVERSED
                };
            }
            topology.patches.push(own);
        }
        topology
    }
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
        let many = PatchMesh::new(
            PatchLayout::TRIANGLE,
            vec![[0.0; 4]; 3],
            vec![0; 3 * 2_000_000],
        );
        assert!(matches!(many, Err(PatchMeshError::TooLarge { .. })));
    }
}
