//! Other libraries, asked the same as ours in the same run.
//!
//! They are compiled with the feature `beside`; without it the studies measure ours alone and say so.

#[cfg_attr(feature = "beside", path = "parry.rs")]
#[cfg_attr(not(feature = "beside"), path = "none.rs")]
mod others;

pub use others::{Mesh, SWEEPS};

use bevy::math::DVec3;
use dolomite_testkit::sweeps::Sweep;

/// Time, in parts of the way, and normal of a contact.
pub type Touch = Option<(f64, DVec3)>;

/// A method of sweeping and what it is called.
pub type SweepMethod = (&'static str, fn(&Sweep) -> Touch);

/// What reports say of the others.
pub const NOTE: &str = if cfg!(feature = "beside") {
    "parry 0.30.2 has no ellipsoid: it casts a ball of radius 1 where the ellipsoid is a unit sphere, in f32"
} else {
    "compiled without the feature `beside`: no other library was asked"
};
