//! The five ground layers, one painter a file.

mod grass;
mod rock;
mod sand;
mod scree;
mod snow;

use crate::hash::pcg;
use crate::surface::{Look, Surface};

/// A ground layer; the discriminant is its place in the texture array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Dry wind-blown sand with faint ripples.
    Sand = 0,
    /// Meadow of blades and tufts.
    Grass = 1,
    /// Bedded, fractured dolomite.
    Rock = 2,
    /// Wind-packed snow.
    Snow = 3,
    /// Angular stones in gravel and soil.
    Scree = 4,
}

impl Layer {
    /// All layers in the order of the texture array.
    pub const ALL: [Self; 5] = [Self::Sand, Self::Grass, Self::Rock, Self::Snow, Self::Scree];

    /// Lower-case name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sand => "sand",
            Self::Grass => "grass",
            Self::Rock => "rock",
            Self::Snow => "snow",
            Self::Scree => "scree",
        }
    }

    /// How the layer is finished.
    #[must_use]
    pub const fn look(self) -> Look {
        match self {
            Self::Sand => sand::LOOK,
            Self::Grass => grass::LOOK,
            Self::Rock => rock::LOOK,
            Self::Snow => snow::LOOK,
            Self::Scree => scree::LOOK,
        }
    }

    /// Paints the layer at `size` x `size` texels.
    #[must_use]
    pub fn paint(self, size: usize, seed: u32) -> Surface {
        let seed = pcg(seed ^ pcg(self as u32));
        match self {
            Self::Sand => sand::paint(size, seed),
            Self::Grass => grass::paint(size, seed),
            Self::Rock => rock::paint(size, seed),
            Self::Snow => snow::paint(size, seed),
            Self::Scree => scree::paint(size, seed),
        }
    }
}
