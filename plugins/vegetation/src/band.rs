//! Bands of height and slope with soft edges.

use serde::{Deserialize, Serialize};

/// Nothing grows outside of a band; within, the density rises from its borders over a length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// Nothing below.
    pub from: f32,
    /// Nothing above.
    pub to: f32,
    /// Over how much the density rises from either border to its full; 0: at once.
    #[serde(default)]
    pub soft: f32,
}

impl Default for Band {
    /// Everywhere.
    fn default() -> Self {
        Self {
            from: -1e6,
            to: 1e6,
            soft: 0.0,
        }
    }
}

impl Band {
    /// From level ground up to 45 degrees.
    pub(crate) const fn of_slopes() -> Self {
        Self {
            from: -1.0,
            to: 1.0,
            soft: 0.3,
        }
    }

    /// The density at `x` as a share of the full one: 0 at the borders and outside, for NaN too.
    #[inline]
    #[must_use]
    pub fn share(self, x: f32) -> f32 {
        ramp(x, self.from, self.to, steepness(self.soft))
    }
}

/// Steepest edge of a band: what "at once" means, a thousandth of a metre or of rise over run.
const STEEPEST: f32 = 1000.0;

/// The number that a band's softness stands for in [`ramp`].
#[inline]
#[must_use]
pub fn steepness(soft: f32) -> f32 {
    if soft > 1.0 / STEEPEST {
        1.0 / soft
    } else {
        STEEPEST
    }
}

/// 0 up to `from` and beyond `to`, 1 between, with edges of this steepness inside. 0 for NaN.
#[inline]
#[must_use]
pub fn ramp(x: f32, from: f32, to: f32, steepness: f32) -> f32 {
    let low = (x - from) * steepness;
    let high = (to - x) * steepness;
    let least = if low < high { low } else { high };
    if least > 0.0 {
        if least < 1.0 { least } else { 1.0 }
    } else {
        0.0
    }
}
