//! The same on the CPU: the CPU reference chooses and places, and what it made is uploaded.

use bevy::math::{UVec2, Vec2, Vec3};
use bevy::render::renderer::RenderQueue;
use bytemuck::{Zeroable, cast_slice};
use dolomite_terrain::GroundPoint;

use super::state::DetailState;
use crate::detail::layout::{HEAD_COARSENING, HEAD_LEFT, HEAD_USED};
use crate::detail::mesh::mesh;
use crate::detail::select::select;
use crate::detail::{DetailCells, DetailVertex, DetailView, Horizon};
use crate::range::DEPTH_RANGE;
use dolomite_geometry::layout::{GeometryHead, OWN};
use dolomite_geometry::render::{GeometryShared, GeometryView};
use dolomite_geometry::vertex::pack;

/// Fills the pools of a view that changed.
pub(super) fn choose(
    own: &DetailState,
    ground: &mut DetailCells,
    view: DetailView,
    state: &mut GeometryView,
    queue: &RenderQueue,
    shared: &GeometryShared,
) {
    let pool = state.pool;
    let most = pool
        .vertices
        .min(pool.primitives / 2)
        .min(own.detail.max_vertices);
    let anchor_height = state.frame.anchor.y as f32;
    let selection = select(ground, &view, most);
    let made = mesh(ground, &selection);
    // Corners of the roots are not among the vertices that the selection counts.
    let room = pool.vertices as usize;
    let stored: Vec<[u32; 5]> = made
        .vertices
        .iter()
        .take(room)
        .map(|vertex| stored(vertex, &view, ground.sea(), anchor_height))
        .collect();
    let mut triangles: Vec<[u32; 3]> = made
        .triangles
        .iter()
        .filter(|triangle| triangle.iter().all(|&corner| (corner as usize) < room))
        .take(pool.primitives as usize)
        .copied()
        .collect();
    let mut seen = triangles.len();
    if let Some((picture, shadowed)) = &own.culled {
        let place = |vertex: &[u32; 5]| Vec3::from([0, 1, 2].map(|k| f32::from_bits(vertex[k])));
        let places: Vec<Vec3> = stored.iter().map(place).collect();
        let horizon = own
            .horizon(ground, &view, anchor_height)
            .map(|horizon| Horizon::of(horizon, ground, &selection, &view, anchor_height));
        let occluded = |corners: [Vec3; 3]| {
            let horizon = horizon.as_ref();
            horizon.is_some_and(|horizon| horizon.hides(corners))
        };
        seen = picture.sort(occluded, &mut triangles, &places);
        if !shadowed {
            triangles.truncate(seen);
        }
    }
    let count = 3 * seen as u32;
    let others = 3 * triangles.len() as u32 - count;
    let mut head = GeometryHead {
        indexed: [count, 1, 0, 0, 0],
        plain: [count, 1, 0, 0],
        vertices: stored.len() as u32,
        primitives: count / 3,
        wanted_vertices: made.vertices.len() as u32,
        wanted_primitives: made.triangles.len() as u32,
        others: [others, 1, count, 0, 0],
        ..GeometryHead::zeroed()
    };
    head.own[HEAD_COARSENING - OWN as usize] = selection.coarsening.to_bits();
    head.own[HEAD_LEFT - OWN as usize] = selection.held.to_bits();
    head.own[HEAD_USED - OWN as usize] = ground.len() as u32;
    let (vertices, indices) = (cast_slice(&stored), cast_slice(&triangles));
    state.upload(queue, shared, [vertices, indices], head);
}

/// A vertex as it is stored, see `place_vertices.wgsl`.
fn stored(vertex: &DetailVertex, view: &DetailView, sea: f32, anchor_height: f32) -> [u32; 5] {
    let anchor = GroundPoint {
        cell: view.anchor(),
        frac: UVec2::ZERO,
    };
    let place = vertex.point.relative_to(anchor);
    let slope = Vec3::new(-vertex.gradient.x, 1.0, -vertex.gradient.y);
    let depth = ((sea - vertex.bed) / DEPTH_RANGE).clamp(-1.0, 1.0);
    pack(
        Vec3::new(place.x, vertex.height - anchor_height, place.y),
        slope.normalize(),
        Vec2::new(depth, 0.0),
        0,
    )
}
