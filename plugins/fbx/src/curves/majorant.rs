//! How fast a function of time may change over a span, all derivatives at once.
//!
//! A [`Majorant`] of a function over a span holds, for each order `k`, a number that no Taylor coefficient of that order is
//! above at any time of the span, in length; the span is taken to be one long. Sums, products, reciprocals, exponentials
//! and solutions of differential equations of functions have majorants that follow from those of their parts by the
//! same formulas as the coefficients themselves, with absolute values (Cauchy's method of majorants): each formula
//! below is one for Taylor coefficients whose terms were made positive. An order of which nothing is known is infinite.
//!
//! Beside them it holds how far any value is from the one in the middle of the span. That is half of the first order at most, but is
//! known where no derivative is: a power near 0, angles near a pole, what lies on both sides of a key.

use glam::DVec3;

/// A span between keys, seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Over {
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Keys that are so near to an end are taken to be that end.
    pub(crate) slack: f64,
}

impl Over {
    pub(crate) fn middle(&self) -> f64 {
        f64::midpoint(self.from, self.to)
    }

    /// The same on a clock that begins at `begin`.
    pub(crate) fn since(&self, begin: f64) -> Self {
        Self {
            from: self.from - begin,
            to: self.to - begin,
            ..*self
        }
    }
}

/// Orders that are kept: 0 to 6.
pub(crate) const ORDERS: usize = 7;

/// See the module: orders, and the way from the middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Majorant(pub(crate) [f64; ORDERS], pub(crate) f64);

/// 1 over each order.
const INVERSE: [f64; ORDERS] = [
    0.0,
    1.0,
    1.0 / 2.0,
    1.0 / 3.0,
    1.0 / 4.0,
    1.0 / 5.0,
    1.0 / 6.0,
];

/// A product that is nothing where one factor is nothing, infinite or not.
fn times(a: f64, b: f64) -> f64 {
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
    fn is_known(&self) -> bool {
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
        self.0[1..].iter().all(|&x| x == 0.0)
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

    /// The larger of each order.
    #[inline]
    pub(crate) fn max(&self, other: &Self) -> Self {
        Self(
            std::array::from_fn(|k| self.0[k].max(other.0[k])),
            self.1.max(other.1),
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
                let mut orders = [0.0; ORDERS];
                for (i, x) in a.iter().enumerate() {
                    for (sum, y) in orders[i..].iter_mut().zip(b) {
                        *sum += x * y;
                    }
                }
                orders
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

    /// Of `exp` of a function whose value does not matter: of what it is multiplied by as it moves.
    #[inline]
    pub(crate) fn exponential(&self) -> Self {
        let mut out = [0.0; ORDERS];
        out[0] = 1.0;
        if self.is_still() {
            return Self(out, 0.0);
        }
        if !self.is_known() && self.0[1].is_infinite() {
            out[1..].fill(f64::INFINITY);
            return Self::by_orders(out);
        }
        let slopes: [f64; ORDERS] = std::array::from_fn(|i| i as f64 * self.0[i]);
        // Lines and cubics have no more than so many orders.
        if self.0[2..].iter().all(|&x| x == 0.0) {
            for k in 1..ORDERS {
                out[k] = slopes[1] * out[k - 1] * INVERSE[k];
            }
            return Self::by_orders(out);
        }
        if self.0[4..].iter().all(|&x| x == 0.0) && self.0[3].is_finite() {
            out[1] = slopes[1];
            out[2] = (slopes[1] * out[1] + slopes[2]) * INVERSE[2];
            for k in 3..ORDERS {
                let sum = slopes[1] * out[k - 1] + slopes[2] * out[k - 2] + slopes[3] * out[k - 3];
                out[k] = sum * INVERSE[k];
            }
            return Self::by_orders(out);
        }
        for (k, inverse) in INVERSE.iter().enumerate().skip(1) {
            let sum: f64 = match self.is_known() {
                true => (1..=k).map(|i| slopes[i] * out[k - i]).sum(),
                false => (1..=k).map(|i| times(slopes[i], out[k - i])).sum(),
            };
            out[k] = sum * inverse;
        }
        Self::by_orders(out)
    }

    /// Of a rotation by a function, half of its angle or the whole: what is one long.
    #[inline]
    pub(crate) fn rotation(&self) -> Self {
        self.exponential().near(self.1.min(2.0))
    }

    /// Of 1 over a function that is at least `least` long, which must be above 0.
    #[inline]
    pub(crate) fn reciprocal(&self, least: f64) -> Self {
        if least.is_nan() || least <= 0.0 {
            return Self::UNKNOWN;
        }
        let mut out = [0.0; ORDERS];
        let over = 1.0 / least;
        out[0] = over;
        let known = self.is_known() && over.is_finite();
        for k in 1..ORDERS {
            let sum: f64 = match known {
                true => (1..=k).map(|i| self.0[i] * out[k - i]).sum(),
                false => (1..=k).map(|i| times(self.0[i], out[k - i])).sum(),
            };
            out[k] = sum * over;
        }
        // What came to no number came of more than numbers have room for.
        Self::by_orders(out.map(|x| if x.is_nan() { f64::INFINITY } else { x }))
    }

    /// Of 1 over the square root of a function that is at least `least` long, which must be above 0: what
    /// `(least - f)^(-1/2)` has for coefficients, by its differential equation.
    pub(crate) fn reciprocal_root(&self, least: f64) -> Self {
        if least.is_nan() || least <= 0.0 {
            return Self::UNKNOWN;
        }
        let mut out = [0.0; ORDERS];
        let over = 1.0 / least;
        out[0] = over.sqrt();
        for k in 1..ORDERS {
            let terms = (1..=k).map(|i| times(self.0[i], out[k - i]) * (k as f64 - 0.5 * i as f64));
            out[k] = terms.sum::<f64>() * over * INVERSE[k];
        }
        Self::by_orders(out.map(|x| if x.is_nan() { f64::INFINITY } else { x }))
    }

    /// Of a logarithm of a function that is between `least` and `most`, which must be above 0.
    pub(crate) fn logarithm(&self, least: f64, most: f64) -> Self {
        if least.is_nan() || least <= 0.0 {
            return Self::UNKNOWN;
        }
        let over = self.reciprocal(least);
        // ln(x) = 8 ln(x^(1/8)), and no logarithm is above its number less 1.
        let eighth = |x: f64| 8.0 * (x.sqrt().sqrt().sqrt() - 1.0);
        let mut out = [0.0; ORDERS];
        out[0] = eighth(most.max(1.0 / least).max(1.0));
        for (k, order) in out.iter_mut().enumerate().skip(1) {
            let terms = (1..=k).map(|i| times(i as f64 * self.0[i], over.0[k - i]));
            *order = terms.sum::<f64>() / k as f64;
        }
        Self::by_orders(out)
    }

    /// Of 1 / (1 - f / radius), where `f` is how the function moves, and begins at 0: what a function that is analytic
    /// to `radius` around makes of it, but for a factor.
    pub(crate) fn geometric(&self, radius: f64) -> Self {
        let mut out = [0.0; ORDERS];
        out[0] = 1.0;
        if self.is_still() {
            return Self(out, 0.0);
        }
        for k in 1..ORDERS {
            let terms = (1..=k).map(|i| times(self.0[i] / radius, out[k - i]));
            out[k] = terms.sum();
        }
        Self::by_orders(out)
    }

    /// Known to change by no more than the first order says, and no further.
    pub(crate) fn bent(mut self) -> Self {
        self.0[2..].fill(f64::INFINITY);
        self
    }
}

/// A number that moves: its value in the middle of the span, and its majorant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Number {
    pub(crate) middle: f64,
    pub(crate) moves: Majorant,
}

impl Number {
    pub(crate) fn still(value: f64) -> Self {
        Self {
            middle: value,
            moves: Majorant::still(value),
        }
    }

    /// What has no derivatives, between two bounds.
    pub(crate) fn within(value: f64, low: f64, high: f64) -> Self {
        let (low, high) = (low.min(value), high.max(value));
        let way = (high - value).max(value - low);
        Self {
            middle: value,
            moves: Majorant::within(low.abs().max(high.abs()), way),
        }
    }

    pub(crate) fn of(middle: f64, moves: Majorant) -> Self {
        let mut out = Self { middle, moves };
        let most = middle.abs() + moves.1;
        out.moves.0[0] = out.moves.0[0].min(most);
        out
    }

    pub(crate) fn low(&self) -> f64 {
        self.middle - self.moves.1
    }

    pub(crate) fn high(&self) -> f64 {
        self.middle + self.moves.1
    }

    pub(crate) fn is_still(&self) -> bool {
        self.moves.is_still()
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self::of(self.middle + other.middle, self.moves.plus(&other.moves))
    }

    pub(crate) fn minus(&self, other: &Self) -> Self {
        Self::of(self.middle - other.middle, self.moves.plus(&other.moves))
    }

    pub(crate) fn product(&self, other: &Self) -> Self {
        Self::of(self.middle * other.middle, self.moves.product(&other.moves))
    }

    /// Between two bounds, where it stays.
    pub(crate) fn clamped(&self, low: f64, high: f64) -> Self {
        if self.low() >= low && self.high() <= high {
            return *self;
        }
        if self.low() >= high || self.high() <= low {
            return Self::still(self.middle.clamp(low, high));
        }
        let middle = self.middle.clamp(low, high);
        Self::of(middle, self.moves.bent())
    }

    /// Its size to a power from 0 to 1, with its sign, as layers of scales have it.
    pub(crate) fn power(&self, exponent: &Self) -> Self {
        if exponent.high() <= 0.0 {
            return Self::still(1.0);
        }
        if exponent.low() >= 1.0 {
            return *self;
        }
        let whole = DVec3::splat(self.middle.abs()).powf(exponent.middle).x;
        let middle = whole * self.middle.signum();
        if self.is_still() && exponent.is_still() {
            return Self::still(middle);
        }
        let (least, most) = (
            self.middle.abs() - self.moves.1,
            self.middle.abs() + self.moves.1,
        );
        // What is below 0 jumps where its power becomes 0.
        let jumps = self.middle < 0.0 && exponent.low() <= 0.0;
        if least.is_nan() || least <= 0.0 || jumps {
            // It grows with its number, and goes towards 1 as its exponent falls.
            let signed =
                |x: f64, e: f64| DVec3::splat(x.abs()).powf(e.clamp(0.0, 1.0)).x * x.signum();
            let (e, f) = (exponent.low(), exponent.high());
            let each = [self.low(), self.high()].map(|x| [signed(x, e), signed(x, f)]);
            let corners = each.as_flattened().iter().copied();
            let ends = corners.chain((e <= 0.0).then_some(1.0));
            let (low, high) = ends.fold((0.0_f64, 0.0_f64), |(low, high), x| {
                (low.min(x), high.max(x))
            });
            return Self::within(middle, low, high);
        }
        let in_it = self.moves.logarithm(least, most).product(&exponent.moves);
        let mut moves = in_it.exponential().scaled(most.max(1.0));
        moves.1 = moves.0[1] / 2.0;
        Self::of(middle, moves)
    }
}

/// A part of a Bézier curve of third degree between two of its parameters, as its four points.
pub(crate) fn part(points: [f64; 4], from: f64, to: f64) -> [f64; 4] {
    // The curve's polar form, which its points are values of.
    let polar = |a: f64, b: f64, c: f64| {
        let mix = |x: f64, y: f64, t: f64| x + (y - x) * t;
        let [p, q, r, s] = points;
        let (pq, qr, rs) = (mix(p, q, a), mix(q, r, a), mix(r, s, a));
        mix(mix(pq, qr, b), mix(qr, rs, b), c)
    };
    [
        polar(from, from, from),
        polar(from, from, to),
        polar(from, to, to),
        polar(to, to, to),
    ]
}

/// Of a cubic by its Bézier points.
pub(crate) fn cubic([a, b, c, d]: [f64; 4]) -> Majorant {
    let most = |list: &[f64]| list.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let mut out = Majorant::ZERO;
    out.0[0] = most(&[a, b, c, d]);
    out.0[1] = 3.0 * most(&[b - a, c - b, d - c]);
    out.0[2] = 3.0 * most(&[c - 2.0 * b + a, d - 2.0 * c + b]);
    out.0[3] = (d - 3.0 * c + 3.0 * b - a).abs();
    let middle = (a + 3.0 * (b + c) + d) / 8.0;
    out.1 = most(&[a - middle, b - middle, c - middle, d - middle]).min(out.0[1] / 2.0);
    out
}

/// Of a cubic over its own time, both by their Bézier points: time goes from 0 to 1.
pub(crate) fn cubic_over_time(time: [f64; 4], value: [f64; 4]) -> Majorant {
    let [a, b, c, d] = time;
    let slowest = 3.0 * (b - a).min(c - b).min(d - c);
    let whole = cubic(value);
    let ends = |of: fn(f64, f64) -> f64| value.into_iter().reduce(of).unwrap_or(0.0);
    let way = ends(f64::max) - ends(f64::min);
    if slowest.is_nan() || slowest <= 0.0 {
        return Majorant::within(whole.0[0], way);
    }
    let speed = cubic(time);
    // p(time) has the derivative 1 / speed(p).
    let mut place = Majorant::ZERO;
    let mut over = Majorant::still(1.0 / slowest);
    let mut there = Majorant::ZERO;
    place.0[1] = over.0[0];
    let squared =
        |place: &Majorant, k: usize| (1..k).map(|i| place.0[i] * place.0[k - i]).sum::<f64>();
    for k in 1..ORDERS - 1 {
        // The speed is the derivative of a cubic: its own derivatives are 2 and 3 times the cubic's next coefficients.
        there.0[k] = 2.0 * speed.0[2] * place.0[k] + 3.0 * speed.0[3] * squared(&place, k);
        over.0[k] = (1..=k).map(|i| there.0[i] * over.0[k - i]).sum::<f64>() / slowest;
        place.0[k + 1] = over.0[k] / (k + 1) as f64;
    }
    let twice = place.product(&place);
    let mut out = place
        .scaled(whole.0[1])
        .plus(&twice.scaled(whole.0[2]))
        .plus(&twice.product(&place).scaled(whole.0[3]));
    out.0[0] = whole.0[0];
    out.1 = way.min(out.0[1] / 2.0);
    out
}

/// Whether divided differences of a function over a span keep to a majorant: each is a mean of Taylor coefficients there
/// (Hermite and Genocchi).
#[cfg(test)]
pub(crate) fn holds<const N: usize>(moves: &Majorant, over: Over, of: impl Fn(f64) -> [f64; N]) {
    let size = (0..=8)
        .map(|i| of(over.from + (over.to - over.from) * f64::from(i) / 8.0))
        .fold(1.0_f64, |most, v| {
            v.iter().fold(most, |most, x| most.max(x.abs()))
        });
    let middle = of(over.middle());
    for i in 0..=32 {
        let value = of(over.from + (over.to - over.from) * f64::from(i) / 32.0);
        let apart = value.iter().zip(&middle).map(|(a, b)| (a - b) * (a - b));
        let way = apart.sum::<f64>().sqrt();
        assert!(
            way <= moves.1 * (1.0 + 1e-9) + 1e-13 * size,
            "{way} of {moves:?}"
        );
    }
    for order in 0..7 {
        // Evenly spread, away from the ends.
        let share = |i: usize| (i as f64 + 0.5) / (order + 1) as f64;
        let mut table: Vec<[f64; N]> = (0..=order)
            .map(|i| of(over.from + (over.to - over.from) * share(i)))
            .collect();
        for level in 1..=order {
            for i in 0..=order - level {
                let way = share(i + level) - share(i);
                table[i] = std::array::from_fn(|axis| (table[i + 1][axis] - table[i][axis]) / way);
            }
        }
        let length = table[0].iter().map(|x| x * x).sum::<f64>().sqrt();
        let crowd = 2.0 * (order + 1) as f64;
        let rounding = (0..order).fold(1e-13 * size, |all, _| all * crowd);
        assert!(
            length <= moves.0[order] * (1.0 + 1e-9) + rounding,
            "order {order}: {length} of {moves:?}"
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: Over = Over {
        from: 0.0,
        to: 1.0,
        slack: 0.0,
    };

    /// 2 + 0.3 t + 0.4 t^2, and its number.
    fn number() -> (impl Fn(f64) -> f64, Number) {
        let mut moves = Majorant::moving(2.7, 1.1);
        moves.0[2] = 0.4;
        (|t| 2.0 + 0.3 * t + 0.4 * t * t, Number::of(2.25, moves))
    }

    #[test]
    fn products_powers_and_exponentials_hold() {
        let (f, number) = number();
        holds(&number.moves, WHOLE, |t| [f(t)]);
        holds(&number.product(&number).moves, WHOLE, |t| [f(t) * f(t)]);
        holds(&number.moves.reciprocal(2.0), WHOLE, |t| [1.0 / f(t)]);
        holds(&number.moves.reciprocal_root(2.0), WHOLE, |t| {
            [1.0 / f(t).sqrt()]
        });
        holds(&number.moves.exponential(), WHOLE, |t| {
            glam::DVec2::from_angle(f(t)).to_array()
        });
        holds(&number.moves.rotation(), WHOLE, |t| {
            glam::DVec2::from_angle(f(t)).to_array()
        });
        let weight = line(0.4, 0.5);
        holds(&number.power(&weight).moves, WHOLE, |t| {
            [DVec3::splat(f(t)).powf(0.15 + 0.5 * t).x]
        });
    }

    fn line(middle: f64, way: f64) -> Number {
        Number::of(middle, Majorant::moving(middle + way / 2.0, way))
    }

    #[test]
    fn what_is_clamped_is_known_to_its_speed() {
        let clamped = line(0.9, 0.4).clamped(0.0, 1.0);
        assert_eq!(clamped.moves.0[1], 0.4);
        assert!(clamped.moves.0[2].is_infinite());
        assert_eq!(line(1.9, 0.4).clamped(0.0, 1.0), Number::still(1.0));
        for (number, exponent) in [
            (line(0.1, 0.4), line(0.5, 0.1)),
            (line(-0.1, 0.4), line(0.1, 0.5)),
            (line(-3.0, 0.4), line(0.1, 0.5)),
        ] {
            let power = number.power(&exponent);
            assert!(power.moves.0[1].is_infinite() && power.moves.1 < 4.2);
            let at = |number: &Number, t: f64| number.middle + number.moves.0[1] * (t - 0.5);
            holds(&power.moves, WHOLE, |t| {
                let (x, e) = (at(&number, t), at(&exponent, t));
                match e <= 0.0 {
                    true => [1.0],
                    false => [DVec3::splat(x.abs()).powf(e).x * x.signum()],
                }
            });
        }
    }

    #[test]
    fn exponentials_of_lines_and_cubics_are_those_of_any_function() {
        let line = [0.3, 1.1, 0.0, 0.0, 0.0, 0.0, 0.0];
        let cubic = [0.3, 1.1, 0.4, 0.2, 0.0, 0.0, 0.0];
        for orders in [line, cubic] {
            let few = Majorant::by_orders(orders);
            // So little changes nothing but the way that it is worked out.
            let mut all = few;
            all.0[ORDERS - 1] = 1e-300;
            let pairs = few.exponential().0.into_iter().zip(all.exponential().0);
            for (order, (a, b)) in pairs.enumerate() {
                // Some roundings of f64.
                assert!((a - b).abs() <= 1e-14 * b, "order {order}: {a} and {b}");
            }
        }
    }

    #[test]
    fn halves_of_spans_hold() {
        let (f, number) = number();
        holds(&number.moves.halved(), WHOLE, |t| [f(t / 2.0)]);
        holds(&number.moves.halved(), WHOLE, |t| [f(0.5 + t / 2.0)]);
        // From a half back to the whole.
        let mut half = Majorant::moving(2.25, 0.35);
        half.0[2] = 0.1;
        holds(&half.longer(1.0), WHOLE, |t| [f(t)]);
        assert!((half.beyond(1.0) - 0.45).abs() < 1e-12);
        let somewhere = Majorant::within(2.7, 0.4);
        holds(&somewhere.halved(), WHOLE, |t| [f(0.5 + t / 2.0)]);
    }

    #[test]
    fn parts_of_cubics_are_cubics() {
        let points = [1.0, -2.0, 5.0, 0.5];
        let at = |points: [f64; 4], t: f64| part(points, t, t)[0];
        let cut = part(points, 0.2, 0.7);
        for t in [0.0, 0.3, 1.0] {
            assert!((at(cut, t) - at(points, 0.2 + 0.5 * t)).abs() < 1e-12);
        }
        holds(&cubic(cut), WHOLE, |t| [at(cut, t)]);
    }
}
