//! Majorants of functions of functions: exponentials and rotations, reciprocals, roots and logarithms.

use super::majorant::{INVERSE, Majorant, ORDERS, times};

impl Majorant {
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::{Number, Over, holds};
    use glam::DVec3;

    /// 2 + 0.3 t + 0.4 t^2, and its number.
    fn number() -> (impl Fn(f64) -> f64, Number) {
        let mut moves = Majorant::moving(2.7, 1.1);
        moves.0[2] = 0.4;
        (|t| 2.0 + 0.3 * t + 0.4 * t * t, Number::of(2.25, moves))
    }

    #[test]
    fn products_powers_and_exponentials_hold() {
        let (f, number) = number();
        holds(&number.moves, Over::WHOLE, |t| [f(t)]);
        holds(&number.product(&number).moves, Over::WHOLE, |t| {
            [f(t) * f(t)]
        });
        holds(&number.moves.reciprocal(2.0), Over::WHOLE, |t| [1.0 / f(t)]);
        holds(&number.moves.reciprocal_root(2.0), Over::WHOLE, |t| {
            [1.0 / f(t).sqrt()]
        });
        holds(&number.moves.exponential(), Over::WHOLE, |t| {
            glam::DVec2::from_angle(f(t)).to_array()
        });
        holds(&number.moves.rotation(), Over::WHOLE, |t| {
            glam::DVec2::from_angle(f(t)).to_array()
        });
        let weight = line(0.4, 0.5);
        holds(&number.power(&weight).moves, Over::WHOLE, |t| {
            [DVec3::splat(f(t)).powf(0.15 + 0.5 * t).x]
        });
    }

    fn line(middle: f64, way: f64) -> Number {
        Number::of(middle, Majorant::moving(middle + way / 2.0, way))
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
}
