//! How fast a function of time may change over a span, all derivatives at once.
//!
//! A [`Majorant`] of a function over a span holds, for each order `k`, a number that no Taylor coefficient of that order is
//! above at any time of the span, in length; the span is taken to be one long. Sums, products, reciprocals, exponentials
//! and solutions of differential equations of functions have majorants that follow from those of their parts by the
//! same formulas as the coefficients themselves, with absolute values (Cauchy's method of majorants): each formula
//! here and in [`functions`](super::functions) is one for Taylor coefficients whose terms were made positive. An order of which nothing is known is infinite.
//!
//! Beside them it holds how far any value is from the one in the middle of the span. That is half of the first order at most, but is
//! known where no derivative is: a power near 0, angles near a pole, what lies on both sides of a key.

use glam::DVec3;

/// Orders that are kept: 0 to 6.
pub(crate) const ORDERS: usize = 7;

/// See the module: orders, and the way from the middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Majorant(pub(crate) [f64; ORDERS], pub(crate) f64);

/// 1 over each order.
pub(super) const INVERSE: [f64; ORDERS] = [
    0.0,
    1.0,
    1.0 / 2.0,
    1.0 / 3.0,
    1.0 / 4.0,
    1.0 / 5.0,
    1.0 / 6.0,
];

/// A product that is nothing where one factor is nothing, infinite or not.
pub(super) fn times(a: f64, b: f64) -> f64 {
    match a == 0.0 || b == 0.0 {
        true => 0.0,
        false => a * b,
    }
}

impl Majorant {
    /// Of what is 0.
    pub(crate) const ZERO: Self = Self([0.0; ORDERS], 0.0);

    /// Of what nothing is known of.
    pub(crate) const UNKNOWN: Self = Self([f64::INFINITY; ORDERS], f64::INFINITY);

    /// Of what has no derivatives: it is at most `size` long, and `way` from its value in the middle.
    pub(crate) fn within(size: f64, way: f64) -> Self {
        let mut out = Self::UNKNOWN;
        (out.0[0], out.1) = (size, way);
        out
    }

    /// Of what goes on at no more than `speed`, evenly: it is at most `size` long.
    pub(crate) fn moving(size: f64, speed: f64) -> Self {
        let mut out = Self::still(size);
        (out.0[1], out.1) = (speed.abs(), speed.abs() / 2.0);
        out
    }

    /// All orders are known: where one is not, none after it is.
    pub(super) fn is_known(&self) -> bool {
        self.0[ORDERS - 1].is_finite()
    }

    /// By its orders alone.
    pub(crate) fn by_orders(orders: [f64; ORDERS]) -> Self {
        Self(orders, orders[1] / 2.0)
    }

    /// No farther than `way` from its value in the middle.
    #[must_use]
    #[inline]
    pub(crate) fn near(mut self, way: f64) -> Self {
        self.1 = self.1.min(way).min(self.0[1] / 2.0);
        self
    }

    /// Over half of the span.
    pub(crate) fn halved(&self) -> Self {
        let mut part = 1.0;
        let orders = self.0.map(|x| {
            let out = x * part;
            part *= 0.5;
            out
        });
        // The middle of the span is as far from that of the half as anything else.
        Self(orders, (2.0 * self.1).min(orders[1] / 2.0))
    }

    /// How far it goes at most where it is continued by so large a part of the span beyond its end.
    pub(crate) fn beyond(&self, by: f64) -> f64 {
        let mut part = 1.0;
        self.0[1..].iter().fold(0.0, |sum, order| {
            part *= by;
            sum + times(*order, part)
        })
    }

    /// Over a span that is longer by so large a part of it, where it is continued.
    pub(crate) fn longer(&self, by: f64) -> Self {
        let mut orders = self.0;
        let mut scale = 1.0;
        for (k, order) in orders.iter_mut().enumerate() {
            // Taylor's series of a Taylor coefficient.
            let mut factor = scale;
            *order = 0.0;
            for (j, known) in self.0[k..].iter().enumerate() {
                *order += times(factor, *known);
                factor *= by * (k + j + 1) as f64 / (j + 1) as f64;
            }
            scale *= 1.0 + by;
        }
        // The middle is elsewhere by half of what it is longer by.
        let way = self.1 + times(1.5 * by, orders[1]);
        Self(orders, way.min(orders[1] / 2.0))
    }

    /// Of what stands still.
    #[inline]
    pub(crate) fn still(size: f64) -> Self {
        let mut out = Self::ZERO;
        out.0[0] = size.abs();
        out
    }

    /// It stands still.
    #[inline]
    pub(crate) fn is_still(&self) -> bool {
        // None is below 0.
        let [_, a, b, c, d, e, f] = self.0;
        a + b + c + d + e + f == 0.0
    }

    #[inline]
    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self(
            std::array::from_fn(|k| self.0[k] + other.0[k]),
            self.1 + other.1,
        )
    }

    #[inline]
    pub(crate) fn scaled(&self, by: f64) -> Self {
        if by == 1.0 {
            return *self;
        }
        if by != 0.0 && by.is_finite() {
            let by = by.abs();
            return Self(self.0.map(|x| x * by), self.1 * by);
        }
        Self(self.0.map(|x| times(x, by.abs())), times(self.1, by.abs()))
    }

    /// With so many times another.
    #[inline]
    pub(crate) fn plus_scaled(&self, other: &Self, by: f64) -> Self {
        if !(other.is_known() && by.is_finite()) {
            return self.plus(&other.scaled(by));
        }
        let by = by.abs();
        Self(
            std::array::from_fn(|k| self.0[k] + other.0[k] * by),
            self.1 + other.1 * by,
        )
    }

    /// With a product of two others.
    #[inline]
    pub(crate) fn plus_product(&self, a: &Self, b: &Self) -> Self {
        match b.is_still() {
            true => self.plus_scaled(a, b.0[0]),
            false => self.plus(&a.product(b)),
        }
    }

    /// The larger of each order.
    #[inline]
    pub(crate) fn max(&self, other: &Self) -> Self {
        // One instruction for two orders, which `f64::max` is not; what is no number stays none.
        let larger = |a: f64, b: f64| if a < b { b } else { a };
        Self(
            std::array::from_fn(|k| larger(self.0[k], other.0[k])),
            larger(self.1, other.1),
        )
    }

    /// The smaller of each order, of two majorants of one function.
    #[inline]
    pub(crate) fn min(&self, other: &Self) -> Self {
        Self(
            std::array::from_fn(|k| self.0[k].min(other.0[k])),
            self.1.min(other.1),
        )
    }

    /// Of a product, of numbers or of matrices and vectors and what else keeps to lengths.
    #[inline]
    pub(crate) fn product(&self, other: &Self) -> Self {
        if other.is_still() {
            return self.scaled(other.0[0]);
        }
        if self.is_still() {
            return other.scaled(self.0[0]);
        }
        let (a, b) = (&self.0, &other.0);
        let orders = match self.is_known() && other.is_known() {
            // Nothing is infinite: no factor has to be looked at.
            true => {
                let [a0, a1, a2, a3, a4, a5, a6] = *a;
                let [b0, b1, b2, b3, b4, b5, b6] = *b;
                [
                    a0 * b0,
                    a0 * b1 + a1 * b0,
                    a0 * b2 + a1 * b1 + a2 * b0,
                    a0 * b3 + a1 * b2 + a2 * b1 + a3 * b0,
                    a0 * b4 + a1 * b3 + a2 * b2 + a3 * b1 + a4 * b0,
                    a0 * b5 + a1 * b4 + a2 * b3 + a3 * b2 + a4 * b1 + a5 * b0,
                    a0 * b6 + a1 * b5 + a2 * b4 + a3 * b3 + a4 * b2 + a5 * b1 + a6 * b0,
                ]
            }
            false => std::array::from_fn(|k| (0..=k).map(|i| times(a[i], b[k - i])).sum()),
        };
        let way = times(self.1, other.0[0]) + times(self.0[0], other.1);
        Self(orders, way).near(way)
    }

    /// Of a vector of three.
    pub(crate) fn length(parts: &[Self; 3]) -> Self {
        if parts.iter().all(Self::is_still) {
            return Self::still(DVec3::from_array([0, 1, 2].map(|i| parts[i].0[0])).length());
        }
        let long = |of: &dyn Fn(&Self) -> f64| DVec3::from_array([0, 1, 2].map(|i| of(&parts[i])));
        Self(
            std::array::from_fn(|k| long(&|part| part.0[k]).length()),
            long(&|part| part.1).length(),
        )
    }

    /// Known to change by no more than the first order says, and no further.
    pub(crate) fn bent(mut self) -> Self {
        self.0[2..].fill(f64::INFINITY);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::{Number, Over, holds};

    /// 2 + 0.3 t + 0.4 t^2, and its number.
    fn number() -> (impl Fn(f64) -> f64, Number) {
        let mut moves = Majorant::moving(2.7, 1.1);
        moves.0[2] = 0.4;
        (|t| 2.0 + 0.3 * t + 0.4 * t * t, Number::of(2.25, moves))
    }

    #[test]
    fn halves_of_spans_hold() {
        let (f, number) = number();
        holds(&number.moves.halved(), Over::WHOLE, |t| [f(t / 2.0)]);
        holds(&number.moves.halved(), Over::WHOLE, |t| [f(0.5 + t / 2.0)]);
        // From a half back to the whole.
        let mut half = Majorant::moving(2.25, 0.35);
        half.0[2] = 0.1;
        holds(&half.longer(1.0), Over::WHOLE, |t| [f(t)]);
        assert!((half.beyond(1.0) - 0.45).abs() < 1e-12);
        let somewhere = Majorant::within(2.7, 0.4);
        holds(&somewhere.halved(), Over::WHOLE, |t| [f(0.5 + t / 2.0)]);
    }
}
