//! Boxes.

use glam::DVec3;

use super::Ray;

/// A box along the axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    pub low: DVec3,
    pub high: DVec3,
}

impl Bounds {
    pub const EMPTY: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
    };

    pub fn of(points: &[DVec3]) -> Self {
        let mut all = Self::EMPTY;
        for p in points {
            all.low = all.low.min(*p);
            all.high = all.high.max(*p);
        }
        all
    }

    pub fn join(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    pub fn middle(&self) -> DVec3 {
        0.5 * (self.low + self.high)
    }

    /// Half of its surface; 0 if it is empty.
    pub fn half_area(&self) -> f64 {
        let size = (self.high - self.low).max(DVec3::ZERO);
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    /// Where a ray enters it, if it does between `near` and `far`.
    ///
    /// The far end is widened by 1 + 2γ₃, γ₃ = 3 · 2⁻⁵³ / (1 − 3 · 2⁻⁵³), which covers the rounding of the three
    /// operations (Ize, "Robust BVH ray traversal", JCGT 2013).
    pub fn enter(&self, ray: &Ray, near: f64, far: f64) -> Option<f64> {
        const WIDER: f64 = 1.0 + 6.0 * f64::EPSILON;
        let a = (self.low - ray.origin) * ray.inverse;
        let b = (self.high - ray.origin) * ray.inverse;
        let (mut enter, mut leave) = (near, far);
        for axis in 0..3 {
            // A ray within a face that it is parallel to gives 0 · ∞: this axis says nothing.
            if a[axis].is_nan() || b[axis].is_nan() {
                continue;
            }
            enter = a[axis].min(b[axis]).max(enter);
            leave = (a[axis].max(b[axis]) * WIDER).min(leave);
        }
        (enter <= leave).then_some(enter)
    }
}
