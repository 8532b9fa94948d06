//! How many vertices a view asks for, by tolerance.

use bevy::math::ops;
use thiserror::Error;

/// Vertices over the error tolerance τ, for one view: log-spaced counts, joined by straight lines in
/// log count over log τ (power laws are exact).
///
/// A selection by error is nested: with a coarser tolerance a vertex may go, none comes. So the curve is
/// the histogram of the vertices' greatest projected errors, summed from the coarse end, and it never
/// rises.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkCurve {
    /// ln τ of the first point.
    first: f32,
    /// Points per unit of ln τ.
    density: f32,
    /// ln of the counts.
    logs: [f32; Self::POINTS],
}

/// A work curve that cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum WorkCurveError {
    /// The tolerances at the ends.
    #[error(
        "tolerances from {least} px to {greatest} px: both must be finite, 0 < least < greatest"
    )]
    Range {
        /// Finest, pixels.
        least: f32,
        /// Coarsest, pixels.
        greatest: f32,
    },
    /// A count that is none.
    #[error("count {index} is {count}, but it must be finite and not below 0")]
    Count {
        /// Which, from the finest tolerance on.
        index: usize,
        /// What it was.
        count: f32,
    },
}

impl WorkCurve {
    /// Points of a curve: over five octaves of τ, six an octave.
    pub const POINTS: usize = 33;

    /// The tolerances at which a curve from `least` to `greatest` (pixels) counts, finest first.
    ///
    /// # Errors
    /// [`WorkCurveError::Range`].
    pub fn tolerances(least: f32, greatest: f32) -> Result<[f32; Self::POINTS], WorkCurveError> {
        if !(least > 0.0 && least < greatest && greatest.is_finite()) {
            return Err(WorkCurveError::Range { least, greatest });
        }
        let (first, last) = (ops::ln(least), ops::ln(greatest));
        let step = (last - first) / (Self::POINTS - 1) as f32;
        let mut all = core::array::from_fn(|i| ops::exp(first + step * i as f32));
        (all[0], all[Self::POINTS - 1]) = (least, greatest);
        Ok(all)
    }

    /// A curve of counts at the [`tolerances`](Self::tolerances). A count below 1 is taken as 1; one that
    /// is above that of a finer tolerance raises the finer one's, since what a coarse tolerance asks for
    /// a fine one does too.
    ///
    /// # Errors
    /// [`WorkCurveError`].
    pub fn new(
        least: f32,
        greatest: f32,
        counts: [f32; Self::POINTS],
    ) -> Result<Self, WorkCurveError> {
        let wrong = |count: &f32| !(count.is_finite() && *count >= 0.0);
        if let Some(index) = counts.iter().position(wrong) {
            let count = counts[index];
            return Err(WorkCurveError::Count { index, count });
        }
        Self::tolerances(least, greatest)?;
        let (first, last) = (ops::ln(least), ops::ln(greatest));
        let mut logs = counts.map(|count| ops::ln(count.max(1.0)));
        for i in (0..Self::POINTS - 1).rev() {
            logs[i] = logs[i].max(logs[i + 1]);
        }
        Ok(Self {
            first,
            density: (Self::POINTS - 1) as f32 / (last - first),
            logs,
        })
    }

    /// The curve of a list of vertices, each by the greatest tolerance that still asks for it (its
    /// saturated projected error), pixels. A NaN counts as asked for by every tolerance: what is not
    /// known is drawn. O(n log points), no allocation.
    ///
    /// # Errors
    /// [`WorkCurveError::Range`].
    pub fn of_errors(
        least: f32,
        greatest: f32,
        errors: impl IntoIterator<Item = f32>,
    ) -> Result<Self, WorkCurveError> {
        let tolerances = Self::tolerances(least, greatest)?;
        let mut bins = [0_u32; Self::POINTS + 1];
        for error in errors {
            // How many tolerances the error exceeds.
            let below = if error.is_nan() {
                Self::POINTS
            } else {
                tolerances.partition_point(|tau| *tau < error)
            };
            bins[below] = bins[below].saturating_add(1);
        }
        let mut counts = [0.0; Self::POINTS];
        let mut sum = 0_u64;
        for i in (0..Self::POINTS).rev() {
            sum += u64::from(bins[i + 1]);
            counts[i] = sum as f32;
        }
        Self::new(least, greatest, counts)
    }

    /// Vertices that `tau` (pixels) asks for; beyond the ends, and for a NaN, those of the nearest end
    /// (of the finest).
    #[must_use]
    pub fn at(&self, tau: f32) -> f32 {
        let last = (Self::POINTS - 1) as f32;
        let place = ((ops::ln(tau.max(f32::MIN_POSITIVE)) - self.first) * self.density)
            .max(0.0)
            .min(last);
        let below = (place as usize).min(Self::POINTS - 2);
        let part = place - below as f32;
        let (a, b) = (self.logs[below], self.logs[below + 1]);
        ops::exp(a + (b - a) * part)
    }

    /// What stands in where no curve is known: work 1/τ, in any unit.
    pub(super) fn inverse(tau: f32) -> f32 {
        1.0 / tau.max(f32::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_is_kept_between_the_points() {
        let law = |tau: f32| 2.0e5 * ops::powf(tau, -1.3);
        let counts = WorkCurve::tolerances(0.25, 16.0).unwrap().map(law);
        let curve = WorkCurve::new(0.25, 16.0, counts).unwrap();
        for k in 0..100 {
            let tau = 0.25 * ops::powf(64.0, k as f32 / 99.0);
            // ln of 1e6 is 14: f32 keeps it to 1e-6, and so the count to 1e-5.
            assert!((curve.at(tau) / law(tau) - 1.0).abs() < 1e-5, "{tau}");
        }
        assert_eq!(curve.at(0.01), curve.at(0.25));
        assert_eq!(curve.at(1e9), curve.at(16.0));
        assert_eq!(curve.at(f32::NAN), curve.at(0.25));
    }

    #[test]
    fn errors_are_counted_as_a_loop_over_all_counts_them() {
        let errors: Vec<f32> = (0..5000)
            .map(|i| 0.1 * ops::powf(1.002, i as f32))
            .collect();
        let curve = WorkCurve::of_errors(0.5, 16.0, errors.iter().copied()).unwrap();
        for tau in WorkCurve::tolerances(0.5, 16.0).unwrap() {
            let count = errors.iter().filter(|error| **error > tau).count() as f32;
            assert!((curve.at(tau) / count.max(1.0) - 1.0).abs() < 1e-4, "{tau}");
        }
        let unknown = WorkCurve::of_errors(0.5, 16.0, [f32::NAN; 7]).unwrap();
        assert!((unknown.at(16.0) - 7.0).abs() < 1e-4);
        let none = WorkCurve::of_errors(0.5, 16.0, []).unwrap();
        assert_eq!(none.at(1.0), 1.0);
    }

    #[test]
    fn what_is_no_curve_is_refused() {
        let flat = [1.0; WorkCurve::POINTS];
        for (least, greatest) in [
            (0.0, 1.0),
            (2.0, 1.0),
            (1.0, f32::INFINITY),
            (f32::NAN, 1.0),
        ] {
            let refusal = WorkCurve::new(least, greatest, flat).unwrap_err();
            assert!(matches!(refusal, WorkCurveError::Range { .. }));
        }
        for wrong in [-1.0, f32::NAN, f32::INFINITY] {
            let mut counts = flat;
            counts[5] = wrong;
            let refusal = WorkCurve::new(0.5, 16.0, counts).unwrap_err();
            assert!(matches!(refusal, WorkCurveError::Count { index: 5, .. }));
        }
        let mut rising = flat;
        rising[10] = 50.0;
        let curve = WorkCurve::new(0.5, 16.0, rising).unwrap();
        assert!((curve.at(0.5) - 50.0).abs() < 1e-4, "never rises");
    }
}
