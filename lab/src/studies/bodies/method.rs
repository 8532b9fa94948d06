//! What moves balls, and what all balls have in common.

use super::messages::ProgramError;
use bevy::math::DVec3;
use std::time::Instant;

/// Radius of all, metres: a ball is the same for an ellipsoid as for Rapier.
pub const RADIUS: f64 = 0.4;

/// Length of a step, seconds.
pub const SECONDS: f64 = 1.0 / 60.0;

/// Somebody who moves balls.
pub trait Walkers {
    /// One step of all balls, each by its wish; says which of them stand then, and how long the moves took,
    /// nanoseconds of all together.
    ///
    /// # Errors
    /// [`ProgramError`] of who is another program.
    fn step(&mut self, wishes: &[DVec3], stands: &mut [bool]) -> Result<f64, ProgramError>;
    /// Where a ball is.
    fn center(&self, ball: usize) -> DVec3;
}

/// Moves one ball after the other, and gives the nanoseconds of all.
pub fn timed(
    wishes: &[DVec3],
    stands: &mut [bool],
    mut step: impl FnMut(usize, DVec3) -> bool,
) -> f64 {
    let begun = Instant::now();
    for (ball, (wish, stands)) in wishes.iter().zip(stands).enumerate() {
        *stands = step(ball, *wish);
    }
    begun.elapsed().as_secs_f64() * 1e9
}
