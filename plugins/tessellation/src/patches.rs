//! Patches with control points, and which corners and edges they share.

use bevy::platform::collections::HashMap;
pub use dolomite_geometry::layout::BINDING_LIMIT;

use super::Domain;
pub use super::patch_layout::{PatchLayout, PatchMeshError};
pub use super::topology::{REVERSED, Topology, WHOLE};

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
