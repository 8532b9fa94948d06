//! Our selection under a camera: its view, its cells, and the corners of its mesh.

use super::camera::Camera;
use super::mesh::{GroundMesh, MOST_TRIANGLES};
use bevy::math::{DQuat, DVec3, EulerRot};
use dolomite_ground::detail::layout::DetailParams;
use dolomite_ground::detail::{
    DetailCells, DetailMesh, DetailView, Lens, Metric, Selection, TerrainLod, mesh, select,
};
use dolomite_terrain::Terrain;

/// Side of the smallest cell, metres: a 64th, so that few views of the study reach it.
pub const FINEST: f32 = 1.0 / 64.0;

/// Most vertices of a view.
pub const MOST_VERTICES: u32 = MOST_TRIANGLES as u32 / 2;

/// Cells that are kept: half a gigabyte.
const KEEP: usize = 1 << 22;

/// No cells of a ground yet; many are kept, since making them is what takes time.
#[must_use]
pub fn cells_of(terrain: &Terrain, finest: f32) -> DetailCells {
    let mut cells = DetailCells::new(terrain.clone(), finest);
    cells.keep = KEEP;
    cells
}

/// A camera as the selection sees it: in f64 to the anchor, then in f32.
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
    cells: &DetailCells,
    camera: &Camera,
    metric: Metric,
    pools: [u32; 2],
) -> DetailParams {
    let view = detail_view(camera, metric);
    DetailParams {
        anchor_height: camera.eye.y.floor() as f32,
        ..DetailParams::new(cells, view, 0, pools)
    }
}

/// The metric that holds errors to `tau` pixels.
#[must_use]
pub fn bound(tau: f64) -> Metric {
    Metric::ErrorBound { pixels: tau as f32 }
}

/// What a view gets.
#[must_use]
pub fn choose(cells: &mut DetailCells, view: &DetailView) -> Selection {
    select(cells, view, MOST_VERTICES)
}

/// The corners of a mesh, world metres.
#[must_use]
pub fn positions(mesh: &DetailMesh) -> Vec<DVec3> {
    let place = |vertex: &mesh::DetailVertex| {
        let xz = vertex.point.to_dvec2();
        DVec3::new(xz.x, f64::from(vertex.height), xz.y)
    };
    mesh.vertices.iter().map(place).collect()
}

/// A mesh whose triangles can be found by their places.
#[must_use]
pub fn ground_mesh(mesh: &DetailMesh, camera: &Camera) -> GroundMesh {
    GroundMesh::new(positions(mesh), mesh.triangles.clone(), &camera.view())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{cameras, terrains};
    use bevy::math::Vec3;

    #[test]
    fn the_selection_sees_what_the_camera_does() {
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
}
