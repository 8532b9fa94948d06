//! Numbers of two f64, some 106 bits: for oracles where f64 itself is what is measured.
//!
//! Sums by D. E. Knuth (TAOCP 2, 4.2.2), products by T. J. Dekker (1971), as in Y. Hida, X. Li, D. Bailey,
//! Algorithms for Quad-Double Precision Floating Point Arithmetic, 2001. Relative errors are some 1e-31; numbers
//! above 1e300 overflow where they are split.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// high + low, |low| ≤ half an ulp of high.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Dd(pub f64, pub f64);

fn two_sum(a: f64, b: f64) -> Dd {
    let sum = a + b;
    let of_b = sum - a;
    Dd(sum, (a - (sum - of_b)) + (b - of_b))
}

fn quick_two_sum(a: f64, b: f64) -> Dd {
    let sum = a + b;
    Dd(sum, b - (sum - a))
}

fn split(a: f64) -> (f64, f64) {
    let scaled = 134_217_729.0 * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

fn two_product(a: f64, b: f64) -> Dd {
    let product = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    Dd(product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)
}

impl Dd {
    /// Nothing.
    pub const ZERO: Self = Self(0.0, 0.0);
    /// One.
    pub const ONE: Self = Self(1.0, 0.0);

    /// The nearest f64.
    #[must_use]
    pub fn to_f64(self) -> f64 {
        self.0
    }

    /// By one step of Newton's method from that of f64; 0 of what is not above 0.
    #[must_use]
    pub fn sqrt(self) -> Self {
        if self.0 <= 0.0 {
            return Self::ZERO;
        }
        let guess = self.0.sqrt();
        let rest = self - two_product(guess, guess);
        two_sum(guess, rest.0 / (2.0 * guess))
    }
}

impl From<f64> for Dd {
    fn from(x: f64) -> Self {
        Self(x, 0.0)
    }
}

impl Add for Dd {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let high = two_sum(self.0, other.0);
        let low = two_sum(self.1, other.1);
        let sum = quick_two_sum(high.0, high.1 + low.0);
        quick_two_sum(sum.0, sum.1 + low.1)
    }
}

impl Neg for Dd {
    type Output = Self;

    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl Sub for Dd {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Dd {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = two_product(self.0, other.0);
        quick_two_sum(product.0, product.1 + (self.0 * other.1 + self.1 * other.0))
    }
}

impl Div for Dd {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let first = self.0 / other.0;
        let rest = self - other * Self(first, 0.0);
        let second = rest.0 / other.0;
        let rest = rest - other * Self(second, 0.0);
        let sum = quick_two_sum(first, second);
        sum + Self(rest.0 / other.0, 0.0)
    }
}

/// Three of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dd3(pub [Dd; 3]);

impl Dd3 {
    /// Of f64.
    #[must_use]
    pub fn new(v: [f64; 3]) -> Self {
        Self(v.map(Dd::from))
    }

    /// Scalar product.
    #[must_use]
    pub fn dot(self, o: Self) -> Dd {
        self.0[0] * o.0[0] + self.0[1] * o.0[1] + self.0[2] * o.0[2]
    }

    /// Vector product.
    #[must_use]
    pub fn cross(self, o: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, o.0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }

    /// Times a number.
    #[must_use]
    pub fn times(self, by: Dd) -> Self {
        Self(self.0.map(|x| x * by))
    }

    /// Each number by its own.
    #[must_use]
    pub fn over(self, o: Self) -> Self {
        Self([0, 1, 2].map(|i| self.0[i] / o.0[i]))
    }

    /// The nearest f64.
    #[must_use]
    pub fn to_f64(self) -> [f64; 3] {
        self.0.map(Dd::to_f64)
    }
}

impl Add for Dd3 {
    type Output = Self;

    fn add(self, o: Self) -> Self {
        Self([0, 1, 2].map(|i| self.0[i] + o.0[i]))
    }
}

impl Sub for Dd3 {
    type Output = Self;

    fn sub(self, o: Self) -> Self {
        Self([0, 1, 2].map(|i| self.0[i] - o.0[i]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_that_f64_lacks_are_kept() {
        let third = Dd::ONE / Dd::from(3.0);
        let back = third + third + third - Dd::ONE;
        assert!(back.0.abs() < 1e-31, "{back:?}");
        let two = Dd::from(2.0).sqrt();
        assert!((two * two - Dd::from(2.0)).0.abs() < 1e-30);
        // (1 + 1e-20)² − 1 − 2e-20 = 1e-40, of which f64 has nothing.
        let small = Dd::from(1e-12);
        let x = Dd::ONE + small;
        let rest = x * x - Dd::ONE - small - small;
        assert!((rest.0 / 1e-24 - 1.0).abs() < 1e-6, "{rest:?}");
        // f64 alone does not.
        let x = 1.0 + 1e-12_f64;
        assert!(((x * x - 1.0 - 2e-12) / 1e-24 - 1.0).abs() > 1.0);
    }
}
