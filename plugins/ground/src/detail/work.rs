//! What a view asks for at every tolerance, as the choice on the GPU counts it: the work curve of its budget.
//!
//! Every vertex that may appear has an *error ratio*: its error over the tolerance that was asked for. A tolerance that
//! is coarser by a factor asks for the vertices whose ratio is above that factor, so the histogram of the ratios is the
//! curve. It comes back two or three frames after its view was chosen. Tolerances finer than the one that was asked for
//! have no ratio: there the curve goes on as steeply as it comes.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use bevy::math::ops;
use bevy::prelude::*;
use dolomite_geometry::budget::{Budget, ViewWork, WorkCurve, WorkCurveError};

/// Counts of vertices by their error ratio.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorCounts {
    /// The tolerance of which the ratios are multiples, pixels.
    pub tolerance: f32,
    /// Vertices that are there whatever the tolerance.
    pub always: f32,
    /// Vertices in each step, the first from a ratio on at which a vertex appears.
    pub counts: Vec<f32>,
    /// Steps in an octave of the ratio.
    pub steps_an_octave: f32,
}

/// Exponents that are believed of a curve at its fine end: vertices go with the inverse of the tolerance where errors
/// are of curvature, with less where cells end, and with its square where ground is rough to the last.
const EXPONENTS: [f32; 2] = [0.25, 2.0];

impl ErrorCounts {
    /// Vertices that a tolerance of `ratio` times the own one asks for; `ratio` at least 1. Counts within a step are
    /// taken as spread over it evenly.
    fn above(&self, ratio: f32) -> f32 {
        let place =
            (ops::log2(ratio.max(1.0)) * self.steps_an_octave).min(self.counts.len() as f32);
        let step = place as usize;
        let rest: f32 = self.counts.iter().skip(step + 1).sum();
        let part = self
            .counts
            .get(step)
            .map_or(0.0, |count| count * (1.0 - place.fract()));
        self.always + part + rest
    }

    /// By which power of the tolerance the work falls at the own one, from there to its double.
    fn exponent(&self) -> f32 {
        let [least, most] = EXPONENTS;
        let (here, there) = (self.above(1.0), self.above(2.0));
        if here > 0.0 && there > 0.0 {
            ops::log2(here / there).clamp(least, most)
        } else {
            1.0
        }
    }

    /// The curve between two tolerances, pixels.
    ///
    /// # Errors
    /// [`WorkCurveError`]: ends that are none, or counts that are not finite.
    pub fn curve(&self, least: f32, greatest: f32) -> Result<WorkCurve, WorkCurveError> {
        let exponent = self.exponent();
        let counts = WorkCurve::tolerances(least, greatest)?.map(|tolerance| {
            let ratio = tolerance / self.tolerance;
            if ratio >= 1.0 {
                self.above(ratio)
            } else {
                self.above(1.0) * ops::powf(1.0 / ratio, exponent)
            }
        });
        WorkCurve::new(least, greatest, counts)
    }
}

/// The newest counts of each camera with a [`Budget`]; whoever chooses ground writes them, from either world.
#[derive(Resource, Clone, Default)]
pub struct GroundWork(Arc<Mutex<HashMap<Entity, ErrorCounts>>>);

impl GroundWork {
    /// Takes over what was counted for a camera (an entity of the main world).
    pub fn set(&self, camera: Entity, counts: ErrorCounts) {
        self.with(|all| all.insert(camera, counts));
    }

    /// Forgets the cameras that are not among these.
    pub fn keep(&self, is_kept: impl Fn(Entity) -> bool) {
        self.with(|all| all.retain(|camera, _| is_kept(*camera)));
    }

    /// The newest counts of a camera.
    #[must_use]
    pub fn of(&self, camera: Entity) -> Option<ErrorCounts> {
        self.with(|all| all.get(&camera).cloned())
    }

    fn with<T>(&self, f: impl FnOnce(&mut HashMap<Entity, ErrorCounts>) -> T) -> T {
        // Plain numbers: a panic elsewhere cannot leave them half-written.
        f(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Gives each camera with a budget the curve of its view, where there is one.
pub(super) fn supply(
    mut commands: Commands,
    work: Res<GroundWork>,
    mut cameras: Query<(Entity, &Budget, Option<&mut ViewWork>)>,
) {
    work.keep(|camera| cameras.contains(camera));
    for (camera, budget, known) in &mut cameras {
        let Some(counts) = work.of(camera) else {
            continue;
        };
        // A budget that is refused has no ends; one tolerance alone has no curve.
        let curve = counts.curve(budget.least, budget.greatest).ok();
        match known {
            Some(mut known) => {
                known.set_if_neq(ViewWork(curve));
            }
            None => {
                commands.entity(camera).insert(ViewWork(curve));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vertices of a power law, by error ratio.
    fn law(exponent: f32) -> ErrorCounts {
        let above = |step: usize| 1e5 * ops::powf(ops::exp2(step as f32 / 8.0), -exponent);
        ErrorCounts {
            tolerance: 2.0,
            always: 0.0,
            counts: (0..256).map(|step| above(step) - above(step + 1)).collect(),
            steps_an_octave: 8.0,
        }
    }

    #[test]
    fn a_power_law_is_found_on_both_sides_of_its_tolerance() {
        for exponent in [0.5, 1.0, 1.7] {
            let curve = law(exponent).curve(0.5, 16.0).unwrap();
            for tolerance in [0.5, 1.0, 2.0, 4.0, 8.0, 15.0] {
                let wanted = 1e5 * ops::powf(tolerance / 2.0, -exponent);
                // Counts of a step of an eighth of an octave are taken as even.
                let off = curve.at(tolerance) / wanted;
                assert!(
                    (off - 1.0).abs() < 0.01,
                    "{exponent}, {tolerance} px: {off}"
                );
            }
        }
    }

    #[test]
    fn what_is_always_there_stays_and_nothing_is_no_curve_of_zero() {
        let mut counts = law(1.0);
        counts.always = 500.0;
        let curve = counts.curve(0.5, 1024.0).unwrap();
        assert!((curve.at(1024.0) / (500.0 + 1e5 / 512.0) - 1.0).abs() < 0.02);
        counts.counts.fill(0.0);
        counts.always = 0.0;
        assert_eq!(counts.curve(0.5, 16.0).unwrap().at(1.0), 1.0);
        assert!(counts.curve(0.0, 16.0).is_err());
        counts.counts[3] = f32::NAN;
        assert!(counts.curve(0.5, 16.0).is_err());
    }
}
