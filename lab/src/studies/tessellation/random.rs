//! Random patches: every domain, spacing, winding and mode in turn, with levels drawn where a
//! tessellator may go wrong.

use crate::tessellators::{DOMAINS, MODES, SPACINGS, WINDINGS, positive};
use dolomite_tessellation::{Levels, Tessellator};
use dolomite_testkit::random::Random;

/// A patch to tessellate, and what else its rules are tried with.
#[derive(Debug, Clone, Copy)]
pub struct Tuple {
    /// What the tessellator is set to.
    pub tessellator: Tessellator,
    /// The levels.
    pub levels: Levels,
    /// Other levels, none of which discards.
    pub others: Levels,
    /// A side of the domain.
    pub side: usize,
    /// Another side; isolines: any.
    pub other_side: usize,
}

/// A stream of patches; same seed, same stream.
pub struct Tuples {
    random: Random,
    drawn: usize,
}

impl Tuples {
    /// Same seed, same stream.
    #[must_use]
    pub fn new(seed: u32) -> Self {
        Self {
            random: Random::new(seed),
            drawn: 0,
        }
    }
}

impl Iterator for Tuples {
    type Item = Tuple;

    fn next(&mut self) -> Option<Tuple> {
        let k = self.drawn;
        self.drawn += 1;
        let tessellator = Tessellator {
            domain: DOMAINS[k % 3],
            spacing: SPACINGS[k / 3 % 3],
            winding: WINDINGS[k / 9 % 2],
            mode: MODES[k / 18 % 2],
        };
        let random = &mut self.random;
        let levels = levels(random, level);
        let others = self::levels(random, positive);
        let sides = tessellator.domain.outer_levels();
        let side = random.below(sides);
        let other_side = (side + 1 + random.below(sides - 1)) % sides;
        Some(Tuple {
            tessellator,
            levels,
            others,
            side,
            other_side,
        })
    }
}

/// The levels of a patch: each for itself, or, one time in eight each, all of them about 1, or all of
/// them the same.
fn levels(random: &mut Random, draw: fn(&mut Random) -> f32) -> Levels {
    let (style, same) = (random.below(8), draw(random));
    let mut one = || match style {
        0 => about_one(random),
        1 => same,
        _ => draw(random),
    };
    Levels {
        outer: std::array::from_fn(|_| one()),
        inner: std::array::from_fn(|_| one()),
    }
}

/// One of the levels that decide whether there is anything inside: positive.
fn about_one(random: &mut Random) -> f32 {
    let levels = [
        1.0,
        1.0,
        0.5,
        1.0 - f32::EPSILON / 2.0,
        1.0 + f32::EPSILON,
        1.0,
        1.0 + 1.0 / 65_536.0,
        2.0,
    ];
    levels[random.below(8)]
}

/// Any level.
fn level(random: &mut Random) -> f32 {
    match random.below(64) {
        // All 2^32 f32: half are negative, some NaN, most far outside [1, 64].
        0..=2 => f32::from_bits(random.next_u32()),
        3 => [0.0, -0.0, f32::NAN, f32::NEG_INFINITY][random.below(4)],
        _ => positive(random),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn same_seed_same_patches() {
        let hash = |seed| {
            let mut hash = dolomite_testkit::metrics::Hash64::default();
            for tuple in Tuples::new(seed).take(500) {
                for level in tuple.levels.outer.iter().chain(&tuple.levels.inner) {
                    hash.add(u64::from(level.to_bits()));
                }
            }
            hash.finish()
        };
        assert_eq!(hash(1), hash(1));
        assert_ne!(hash(1), hash(2));
    }

    #[test]
    fn every_kind_of_level_is_drawn_and_the_others_never_discard() {
        let tuples: Vec<Tuple> = Tuples::new(1).take(4000).collect();
        let drawn = || tuples.iter().flat_map(|tuple| tuple.levels.outer);
        assert!(drawn().any(f32::is_nan));
        assert!(drawn().any(f32::is_subnormal));
        assert!(drawn().any(|level| level == f32::INFINITY));
        assert!(drawn().any(|level| level == f32::NEG_INFINITY));
        assert!(drawn().any(|level| level < 0.0));
        assert!(drawn().any(|level| level == 0.0));
        assert!(drawn().any(|level| level == 1.0_f32.next_up()));
        assert!(drawn().any(|level| level > 64.0 && level.is_finite()));
        for tuple in &tuples {
            assert!(
                tuple.others.outer.iter().all(|level| *level > 0.0),
                "{:?}",
                tuple.others
            );
            assert_ne!(tuple.side, tuple.other_side);
        }
        let all_ones = |tuple: &&Tuple| tuple.levels.outer.iter().all(|level| *level == 1.0);
        assert!(tuples.iter().filter(all_ones).count() > 3);
    }
}
