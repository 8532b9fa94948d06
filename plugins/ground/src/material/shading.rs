//! How much is done for a pixel of the ground.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// How the pixels of a terrain are shaded; on the entity that carries its [`GroundMaterial`](crate::GroundMaterial),
/// which requires it.
///
/// All but [`Full`](Self::Full) show the two heaviest layers of a place, whatever lies below them, and read at most
/// [`Self::MOST_READS`] texels, filtered, however many layers there are. Most pixels read far fewer: what has no weight
/// is not read, and narrow blends leave less with one. Nothing jumps: what goes out goes out with a weight of 0. The
/// study `material` measures their time and their error; `docs/measured/material.md` has the numbers.
#[derive(
    Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect, Serialize, Deserialize,
)]
#[reflect(Component, Default)]
#[serde(rename_all = "snake_case")]
pub enum GroundShading {
    /// Every layer that lies at a place, from above and from the side, with wide blends. Its time grows with the
    /// number of layers; for pictures, and what the others are measured by.
    Full,
    /// Blends as wide as those of [`Self::Full`].
    Fine,
    /// Narrower blends: for most. Still narrower ones save next to nothing and double the error.
    #[default]
    Balanced,
}

impl GroundShading {
    /// Texels, filtered, that a pixel reads at most in all ways but [`Self::Full`]: two of each of 16 taps, and one of
    /// the relief map.
    pub const MOST_READS: u32 = 33;

    /// What blends lose at either end, of 1.
    #[must_use]
    pub const fn narrowing(self) -> f32 {
        match self {
            Self::Full | Self::Fine => 0.0,
            Self::Balanced => 0.1,
        }
    }
}
