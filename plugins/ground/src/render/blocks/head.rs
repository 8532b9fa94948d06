//! What a choice says of itself, when it has come back from the GPU.

use bevy::math::ops;
use dolomite_geometry::layout::{OWN, OWN_WORDS};
use dolomite_geometry::render::GeometryView;

use crate::blocks::layout::{
    HEAD_CANDIDATES, HEAD_COARSENING, HEAD_CURVE, HEAD_DRAWN, HEAD_LEFT, HEAD_MADE, HEAD_STAMP,
    HEAD_USED, HEAD_WISHES,
};
use crate::detail::work::ErrorCounts;

/// Words of the curve.
const CURVE: usize = 8;
/// Its steps in an octave.
const STEPS_AN_OCTAVE: f32 = 2.0;
/// Steps beyond it that the work is continued for: half of a thousandth of it is left then.
const BEYOND: i32 = 20;
/// Vertices of a root that are there whatever the tolerance, as `ROOT_CORNERS` in `fit.wgsl`.
const ROOT_CORNERS: f32 = 145.0;
/// Triangles of a root where nothing is finer, as `ROOT_TRIANGLES` there.
const ROOT_TRIANGLES: f32 = 512.0;
/// Vertices of a block that an older one may have as well, as `SHARED` there.
const SHARED: f32 = 33.0;

/// The producer's own words of a view's head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::render) struct Head {
    /// Number of the choice.
    pub stamp: u32,
    /// What error ratios were divided by.
    pub coarsening: f32,
    /// The greatest error ratio that the finest blocks leave.
    pub left: f32,
    /// Blocks that there are.
    pub used: u32,
    /// Blocks that were made, and those that would have been with more time or room.
    pub made: u32,
    pub wishes: u32,
    /// Blocks that were looked at, and that are drawn.
    pub candidates: u32,
    pub drawn: u32,
    /// Vertices that appear at the coarsenings 2^(k/2).
    pub curve: [u32; CURVE],
}

impl Head {
    /// The newest that came back of a view's choices, if any did.
    pub fn of(state: &GeometryView) -> Option<Self> {
        Self::read(&state.counters.newest.own)
    }

    fn read(own: &[u32; OWN_WORDS]) -> Option<Self> {
        let word = |at: usize| own[at - OWN as usize];
        (word(HEAD_STAMP) > 0).then(|| Self {
            stamp: word(HEAD_STAMP),
            coarsening: f32::from_bits(word(HEAD_COARSENING)),
            left: f32::from_bits(word(HEAD_LEFT)),
            used: word(HEAD_USED),
            made: word(HEAD_MADE),
            wishes: word(HEAD_WISHES),
            candidates: word(HEAD_CANDIDATES),
            drawn: word(HEAD_DRAWN),
            curve: std::array::from_fn(|k| word(HEAD_CURVE + k)),
        })
    }

    /// The bound that was kept, in tolerances.
    pub const fn held(&self) -> f32 {
        self.coarsening.max(self.left).max(1.0)
    }

    /// Vertices for which there has to be room so that nothing is coarsened, as `fit.wgsl` counts them; pools have room for
    /// twice as many triangles. Where it was coarsened not all blocks were drawn that will be: then those count that were
    /// looked at.
    pub fn needed(&self, roots: u32) -> u32 {
        let drawn = if self.coarsening > 1.0 {
            self.candidates
        } else {
            self.drawn
        };
        let own = self.curve[0] as f32;
        let vertices = own + SHARED * drawn as f32 + ROOT_CORNERS * roots as f32;
        let triangles = 2.0 * own + ROOT_TRIANGLES * roots as f32;
        vertices.max(0.5 * triangles) as u32
    }

    /// What the view asks for at every tolerance from the first on that all blocks were there for; the asked one is
    /// `pixels`. `None` where not even the coarsest was counted in full.
    pub fn work(&self, pixels: f32, roots: u32) -> Option<ErrorCounts> {
        let ratio = |k: usize| ops::exp2(k as f32 / STEPS_AN_OCTAVE);
        let first = (0..CURVE).find(|&k| ratio(k) >= 0.999 * self.coarsening)?;
        let above: Vec<f32> = self.curve[first..].iter().map(|&n| n as f32).collect();
        let mut counts: Vec<f32> = above.windows(2).map(|pair| pair[0] - pair[1]).collect();
        // As at its end, so beyond it.
        let [.., before, last] = self.curve.map(|count| count as f32);
        let falls = if before > 0.0 {
            (last / before).clamp(0.0, 0.95)
        } else {
            0.0
        };
        let beyond = (0..BEYOND).map(|k| last * (1.0 - falls) * ops::powf(falls, k as f32));
        counts.extend(beyond);
        Some(ErrorCounts {
            tolerance: pixels * ratio(first),
            always: ROOT_CORNERS * roots as f32,
            counts,
            steps_an_octave: STEPS_AN_OCTAVE,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(coarsening: f32, curve: [u32; CURVE]) -> Head {
        Head {
            stamp: 1,
            coarsening,
            left: 0.0,
            used: 1,
            made: 0,
            wishes: 0,
            candidates: 1,
            drawn: 1,
            curve,
        }
    }

    /// 10⁵ vertices at the tolerance, and so on by a power of it.
    fn law(exponent: f32) -> [u32; CURVE] {
        std::array::from_fn(|k| (1e5 * ops::exp2(-exponent * k as f32 / 2.0)).round() as u32)
    }

    #[test]
    fn a_power_law_is_found_within_the_curve_and_beyond_it() {
        for exponent in [0.5, 1.0, 1.7] {
            let work = head(1.0, law(exponent)).work(2.0, 0).expect("counted");
            let curve = work.curve(0.5, 64.0).expect("ends");
            for tolerance in [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 60.0] {
                let wanted = 1e5 * ops::powf(tolerance / 2.0, -exponent);
                let off = curve.at(tolerance) / wanted;
                // Counts of half an octave are taken as even: up to 6 % at the steepest.
                assert!((off - 1.0).abs() < 0.1, "{exponent}, {tolerance} px: {off}");
            }
        }
    }

    #[test]
    fn what_has_not_been_made_is_not_counted() {
        let work = head(2.0, law(1.0)).work(1.0, 1).expect("counted");
        assert_eq!((work.tolerance, work.always), (2.0, 145.0));
        assert_eq!(work.counts[0], 50_000.0 - 35_355.0);
        assert_eq!(head(20.0, law(1.0)).work(1.0, 1), None);
        let nothing = head(1.0, [0; CURVE]).work(1.0, 1).expect("counted");
        let always = nothing.curve(1.0, 8.0).expect("ends").at(4.0);
        // The curve keeps logarithms.
        assert!((always - 145.0).abs() < 0.01, "{always}");
    }

    #[test]
    fn pools_have_room_for_all_that_is_counted() {
        let mut of = head(1.0, law(1.0));
        of.drawn = 1000;
        of.candidates = 1500;
        assert_eq!(of.needed(4), 100_000 + 33_000 + 580);
        of.coarsening = 1.5;
        assert_eq!(of.needed(4), 100_000 + 49_500 + 580);
        let roots = head(1.0, [0; CURVE]);
        assert_eq!(roots.needed(4), 1024, "two triangles a vertex");
    }

    #[test]
    fn nothing_has_come_back_before_the_first_choice() {
        assert_eq!(Head::read(&[0; OWN_WORDS]), None);
    }
}
