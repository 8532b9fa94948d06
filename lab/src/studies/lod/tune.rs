//! Turns a method's knob until its largest error is the wanted one.

use super::baseline::Baseline;
use super::measure::{Measured, measure};
use crate::scenes::camera::Camera;
use crate::scenes::places::Places;
use crate::scenes::truth::Truth;
use std::time::{Duration, Instant};
use thiserror::Error;

/// A method at the wanted error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tuned {
    /// Where its knob stands.
    pub knob: f64,
    /// Vertices of triangles that may be seen.
    pub vertices: u64,
    /// Triangles that may be seen.
    pub triangles: u64,
    /// Errors at the places that it was tuned on.
    pub measured: Measured,
    /// Errors at other places: by how much the first may have missed the largest.
    pub fresh: Measured,
    /// Time of drawing once on the CPU, in f64: to tell whether a run is worth waiting for, no more.
    pub draw: Duration,
    /// How often it was drawn.
    pub draws: u32,
}

/// Why a method has no knob for an error.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum TuneError {
    /// Nothing is seen.
    #[error("none of the places is seen by the camera")]
    NothingSeen,
    /// Too much to draw.
    #[error(
        "at {knob} it draws more triangles than are kept and errs by {last_error} pixels before"
    )]
    TooMany {
        /// Where the knob stood.
        knob: f64,
        /// The error at the finest knob that could be drawn, pixels.
        last_error: f64,
    },
    /// The end of the knob.
    #[error("at its finest it still errs by {error} pixels")]
    Finest {
        /// The error there, pixels.
        error: f64,
    },
}

/// The largest error may be this share below the wanted one.
pub const CLOSE: f64 = 0.02;
/// Draws after which the coarsest knob that keeps to the error is taken as it is; a maximum over
/// samples jumps, and may have no knob within [`CLOSE`].
const MOST_DRAWS: u32 = 28;

/// Where a method may draw no more, its error is known to within this step of ln(knob): a twentieth.
const LAST_STEP: f64 = 0.05;

/// Finds the knob for which the largest error at `places` is at most `wanted` pixels, and no more
/// than 2 % below if there is such a one. From the coarsest end in steps of what the error asks for,
/// then by false position on logarithms, kept inside the middle four fifths. `fresh` are other places.
///
/// # Errors
/// [`TuneError`].
pub fn tune(
    baseline: &dyn Baseline,
    truth: &Truth,
    camera: &Camera,
    (places, fresh): (&Places, &Places),
    wanted: f64,
) -> Result<Tuned, TuneError> {
    let view = camera.view();
    let knob = baseline.knob();
    // ln of the knob, from 0 at the coarsest end to `length` at the finest.
    let length = (knob.finest / knob.coarsest).ln().abs();
    let sign = (knob.finest / knob.coarsest).ln().signum();
    let at = |t: f64| knob.coarsest * (sign * t).exp();
    let mut draws = 0;
    let mut try_at = |t: f64| {
        draws += 1;
        let start = Instant::now();
        let Some(drawn) = baseline.draw(truth, camera, at(t)) else {
            return Ok(None);
        };
        let draw = start.elapsed();
        let measured = measure(truth, &view, &*drawn, places).ok_or(TuneError::NothingSeen)?;
        Ok(Some(Tuned {
            knob: at(t),
            vertices: drawn.vertices(),
            triangles: drawn.triangles(),
            measured,
            fresh: measured,
            draw,
            draws,
        }))
    };
    let close = |tuned: &Tuned| tuned.measured.max >= wanted * (1.0 - CLOSE);
    // Coarser than wanted: (t, error).
    let mut coarse = (0.0, f64::INFINITY);
    let mut t = 0.0;
    // The coarsest knob that draws too much.
    let mut beyond = f64::INFINITY;
    let (mut fine_t, mut fine) = loop {
        if beyond - coarse.0 < LAST_STEP {
            return Err(TuneError::TooMany {
                knob: at(beyond),
                last_error: coarse.1,
            });
        }
        let Some(tuned) = try_at(t)? else {
            beyond = t;
            t = (coarse.0 + beyond) / 2.0;
            continue;
        };
        let error = tuned.measured.max;
        if error <= wanted {
            break (t, tuned);
        }
        if t >= length {
            return Err(TuneError::Finest { error });
        }
        coarse = (t, error);
        // The error falls with the knob's first power at least on rough ground: 0.7 of it.
        let ratio = if error.is_finite() {
            error / wanted
        } else {
            1.6
        };
        t = (t + 0.7 * ratio.ln().clamp(0.2, 3.0)).min(length);
        if t >= beyond {
            t = (coarse.0 + beyond) / 2.0;
        }
    };
    // At its coarsest it may be better than wanted; there is nothing to be gained then.
    while fine_t > 0.0 && !close(&fine) && fine.draws < MOST_DRAWS {
        let (low, high) = (coarse.0, fine_t);
        // A quarter of the tolerance.
        if high - low < CLOSE / 4.0 {
            break;
        }
        let aim = (wanted * (1.0 - CLOSE / 2.0)).ln();
        let (from, to) = (coarse.1.ln(), fine.measured.max.max(1e-9).ln());
        let share = if from.is_finite() && from > to {
            (from - aim) / (from - to)
        } else {
            0.5
        };
        let middle = low + (high - low) * share.clamp(0.1, 0.9);
        match try_at(middle)? {
            Some(tuned) if tuned.measured.max <= wanted => (fine_t, fine) = (middle, tuned),
            Some(tuned) => {
                coarse = (middle, tuned.measured.max);
                fine.draws = tuned.draws;
            }
            None => coarse = (middle, f64::INFINITY),
        }
    }
    if let Some(drawn) = baseline.draw(truth, camera, fine.knob)
        && let Some(fresh) = measure(truth, &view, &*drawn, fresh)
    {
        fine.fresh = fresh;
    }
    Ok(fine)
}

#[cfg(test)]
mod tests {
    use super::super::baseline::AtMost;
    use super::super::uniform::Uniform;
    use super::*;
    use crate::scenes::{cameras, terrains};

    #[test]
    fn the_knob_is_found_for_a_wanted_error() {
        let truth = Truth::new(&terrains::fbm(1));
        let camera = cameras::camera(&truth.terrain, cameras::Kind::Above, 1);
        let view = camera.view();
        let places = Places::new(&truth, &view, 4000, 1);
        let fresh = Places::new(&truth, &view, 4000, 2);
        let tuned = |wanted| tune(&Uniform, &truth, &camera, (&places, &fresh), wanted).unwrap();
        let (coarse, fine) = (tuned(2.0), tuned(1.0));
        for (tuned, wanted) in [(coarse, 2.0), (fine, 1.0)] {
            let max = tuned.measured.max;
            assert!(max <= wanted, "{tuned:?}");
            // Within 2 %, or the error jumps past the wanted one at the next coarser knob.
            let coarser = Uniform.draw(&truth, &camera, tuned.knob * 1.006).unwrap();
            let jumped = measure(&truth, &view, &*coarser, &places).unwrap().max > wanted;
            assert!(max >= wanted * (1.0 - CLOSE) || jumped, "{tuned:?}");
            let drawn = Uniform.draw(&truth, &camera, tuned.knob).unwrap();
            assert_eq!(
                measure(&truth, &view, &*drawn, &places),
                Some(tuned.measured)
            );
            assert!((0.5..2.0).contains(&(tuned.fresh.max / max)));
        }
        assert!(fine.knob < coarse.knob && fine.vertices > coarse.vertices);
        let nothing = Places::default();
        let refused = tune(&Uniform, &truth, &camera, (&nothing, &fresh), 1.0);
        assert_eq!(refused, Err(TuneError::NothingSeen));
        let never = tune(&Uniform, &truth, &camera, (&places, &fresh), 1e-14);
        assert!(matches!(never, Err(TuneError::Finest { .. })), "{never:?}");
        // With as many vertices as it takes, and a few more, it is found; with a few less it is not, and
        // the error that is told is of a knob close to where it ends.
        let enough = |share: f64| {
            let most = (fine.vertices as f64 * share) as u64;
            let limited = AtMost {
                baseline: &Uniform,
                vertices: most,
            };
            tune(&limited, &truth, &camera, (&places, &fresh), 1.0)
        };
        assert!(enough(1.02).unwrap().measured.max <= 1.0);
        let Err(TuneError::TooMany { last_error, .. }) = enough(0.8) else {
            panic!("{:?}", enough(0.8));
        };
        assert!((1.0..1.6).contains(&last_error), "{last_error}");
    }
}
