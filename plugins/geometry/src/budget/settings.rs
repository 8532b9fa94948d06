//! What is asked of a budget, and what it says.

use bevy::prelude::*;
use thiserror::Error;

/// Holds the camera's measured time at so many milliseconds, by a producer's error tolerance.
///
/// Where the time comes from is said by the [`FrameTime`](super::FrameTime) beside it, without which nothing is
/// measured unless the app does; the tolerance reached stands in its [`BudgetReport`], and moves what somebody
/// takes it over for. Until a time has come the tolerance stays what it was. Numbers that make no sense are refused by a
/// [`BudgetError`], which the report carries; nothing is clamped silently, and the tolerance stays
/// where it was.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
#[require(BudgetReport, super::FrameTime, super::TimeSamples)]
pub struct Budget {
    /// Time that 99 frames in 100 shall keep to, milliseconds; above 0 and finite. Default 4.
    pub milliseconds: f32,
    /// The finest tolerance, pixels; above 0 and finite. Default 0.5.
    pub least: f32,
    /// The coarsest tolerance, pixels; finite, at least `least`. Where it does not suffice, the budget is
    /// not met, and the report says so. Default 16.
    pub greatest: f32,
}

impl Default for Budget {
    fn default() -> Self {
        Self {
            milliseconds: 4.0,
            least: 0.5,
            greatest: 16.0,
        }
    }
}

/// A budget with a number that cannot be used.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Error)]
pub enum BudgetError {
    /// The time.
    #[error("a budget of {0} ms: it must be finite and above 0")]
    Milliseconds(f32),
    /// The finest tolerance.
    #[error("a finest tolerance of {0} px: it must be finite and above 0")]
    Least(f32),
    /// The coarsest tolerance.
    #[error(
        "a coarsest tolerance of {greatest} px: it must be finite and at least the finest, {least} px"
    )]
    Greatest {
        /// What it was, pixels.
        greatest: f32,
        /// The finest, pixels.
        least: f32,
    },
}

impl Budget {
    /// Whether all three numbers can be used.
    ///
    /// # Errors
    /// [`BudgetError`], with the number.
    pub fn check(&self) -> Result<(), BudgetError> {
        let usable = |x: f32| x.is_finite() && x > 0.0;
        if !usable(self.milliseconds) {
            return Err(BudgetError::Milliseconds(self.milliseconds));
        }
        if !usable(self.least) {
            return Err(BudgetError::Least(self.least));
        }
        if !(self.greatest.is_finite() && self.greatest >= self.least) {
            return Err(BudgetError::Greatest {
                greatest: self.greatest,
                least: self.least,
            });
        }
        Ok(())
    }
}

/// The end of the range at which a tolerance stands.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub enum BudgetLimit {
    /// The finest: there is time to spare.
    Least,
    /// The coarsest: it may be that the budget cannot be met.
    Greatest,
}

/// What a [`Budget`] has come to; written each frame.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct BudgetReport {
    /// Number of the frame that this is said of; a time measured of it carries the number back.
    pub frame: u64,
    /// The tolerance to draw this frame with, pixels; 0 as long as no time has come: then there is nothing to
    /// take over.
    pub tau: f32,
    /// Whether this frame is expected within the budget; false before the first measurement.
    pub held: bool,
    /// The end of its range at which the tolerance stands, if it does.
    pub limit: Option<BudgetLimit>,
    /// Time expected of this frame, milliseconds; 0 before the first measurement.
    pub expected: f32,
    /// Standard deviation of measured times, as a part of the time.
    pub noise: f32,
    /// Measurements passed over as lone outliers so far.
    pub outliers: u32,
    /// Changes of load found in the measurements so far.
    pub load_changes: u32,
    /// Why the budget was refused, if it was.
    pub fault: Option<BudgetError>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_without_sense_are_refused() {
        assert_eq!(Budget::default().check(), Ok(()));
        for wrong in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let budget = Budget {
                milliseconds: wrong,
                ..Budget::default()
            };
            let refusal = budget.check().unwrap_err();
            assert!(matches!(refusal, BudgetError::Milliseconds(_)), "{wrong}");
            assert!(refusal.to_string().contains(&wrong.to_string()));
            let budget = Budget {
                least: wrong,
                ..Budget::default()
            };
            assert!(matches!(budget.check(), Err(BudgetError::Least(_))));
            let budget = Budget {
                greatest: wrong,
                ..Budget::default()
            };
            assert!(matches!(budget.check(), Err(BudgetError::Greatest { .. })));
        }
        let crossed = Budget {
            least: 2.0,
            greatest: 1.0,
            ..Budget::default()
        };
        assert!(crossed.check().is_err());
    }
}
