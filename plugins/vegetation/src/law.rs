//! How many of those that stand are drawn at a distance, and how wide: the functions of `shaders/src/vegetation/law.wgsl`,
//! in Rust.
//!
//! Up to a first distance all stand at their own width, which is a pixel there. Beyond it the share 1/d stays, each d times
//! as wide: pixels stay covered and no blade is less than a pixel. From a second distance on the share falls as 1/d²,
//! since the area of rings grows as d². Whoever enters does so at no width: over a band of ranks the width rises
//! from 0 to that of the others. The mean width over all ranks is 1 at every distance, so that the optical depth of what is
//! drawn is that of all blades.
//!
//! Towards the end of the reach all end, partly by rank and partly by width: [`Law::cover`] says how much of the
//! depth is left to blades. The rest is the ground's to show. Before that the colours of blades [settle](Law::settled) to those
//! that the ground will show: through fewer blades one sees deeper into their shade, and the meadow would darken.

use bytemuck::{Pod, Zeroable};

/// Ranks between this share of the greatest that is drawn and the greatest are on their way in.
pub const BAND: f32 = 0.25;

/// Share of the ranks that is still drawn where all end. Ranks alone would come and go ever faster there: a rank's width
/// changes by the logarithm of the share, which has no bound at 0. Width alone would draw all of them to the end.
pub const LAST: f32 = 0.25;

/// Distance from which on the share falls with the square, metres; of those that are a pixel wide beyond it, as far
/// as they are.
pub const SQUARE_FROM: f32 = 120.0;

/// Where the fade at the end begins, as a share of the reach.
pub const FADE_FROM: f32 = 0.6;

/// From this share of the distance of the fade on colours settle; at the fade they have.
pub const SETTLE_FROM: f32 = 0.7;

/// How much more of the ground fewer and wider blades hide than the many do: by this times how much wider than before they
/// are, in the distances between roots. Ranks are nested, so that roots are spread more evenly than at random, and what is
/// wide overlaps less for it. Fitted to brute force over kinds of 45 to 250 roots a square metre, shares of 1 to 1/10 and
/// elevations with sines of 0.08 to 1; what it leaves of the error is in `docs/measured/vegetation.md`.
pub const EVEN: f32 = 0.165;

/// Farthest that a kind is drawn, metres: places in records have 24 bits.
pub const MOST_REACH: f32 = 2000.0;

/// The numbers of a kind's law, for shaders too: 16 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Law {
    /// Up to here all are drawn, metres.
    pub first: f32,
    /// From here on the share falls with the square, metres.
    pub second: f32,
    /// From here on they end, metres.
    pub fade: f32,
    /// Here they have ended, metres.
    pub reach: f32,
}

impl Law {
    /// Of a kind that is so wide and drawn so far, in metres, in a picture of so many pixels a radian. NaN is 0.
    #[must_use]
    pub fn new(width: f32, pixels_per_radian: f32, reach: f32) -> Self {
        let number = |x: f32, least: f32| if x > least { x.min(MOST_REACH) } else { least };
        let first = number(width * pixels_per_radian, 0.25);
        let reach = number(reach, 0.0);
        Self {
            first,
            second: first.max(SQUARE_FROM),
            fade: reach * FADE_FROM,
            reach,
        }
    }

    /// The share that has its full width at a distance, metres.
    #[inline]
    #[must_use]
    pub fn kept(&self, distance: f32) -> f32 {
        let d = distance.max(1e-3);
        (self.first / d).min(1.0) * (self.second / d).min(1.0)
    }

    /// What is left of the cover towards the end.
    #[inline]
    #[must_use]
    pub fn left(&self, distance: f32) -> f32 {
        let t = (distance - self.fade) / (self.reach - self.fade).max(1e-3);
        let t = t.clamp(0.0, 1.0);
        1.0 - t * t * (3.0 - 2.0 * t)
    }

    /// How far the colours of blades have settled to those that the ground shows beyond them, 0 to 1.
    #[inline]
    #[must_use]
    pub fn settled(&self, distance: f32) -> f32 {
        let from = SETTLE_FROM * self.fade;
        let t = ((distance - from) / (self.fade - from).max(1e-3)).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }

    /// Ranks below this share of those that stand are drawn: more than 1 where all have come in, none beyond the reach.
    #[inline]
    #[must_use]
    pub fn drawn(&self, distance: f32) -> f32 {
        let left = self.left(distance);
        if left <= 0.0 {
            return 0.0;
        }
        self.kept(distance) / (1.0 - BAND) * left_ranks(left)
    }

    /// Width as a multiple of a plant's own, for one that has come in so far: what is missing and what is on its way in is
    /// made up for.
    #[inline]
    #[must_use]
    pub fn widened(&self, distance: f32, come: f32) -> f32 {
        let left = self.left(distance);
        come / mean_entered(self.kept(distance) / (1.0 - BAND)) * left / left_ranks(left)
    }

    /// The share of the whole cover's optical depth that is drawn.
    #[inline]
    #[must_use]
    pub fn cover(&self, distance: f32) -> f32 {
        let left = self.left(distance);
        let all = self.kept(distance) / (1.0 - BAND);
        mean_entered(all * left_ranks(left)) / mean_entered(all) * left / left_ranks(left)
    }

    /// The width of a plant as a multiple of its own; `rank` is a share of the ranks that stand there, 0 to 1. 0: it is
    /// not drawn.
    #[must_use]
    pub fn width_of(&self, rank: f32, distance: f32) -> f32 {
        let drawn = self.drawn(distance);
        if rank < drawn {
            self.widened(distance, entered(rank / drawn))
        } else {
            0.0
        }
    }

    /// A distance from which on no more than this share of those that stand is drawn: the least one but for the fade at the
    /// end.
    #[must_use]
    pub fn distance_of(&self, share: f32) -> f32 {
        let kept = share * (1.0 - BAND);
        if share >= 1.0 / (1.0 - BAND) {
            0.0
        } else if kept * self.second >= self.first {
            self.first / kept
        } else {
            (self.first * self.second / kept).sqrt()
        }
    }
}

/// A factor of the widths where a share of all blades is kept: [`EVEN`]. `crowding` is the width of a blade in mean distances
/// of roots, width · √density.
#[inline]
#[must_use]
pub fn evened(crowding: f32, kept: f32) -> f32 {
    1.0 / (1.0 + EVEN * crowding * (1.0 / kept.max(1e-6).sqrt() - 1.0))
}

/// The part of what is left towards the end by which ranks become fewer; the other part is that of the widths.
#[inline]
#[must_use]
pub fn left_ranks(left: f32) -> f32 {
    LAST + (1.0 - LAST) * left
}

/// How far a rank has come in, of which `part` is the ratio to the greatest that is drawn.
#[inline]
#[must_use]
pub fn entered(part: f32) -> f32 {
    ((1.0 - part) / BAND).clamp(0.0, 1.0)
}

/// The mean of [`entered`] over all ranks that stand, where those below `drawn` are drawn.
#[inline]
#[must_use]
pub fn mean_entered(drawn: f32) -> f32 {
    if drawn <= 1.0 {
        return drawn * (1.0 - 0.5 * BAND);
    }
    let whole = (drawn * (1.0 - BAND)).min(1.0);
    let last = ((drawn - 1.0) / (drawn * BAND)).min(1.0);
    whole + 0.5 * (1.0 + last) * (1.0 - whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A blade of 13 mm at 935 pixels a radian.
    const LAW: Law = Law {
        first: 12.2,
        second: 120.0,
        fade: 156.0,
        reach: 260.0,
    };

    /// The mean width over ranks is what the law says is left: 1 up to the fade. A kind that ends while all of it still
    /// stands keeps to that too.
    #[test]
    fn cover_is_kept() {
        let short = Law::new(0.02, 935.0, 20.0);
        for law in [LAW, short] {
            for k in 0..200 {
                let distance = 0.5 + k as f32 * 1.4;
                let widths = (0..100_000).map(|k| {
                    let rank = (k as f32 + 0.5) / 1e5;
                    f64::from(law.width_of(rank, distance))
                });
                let mean = widths.sum::<f64>() / 1e5;
                let cover = f64::from(law.cover(distance));
                // Of 10⁵ samples of a line with a kink, and of f32.
                assert!((mean - cover).abs() < 2e-4, "{distance}: {mean} {cover}");
                assert!(distance > law.fade || (cover - 1.0).abs() < 1e-6);
                assert!(distance < law.reach || cover == 0.0);
            }
        }
    }

    /// No width jumps: what enters, enters at none, and centimetres change widths on the screen by little.
    #[test]
    fn nothing_jumps() {
        for rank in [0.0, 0.01, 0.1, 0.3, 0.7, 0.99] {
            let mut last = LAW.width_of(rank, 0.01);
            assert_eq!(last, 1.0, "near to it a plant has its own width");
            for k in 1..27_000 {
                let distance = 0.01 * k as f32;
                let width = LAW.width_of(rank, distance);
                // In pixels: a blade's own is `first / distance` wide. Ranks change by at most two parts in d plus the
                // fade's, which `LAST` bounds by 1.5 · 0.75/0.25 over its length; a band is a quarter of them.
                let pixels = LAW.first / distance;
                let steepest = (2.0 / distance + 4.5 / 104.0) / BAND + 2.0 / distance + 1.5 / 104.0;
                let widest = 1.0 / mean_entered(LAW.kept(distance) / (1.0 - BAND));
                let most = steepest * widest * pixels * 0.01;
                let change = (width - last).abs() * pixels;
                // A tenth more for the width's own part of the fade, and for what a step of a centimetre is behind.
                assert!(
                    change <= 1.1 * most,
                    "{rank} at {distance}: {change} {most}"
                );
                last = width;
            }
            assert_eq!(last, 0.0, "beyond the reach there is nothing");
        }
    }

    /// Beyond the first distance a blade keeps its width in pixels, beyond the second it grows with the distance.
    #[test]
    fn width_grows_with_distance() {
        let [near, far] = [50.0, 100.0].map(|d| LAW.widened(d, 1.0) * LAW.first / d);
        assert!((near / far - 1.0).abs() < 1e-5, "{near} {far}");
        let [near, far] = [125.0, 150.0].map(|d| LAW.widened(d, 1.0) * LAW.first / d);
        assert!((far / near - 1.2).abs() < 1e-5, "{near} {far}");
        assert_eq!(LAW.drawn(5.0), 1.0 / (1.0 - BAND));
    }

    /// What rings go by is no less than what is drawn.
    #[test]
    fn no_more_is_drawn_beyond_the_distance_of_a_share() {
        for k in 0..400 {
            let share = 1.4 - 0.0035 * k as f32;
            let distance = LAW.distance_of(share);
            for beyond in [1.0001, 1.5, 4.0] {
                let drawn = LAW.drawn(distance * beyond);
                assert!(drawn <= share * 1.0001, "{share}: {drawn} at {distance}");
            }
            // And not far more.
            let near = LAW.drawn(distance * 0.99);
            assert!(
                distance > LAW.fade || near >= share.min(1.33),
                "{share}: {near}"
            );
        }
    }

    #[test]
    fn colours_settle_before_the_fade() {
        assert_eq!((LAW.settled(100.0), LAW.settled(156.0)), (0.0, 1.0));
        assert!((LAW.settled(132.6) - 0.5).abs() < 1e-4);
        assert_eq!(evened(0.2, 1.0), 1.0);
        assert!((evened(0.2, 0.25) - 1.0 / 1.033).abs() < 1e-6);
    }

    #[test]
    fn any_number_is_taken() {
        let law = Law::new(f32::NAN, f32::INFINITY, f32::NAN);
        assert_eq!((law.first, law.reach), (0.25, 0.0));
        assert!(Law::new(1.0, 1e9, 1e9).reach == MOST_REACH);
        assert_eq!(law.width_of(0.0, 1.0), 0.0);
    }
}
