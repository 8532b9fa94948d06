//! One phase for all clips that step: 0 when the left foot lands, 1/2 when the right one does.
//!
//! Clips differ in when their feet land. A [`Warp`] takes the common phase to a clip's own, so that blended
//! clips land together: `own = left + phase + a (1 − cos 2π phase) / 2`, with `a` such that 1/2 leads to
//! the right foot's landing. It is smooth, periodic, and rises wherever |a| < 1/π.

use bevy::math::ops;
use std::f32::consts::{FRAC_1_PI, TAU};

/// From the common phase to a clip's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Warp {
    left: f32,
    bend: f32,
}

impl Warp {
    /// Nothing warped.
    pub const IDENTITY: Self = Self {
        left: 0.0,
        bend: 0.0,
    };

    /// For a clip whose left foot lands at phase `left` of its length, the right one at `right`; `None`
    /// where they are so close to each other that the clip would have to run backwards.
    #[must_use]
    pub fn new(left: f32, right: f32) -> Option<Self> {
        let half = (right - left).rem_euclid(1.0);
        let bend = half - 0.5;
        (bend.abs() < 0.95 * FRAC_1_PI).then_some(Self { left, bend })
    }

    /// The clip's phase, in [0, 1).
    #[must_use]
    pub fn apply(self, phase: f32) -> f32 {
        let own = self.left + phase + self.bend * 0.5 * (1.0 - ops::cos(TAU * phase));
        let own = own.rem_euclid(1.0);
        // `rem_euclid` rounds a tiny negative number to 1.
        if own < 1.0 { own } else { 0.0 }
    }

    /// The common phase that leads to the clip's `own`, in [0, 1).
    #[must_use]
    pub fn invert(self, own: f32) -> f32 {
        let wanted = (own - self.left).rem_euclid(1.0);
        let (mut low, mut high) = (0.0_f32, 1.0_f32);
        // As many halvings as an f32 below 1 has digits.
        for _ in 0..26 {
            let middle = 0.5 * (low + high);
            let at = middle + self.bend * 0.5 * (1.0 - ops::cos(TAU * middle));
            if at < wanted {
                low = middle
            } else {
                high = middle
            }
        }
        0.5 * (low + high)
    }
}

/// How firmly a foot stands, in [0, 1], at `since` phases after it landed, when it is lifted after
/// `stance` of them: 1 while it stands; it lets go in the first third of the swing and takes hold in the
/// last.
pub(crate) fn firmness(since: f32, stance: f32) -> f32 {
    let since = since.rem_euclid(1.0);
    if since <= stance {
        return 1.0;
    }
    let swing = ((since - stance) / (1.0 - stance).max(1e-3)).min(1.0);
    let third = 1.0 / 3.0;
    let away = swing.min(1.0 - swing) / third;
    1.0 - crate::blend::smooth(away)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn feet_land_where_they_should_and_time_runs_on() {
        for (left, right) in [(0.0, 0.5), (0.1, 0.7), (0.9, 0.3), (0.62, 0.0), (0.4, 0.7)] {
            let warp = Warp::new(left, right).unwrap();
            let close = |a: f32, b: f32| ((a - b + 0.5).rem_euclid(1.0) - 0.5).abs() < 1e-6;
            assert!(close(warp.apply(0.0), left) && close(warp.apply(0.5), right));
            let mut before = warp.apply(0.0);
            for step in 1..=1000 {
                let now = warp.apply(step as f32 / 1000.0);
                let on = (now - before).rem_euclid(1.0);
                assert!(on > 0.0 && on < 0.01, "{left} {right} {step}: {on}");
                before = now;
            }
            for step in 0..50 {
                let phase = step as f32 / 50.0 + 0.003;
                assert!((warp.invert(warp.apply(phase)) - phase).abs() < 1e-5);
            }
        }
        assert_eq!(Warp::new(0.0, 0.1), None);
    }

    #[test]
    fn a_foot_is_firm_while_it_stands() {
        for stance in [0.3, 0.62, 0.9] {
            assert_eq!(firmness(0.0, stance), 1.0);
            assert_eq!(firmness(stance, stance), 1.0);
            assert_eq!(firmness(0.5 * (1.0 + stance), stance), 0.0);
            assert!(firmness(0.9999, stance) > 0.999);
        }
    }
}
