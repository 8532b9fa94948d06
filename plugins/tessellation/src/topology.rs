//! Which corners and edges the patches of a mesh share.

use std::hash::Hash;

use bevy::platform::collections::HashMap;

use super::patch_layout::{PatchLayout, PatchMeshError};

/// Corners and edges of a mesh: each is owned by the first patch that has it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    /// Owner of each corner: patch · 4 + corner of the patch.
    pub corners: Vec<u32>,
    /// Owner of each edge: patch · 4 + side of the patch.
    pub edges: Vec<u32>,
    /// Of each patch: its corners, then its edges; [`REVERSED`] is set where the edge runs against
    /// the patch's side. Of a split side: the edge of its first half.
    pub patches: Vec<[u32; 8]>,
    /// Of each patch of a layout with split sides: the corners in the middle of its sides, then the
    /// edges of their second halves; [`WHOLE`] for sides that are not split. Else empty.
    pub halves: Vec<[u32; 8]>,
}

/// In place of a middle: the side is not split.
pub const WHOLE: u32 = u32::MAX;

/// Marks an edge that runs against the side of the patch.
pub const REVERSED: u32 = 1 << 31;

/// Edges by the points along them, in the direction that sorts first: number, and whether the owner
/// runs the other way.
type EdgesBy<K> = HashMap<K, (u32, bool)>;

impl Topology {
    /// Links the patches of `layout`; `middles` as [`PatchMesh::with_middles`]
    /// (super::PatchMesh::with_middles) takes them.
    pub(super) fn new(
        layout: PatchLayout,
        indices: &[u32],
        middles: &[[u32; 4]],
    ) -> Result<Self, PatchMeshError> {
        if layout.sides.iter().all(|side| side.len() == 2) {
            // Ends alone: no allocation a side.
            Self::link(layout, indices, middles, |along| [along[0], along[1]])
        } else {
            Self::link(layout, indices, middles, <[u32]>::to_vec)
        }
    }

    fn link<K: Hash + Eq>(
        layout: PatchLayout,
        indices: &[u32],
        middles: &[[u32; 4]],
        key: impl Fn(&[u32]) -> K,
    ) -> Result<Self, PatchMeshError> {
        let patches = indices.len() / layout.points as usize;
        let mut topology = Self::default();
        topology.patches.reserve(patches);
        let mut corners = HashMap::with_capacity(patches);
        let mut edges: EdgesBy<K> = HashMap::with_capacity(2 * patches);
        let mut along = Vec::with_capacity(16);
        for (patch, points) in (0_u32..).zip(indices.chunks_exact(layout.points as usize)) {
            let mut own = [0; 8];
            for (k, side) in layout.sides.iter().enumerate() {
                along.clear();
                along.extend(side.iter().map(|k| points[*k as usize]));
                let (from, to) = (along[0], along[along.len() - 1]);
                own[k] = *corners.entry(to).or_insert_with(|| {
                    topology.corners.push(patch * 4 + k as u32);
                    topology.corners.len() as u32 - 1
                });
                if middles.get(patch as usize).is_some_and(|of| of[k] != WHOLE) {
                    // Its halves belong to the patches along them.
                    continue;
                }
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
                    *edges.entry(key(&along)).or_insert_with(new)
                };
                own[4 + k] = marked(edge, owner_backwards != backwards);
            }
            topology.patches.push(own);
        }
        for (patch, of) in middles.iter().enumerate() {
            let mut halves = [WHOLE; 8];
            let points = &indices[patch * layout.points as usize..];
            for (k, side) in layout.sides.iter().enumerate() {
                let middle = of[k];
                if middle == WHOLE {
                    continue;
                }
                let find = |from: u32, to: u32| {
                    let backwards = from > to;
                    let ends = [from.min(to), from.max(to)];
                    let (edge, owner_backwards) = edges.get(&key(&ends))?;
                    Some(marked(*edge, *owner_backwards != backwards))
                };
                let ends = [side[0], side[1]].map(|k| points[k as usize]);
                let found = (
                    find(ends[0], middle),
                    find(middle, ends[1]),
                    corners.get(&middle),
                );
                let (Some(first), Some(second), Some(corner)) = found else {
                    return Err(PatchMeshError::NoHalves {
                        patch,
                        side: k,
                        middle,
                    });
                };
                topology.patches[patch][4 + k] = first;
                halves[k] = *corner;
                halves[4 + k] = second;
            }
            topology.halves.push(halves);
        }
        Ok(topology)
    }
}

const fn marked(edge: u32, reversed: bool) -> u32 {
    if reversed { edge | REVERSED } else { edge }
}
