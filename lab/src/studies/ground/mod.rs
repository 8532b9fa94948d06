//! Study `ground`: answers of the drawn ground, their time, their age and their errors.

#![expect(
    clippy::disallowed_methods,
    reason = "f64 measurements: the last bit of where a place lies decides nothing"
)]

pub mod frames;
pub mod measure;

use crate::csv::{ErrorNumbers, Row};
use crate::plot::{Axes, Chart, Curve};
use crate::scenes::cameras::{Kind, camera};
use crate::scenes::selection::ground_of;
use crate::study::{Figure, Options, Report, Study};
use bevy::math::DVec2;
use dolomite_ground::detail::Metric;
use dolomite_testkit::blocks::{BlockError, BlockStage};
use dolomite_testkit::gpu::Gpu;
use dolomite_testkit::metrics::ErrorStats;
use frames::{Ages, FRAMES, fly};
use measure::{BUDGET, Checked, MOST, SLOTS, Verdict, check, ground, params, places};
use serde_json::{Value, json};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "ground",
    about: "answers of the drawn ground: time, age in frames, error against triangle and true surface",
    run,
    asked: &[],
};

/// Queries of a frame.
const QUERIES: [usize; 4] = [100, 1000, 10_000, 100_000];
/// Distances of the ground from the origin, along both axes, metres.
const FAR: [f64; 2] = [0.0, 1e6];
/// The tolerance of the views, pixels of 1080 rows.
const TAU: f32 = 4.0;
/// Side of the finest cell, metres.
const FINEST: f32 = 0.125;

/// One view that was asked so many times.
struct Case {
    far: f64,
    kind: Kind,
    queries: usize,
    /// Median, milliseconds from submit to done.
    ms: f64,
    verdict: Verdict,
    triangles: usize,
    /// By how much the tolerance was raised so that all fits.
    coarsening: f32,
}

fn cases(options: &Options, gpu: &Gpu) -> Result<Vec<Case>, BlockError> {
    let mut cases = Vec::new();
    for far in FAR {
        let terrain = ground(options.seed, DVec2::splat(far));
        let on_lattice = ground_of(&terrain, FINEST);
        let mut stage = BlockStage::new(gpu, &on_lattice, SLOTS)?;
        for kind in [Kind::Standing, Kind::Flying] {
            let camera = camera(&terrain, kind, options.seed);
            let told = params(&on_lattice, &camera, Metric::ErrorBound { pixels: TAU });
            let (run, _) = stage.settle_in_room(told, BUDGET, MOST)?;
            for queries in QUERIES {
                let places = places(&terrain, &camera, queries, options.seed);
                let (answers, times) = stage.timed_answers(&places, options.repeats)?;
                let verdict = check(&terrain, &camera, (&told, &run), &places, &answers);
                let ms = times[times.len() / 2].as_secs_f64() * 1e3;
                eprintln!("{}: {far} m, {kind:?}, {queries}: {ms:.3} ms", STUDY.name);
                cases.push(Case {
                    far,
                    kind,
                    queries,
                    ms,
                    verdict,
                    triangles: run.triangles.len(),
                    coarsening: run.coarsening,
                });
            }
        }
    }
    Ok(cases)
}

fn flights(options: &Options, gpu: &Gpu) -> Result<Vec<(usize, usize, Ages)>, BlockError> {
    let terrain = ground(options.seed, DVec2::ZERO);
    let eye = camera(&terrain, Kind::Flying, options.seed);
    let mut flights = Vec::new();
    for queries in QUERIES {
        for in_flight in [0, 1] {
            let ages = fly(
                gpu,
                &terrain,
                eye,
                FRAMES,
                (queries, in_flight, options.seed),
            )?;
            flights.push((queries, in_flight, ages));
        }
    }
    Ok(flights)
}

fn stats(checked: &[Checked], pick: impl Fn(&Checked) -> f64) -> Option<ErrorStats> {
    ErrorStats::of(checked.iter().map(pick))
}

fn rows(case: &Case, device: &str) -> Vec<Row> {
    let checked = &case.verdict.checked;
    let of = [
        (
            "from the drawn triangle",
            stats(checked, |c| c.from_drawn),
            "m",
        ),
        ("slope", stats(checked, |c| c.slope), "rise over run"),
        (
            "from the true surface",
            stats(checked, |c| c.from_truth),
            "m",
        ),
        ("bound", stats(checked, |c| c.bound), "m"),
        (
            "from the true surface / bound",
            stats(checked, |c| c.from_truth / c.bound),
            "1",
        ),
    ];
    of.into_iter()
        .map(|(quantity, error, unit)| Row {
            sweep: format!("{} m from the origin", case.far),
            method: format!("{:?}", case.kind),
            parameter: format!("queries={}", case.queries),
            parameter_value: case.queries as f64,
            quantity: quantity.into(),
            error: error.map(ErrorNumbers::from),
            error_unit: unit.into(),
            time_ns: Some(case.ms * 1e6 / case.queries as f64),
            bytes: None,
            vertices: None,
            hash: None,
            device: device.into(),
        })
        .collect()
}

fn told(case: &Case) -> Value {
    let checked = &case.verdict.checked;
    let max = |pick: fn(&Checked) -> f64| stats(checked, pick).map(|stats| stats.max);
    let above = checked.iter().filter(|c| c.from_truth > c.bound).count();
    json!({
        "metres_from_origin": case.far,
        "view": format!("{:?}", case.kind),
        "triangles": case.triangles,
        "coarsening": case.coarsening,
        "queries": case.queries,
        "ms": case.ms,
        "answered": checked.len(),
        "nothing_drawn": case.verdict.nothing,
        "disagree_on_whether_drawn": case.verdict.wrong,
        "error_drawn_max_m": max(|c| c.from_drawn),
        "error_slope_max": max(|c| c.slope),
        "error_true_max_m": max(|c| c.from_truth),
        "error_true_p99_m": stats(checked, |c| c.from_truth).map(|stats| stats.p99),
        "bound_max_m": max(|c| c.bound),
        "error_true_over_bound_max": max(|c| c.from_truth / c.bound),
        "above_bound": above,
    })
}

fn flown((queries, in_flight, ages): &(usize, usize, Ages)) -> Value {
    json!({
        "queries": queries,
        "frames_under_way": in_flight + 1,
        "frames": FRAMES,
        "answers": ages.ages.len(),
        "age_max": ages.max(),
        "age_mean": ages.mean(),
        "unasked": ages.unasked,
        "cpu_ms": ages.cpu_ms,
    })
}

fn run(options: &Options) -> Report {
    let mut report = Report {
        study: STUDY.name,
        rows: Vec::new(),
        figures: Vec::new(),
        notes: notes(),
        summary: Value::Null,
    };
    let measured = Gpu::new().map_err(BlockError::from).and_then(|gpu| {
        let cases = cases(options, &gpu)?;
        Ok((cases, flights(options, &gpu)?, gpu.name.clone()))
    });
    let (cases, flights, device) = match measured {
        Ok(measured) => measured,
        Err(reason) => {
            report.notes.push(format!("Nothing was measured: {reason}"));
            return report;
        }
    };
    report.rows = cases.iter().flat_map(|case| rows(case, &device)).collect();
    report.figures = figures(&cases, &flights);
    report.summary = json!({
        "device": device,
        "tau_px": TAU,
        "finest_m": FINEST,
        "answers": cases.iter().map(told).collect::<Vec<_>>(),
        "ages": flights.iter().map(flown).collect::<Vec<_>>(),
    });
    report
}

fn notes() -> Vec<String> {
    vec![
        format!(
            "The mountain of the study lod, 1920 x 1080, {TAU} px, cells down to {FINEST} m. Half of the \
             places lie before the camera, 1 to 1024 m away, half anywhere; where nothing is drawn (out \
             of the picture) the answer says so."
        ),
        "Times are wall times from submit to done of the one dispatch: with all that a submit costs. \
         Software Vulkan works on the processor."
            .into(),
        "Errors against the drawn triangle are those of its corners as they lie in the vertex buffer, \
         in f64. Those against the true surface are of the height function in f64, or of the sea."
            .into(),
        format!(
            "Ages: {FRAMES} frames of a flight, all vertices chosen anew in each, and up to {BUDGET} blocks made. They are counted as the \
             engine's simulation sees them: what has arrived when a frame is handed to the renderer is \
             used in the next."
        ),
    ]
}

fn figures(cases: &[Case], flights: &[(usize, usize, Ages)]) -> Vec<Figure> {
    let curve = |far: f64, kind: Kind, colour, pick: &dyn Fn(&Case) -> f64| Curve {
        name: format!("{kind:?}, {far} m from the origin"),
        colour,
        points: cases
            .iter()
            .filter(|case| case.far == far && case.kind == kind)
            .map(|case| (case.queries as f64, pick(case)))
            .collect(),
    };
    let curves = |pick: &dyn Fn(&Case) -> f64| {
        let all = FAR
            .into_iter()
            .flat_map(|far| [Kind::Standing, Kind::Flying].map(|kind| (far, kind)));
        all.enumerate()
            .map(|(colour, (far, kind))| curve(far, kind, colour, pick))
            .collect::<Vec<_>>()
    };
    let max = |case: &Case, pick: fn(&Checked) -> f64| {
        stats(&case.verdict.checked, pick).map_or(0.0, |stats| stats.max)
    };
    let chart = |title: &str, y_label: &str, axes, curves| Chart {
        title: title.into(),
        x_label: "queries a frame".into(),
        y_label: y_label.into(),
        axes,
        curves,
    };
    let ages = [0, 1].map(|in_flight| Curve {
        name: format!("largest, {} frames under way", in_flight + 1),
        colour: in_flight,
        points: flights
            .iter()
            .filter(|flight| flight.1 == in_flight)
            .map(|(queries, _, ages)| (*queries as f64, ages.max().unwrap_or(0).into()))
            .collect(),
    });
    vec![
        Figure {
            name: "ground_time".into(),
            caption: "Time of all answers of a frame, from submit to done.".into(),
            chart: chart(
                "Time of height queries",
                "ms",
                Axes::Logarithmic,
                curves(&|case| case.ms),
            ),
        },
        Figure {
            name: "ground_error_drawn".into(),
            caption: "Largest distance of an answer from the triangle that was drawn; 1e-4 m is what it \
                      has to keep to."
                .into(),
            chart: chart(
                "Error against the drawn triangle",
                "metres",
                Axes::Logarithmic,
                curves(&|case| max(case, |c| c.from_drawn)),
            ),
        },
        Figure {
            name: "ground_error_true".into(),
            caption: "Largest distance from the true surface, over the bound that the answer holds. Above 1, \
                      what lies between the samples of a block is more than the block allows for."
                .into(),
            chart: chart(
                "Error against the true surface",
                "error / bound",
                Axes::Logarithmic,
                curves(&|case| max(case, |c| c.from_truth / c.bound)),
            ),
        },
        Figure {
            name: "ground_age".into(),
            caption: "Frames from a question to the first frame that uses its answer.".into(),
            chart: chart("Age of height queries", "frames", Axes::Logarithmic, ages.into()),
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gpu_a_flight_gets_its_answers_within_three_frames() {
        let Some(gpu) = dolomite_testkit::gpu::for_test() else {
            return;
        };
        let terrain = ground(2, DVec2::ZERO);
        let eye = camera(&terrain, Kind::Flying, 2);
        for in_flight in [0, 1] {
            let ages = fly(&gpu, &terrain, eye, 24, (1000, in_flight, 2)).expect("flies");
            assert!(ages.max() <= Some(3), "{ages:?}");
            // The last frames are under way when it ends.
            assert!(ages.ages.len() + 3 >= 24 && ages.unasked == 0, "{ages:?}");
        }
    }
}
