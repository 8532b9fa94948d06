//! One method at one setting: its errors, its time, its hash, as rows of the table.

use super::method::{Method, Output, WAVELENGTH};
use super::points::Points;
use crate::csv::{ErrorNumbers, Row};
use bevy::math::DVec2;
use dolomite_testkit::metrics::{ErrorStats, Hash64, median};

/// Errors of values are in this unit.
pub const VALUE_UNIT: &str = "amplitude of the first octave";
/// Errors of gradients are in this unit: both axes together, as a length.
pub const GRADIENT_UNIT: &str = "amplitude / wavelength of the first octave";

/// Where a measurement stands in the sweeps.
#[derive(Debug, Clone)]
pub struct Place {
    /// Which sweep.
    pub sweep: String,
    /// Name of its knob.
    pub knob: &'static str,
    /// Where it stands.
    pub setting: f64,
}

/// What a method's results come to beside its definition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// In [`VALUE_UNIT`]; `None` where the method has no definition but itself.
    pub value: Option<ErrorStats>,
    /// In [`GRADIENT_UNIT`]; `None` where the method or its definition has no gradient.
    pub gradient: Option<ErrorStats>,
    /// Of all results.
    pub hash: u64,
}

/// Errors of results that lie in `out`.
pub fn errors(method: &dyn Method, points: &Points, with_gradient: bool, out: &Output) -> Errors {
    let amplitude = method.amplitude();
    let mut hash = Hash64::default();
    let (mut values, mut gradients) = (Vec::new(), Vec::new());
    for (i, at) in points.exact.iter().enumerate() {
        let value = if method.is_f64() {
            hash.add(out.values_f64[i].to_bits());
            out.values_f64[i]
        } else {
            hash.add(u64::from(out.values[i].to_bits()));
            f64::from(out.values[i])
        };
        if with_gradient {
            hash.add(u64::from(out.dx[i].to_bits()));
            hash.add(u64::from(out.dz[i].to_bits()));
        }
        let Some(exact) = method.definition(*at) else {
            continue;
        };
        values.push((value - exact.value) / amplitude);
        if let (true, Some(gradient)) = (with_gradient, exact.gradient) {
            let found = DVec2::new(f64::from(out.dx[i]), f64::from(out.dz[i]));
            let error = (found - gradient).length();
            gradients.push(error * WAVELENGTH / amplitude);
        }
    }
    Errors {
        value: ErrorStats::of(values),
        gradient: ErrorStats::of(gradients),
        hash: hash.finish(),
    }
}

/// One method with or without gradients, and what is known of it so far.
struct Job {
    method: usize,
    with_gradient: bool,
    errors: Errors,
    times: Vec<f64>,
}

/// Runs the methods that take them over `points` and gives their rows: one for values alone and,
/// where a method has them, one for gradients.
///
/// Times (of the first row values alone, of the second values and gradients together) are taken if
/// `repeats` is not 0. The methods take turns, so that whatever else the machine does in the
/// meantime slows all of them.
pub fn rows(
    methods: &mut [Box<dyn Method>],
    points: &Points,
    place: &Place,
    repeats: usize,
) -> Vec<Row> {
    let mut jobs = Vec::new();
    for (index, method) in methods
        .iter_mut()
        .enumerate()
        .filter(|(_, m)| m.takes(points))
    {
        let kinds = if method.has_gradient() {
            &[false, true][..]
        } else {
            &[false]
        };
        for &with_gradient in kinds {
            let mut out = Output::new(points.len());
            method.evaluate(points, with_gradient, &mut out);
            let errors = errors(method.as_ref(), points, with_gradient, &out);
            jobs.push(Job {
                method: index,
                with_gradient,
                errors,
                times: Vec::new(),
            });
        }
    }
    let mut out = Output::new(points.len());
    for _ in 0..repeats {
        for job in &mut jobs {
            let method = &mut methods[job.method];
            let seconds = method.seconds(points, job.with_gradient, &mut out);
            job.times.push(seconds * 1e9 / points.len() as f64);
        }
    }
    jobs.into_iter()
        .map(|job| row(job, methods, place))
        .collect()
}

fn row(job: Job, methods: &[Box<dyn Method>], place: &Place) -> Row {
    let method = &methods[job.method];
    let (quantity, error, unit) = if job.with_gradient {
        ("gradient", job.errors.gradient, GRADIENT_UNIT)
    } else {
        ("value", job.errors.value, VALUE_UNIT)
    };
    Row {
        sweep: place.sweep.clone(),
        method: method.name().to_owned(),
        parameter: format!("{}={}", place.knob, place.setting),
        parameter_value: place.setting,
        quantity: quantity.to_owned(),
        error: error.map(ErrorNumbers::from),
        error_unit: unit.to_owned(),
        time_ns: median(job.times),
        bytes: Some(method.bytes()),
        vertices: None,
        hash: Some(job.errors.hash),
        device: method.device(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::method::Exact;
    use super::*;

    /// The plane value = x / 4, and what is done to it.
    struct Plane {
        value_off: f32,
        gradient_off: f32,
        writes: bool,
    }

    impl Method for Plane {
        fn name(&self) -> &'static str {
            "plane"
        }
        fn bytes(&self) -> usize {
            0
        }
        fn amplitude(&self) -> f64 {
            2.0
        }
        fn has_gradient(&self) -> bool {
            true
        }
        fn evaluate(&mut self, points: &Points, with_gradient: bool, out: &mut Output) {
            if !self.writes {
                return;
            }
            for (i, p) in points.exact.iter().enumerate() {
                out.values[i] = (p.x / 4.0) as f32 + self.value_off;
                if with_gradient {
                    out.dx[i] = 0.25;
                    out.dz[i] = self.gradient_off;
                }
            }
        }
        fn definition(&self, at: DVec2) -> Option<Exact> {
            Some(Exact {
                value: at.x / 4.0,
                gradient: Some(DVec2::new(0.25, 0.0)),
            })
        }
    }

    fn errors_of(mut plane: Plane) -> Errors {
        // Multiples of 1 m: the plane is exact in f32.
        let points = Points::tile(400, 1.0, 1);
        let mut out = Output::new(points.len());
        plane.evaluate(&points, true, &mut out);
        errors(&plane, &points, true, &out)
    }

    #[test]
    fn a_right_answer_has_an_error_of_one_rounding() {
        let right = errors_of(Plane {
            value_off: 0.0,
            gradient_off: 0.0,
            writes: true,
        });
        // Values up to 256 are rounded to half of 2^-16, and count relative to an amplitude of 2.
        assert!(right.value.unwrap().max <= 256.0 * 6e-8 / 2.0);
        assert_eq!(right.gradient.unwrap().max, 0.0);
    }

    /// The comparison can fail: wrong answers of each kind are seen, by as much as they are wrong.
    #[test]
    fn a_wrong_answer_is_seen() {
        let value = errors_of(Plane {
            value_off: 0.01,
            gradient_off: 0.0,
            writes: true,
        });
        assert!((value.value.unwrap().rms - 0.005).abs() < 1e-4, "{value:?}");
        let gradient = errors_of(Plane {
            value_off: 0.0,
            gradient_off: 0.01,
            writes: true,
        });
        let expected = 0.01 * WAVELENGTH / 2.0;
        assert!(
            (gradient.gradient.unwrap().max - expected).abs() < 1e-4,
            "{gradient:?}"
        );
        assert_ne!(value.hash, gradient.hash);
    }

    #[test]
    fn results_that_are_not_written_are_infinitely_wrong() {
        let nothing = errors_of(Plane {
            value_off: 0.0,
            gradient_off: 0.0,
            writes: false,
        });
        assert_eq!(nothing.value.unwrap().rms, f64::INFINITY);
        assert_eq!(nothing.gradient.unwrap().rms, f64::INFINITY);
    }

    #[test]
    fn rows_say_what_was_measured() {
        let plane = Plane {
            value_off: 0.0,
            gradient_off: 0.0,
            writes: true,
        };
        let place = Place {
            sweep: "distance".into(),
            knob: "distance_m",
            setting: 10.0,
        };
        let points = Points::tile(400, 1.0, 1);
        let mut methods: [Box<dyn Method>; 1] = [Box::new(plane)];
        let untimed = rows(&mut methods, &points, &place, 0);
        let quantities: Vec<&str> = untimed.iter().map(|row| row.quantity.as_str()).collect();
        assert_eq!(quantities, ["value", "gradient"]);
        assert!(
            untimed
                .iter()
                .all(|row| row.time_ns.is_none() && row.error.is_some())
        );
        assert_eq!(untimed[0].parameter, "distance_m=10");
        let timed = rows(&mut methods, &points, &place, 3);
        assert!(
            timed
                .iter()
                .all(|row| row.time_ns.is_some_and(|ns| ns > 0.0))
        );
    }
}
