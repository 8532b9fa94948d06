//! Other libraries, asked the same as ours in the same run.

mod parry;

pub use parry::{Mesh, SWEEPS};

use bevy::math::DVec3;
use dolomite_testkit::sweeps::Sweep;

/// Time, in parts of the way, and normal of a contact.
pub type Touch = Option<(f64, DVec3)>;

/// A method of sweeping and what it is called.
pub type SweepMethod = (&'static str, fn(&Sweep) -> Touch);

/// What reports say of the others.
pub const NOTE: &str = "parry 0.30.2 has no ellipsoid: it is given a ball of radius 1 where the ellipsoid is a unit \
                        sphere, in f32. `parry` is its cast of shapes, which takes the ball for a convex shape of which \
                        it knows the farthest point of any direction, and gives up, as a miss, where two bounds of a \
                        distance agree within 1e-3; `parry_toi` is what Rapier 0.35 sweeps fast bodies by, a point with \
                        a radius against the corners of the triangle, at a slop of 1e-4 radii";
