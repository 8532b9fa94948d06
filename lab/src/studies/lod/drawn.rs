//! The guarantee of [`super::guarantee`] for the triangles that the adapter drew: vertices and indices are read
//! back from the passes, placed in the world, and held against the f64 ground.

use super::guarantee::{AT_A_PLACE, ground_of, merge, size_of};
use super::judge::{Count, Surface, judge};
use crate::scenes::camera::Camera;
use crate::scenes::cameras::{KINDS, around};
use crate::scenes::selection::{self, FINEST, bound, params};
use crate::scenes::truth::Truth;
use dolomite_ground::detail::DetailGround;
use dolomite_testkit::blocks::{BlockError, BlockStage};
use dolomite_testkit::gpu::Gpu;
use dolomite_testkit::random::Random;

/// Slots of blocks: 110 MB.
pub const SLOTS: u32 = 1 << 13;
/// Blocks that a choice makes.
pub const BUDGET: u32 = 64;
/// Most choices until all that a view asks for is made, as far as there is room.
pub const MOST: usize = 1000;
/// Room for vertices and triangles.
pub const POOLS: [u32; 2] = [1 << 18, 1 << 19];

/// What the adapter draws for a camera at a tolerance, once all that it asks for is made.
///
/// # Errors
/// [`BlockError`].
///
/// # Panics
/// If it is not settled after [`MOST`] choices.
pub fn drawn(
    stage: &mut BlockStage<'_>,
    ground: &DetailGround,
    camera: &Camera,
    tau: f64,
) -> Result<Surface, BlockError> {
    let params = params(ground, camera, bound(tau), POOLS);
    let (run, _) = stage.settle_in_room(params, BUDGET, MOST)?;
    Ok(Surface::of_run(&params, &run))
}

/// Measures the cameras of place `group`, all at every tolerance.
///
/// # Errors
/// [`BlockError`].
pub fn at_a_place(
    gpu: &Gpu,
    (group, cameras): (u32, usize),
    taus: &[f64],
    samples: usize,
    seed: u32,
) -> Result<Vec<Count>, BlockError> {
    let own = seed.wrapping_mul(1000).wrapping_add(group);
    let terrain = ground_of(group, own);
    let truth = Truth::new(&terrain);
    let ground = selection::ground_of(&terrain, FINEST);
    let mut stage = BlockStage::new(gpu, &ground, SLOTS)?;
    let mut counts = Vec::new();
    for (number, (kind, camera)) in around(&terrain, cameras, own).into_iter().enumerate() {
        let round = group as usize * AT_A_PLACE / KINDS.len() + number / KINDS.len();
        let camera = Camera {
            size: size_of(round),
            ..camera
        };
        for &tau in taus {
            let mut random = Random::new(own.wrapping_add(number as u32 * 7919));
            let surface = drawn(&mut stage, &ground, &camera, tau)?;
            let count = judge(&truth, &surface, (kind, camera), tau, samples, &mut random);
            merge(&mut counts, vec![count]);
        }
    }
    Ok(counts)
}
