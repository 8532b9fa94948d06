//! Intervals, and Taylor's theorem over a rectangle.

use bevy::math::DVec2;

/// What a source, or the sum so far, stays within in one cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellBounds {
    /// Heights, metres.
    pub height: Interval,
    /// Longest gradient.
    pub slope: f64,
}

/// All numbers from low to high. The arithmetic is that of f64, not rounded outward: the margins
/// that callers add for f32 are a million times its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub low: f64,
    pub high: f64,
}

impl Interval {
    pub(crate) const fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    pub(crate) const fn point(at: f64) -> Self {
        Self::new(at, at)
    }

    /// [centre − reach, centre + reach]
    pub(crate) fn around(centre: f64, reach: f64) -> Self {
        Self::new(centre - reach, centre + reach)
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        Self::new(self.low + other.low, self.high + other.high)
    }

    pub(crate) fn times(self, other: Self) -> Self {
        let products = [
            self.low * other.low,
            self.low * other.high,
            self.high * other.low,
            self.high * other.high,
        ];
        let low = products.into_iter().fold(f64::INFINITY, f64::min);
        Self::new(low, products.into_iter().fold(f64::NEG_INFINITY, f64::max))
    }

    /// The same with a factor.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        self.times(Self::point(factor))
    }

    /// What lies in both. Both hold the truth, so they overlap but for rounding; where they do
    /// not, the touching ends are kept.
    pub(crate) fn intersect(self, other: Self) -> Self {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        Self::new(low.min(high), high.max(low))
    }

    /// Largest absolute value.
    pub(crate) fn size(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// Smallest absolute value.
    pub(crate) fn nearest_zero(self) -> f64 {
        if self.low <= 0.0 && self.high >= 0.0 {
            0.0
        } else {
            self.low.abs().min(self.high.abs())
        }
    }
}

/// Bounds of |∂²h/∂x²|, |∂²h/∂x∂z|, |∂²h/∂z²|.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SecondOrder {
    pub xx: f64,
    pub xz: f64,
    pub zz: f64,
}

impl SecondOrder {
    /// ½ dᵀMd, the most that h differs from its tangent plane within ±half of the centre.
    pub(crate) fn rest(self, half: DVec2) -> f64 {
        0.5 * (self.xx * half.x * half.x + self.zz * half.y * half.y) + self.xz * half.x * half.y
    }

    /// The most that each component of the gradient differs from that at the centre.
    pub(crate) fn turn(self, half: DVec2) -> DVec2 {
        DVec2::new(
            self.xx * half.x + self.xz * half.y,
            self.xz * half.x + self.zz * half.y,
        )
    }

    /// Bounds within ±half of a place with this height and gradient.
    pub(crate) fn bounds(self, height: f64, gradient: DVec2, half: DVec2) -> CellBounds {
        let reach = gradient.abs().dot(half) + self.rest(half);
        CellBounds {
            height: Interval::around(height, reach),
            slope: (gradient.abs() + self.turn(half)).length(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_take_every_sign() {
        let ends = [-3.0, -1.0, 0.0, 0.5, 2.0];
        for (i, &a) in ends.iter().enumerate() {
            for &b in &ends[i..] {
                for (j, &c) in ends.iter().enumerate() {
                    for &d in &ends[j..] {
                        let product = Interval::new(a, b).times(Interval::new(c, d));
                        for k in 0..=4 {
                            let x = a + (b - a) * f64::from(k) / 4.0;
                            let y = c + (d - c) * f64::from(4 - k) / 4.0;
                            assert!(product.low <= x * y && x * y <= product.high);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn taylor_holds_for_a_paraboloid() {
        // h = 3x² + xz − 2z² about (1, 2): value −3, gradient (8, −7), second derivatives 6, 1, −4.
        let h = |x: f64, z: f64| 3.0 * x * x + x * z - 2.0 * z * z;
        let second = SecondOrder {
            xx: 6.0,
            xz: 1.0,
            zz: 4.0,
        };
        let half = DVec2::new(0.5, 0.25);
        let bounds = second.bounds(h(1.0, 2.0), DVec2::new(8.0, -7.0), half);
        for i in 0..=20 {
            for j in 0..=20 {
                let x = 1.0 + half.x * (f64::from(i) / 10.0 - 1.0);
                let z = 2.0 + half.y * (f64::from(j) / 10.0 - 1.0);
                let slope = DVec2::new(6.0 * x + z, x - 4.0 * z).length();
                assert!((bounds.height.low..=bounds.height.high).contains(&h(x, z)));
                assert!(slope <= bounds.slope);
            }
        }
    }
}
