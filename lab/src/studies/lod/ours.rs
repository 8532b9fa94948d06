//! Our selection as a method among the others: its CPU twin, cells and all, for three metrics.

use super::camera::Camera;
use super::mesh::{Drawn, GroundMesh};
use super::rival::{Knob, MOST_TRIANGLES, Rival};
use super::truth::Truth;
use bevy::math::{DQuat, DVec3, EulerRot};
use dolomite_terrain::Terrain;
use dolomite_ground::detail::{
    Detail, DetailCells, DetailMesh, DetailView, Lens, Metric, Selection, mesh, select,
};
use std::sync::{Arc, Mutex};

/// Side of the smallest cell, metres: a 64th, so that few views of the study reach it.
pub const FINEST: f32 = 1.0 / 64.0;

/// Most vertices of a view.
const MOST_VERTICES: u32 = MOST_TRIANGLES as u32 / 2;

/// The same by the length of edges: a few times what 4 pixels of error take.
const MOST_BY_LENGTH: u32 = 1 << 21;

/// The same by distance. With eight times as many the mountain still errs by 219 pixels for who stands on it,
/// and finding that out takes three minutes.
const MOST_BY_DISTANCE: u32 = 1 << 18;

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
    view.set_metric(&Detail {
        metric,
        ..Detail::default()
    });
    view
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

/// What the knob of a method turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    /// [`Metric::Classic`]: the side of its patches.
    Classic,
    /// [`Metric::EdgeLength`].
    EdgeLength,
    /// [`Metric::ErrorBound`].
    ErrorBound,
}

/// Cells of one terrain, made for whoever asks first.
pub type SharedCells = Arc<Mutex<Option<DetailCells>>>;

/// Our selection with one of its metrics.
#[derive(Debug)]
pub struct Ours {
    asked: Asked,
    cells: SharedCells,
}

impl Ours {
    /// The three metrics on shared cells.
    #[must_use]
    pub fn all() -> [Self; 3] {
        let cells = SharedCells::default();
        [Asked::ErrorBound, Asked::EdgeLength, Asked::Classic].map(|asked| Self {
            asked,
            cells: cells.clone(),
        })
    }

    fn metric(&self, knob: f64) -> Metric {
        let pixels = knob as f32;
        match self.asked {
            Asked::ErrorBound => Metric::ErrorBound { pixels },
            Asked::EdgeLength => Metric::EdgeLength { pixels },
            Asked::Classic => Metric::Classic {
                patch: pixels,
                least: 1.0,
                greatest: 32.0,
                reach: 400.0,
                height: 10.0,
            },
        }
    }
}

impl Rival for Ours {
    fn name(&self) -> &'static str {
        match self.asked {
            Asked::ErrorBound => "ours",
            Asked::EdgeLength => "ours, edge length",
            Asked::Classic => "ours, classic",
        }
    }

    fn knob(&self) -> Knob {
        match self.asked {
            Asked::ErrorBound => Knob {
                name: "error bound, pixels",
                coarsest: 512.0,
                finest: 1.0 / 64.0,
            },
            Asked::EdgeLength => Knob {
                name: "longest edge, pixels",
                coarsest: 2048.0,
                finest: 1.0 / 16.0,
            },
            Asked::Classic => Knob {
                name: "side of a patch, metres",
                coarsest: 2048.0,
                finest: 1.0 / 16.0,
            },
        }
    }

    fn draw(&self, truth: &Truth, camera: &Camera, knob: f64) -> Option<Box<dyn Drawn>> {
        let view = detail_view(camera, self.metric(knob));
        // A poisoned lock holds cells of another thread that are right all the same.
        let mut cells = self.cells.lock().unwrap_or_else(|e| e.into_inner());
        let cells = match &mut *cells {
            Some(cells) if cells.terrain().same(&truth.terrain) => cells,
            other => other.insert(cells_of(&truth.terrain, FINEST)),
        };
        let most = match self.asked {
            Asked::ErrorBound => MOST_VERTICES,
            Asked::EdgeLength => MOST_BY_LENGTH,
            Asked::Classic => MOST_BY_DISTANCE,
        };
        let selection = select(cells, &view, most);
        // A coarser tolerance than asked: the knob would no longer mean what it says.
        if selection.coarsening > 1.0 {
            return None;
        }
        Some(Box::new(ground_mesh(
            &mesh::mesh(cells, &selection),
            camera,
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{cameras, terrains};
    use super::*;
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

    #[test]
    fn finer_knobs_draw_more_for_every_metric() {
        let truth = Truth::new(&terrains::fbm(3));
        let camera = cameras::camera(&truth.terrain, cameras::Kind::Flying, 3);
        for (method, knobs) in Ours::all()
            .iter()
            .zip([[16.0, 4.0], [128.0, 64.0], [128.0, 64.0]])
        {
            let [coarse, fine] = knobs.map(|knob| method.draw(&truth, &camera, knob).unwrap());
            assert!(fine.vertices() > coarse.vertices(), "{}", method.name());
            assert!(fine.triangles() < 2 * fine.vertices());
        }
    }
}
