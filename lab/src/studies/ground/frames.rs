//! How old answers are when they are used, in frames that wait for nothing but their display.
//!
//! A frame is made in the order of the engine: the simulation, then what has arrived is handed over, then
//! the frame is recorded and submitted. So what is handed over in a frame is used in the next, and an age
//! is at least 2.

use super::measure::{BUDGET, MOST, params, places};
use crate::scenes::camera::Camera;
use crate::scenes::selection::ground_of;
use dolomite_geometry::ring::Ring;
use dolomite_ground::detail::Metric;
use dolomite_terrain::Terrain;
use dolomite_testkit::blocks::{BlockError, BlockStage};
use dolomite_testkit::gpu::Gpu;
use std::time::{Duration, Instant};

/// Frames of a flight of the study.
pub const FRAMES: u32 = 48;

/// What a flight found.
#[derive(Debug, Clone)]
pub struct Ages {
    /// Frames from a question to the first that uses its answer, one an answer.
    pub ages: Vec<u32>,
    /// Frames in which all staging buffers were under way, so that nothing was asked.
    pub unasked: u32,
    /// Time in which the CPU made and submitted a frame, and took what had arrived; the median,
    /// milliseconds.
    pub cpu_ms: f64,
}

impl Ages {
    /// The largest.
    #[must_use]
    pub fn max(&self) -> Option<u32> {
        self.ages.iter().copied().max()
    }

    /// The mean.
    #[must_use]
    pub fn mean(&self) -> f64 {
        let sum: u32 = self.ages.iter().sum();
        f64::from(sum) / self.ages.len().max(1) as f64
    }
}

/// Flies forward for so many frames and asks `count` places in every frame. A frame begins when the device has drawn the one
/// before the last (`in_flight` 1) or the last (0): as renderers that keep that many frames under way.
///
/// The first view is settled before; then each frame makes up to [`BUDGET`] blocks.
///
/// # Errors
/// [`BlockError`].
///
/// # Panics
/// If the first view is not settled after [`MOST`] choices.
pub fn fly(
    gpu: &Gpu,
    terrain: &Terrain,
    mut camera: Camera,
    frames: u32,
    (count, in_flight, seed): (usize, usize, u32),
) -> Result<Ages, BlockError> {
    let ground = ground_of(terrain, 1.0);
    let mut stage = BlockStage::new(gpu, &ground, 1 << 12)?;
    let metric = Metric::ErrorBound { pixels: 8.0 };
    stage.settle(params(&ground, &camera, metric), BUDGET, MOST)?;
    let places = places(terrain, &camera, count, seed);
    let forward = camera.view().forward;
    let mut ring = Ring::default();
    let (mut ages, mut times) = (Vec::new(), Vec::new());
    let mut under_way = std::collections::VecDeque::new();
    for frame in 0..frames {
        camera.eye += forward * 0.5;
        let told = params(&ground, &camera, metric);
        let start = Instant::now();
        let arrived = stage.frame(told, BUDGET, (frame, &places), &mut ring)?;
        times.push(start.elapsed());
        ages.extend(arrived.iter().map(|(asked, _)| frame + 1 - asked));
        under_way.push_back(gpu.queue().submit([]));
        if under_way.len() > in_flight
            && let Some(last) = under_way.pop_front()
        {
            gpu.finish_until(last)?;
        }
    }
    times.sort_unstable();
    let milliseconds = |time: Duration| time.as_secs_f64() * 1e3;
    Ok(Ages {
        unasked: frames - ring.asked() as u32,
        cpu_ms: milliseconds(times[times.len() / 2]),
        ages,
    })
}
