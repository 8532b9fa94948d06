//! Random pairs of patches with a side in common.

use crate::tessellators::{MODES, SPACINGS, positive};
use dolomite_tessellation::{Domain, Levels, PatchLayout, Tessellator, Winding};
use dolomite_testkit::random::Random;

/// Domains whose patches have sides.
pub const DOMAINS: [Domain; 2] = [Domain::Triangles, Domain::Quads];

/// How many tessellators are tried: each of [`DOMAINS`], every spacing, both modes.
pub const TESSELLATORS: usize = 12;

/// Two patches beside each other.
#[derive(Debug, Clone)]
pub struct Pair {
    /// What each of them asks for.
    pub levels: [Levels; 2],
    /// Which side of each is the common one.
    pub sides: [usize; 2],
    /// Whether the second patch's side runs as the first one's does; patches of a surface with one
    /// orientation run against each other.
    pub along: bool,
    /// Control points of each, those of the common side with the same bits.
    pub points: [Vec<[f32; 4]>; 2],
}

/// The tessellator of a place in the round of all [`TESSELLATORS`].
#[must_use]
pub fn tessellator(place: usize) -> Tessellator {
    Tessellator {
        domain: DOMAINS[place % 2],
        spacing: SPACINGS[place / 2 % 3],
        mode: MODES[place / 6 % 2],
        winding: if (place / TESSELLATORS).is_multiple_of(2) {
            Winding::Ccw
        } else {
            Winding::Cw
        },
    }
}

/// Three or four control points.
#[must_use]
pub const fn layout(domain: Domain) -> PatchLayout {
    match domain {
        Domain::Triangles => PatchLayout::TRIANGLE,
        _ => PatchLayout::QUAD,
    }
}

/// A pair of patches of `domain`.
#[must_use]
pub fn pair(random: &mut Random, domain: Domain) -> Pair {
    let layout = layout(domain);
    let sides = layout.sides;
    let below = |random: &mut Random, end: usize| (random.unit() * end as f64) as usize;
    let own = [below(random, sides.len()), below(random, sides.len())];
    let along = random.next_u32() >> 31 == 0;
    let mut triple =
        |size: f64| -> [f64; 3] { std::array::from_fn(|_| size * random.signed_unit()) };
    // Up to 100 lengths from the origin, where rounding is no longer the same for all points.
    let (from, across) = (triple(100.0), triple(1.0));
    let to: [f64; 3] = std::array::from_fn(|k| from[k] + across[k]);
    let off = [triple(1.0), triple(1.0)];
    let points = [0, 1].map(|which| {
        let mut points = vec![[0.0; 4]; layout.points as usize];
        let (start, end) = if which == 1 && !along {
            (to, from)
        } else {
            (from, to)
        };
        let put = |points: &mut Vec<[f32; 4]>, place: u32, p: [f64; 3]| {
            points[place as usize] = [p[0] as f32, p[1] as f32, p[2] as f32, 0.0];
        };
        let side = own[which];
        // Sides follow each other: behind the end of one begins the next.
        let next = sides[(side + 1) % sides.len()][1];
        let last = sides[(side + sides.len() - 1) % sides.len()][0];
        put(
            &mut points,
            last,
            std::array::from_fn(|k| start[k] + off[which][k]),
        );
        put(
            &mut points,
            next,
            std::array::from_fn(|k| end[k] + off[which][k]),
        );
        put(&mut points, sides[side][0], start);
        put(&mut points, sides[side][1], end);
        points
    });
    let mut levels = || Levels {
        outer: std::array::from_fn(|_| positive(random)),
        // Few inner vertices as a rule, many now and then: what counts is the side.
        inner: std::array::from_fn(|_| {
            let cubed = random.unit() * random.unit() * random.unit();
            (0.5 + 63.5 * cubed) as f32
        }),
    };
    Pair {
        levels: [levels(), levels()],
        sides: own,
        along,
        points,
    }
}

impl Pair {
    /// The same, with the second patch asking for the first one's level along the common side.
    #[must_use]
    pub fn with_equal_levels(mut self) -> Self {
        self.levels[1].outer[self.sides[1]] = self.levels[0].outer[self.sides[0]];
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tessellator_is_tried() {
        let all: std::collections::HashSet<_> = (0..2 * TESSELLATORS).map(tessellator).collect();
        assert_eq!(all.len(), 2 * TESSELLATORS);
    }

    #[test]
    fn pairs_have_a_side_in_common_and_nothing_else() {
        let mut random = Random::new(4);
        let mut along = 0;
        for k in 0..200 {
            let domain = DOMAINS[k % 2];
            let pair = pair(&mut random, domain);
            let sides = layout(domain).sides;
            let ends = |which: usize| {
                let [a, b] = [0, 1].map(|end| sides[pair.sides[which]][end] as usize);
                [pair.points[which][a], pair.points[which][b]]
            };
            let [first, mut second] = [ends(0), ends(1)];
            if !pair.along {
                second.reverse();
            }
            assert_eq!(first, second);
            let common = |p: &&[f32; 4]| pair.points[1].contains(p);
            assert_eq!(pair.points[0].iter().filter(common).count(), 2);
            along += usize::from(pair.along);
        }
        assert!((50..150).contains(&along));
    }
}
