//! What moves balls, and what all balls have in common.

use bevy::math::DVec3;

/// Radius of all, metres: a ball is the same for an ellipsoid as for Rapier.
pub const RADIUS: f64 = 0.4;

/// Length of a step, seconds.
pub const SECONDS: f64 = 1.0 / 60.0;

/// Somebody who moves balls.
pub trait Walkers {
    /// One step of one ball, and whether it stands then.
    fn step(&mut self, ball: usize, wish: DVec3) -> bool;
    /// Where it is.
    fn center(&self, ball: usize) -> DVec3;
}
