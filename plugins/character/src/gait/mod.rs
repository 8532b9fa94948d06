//! Gaits: which clips a figure plays, when, and how much of each.
//!
//! Directions are the model's, as glTF has them: +x is the figure's left, +y up, and it looks along +z.
//! Turning is positive to the left.

mod data;
mod lean;
mod locomotion;
mod phase;
mod spring;
mod travel;

pub use data::{ClipMotion, Gait, GaitData, GaitError, LegData, LegJoints, MoveClip, OneShotData};
pub(crate) use lean::rotation_of;
pub use lean::{Lean, LeanSettings};
pub use locomotion::{Locomotion, LocomotionState, Motion, Overlay, Step, Voice};
pub use phase::Warp;
pub use spring::Spring;
pub use travel::{RootDelta, root_delta};
pub(crate) use travel::{turned, wrapped, yaw_of};
