//! How many stand at a distance, and how wide: cover is kept.
//!
//! Up to a distance d₀ all stand at their own width. Beyond, the share falls as d₀/d and those that are left are wider
//! by as much, so that a blade keeps its width in pixels. Whoever enters does so at no width: over a band of ranks the
//! width rises from 0 to that of the others, and the mean width over all ranks is 1 at every distance.

use bytemuck::{Pod, Zeroable};

/// The law of a kind.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Fade {
    /// Up to here all stand, metres.
    pub near: f32,
    /// Which part of the ranks that stand have less than the full width, above 0 and below 1.
    pub band: f32,
    /// Beyond, nothing: the last quarter of the way is a fade by width, metres.
    pub reach: f32,
    /// To fill 16 bytes.
    pub rest: f32,
}

/// What stands at a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// Of the ranks up to here, as shares of those that stand there at all: may exceed 1.
    pub most: f32,
    /// Ranks up to here have the full width.
    pub whole: f32,
    /// The full width, as a multiple of a plant's own.
    pub width: f32,
}

impl Fade {
    /// The usual band, a quarter.
    #[must_use]
    pub const fn new(near: f32, reach: f32) -> Self {
        Self {
            near,
            band: 0.25,
            reach,
            rest: 0.0,
        }
    }

    /// What stands at a distance, metres. At 0 and for NaN everything does.
    #[inline]
    #[must_use]
    pub fn at(&self, distance: f32) -> Shown {
        // Ranks up to `most`, of which those up to `most · (1 − band)` are whole. At `near` the latter are all.
        let whole_of = 1.0 - self.band;
        let all = 1.0 / whole_of;
        let ratio = all * self.near / distance;
        let most = if ratio < all { ratio } else { all };
        let whole = most * whole_of;
        // Mean width over ranks up to 1, where the full one is 1.
        let mean = if most <= 1.0 {
            most * (1.0 - 0.5 * self.band)
        } else {
            let last = (most - 1.0) / (most * self.band);
            whole + 0.5 * (1.0 + last) * (1.0 - whole)
        };
        Shown {
            most,
            whole,
            width: 1.0 / mean,
        }
    }

    /// Which share of a plant's width, or of what it has in place of one, is left towards the end of the reach.
    #[inline]
    #[must_use]
    pub fn left(&self, distance: f32) -> f32 {
        let left = 4.0 * (1.0 - distance / self.reach);
        if left > 0.0 {
            if left < 1.0 { left } else { 1.0 }
        } else {
            0.0
        }
    }
}

impl Shown {
    /// The width of a plant as a multiple of its own; `rank` is a share of the ranks that stand there, 0 to 1.
    #[inline]
    #[must_use]
    pub fn width_of(&self, rank: f32) -> f32 {
        let part = (self.most - rank) / (self.most - self.whole);
        let part = if part > 0.0 { part } else { 0.0 };
        self.width * if part < 1.0 { part } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FADE: Fade = Fade::new(9.4, 300.0);

    /// The mean width over ranks is 1 at any distance: cover is kept in the mean.
    #[test]
    fn cover_is_kept() {
        for k in 0..200 {
            let distance = 1.0 + k as f32 * 1.7;
            let shown = FADE.at(distance);
            let widths = (0..100_000).map(|k| f64::from(shown.width_of((k as f32 + 0.5) / 1e5)));
            let mean = widths.sum::<f64>() / 1e5;
            // Of 10⁵ samples of a line with a kink, and of f32.
            assert!((mean - 1.0).abs() < 1e-4, "{distance}: {mean}");
        }
    }

    /// No width jumps: what enters, enters at none, and a metre changes widths by little.
    #[test]
    fn nothing_jumps() {
        for rank in [0.0, 0.1, 0.3, 0.7, 0.99] {
            let mut last = FADE.at(0.01).width_of(rank);
            assert_eq!(last, 1.0, "near to it a plant has its own width");
            for k in 1..30_000 {
                let distance = 0.01 * k as f32;
                let width = FADE.at(distance).width_of(rank);
                let steepest = 5.0 / FADE.near;
                assert!(
                    (width - last).abs() <= 0.01 * steepest,
                    "{rank} at {distance}"
                );
                last = width;
            }
        }
    }

    /// Beyond the first distance a blade keeps its width in pixels.
    #[test]
    fn width_grows_with_distance() {
        let [near, far] = [50.0, 200.0].map(|distance| FADE.at(distance));
        assert!((far.width / near.width - 4.0).abs() < 1e-4);
        assert!((near.most / far.most - 4.0).abs() < 1e-4);
        assert_eq!(
            (FADE.left(100.0), FADE.left(300.0), FADE.left(1e9)),
            (1.0, 0.0, 0.0)
        );
        assert!(FADE.at(f32::NAN).most > 1.0 && FADE.at(0.0).width == 1.0);
    }
}
