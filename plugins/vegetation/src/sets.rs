//! Where the plugin's systems stand in a frame.

use bevy::prelude::*;

/// What the plugin does in a frame, in `PostUpdate`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VegetationSystems {
    /// Lists of kinds are checked: [`VegetationState`](crate::VegetationState).
    Check,
    /// What stands around the cameras comes and goes.
    Place,
}
