//! Where the plugin's systems stand in a frame.

use bevy::prelude::*;

/// What the plugin does in a frame, in `PostUpdate`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CitySystems {
    /// Blocks come and go: [`CityBlocks`](crate::CityBlocks).
    Look,
    /// They are drawn, and lamps are lit.
    Draw,
}
