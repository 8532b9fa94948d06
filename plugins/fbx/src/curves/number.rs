//! Numbers that move.

use super::majorant::Majorant;
use glam::DVec3;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::{Over, holds};

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
            holds(&power.moves, Over::WHOLE, |t| {
                let (x, e) = (at(&number, t), at(&exponent, t));
                match e <= 0.0 {
                    true => [1.0],
                    false => [DVec3::splat(x.abs()).powf(e).x * x.signum()],
                }
            });
        }
    }
}
