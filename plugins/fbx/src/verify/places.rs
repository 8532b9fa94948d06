//! Places of a span at which an error is looked at, and what it is at most between them.
//!
//! Two kinds: zeros of Chebyshev's polynomials, which lie within the span, for spans whose ends may be beside a jump; and
//! the extrema of these (Lobatto's places), of which the ends are two, so that a span has one look in common with the next.

use crate::curves::{Majorant, ORDERS};
use std::f64::consts::PI;
use std::sync::{LazyLock, OnceLock};

/// Places, -1 to 1, and what follows from their number.
#[derive(Debug)]
pub(super) struct Places {
    /// Growing.
    pub(super) at: Vec<f64>,
    /// The ends are two of them.
    pub(super) ends: bool,
    /// Their Lebesgue constant, or a little more: no polynomial of a degree less than their number is longer by more.
    pub(super) lebesgue: f64,
    /// Over a span that is one long, the most of the product of all distances from them.
    product: f64,
    /// For each point that spans the hull of the polynomial through them, and is no place itself: how much of each place is in it.
    pub(super) hull: Vec<Vec<f64>>,
    /// The same for each of the [`dense`] places.
    dense: OnceLock<Vec<Vec<f64>>>,
}

/// Within the span: how many, and Lebesgue constants (1 / n times the sum of cot((2 k + 1) pi / 4 n)).
const WITHIN: [(usize, f64); 5] = [(1, 1.0), (2, 1.415), (3, 1.667), (4, 1.848), (6, 2.105)];

/// With its ends: how many, Lebesgue constants, and products. The product of `n` is at most 4 / 4^n; that of three is known.
const ENDS: [(usize, f64, f64); 5] = [
    (2, 1.0, 1.0 / 4.0),
    (3, 1.2501, 0.048_113),
    (4, 1.667, 1.0 / 64.0),
    (5, 1.80, 1.0 / 256.0),
    (6, 1.99, 1.0 / 1024.0),
];

static OF_WITHIN: LazyLock<Vec<Places>> = LazyLock::new(|| {
    let each = WITHIN.into_iter().map(|(count, lebesgue)| {
        // Two over four to the power of their number.
        let product = 2.0 / f64::from(1_u32 << (2 * count));
        Places::of(zeros(count), false, lebesgue, product)
    });
    each.collect()
});

static OF_ENDS: LazyLock<Vec<Places>> = LazyLock::new(|| {
    let middle = Places::of(zeros(1), false, 1.0, 0.5);
    let each = ENDS.into_iter().map(|(count, lebesgue, product)| {
        let last = count - 1;
        let at = (0..count).map(|k| -cosine(PI * k as f64 / last as f64));
        Places::of(at.collect(), true, lebesgue, product)
    });
    [middle].into_iter().chain(each).collect()
});

fn cosine(angle: f64) -> f64 {
    glam::DVec2::from_angle(angle).x
}

/// Zeros of Chebyshev's polynomial of degree `count`, growing.
fn zeros(count: usize) -> Vec<f64> {
    let angle = |k: usize| PI * (2 * k + 1) as f64 / (2 * count) as f64;
    (0..count).map(|k| -cosine(angle(k))).collect()
}

/// So many places as many times the degree of a polynomial, at which its size is known to a factor of
/// 1 / cos(pi / 12) (Ehlich and Zeller, 1964).
pub(super) fn dense(degree: usize) -> Vec<f64> {
    zeros(DENSE * degree)
}

/// Places for each degree at which a polynomial is looked at.
const DENSE: usize = 6;

impl Places {
    fn of(at: Vec<f64>, ends: bool, lebesgue: f64, product: f64) -> Self {
        let hull = hull(&at, ends);
        Self {
            at,
            ends,
            lebesgue,
            product,
            hull,
            dense: OnceLock::new(),
        }
    }

    /// All kinds, with the ends or without, few places first.
    pub(super) fn all(ends: bool) -> &'static [Self] {
        if ends { &OF_ENDS } else { &OF_WITHIN }
    }

    /// What polynomials through them are at dense places: for each of these, how much of each place is in it. Nothing for one place.
    pub(super) fn dense(&self) -> &[Vec<f64>] {
        self.dense.get_or_init(|| {
            let row = |x: f64| (0..self.count()).map(|i| value(&self.at, i, x)).collect();
            dense(self.count() - 1).into_iter().map(row).collect()
        })
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.at.len()
    }

    /// How far a function of this majorant is from the polynomial through them, where it is one place: from its value there.
    pub(super) fn rest(&self, rate: &Majorant) -> f64 {
        match self.count() {
            1 => rate.1,
            count if count < ORDERS => rate.0[count] * self.product,
            _ => f64::INFINITY,
        }
    }

    /// On the way from `from` to `to`, both exact.
    pub(super) fn time(&self, index: usize, from: f64, to: f64) -> f64 {
        let last = self.count() - 1;
        match index {
            0 if self.ends => from,
            _ if self.ends && index == last => to,
            _ => within(self.at[index], from, to),
        }
    }
}

/// A place of a span.
pub(super) fn within(x: f64, from: f64, to: f64) -> f64 {
    f64::midpoint(from, to) + (to - from) / 2.0 * x
}

/// Pieces that a polynomial's hull is made of: its Bézier points over each.
fn pieces(count: usize) -> usize {
    match count {
        0..=2 => 1,
        3 => 2,
        _ => 4,
    }
}

fn hull(places: &[f64], ends: bool) -> Vec<Vec<f64>> {
    let count = places.len();
    let degree = count - 1;
    let mut out = Vec::new();
    if degree == 0 {
        return out;
    }
    let pieces = pieces(count);
    let end = |piece: usize| 2.0 * piece as f64 / pieces as f64 - 1.0;
    for piece in 0..pieces {
        let each: Vec<Vec<f64>> = (0..count)
            .map(|i| points(&lagrange(places, i, end(piece), end(piece + 1))))
            .collect();
        for point in 0..=degree {
            // Where pieces meet the point lies between its neighbours; the ends of all are places themselves, or stand here.
            let is_first = point == 0 && (ends || piece > 0);
            let is_last = point == degree && (ends || piece + 1 < pieces);
            if is_first || is_last {
                continue;
            }
            out.push(each.iter().map(|points| points[point]).collect());
        }
    }
    out
}

/// Lagrange's polynomial to a place.
fn value(places: &[f64], to: usize, x: f64) -> f64 {
    let others = places.iter().enumerate().filter(|(i, _)| *i != to);
    let factors = others.map(|(_, place)| (x - place) / (places[to] - place));
    factors.product()
}

/// Coefficients of Lagrange's polynomial to a place over a piece, which is taken to be one long.
fn lagrange(places: &[f64], to: usize, from: f64, until: f64) -> Vec<f64> {
    let mut out = vec![1.0];
    for (i, place) in places.iter().enumerate() {
        if i == to {
            continue;
        }
        let over = 1.0 / (places[to] - place);
        let (constant, slope) = ((from - place) * over, (until - from) * over);
        let mut next = vec![0.0; out.len() + 1];
        for (k, x) in out.iter().enumerate() {
            next[k] += x * constant;
            next[k + 1] += x * slope;
        }
        out = next;
    }
    out
}

/// The Bézier points of a polynomial by its coefficients.
fn points(coefficients: &[f64]) -> Vec<f64> {
    let degree = coefficients.len() - 1;
    let choose = |n: usize, k: usize| (0..k).fold(1.0, |c, i| c * (n - i) as f64 / (i + 1) as f64);
    let point = |j: usize| {
        let parts = coefficients.iter().enumerate().take(j + 1);
        parts
            .map(|(k, x)| x * choose(j, k) / choose(degree, k))
            .sum()
    };
    (0..=degree).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(places: &[f64], values: &[f64], x: f64) -> f64 {
        let each = (0..places.len()).map(|i| value(places, i, x) * values[i]);
        each.sum()
    }

    fn shares() -> impl Iterator<Item = f64> {
        (0..=20_000).map(|i| f64::from(i) / 10_000.0 - 1.0)
    }

    #[test]
    fn lebesgue_constants_and_products_are_those_of_the_places() {
        for places in Places::all(false).iter().chain(Places::all(true)) {
            let count = places.count();
            let (mut sum, mut product) = (0.0_f64, 0.0_f64);
            for x in shares() {
                let one = |i: usize| {
                    let mut values = vec![0.0; count];
                    values[i] = 1.0;
                    polynomial(&places.at, &values, x).abs()
                };
                sum = sum.max((0..count).map(one).sum());
                let ways = places.at.iter().map(|place| (x - place).abs() / 2.0);
                product = product.max(ways.product());
            }
            assert!(
                sum <= places.lebesgue && sum > places.lebesgue - 0.02,
                "{places:?}: {sum}"
            );
            assert!(
                product <= places.product * (1.0 + 1e-9),
                "{places:?}: {product}"
            );
            assert!(product > places.product * 0.6, "{places:?}: {product}");
        }
    }

    #[test]
    fn polynomials_stay_within_their_hulls() {
        let mut seed = 7_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
        };
        for places in Places::all(false).iter().chain(Places::all(true)) {
            if places.count() == 1 {
                continue;
            }
            for _ in 0..20 {
                let values: Vec<f64> = places.at.iter().map(|_| random()).collect();
                let most = shares().step_by(20);
                let most = most.map(|x| polynomial(&places.at, &values, x).abs());
                let most = most.fold(0.0, f64::max);
                let row = |row: &Vec<f64>| row.iter().zip(&values).map(|(a, b)| a * b).sum::<f64>();
                let mut hull = places
                    .hull
                    .iter()
                    .map(|each| row(each).abs())
                    .fold(0.0, f64::max);
                if places.ends {
                    hull = values
                        .iter()
                        .fold(hull, |hull, value| hull.max(value.abs()));
                }
                assert!(hull >= most * (1.0 - 1e-12), "{hull} of {most}: {places:?}");
                let dense = places.dense().iter();
                let dense = dense.map(|each| row(each).abs()).fold(0.0, f64::max);
                assert!(
                    dense <= most * (1.0 + 1e-6),
                    "{dense} of {most}: {places:?}"
                );
                assert!(1.035_277 * dense >= most, "{dense} of {most}: {places:?}");
                assert!(hull <= most * 1.6, "{hull} of {most}: {places:?}");
            }
        }
    }
}
