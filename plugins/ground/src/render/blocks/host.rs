//! The same on the CPU, for kinds that ask for it: the CPU reference chooses and places, and what it made is uploaded.

use bevy::math::{UVec2, Vec2, Vec3};
use bevy::render::renderer::RenderQueue;
use bytemuck::{Zeroable, cast_slice};
use dolomite_geometry::layout::{GeometryHead, OWN};
use dolomite_geometry::render::{GeometryShared, GeometryView};
use dolomite_geometry::vertex::pack;
use dolomite_terrain::GroundPoint;

use super::state::BlockState;
use super::store::BlockStore;
use crate::blocks::choose::{Limits, settle};
use crate::blocks::kept::KeptBlocks;
use crate::blocks::layout::{
    HEAD_CANDIDATES, HEAD_COARSENING, HEAD_CURVE, HEAD_DRAWN, HEAD_LEFT, HEAD_STAMP, HEAD_USED,
};
use crate::blocks::mesh::{BlockVertex, mesh};
use crate::detail::{DetailLattice, DetailView};
use crate::range::DEPTH_RANGE;

/// Fills the pools of a view that changed, by the newest choice of the store. All that is missing is made at once; what nearer
/// ground hides is drawn, as the picture is the same.
pub(super) fn choose(
    own: &mut BlockState,
    store: &mut BlockStore,
    state: &mut GeometryView,
    (queue, shared): (&RenderQueue, &GeometryShared),
) {
    own.stamp = store.stamp;
    let BlockStore { kept, ground, .. } = store;
    let kept = kept.get_or_insert_with(|| KeptBlocks::on(ground.terrain().clone(), ground.lattice));
    let (inputs, pool) = (&own.inputs, state.pool);
    let room = pool.vertices.min(pool.primitives / 2);
    let limits = Limits {
        vertices: room.min(inputs.detail.max_vertices),
        ..Limits::default()
    };
    kept.keep = own.slots as usize;
    let choice = settle(kept, &inputs.view, limits);
    let made = mesh(kept, &choice);
    let anchor_height = state.frame.anchor.y as f32;
    let stored = |vertex| {
        stored(
            vertex,
            &inputs.view,
            &kept.lattice,
            kept.sea(),
            anchor_height,
        )
    };
    // Roots are there even where the pools are smaller.
    let room = pool.vertices as usize;
    let vertices: Vec<[u32; 5]> = made.vertices.iter().take(room).map(stored).collect();
    let fits = |triangle: &&[u32; 3]| triangle.iter().all(|&corner| (corner as usize) < room);
    let triangles = made.triangles.iter().filter(fits);
    let mut triangles: Vec<[u32; 3]> = triangles.take(pool.primitives as usize).copied().collect();
    let mut seen = triangles.len();
    if let Some((picture, shadowed)) = &inputs.culled {
        let place = |vertex: &[u32; 5]| Vec3::from([0, 1, 2].map(|k| f32::from_bits(vertex[k])));
        let places: Vec<Vec3> = vertices.iter().map(place).collect();
        seen = picture.sort(&mut triangles, &places);
        if !shadowed {
            triangles.truncate(seen);
        }
    }
    let count = 3 * seen as u32;
    let others = 3 * triangles.len() as u32 - count;
    let mut head = GeometryHead {
        indexed: [count, 1, 0, 0, 0],
        plain: [count, 1, 0, 0],
        vertices: vertices.len() as u32,
        primitives: count / 3,
        wanted_vertices: made.vertices.len() as u32,
        wanted_primitives: made.triangles.len() as u32,
        others: [others, 1, count, 0, 0],
        ..GeometryHead::zeroed()
    };
    let drawn = choice
        .blocks
        .iter()
        .filter(|block| choice.exists(block, kept));
    // Vertices go with one over the tolerance: without the coarsening there would be about so many.
    let needed = made.vertices.len() as f32 * choice.coarsening;
    for (word, value) in [
        (HEAD_COARSENING, choice.coarsening.to_bits()),
        (HEAD_LEFT, choice.held.to_bits()),
        (HEAD_USED, kept.len() as u32),
        (HEAD_CANDIDATES, choice.blocks.len() as u32),
        (HEAD_DRAWN, drawn.count() as u32),
        (HEAD_STAMP, own.stamp),
        (HEAD_CURVE, needed as u32),
    ] {
        head.own[word - OWN as usize] = value;
    }
    let (vertices, indices) = (cast_slice(&vertices), cast_slice(&triangles));
    state.upload(queue, shared, [vertices, indices], head);
}

/// A vertex as it is stored, see `emit.wgsl`.
fn stored(
    vertex: &BlockVertex,
    view: &DetailView,
    lattice: &DetailLattice,
    sea: f32,
    anchor_height: f32,
) -> [u32; 5] {
    let anchor = GroundPoint {
        cell: view.anchor(),
        frac: UVec2::ZERO,
    };
    let place = lattice.point(vertex.at).relative_to(anchor);
    let slope = Vec3::new(-vertex.gradient.x, 1.0, -vertex.gradient.y);
    let depth = ((sea - vertex.bed) / DEPTH_RANGE).clamp(-1.0, 1.0);
    pack(
        Vec3::new(place.x, vertex.height - anchor_height, place.y),
        slope.normalize(),
        Vec2::new(depth, 0.0),
        0,
    )
}
