//! Feet on the ground: legs bent so that soles lie on slopes, and stay where they stand.

mod foot;
mod plant;
mod two_bone;

pub use foot::Sole;
pub use plant::{Body, Feet, FeetSettings, Footing, Place};
pub use two_bone::{Bend, EXACT_REACH, Limb, bend};
