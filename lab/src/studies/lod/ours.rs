//! Our selection as a method among the others: its CPU reference, cells and all, for three metrics.

use super::baseline::{Baseline, Knob};
use crate::scenes::camera::Camera;
use crate::scenes::mesh::Drawn;
use crate::scenes::selection::{FINEST, MOST_VERTICES, cells_of, detail_view, ground_mesh};
use crate::scenes::truth::Truth;
use dolomite_ground::detail::{DetailCells, Metric, mesh, select};
use std::sync::{Arc, Mutex};

/// The same by the length of edges: a few times what 4 pixels of error take.
const MOST_BY_LENGTH: u32 = 1 << 21;

/// The same by distance. With eight times as many the mountain still errs by 219 pixels for who stands on it,
/// and finding that out takes three minutes.
const MOST_BY_DISTANCE: u32 = 1 << 18;

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

impl Baseline for Ours {
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
    use super::*;
    use crate::scenes::{cameras, terrains};

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
