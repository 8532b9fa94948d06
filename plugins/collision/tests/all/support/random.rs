//! Random volumes.

use bevy::math::DVec3;
use dolomite_collision::{Aabb, Capsule, Ellipsoid, Sphere, Volume};
pub use dolomite_testkit::places::{direction, place, size, turn};
use dolomite_testkit::random::Random;

/// Of one of the four kinds, some metres around the origin.
pub fn volume(random: &mut Random, kind: usize) -> Volume {
    let center = place(random, 5.0);
    let mut some = || size(random, 0.01, 10.0);
    let (a, b, c) = (some(), some(), some());
    match kind {
        0 => Sphere { center, radius: a }.into(),
        1 => Aabb::around(center, DVec3::new(a, b, c)).into(),
        2 => Ellipsoid {
            center,
            radii: DVec3::new(a, b, c),
            rotation: turn(random),
        }
        .into(),
        _ => {
            let arm = direction(random) * b;
            Capsule {
                segment: [center - arm, center + arm],
                radius: a,
            }
            .into()
        }
    }
}
