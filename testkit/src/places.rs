//! Random places, directions, turns and sizes in f64.

use crate::random::Random;
use bevy::math::{DMat3, DQuat, DVec3};

/// In the cube of this half size.
pub fn place(random: &mut Random, half: f64) -> DVec3 {
    DVec3::new(
        random.signed_unit(),
        random.signed_unit(),
        random.signed_unit(),
    ) * half
}

/// Of length 1, all alike.
pub fn direction(random: &mut Random) -> DVec3 {
    loop {
        let p = place(random, 1.0);
        let length = p.length();
        if length > 1e-3 && length <= 1.0 {
            return p / length;
        }
    }
}

/// A turn.
pub fn turn(random: &mut Random) -> DQuat {
    let x = direction(random);
    let y = direction(random)
        .reject_from(x)
        .normalize_or(x.any_orthonormal_vector());
    DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))).normalize()
}

/// Between the two, each factor as often as its double.
pub fn size(random: &mut Random, low: f64, high: f64) -> f64 {
    // A power of two by products alone: the same everywhere.
    let mut size = low;
    let steps = (0..60)
        .take_while(|i| low * f64::from(1 << (i / 2).min(30)) < high)
        .count();
    for _ in 0..random.below(steps.max(1)) {
        size *= std::f64::consts::SQRT_2;
    }
    (size * (1.0 + 0.4 * random.unit())).min(high)
}
