//! How the water looks.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use crate::range::within;

/// The sea of a terrain: goes on the entity that carries the [`Terrain`](dolomite_terrain::Terrain), whose
/// `sea_level` says how high it stands.
///
/// It is opaque, with a colour that follows the depth below it, and with waves that turn into roughness where
/// they are smaller than a pixel. Without this component, or without a `sea_level`, there is no water: the bed
/// is drawn as dry ground, and nothing of the sea is computed.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Component, Default)]
#[serde(deny_unknown_fields, default)]
pub struct Sea {
    /// Light that is lost on a metre of its way through the water, as a natural exponent (Beer and Lambert):
    /// red, green, blue. Default (0.55, 0.16, 0.11): red goes first.
    pub extinction: [f32; 3],
    /// Linear colour of water that is too deep to see the bed. Default (0.004, 0.022, 0.035).
    pub deep: [f32; 3],
    /// Greatest slope of each of seven waves, where no gust is; 0 is a mirror. Default 0.045.
    pub steepness: f32,
}

impl Default for Sea {
    fn default() -> Self {
        Self {
            extinction: [0.55, 0.16, 0.11],
            deep: [0.004, 0.022, 0.035],
            steepness: 0.045,
        }
    }
}

impl Sea {
    /// The same with every number in its range; what is not a number becomes the default.
    #[must_use]
    pub fn clamped(self) -> Self {
        let default = Self::default();
        let three = |value: [f32; 3], most: f32, default: [f32; 3]| {
            [0, 1, 2].map(|k| within(value[k], 0.0, most, default[k]))
        };
        Self {
            extinction: three(self.extinction, 100.0, default.extinction),
            deep: three(self.deep, 1.0, default.deep),
            steepness: within(self.steepness, 0.0, 1.0, default.steepness),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_water_becomes_water() {
        let sea = Sea {
            extinction: [f32::NAN, -1.0, f32::INFINITY],
            deep: [2.0, 0.5, f32::NEG_INFINITY],
            steepness: f32::NAN,
        };
        let expected = Sea {
            extinction: [0.55, 0.0, 100.0],
            deep: [1.0, 0.5, 0.0],
            steepness: 0.045,
        };
        assert_eq!(sea.clamped(), expected);
    }
}
