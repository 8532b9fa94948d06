//! The leaves of the quadtree as patches of the tessellation stage.
//!
//! A leaf is a quad; where two finer leaves lie along one of its sides, that side is split between
//! their edges (`PatchLayout::with_split_sides`), so that both sides of every edge draw the very same
//! vertices.

use std::sync::Arc;

use bevy::math::{DVec2, IVec2, UVec2};
use bevy::platform::collections::HashMap;
use dolomite_terrain::GroundPoint;

use super::lattice::{Lattice, Node};
use dolomite_tessellation::patches::WHOLE;
use dolomite_tessellation::{PatchLayout, PatchMesh, PatchMeshError};

/// A quad (u towards +x, v towards −z) of four corners, (0,0), (1,0), (1,1) and (0,1): place and
/// height relative to the origin, metres. A fifth point holds the least and the greatest height of the
/// ground in the patch.
pub const GROUND_LAYOUT: PatchLayout = PatchLayout {
    points: 5,
    ..PatchLayout::QUAD.with_split_sides()
};

/// Corners of a leaf in half sides, in the order of the control points.
const CORNERS: [UVec2; 4] = [
    UVec2::new(0, 2),
    UVec2::new(2, 2),
    UVec2::new(2, 0),
    UVec2::new(0, 0),
];

/// Middles of its sides u = 0, v = 0, u = 1, v = 1.
const MIDDLES: [UVec2; 4] = [
    UVec2::new(0, 1),
    UVec2::new(1, 2),
    UVec2::new(2, 1),
    UVec2::new(1, 0),
];

/// Patches that cover the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundPatches {
    /// One a leaf, in the leaves' order.
    pub mesh: Arc<PatchMesh>,
    /// What its points are relative to, whole metres (x, z): near the finest patches, and the same
    /// for the same leaves.
    pub origin: IVec2,
}

impl GroundPatches {
    /// The patches of a balanced quadtree's leaves. `bounds` gives (least, greatest) height of a
    /// node, `heights` those of a list of points.
    ///
    /// # Errors
    /// [`PatchMeshError`]: more leaves than a buffer holds, or a quadtree that is not balanced.
    pub fn new(
        lattice: &Lattice,
        leaves: &[Node],
        mut bounds: impl FnMut(Node) -> (f32, f32),
        heights: impl FnOnce(&[GroundPoint]) -> Vec<f32>,
    ) -> Result<Self, PatchMeshError> {
        let origin = leaves.first().map_or(DVec2::ZERO, |finest| {
            lattice.position(finest.corner).floor()
        });
        // In half lattice steps, so that middles are whole.
        let mut corners: HashMap<UVec2, u32> = HashMap::with_capacity(2 * leaves.len());
        let mut places = Vec::with_capacity(2 * leaves.len());
        let at = |leaf: &Node, offset: UVec2| 2 * leaf.corner + offset * leaf.side;
        let mut indices = Vec::with_capacity(5 * leaves.len());
        for leaf in leaves {
            for offset in CORNERS {
                let point = at(leaf, offset);
                indices.push(*corners.entry(point).or_insert_with(|| {
                    places.push(lattice.position(point / 2) - origin);
                    places.len() as u32 - 1
                }));
            }
            indices.push(0);
        }
        let middles: Vec<[u32; 4]> = leaves
            .iter()
            .map(|leaf| MIDDLES.map(|middle| corners.get(&at(leaf, middle)).copied()))
            .map(|of| of.map(|corner| corner.unwrap_or(WHOLE)))
            .collect();
        // The surface is evaluated at the rounded places: rounding moves a vertex along it.
        let rounded: Vec<_> = places.iter().map(|place| place.as_vec2()).collect();
        let ground: Vec<GroundPoint> = rounded
            .iter()
            .map(|place| GroundPoint::new(origin).offset(place.as_dvec2()))
            .collect();
        let mut points: Vec<[f32; 4]> = rounded
            .iter()
            .zip(heights(&ground))
            .map(|(place, height)| [place.x, height, place.y, 0.0])
            .collect();
        for (leaf, patch) in leaves.iter().zip(indices.chunks_exact_mut(5)) {
            let (least, greatest) = bounds(*leaf);
            patch[4] = points.len() as u32;
            points.push([least, greatest, 0.0, 0.0]);
        }
        Ok(Self {
            mesh: Arc::new(PatchMesh::with_middles(
                GROUND_LAYOUT,
                points,
                indices,
                &middles,
            )?),
            origin: origin.as_ivec2(),
        })
    }
}

impl Default for GroundPatches {
    fn default() -> Self {
        let none = PatchMesh::new(GROUND_LAYOUT, Vec::new(), Vec::new());
        Self {
            mesh: Arc::new(none.expect("a mesh without patches is one")),
            origin: IVec2::ZERO,
        }
    }
}
