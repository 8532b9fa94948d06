//! Random patches: every domain, spacing, winding and mode in turn, with levels drawn where a
//! tessellator may go wrong.

use crate::studies::noise::points::Random;
use dolomite_tessellation::{Domain, Levels, Mode, Spacing, Tessellator, Winding};

/// Domains, as they are drawn.
pub const DOMAINS: [Domain; 3] = [Domain::Triangles, Domain::Quads, Domain::Isolines];
/// Spacings, as they are drawn.
pub const SPACINGS: [Spacing; 3] = [
    Spacing::Equal,
    Spacing::FractionalEven,
    Spacing::FractionalOdd,
];
/// Modes, as they are drawn.
pub const MODES: [Mode; 2] = [Mode::Exact, Mode::D3d];
const WINDINGS: [Winding; 2] = [Winding::Ccw, Winding::Cw];

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
        let side = below(random, sides as u32) as usize;
        let other_side = (side + 1 + below(random, sides as u32 - 1) as usize) % sides;
        Some(Tuple {
            tessellator,
            levels,
            others,
            side,
            other_side,
        })
    }
}

/// Uniform, 0 to `end` − 1.
fn below(random: &mut Random, end: u32) -> u32 {
    ((u64::from(random.next_u32()) * u64::from(end)) >> 32) as u32
}

/// The levels of a patch: each for itself, or, one time in eight each, all of them about 1, or all of
/// them the same.
fn levels(random: &mut Random, draw: fn(&mut Random) -> f32) -> Levels {
    let (style, same) = (below(random, 8), draw(random));
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
    levels[below(random, 8) as usize]
}

/// Any level.
fn level(random: &mut Random) -> f32 {
    match below(random, 64) {
        // All 2^32 f32: half are negative, some NaN, most far outside [1, 64].
        0..=2 => f32::from_bits(random.next_u32()),
        3 => [0.0, -0.0, f32::NAN, f32::NEG_INFINITY][below(random, 4) as usize],
        _ => positive(random),
    }
}

/// A level that does not discard.
pub fn positive(random: &mut Random) -> f32 {
    match below(random, 32) {
        // An integer, 16 in all or up to 64, or its neighbour among f32.
        0..=4 => neighbour(random, 16),
        5..=8 => neighbour(random, 65),
        // Next to an integer.
        9..=13 => {
            let step = (8 + below(random, 17)) << 23;
            let apart = f32::from_bits(f32::to_bits(1.0) - step);
            let whole = whole(random, 64);
            if below(random, 2) == 0 {
                whole + apart
            } else {
                whole - apart
            }
        }
        // From the least denormal to 1.
        14 => f32::from_bits(1 + below(random, f32::to_bits(1.0))),
        // Denormals alone.
        15 => f32::from_bits(1 + below(random, (1 << 23) - 1)),
        // 64 and beyond.
        16 => {
            let least = f32::to_bits(64.0);
            let span = f32::to_bits(f32::INFINITY) - least;
            f32::from_bits(least + below(random, span + 1))
        }
        17 => [65.0, 1e9, f32::MAX, f32::INFINITY][below(random, 4) as usize],
        _ => (0.5 + 65.5 * random.unit()) as f32,
    }
}

fn whole(random: &mut Random, most: u32) -> f32 {
    (1 + below(random, most)) as f32
}

fn neighbour(random: &mut Random, most: u32) -> f32 {
    let whole = whole(random, most);
    match below(random, 4) {
        0 => whole.next_up(),
        1 => whole.next_down(),
        _ => whole,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn same_seed_same_patches() {
        let hash = |seed| {
            let mut hash = crate::metrics::Hash64::default();
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
