//! Our choice under a camera: its view, its blocks, and the corners of its mesh.

use super::camera::Camera;
use super::mesh::GroundMesh;
use bevy::math::{DQuat, DVec3, EulerRot};
use bevy::platform::collections::HashMap;
use dolomite_ground::blocks::choose::{Choice, Limits, settle};
use dolomite_ground::blocks::kept::{KeptBlocks, lattice_of};
use dolomite_ground::blocks::mesh::{BlockMesh, BlockVertex, mesh};
use dolomite_ground::detail::layout::DetailParams;
use dolomite_ground::detail::{DetailGround, DetailView, Lens, Metric, TerrainLod};
use dolomite_terrain::Terrain;
use std::hash::Hash;

/// Side of the smallest cell, metres: a 64th, so that few views of the study reach it.
pub const FINEST: f32 = 1.0 / 64.0;

/// Blocks that are kept: less than half a gigabyte, and more than any view of the studies asks for within its bound.
pub const KEEP: usize = 1 << 15;

/// The blocks of a ground, of which there are the roots; many are kept, since making them is what takes time.
#[must_use]
pub fn blocks_of(terrain: &Terrain, finest: f32) -> KeptBlocks {
    let mut blocks = KeptBlocks::new(terrain.clone(), finest);
    blocks.keep = KEEP;
    blocks
}

/// What the passes are told of a ground: the lattice of its blocks.
#[must_use]
pub fn ground_of(terrain: &Terrain, finest: f32) -> DetailGround {
    DetailGround::on(terrain.clone(), lattice_of(terrain, finest))
}

/// A camera as the choice sees it: in f64 to the anchor, then in f32.
#[must_use]
pub fn detail_view(camera: &Camera, metric: Metric) -> DetailView {
    let turn = DQuat::from_euler(EulerRot::YXZ, camera.yaw, camera.pitch, camera.roll);
    let lens = match camera.orthographic {
        Some(metres) => Lens::Orthographic(metres),
        None => Lens::Perspective((camera.fov_y / 2.0).tan()),
    };
    let mut view = DetailView::new(camera.eye, turn, lens, camera.size, camera.near);
    view.set_metric(&TerrainLod {
        metric,
        ..TerrainLod::default()
    });
    view
}

/// What the passes are told of a camera, with room for so many vertices and triangles: heights relative to
/// whole metres near the eye, as the renderer has them.
#[must_use]
pub fn params(
    ground: &DetailGround,
    camera: &Camera,
    metric: Metric,
    pools: [u32; 2],
) -> DetailParams {
    let view = detail_view(camera, metric);
    DetailParams {
        anchor_height: camera.eye.y.floor() as f32,
        ..DetailParams::new(ground, view, 0, pools)
    }
}

/// The metric that holds errors to `tau` pixels.
#[must_use]
pub fn bound(tau: f64) -> Metric {
    Metric::ErrorBound { pixels: tau as f32 }
}

/// What a view gets once all that it asks for is made, as far as there is room for blocks; however many vertices that
/// takes.
#[must_use]
pub fn choose(blocks: &mut KeptBlocks, view: &DetailView) -> Choice {
    let limits = Limits {
        vertices: u32::MAX,
        ..Limits::default()
    };
    settle(blocks, view, limits)
}

/// Which vertices stay where those with the same key are one, and the number of each among them.
#[derive(Debug, Clone, Default)]
pub struct Welded {
    /// The first of each key, in order.
    pub kept: Vec<usize>,
    /// One a vertex.
    pub numbers: Vec<u32>,
}

impl Welded {
    /// Triangles with vertices by their new numbers.
    #[must_use]
    pub fn triangles(&self, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let numbered = |corners: &[u32; 3]| corners.map(|k| self.numbers[k as usize]);
        triangles.iter().map(numbered).collect()
    }
}

/// Each block has vertices of its own, of which those on its border are its neighbour's too: makes one of those with the
/// same key.
#[must_use]
pub fn weld<K: Eq + Hash>(keys: impl Iterator<Item = K>) -> Welded {
    let mut welded = Welded::default();
    let mut known = HashMap::new();
    for (at, key) in keys.enumerate() {
        let number = *known.entry(key).or_insert_with(|| {
            welded.kept.push(at);
            welded.kept.len() as u32 - 1
        });
        welded.numbers.push(number);
    }
    welded
}

/// A mesh with one vertex where blocks have the same: at the same place, with the bits of the same height.
#[must_use]
pub fn welded(mesh: &BlockMesh) -> BlockMesh {
    let key = |vertex: &BlockVertex| (vertex.at, vertex.height.to_bits());
    let welded = weld(mesh.vertices.iter().map(key));
    BlockMesh {
        triangles: welded.triangles(&mesh.triangles),
        vertices: welded.kept.iter().map(|&k| mesh.vertices[k]).collect(),
    }
}

/// What a choice draws, [`welded`].
#[must_use]
pub fn drawn(blocks: &KeptBlocks, choice: &Choice) -> BlockMesh {
    welded(&mesh(blocks, choice))
}

/// The corners of a mesh, world metres.
#[must_use]
pub fn positions(blocks: &KeptBlocks, mesh: &BlockMesh) -> Vec<DVec3> {
    let place = |vertex: &BlockVertex| {
        let xz = blocks.lattice.point(vertex.at).to_dvec2();
        DVec3::new(xz.x, f64::from(vertex.height), xz.y)
    };
    mesh.vertices.iter().map(place).collect()
}

/// What a choice draws, as a mesh whose triangles can be found by their places.
#[must_use]
pub fn ground_mesh(blocks: &KeptBlocks, choice: &Choice, camera: &Camera) -> GroundMesh {
    let mesh = drawn(blocks, choice);
    GroundMesh::new(positions(blocks, &mesh), mesh.triangles, &camera.view())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{cameras, terrains};
    use bevy::math::Vec3;

    #[test]
    fn the_choice_sees_what_the_camera_does() {
        let terrain = terrains::fbm(1);
        for (kind, camera) in cameras::KINDS.into_iter().zip(cameras::over(&terrain, 2)) {
            let (view, seen) = (camera.view(), detail_view(&camera, bound(1.0)));
            let anchor = DVec3::new(f64::from(seen.anchor[0]), 0.0, f64::from(seen.anchor[1]));
            let off = |a: [f32; 3], b: DVec3| (Vec3::from(a).as_dvec3() - b).length();
            // f32: 2⁻²⁵ of an axis, and of the greatest height.
            for (axis, expected) in [
                (seen.right, view.right),
                (seen.up, view.up),
                (seen.forward, view.forward),
            ] {
                assert!(off(axis, expected) < 1e-7, "{kind:?}");
            }
            assert!(off(seen.eye, view.eye - anchor) < 1e-6 * view.eye.y.abs().max(1.0));
            assert!((f64::from(seen.scale) / view.scale - 1.0).abs() < 1e-7);
            assert_eq!(seen.orthographic == 1.0, camera.orthographic.is_some());
        }
    }

    #[test]
    fn blocks_are_welded_where_their_bits_are_the_same_and_nowhere_else() {
        let terrain = terrains::fbm(1);
        let mut blocks = blocks_of(&terrain, 1.0);
        let camera = cameras::camera(&terrain, cameras::Kind::Flying, 1);
        let choice = choose(&mut blocks, &detail_view(&camera, bound(8.0)));
        assert_eq!(choice.coarsening, 1.0);
        let (own, one) = (mesh(&blocks, &choice), drawn(&blocks, &choice));
        assert_eq!(own.triangles.len(), one.triangles.len());
        let share = one.vertices.len() as f64 / own.vertices.len() as f64;
        println!("{} vertices of {}", one.vertices.len(), own.vertices.len());
        assert!((0.5..0.99).contains(&share), "{share}");
        let place = |mesh: &BlockMesh, k: u32| mesh.vertices[k as usize].at;
        for (a, b) in own.triangles.iter().zip(&one.triangles) {
            assert_eq!(a.map(|k| place(&own, k)), b.map(|k| place(&one, k)));
        }
        // A height that is another by a bit stays another vertex.
        let keys = [(1, 2.0_f32), (1, 2.0), (1, 2.0_f32.next_up())];
        let welded = weld(keys.iter().map(|&(at, height)| (at, height.to_bits())));
        assert_eq!((welded.kept, welded.numbers), (vec![0, 2], vec![0, 0, 1]));
    }
}
