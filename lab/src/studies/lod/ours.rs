//! Our choice as a method among the others: its CPU reference, blocks and all, for three metrics.

use super::baseline::{Baseline, Knob};
use crate::scenes::camera::Camera;
use crate::scenes::mesh::Drawn;
use crate::scenes::selection::{FINEST, KEEP, blocks_of, choose, detail_view, ground_mesh};
use crate::scenes::truth::Truth;
use dolomite_ground::blocks::kept::KeptBlocks;
use dolomite_ground::detail::Metric;
use std::sync::{Arc, Mutex};

/// Most blocks by the length of edges: with each as fine as it may be, 2²¹ vertices, a few times what 4 pixels of error
/// take.
const MOST_BY_LENGTH: usize = 1 << 12;

/// The same by distance: 2¹⁸ vertices. With eight times as many the mountain still errs by 219 pixels for who stands on it,
/// and finding that out takes minutes.
const MOST_BY_DISTANCE: usize = 1 << 9;

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

/// Blocks of one terrain, made for whoever asks first.
pub type SharedBlocks = Arc<Mutex<Option<KeptBlocks>>>;

/// Our choice with one of its metrics.
#[derive(Debug)]
pub struct Ours {
    asked: Asked,
    blocks: SharedBlocks,
}

impl Ours {
    /// The three metrics on shared blocks.
    #[must_use]
    pub fn all() -> [Self; 3] {
        let blocks = SharedBlocks::default();
        [Asked::ErrorBound, Asked::EdgeLength, Asked::Classic].map(|asked| Self {
            asked,
            blocks: blocks.clone(),
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
        // A poisoned lock holds blocks of another thread that are right all the same.
        let mut blocks = self.blocks.lock().unwrap_or_else(|e| e.into_inner());
        let blocks = match &mut *blocks {
            Some(blocks) if blocks.terrain().same(&truth.terrain) => blocks,
            other => other.insert(blocks_of(&truth.terrain, FINEST)),
        };
        blocks.keep = match self.asked {
            Asked::ErrorBound => KEEP,
            Asked::EdgeLength => MOST_BY_LENGTH,
            Asked::Classic => MOST_BY_DISTANCE,
        };
        let choice = choose(blocks, &view);
        // A coarser tolerance than asked: the knob would no longer mean what it says.
        if choice.coarsening > 1.0 {
            return None;
        }
        Some(Box::new(ground_mesh(blocks, &choice, camera)))
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
