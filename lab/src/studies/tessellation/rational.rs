//! Where the vertices of a patch lie, in rational numbers: from the definition, not from the stage.
//!
//! A fractional level f with n segments (n − 2 < f ≤ n) blends two edges of equal segments: vertex p
//! lies at (1 − g) i / (n − 2) + g p / n with g = (f − (n − 2)) / 2. Half an edge holds the first
//! ⌊n / 2⌋ vertices of a list that halves the longest gap over and over (the ruler function), and the
//! last of them is new: it and those behind it have i = p − 1. Ring k of a triangle lies ⅔ p(k) inside
//! its sides; a vertex of it above place p has, besides ⅔ p(k), the coordinates p − ⅓ p(k) and
//! 1 − p − ⅓ p(k).

use super::expected::{Clamped, Expected, expected};
use super::random::Tuple;
use dolomite_tessellation::Domain;
use dolomite_tessellation::place::UNIT;

/// Largest error that a coordinate may have in mode `Exact`: 2⁻²⁴.
pub const EXACT_REACH: f64 = 1.0 / UNIT as f64;

/// Largest error that the fixed point of mode `D3d` is known to make along an edge.
pub const D3D_REACH: f64 = 2e-4;

/// The same of the vertices inside a triangle: the error of a place, a third of another one's, and
/// three roundings.
pub const D3D_RING_REACH: f64 = 2.8e-4;

/// A number as a quotient; the denominator is positive.
#[derive(Debug, Clone, Copy)]
struct Ratio(i128, i128);

const ZERO: Ratio = Ratio(0, 1);
const ONE: Ratio = Ratio(1, 1);

impl Ratio {
    /// How far `fixed` / 2²⁴ is from the number. The difference is exact; it is rounded but once.
    fn error_of(self, fixed: u32) -> f64 {
        let Self(numerator, denominator) = self;
        let unit = i128::from(UNIT);
        let difference = i128::from(fixed) * denominator - numerator * unit;
        difference.unsigned_abs() as f64 / denominator as f64 / unit as f64
    }
}

/// The 32 places of half an edge in the order in which growing levels open them: 0, 16, 8, 24, 4, ...
fn ruler() -> [u32; 32] {
    let mut order = [0; 32];
    let mut next = 1;
    for step in [16, 8, 4, 2, 1] {
        for odd in (step..32).step_by(2 * step as usize) {
            order[next] = odd;
            next += 1;
        }
    }
    order
}

/// The vertices of an edge, over one denominator that is a multiple of 3.
struct Edge {
    places: Vec<i128>,
    denominator: i128,
}

impl Edge {
    fn new(Clamped { level, segments }: Clamped) -> Self {
        let n = i128::from(segments);
        if level == f64::from(segments) {
            return Self {
                places: (0..=n).map(|p| 3 * p).collect(),
                denominator: 3 * n,
            };
        }
        // Levels are multiples of 2^-23: g = weight / 2^24.
        let fixed = (level * 8_388_608.0) as i128;
        let unit = i128::from(UNIT);
        let weight = fixed - (n - 2) * 8_388_608;
        let denominator = 3 * unit * n * (n - 2);
        // The new vertex is number 1 + (open places before it).
        let half = segments as usize / 2;
        let order = ruler();
        let (open, new_place) = (&order[..half], order[half - 1]);
        let new = 1 + open.iter().filter(|place| **place < new_place).count() as i128;
        let place = |p: i128| {
            let i = if p < new { p } else { p - 1 };
            3 * ((unit - weight) * i * n + weight * p * (n - 2))
        };
        let places = (0..=n)
            .map(|p| match p.cmp(&(n - p)) {
                std::cmp::Ordering::Less => place(p),
                std::cmp::Ordering::Equal => denominator / 2,
                std::cmp::Ordering::Greater => denominator - place(n - p),
            })
            .collect();
        Self {
            places,
            denominator,
        }
    }

    fn at(&self, p: usize) -> Ratio {
        Ratio(self.places[p], self.denominator)
    }

    fn mirrored_place(&self, p: usize) -> Ratio {
        Ratio(self.denominator - self.places[p], self.denominator)
    }

    /// Towards the start, towards the end and off side, of vertex `i` of a side of ring `k`.
    fn ring(&self, k: usize, i: usize) -> [Ratio; 3] {
        let (third, along) = (self.places[k] / 3, self.places[k + i]);
        [
            self.denominator - along - third,
            along - third,
            2 * self.places[k] / 3,
        ]
        .map(|numerator| Ratio(numerator, self.denominator))
    }
}

/// Every vertex of a patch: corners, sides from `outer[0]` on, inner ones (triangles: ring by ring,
/// side by side; quads and isolines: row by row).
fn vertices(expected: &Expected) -> Vec<[Ratio; 3]> {
    let mut vertices = Vec::new();
    let outer = expected.outer.map(Edge::new);
    match expected.domain {
        Domain::Triangles => {
            vertices.extend([[ZERO, ZERO, ONE], [ONE, ZERO, ZERO], [ZERO, ONE, ZERO]]);
            for (side, edge) in outer[..3].iter().enumerate() {
                let inner = 1..edge.places.len() - 1;
                vertices.extend(
                    inner.map(|p| on_axes(side, [edge.mirrored_place(p), edge.at(p), ZERO])),
                );
            }
            let edge = Edge::new(expected.inner[0]);
            let n = edge.places.len() - 1;
            for k in 1..=n / 2 {
                if 2 * k == n {
                    vertices.push([Ratio(1, 3); 3]);
                    continue;
                }
                for side in 0..3 {
                    vertices.extend((0..n - 2 * k).map(|i| on_axes(side, edge.ring(k, i))));
                }
            }
        }
        Domain::Quads => {
            vertices.extend([
                [ZERO, ZERO, ZERO],
                [ONE, ZERO, ZERO],
                [ONE, ONE, ZERO],
                [ZERO, ONE, ZERO],
            ]);
            for (side, edge) in outer.iter().enumerate() {
                vertices.extend((1..edge.places.len() - 1).map(|p| match side {
                    0 => [ZERO, edge.mirrored_place(p), ZERO],
                    1 => [edge.at(p), ZERO, ZERO],
                    2 => [ONE, edge.at(p), ZERO],
                    _ => [edge.mirrored_place(p), ONE, ZERO],
                }));
            }
            let [columns, rows] = expected.inner.map(Edge::new);
            for row in 1..rows.places.len() - 1 {
                let v = rows.at(row);
                let inner = 1..columns.places.len() - 1;
                vertices.extend(inner.map(|column| [columns.at(column), v, ZERO]));
            }
        }
        Domain::Isolines => {
            let [lines, detail, ..] = outer;
            for line in 0..lines.places.len() - 1 {
                let v = lines.at(line);
                vertices.extend((0..detail.places.len()).map(|p| [detail.at(p), v, ZERO]));
            }
        }
    }
    vertices
}

/// (u, v, w) of a vertex by side: u, v, w are off side 0, 1, 2, and the corners w, u, v are the ends
/// of side 0, 1, 2.
fn on_axes(side: usize, [start, end, off]: [Ratio; 3]) -> [Ratio; 3] {
    let mut vertex = [off; 3];
    vertex[(side + 1) % 3] = start;
    vertex[(side + 2) % 3] = end;
    vertex
}

/// Error of each vertex of a patch, in its worst coordinate; `None` if there is another number of
/// vertices than there should be.
///
/// In mode `D3d` the level is the one that its fixed point has made of it.
#[must_use]
pub fn errors(tuple: &Tuple, coordinates: &[[u32; 3]]) -> Option<Vec<f64>> {
    let Some(expected) = expected(&tuple.tessellator, &tuple.levels) else {
        return coordinates.is_empty().then(Vec::new);
    };
    let places = vertices(&expected);
    (places.len() == coordinates.len()).then(|| {
        let error = |(place, fixed): (&[Ratio; 3], &[u32; 3])| {
            (0..3)
                .map(|k| place[k].error_of(fixed[k]))
                .fold(0.0, f64::max)
        };
        places.iter().zip(coordinates).map(error).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::super::random::Tuples;
    use super::*;
    use dolomite_tessellation::{Levels, Mode, Spacing, Tessellator};

    #[test]
    fn the_ruler_halves_the_longest_gap() {
        assert_eq!(ruler()[..9], [0, 16, 8, 24, 4, 12, 20, 28, 2]);
        let mut places = ruler();
        places.sort_unstable();
        assert!((0..32).eq(places));
    }

    /// Five segments at level 4: halfway from thirds to fifths.
    #[test]
    fn an_edge_by_hand() {
        let edge = Edge::new(Clamped {
            level: 4.0,
            segments: 5,
        });
        let expected = [
            0.0,
            (1.0 / 3.0 + 1.0 / 5.0) / 2.0,
            (1.0 / 3.0 + 2.0 / 5.0) / 2.0,
        ];
        for (p, expected) in expected.into_iter().enumerate() {
            let Ratio(numerator, denominator) = edge.at(p);
            let place = numerator as f64 / denominator as f64;
            assert!((place - expected).abs() < 1e-15, "{p}: {place}");
        }
        assert_eq!(edge.places[3], edge.denominator - edge.places[2]);
    }

    #[test]
    fn coordinates_sum_to_one() {
        for tuple in Tuples::new(2).take(200) {
            let expected = expected(&tuple.tessellator, &tuple.levels);
            for vertex in expected.iter().flat_map(vertices) {
                if tuple.tessellator.domain == Domain::Triangles {
                    let sum: f64 = vertex.iter().map(|r| r.0 as f64 / r.1 as f64).sum();
                    assert!((sum - 1.0).abs() < 1e-14, "{tuple:?}");
                }
            }
        }
    }

    #[test]
    fn a_nudge_exceeds_the_reach() {
        let tessellator = Tessellator {
            spacing: Spacing::FractionalOdd,
            mode: Mode::Exact,
            ..Default::default()
        };
        let levels = Levels::uniform(9.4);
        let tuple = Tuple {
            tessellator,
            levels,
            others: levels,
            side: 0,
            other_side: 1,
        };
        let good = tessellator.tessellate_fixed(&levels).0;
        let worst = |coordinates: &[[u32; 3]]| {
            let errors = errors(&tuple, coordinates).expect("as many vertices as there should be");
            errors.into_iter().fold(0.0, f64::max)
        };
        assert!(worst(&good) <= EXACT_REACH);
        for vertex in 0..good.len() {
            let mut nudged = good.clone();
            nudged[vertex][2] += 2;
            assert!(worst(&nudged) > EXACT_REACH, "vertex {vertex}");
        }
        assert!(errors(&tuple, &good[1..]).is_none());
    }
}
