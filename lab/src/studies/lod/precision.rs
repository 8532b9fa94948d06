//! The same ground far from the origin: are errors the same there?

use super::guarantee::{at_a_place, view};
use super::judge::Count;
use crate::scenes::cameras::{KINDS, around};
use crate::scenes::selection::{FINEST, blocks_of};
use crate::scenes::terrains;
use crate::scenes::truth::Truth;
use bevy::math::DVec2;
use dolomite_terrain::{Terrain, TerrainData};
use dolomite_testkit::random::Random;

/// How far the ground is moved along both axes, metres: a million, and such that places keep their last
/// bits.
pub const FAR: f64 = 1_048_576.0;

/// One camera at one tolerance, over ground at the origin and over the same ground [`FAR`] away.
#[derive(Debug, Clone)]
pub struct Pair {
    /// At the origin.
    pub near: Count,
    /// Far away.
    pub far: Count,
}

impl Pair {
    /// By how much the largest errors differ, as a share of the bound.
    #[must_use]
    pub fn difference(&self) -> f64 {
        (self.near.tally.max - self.far.tally.max).abs()
    }
}

/// `rounds` cameras of each kind over ground that can be moved.
#[must_use]
pub fn pairs(rounds: usize, taus: &[f64], samples: usize, seed: u32) -> Vec<Pair> {
    let centres = [DVec2::ZERO, DVec2::splat(FAR)];
    let grounds = centres.map(|centre| terrains::movable(seed, centre));
    let truths = grounds.each_ref().map(Truth::new);
    let mut blocks = grounds.map(|terrain| blocks_of(&terrain, FINEST));
    let cameras = around(&truths[0].terrain, rounds * KINDS.len(), seed);
    let mut pairs = Vec::new();
    for (number, (kind, camera)) in cameras.into_iter().enumerate() {
        for &tau in taus {
            let [near, far] = [0, 1].map(|k| {
                let mut there = camera;
                there.eye.x += centres[k].x;
                there.eye.z += centres[k].y;
                let mut random = Random::new(seed.wrapping_add(number as u32));
                let blocks = &mut blocks[k];
                view(&truths[k], blocks, (kind, there), tau, samples, &mut random)
            });
            pairs.push(Pair { near, far });
        }
    }
    pairs
}

/// Noise over ground that lies [`FAR`] away: other ground, since noise is another there, by
/// the same rules.
#[must_use]
pub fn far_noise(cameras: usize, taus: &[f64], samples: usize, seed: u32) -> Vec<Count> {
    let fbm = terrains::fbm(seed);
    let centre = DVec2::splat(FAR);
    let mut extent = fbm.extent();
    extent.min += centre;
    extent.max += centre;
    let data = TerrainData {
        extent,
        ..fbm.data().clone()
    };
    let far = Terrain::new(data).expect("moved ground is as valid as it was");
    at_a_place(&far, cameras, 0, taus, samples, seed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_the_same_a_thousand_kilometres_away() {
        for pair in pairs(1, &[8.0, 4.0], 600, 4) {
            // Places in f64 have lost 2⁻³³ m there, times the pixels of a metre.
            assert!(pair.difference() < 1e-5, "{pair:?}");
            assert_eq!(pair.near.tally.samples, pair.far.tally.samples);
        }
        let counts = far_noise(KINDS.len(), &[8.0, 4.0], 600, 4);
        for count in &counts {
            assert_eq!(count.above(), 0, "{count:?}");
        }
        let samples: u64 = counts.iter().map(|count| count.tally.samples).sum();
        assert!(samples > 5_000, "{samples}");
    }
}
