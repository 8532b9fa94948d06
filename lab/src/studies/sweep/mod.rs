//! Study `sweep`: ellipsoids that move against triangles, ours and others', held to halving in double-double numbers.

pub mod case;
mod tally;

use crate::csv::{ErrorNumbers, Row};
use crate::plot::{Axes, Chart, Curve};
use crate::studies::beside::{NOTE, SWEEPS, SweepMethod, Touch};
use crate::study::{Asked, Figure, Options, Report, Study};
use bevy::math::DVec3;
use dolomite_collision::{Ellipsoid, sweep};
use dolomite_testkit::hostile::{self, KINDS};
use dolomite_testkit::metrics::{ErrorStats, median};
use dolomite_testkit::random::{Random, mixed};
use dolomite_testkit::sweeps::{Sweep, swept};
use serde_json::{Map, json};
use std::hint::black_box;
use std::time::Instant;
use tally::{CLEARLY, DOUBT, Tally, Total};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "sweep",
    about: "swept ellipsoids against triangles: misses, time of contact, normals, ns; beside parry",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 14] = [
    asked("Sweeps, of nine kinds", "≥ 1.1e7", "/sweeps", ""),
    asked("Contacts missed", "0", "/ours/missed", ""),
    asked("Contacts where there are none", "0", "/ours/invented", ""),
    asked(
        "Time of contact, largest error",
        "≤ 1e-6",
        "/ours/time_max",
        "of the way",
    ),
    asked(
        "Normal, largest error",
        "≤ 1e-4",
        "/ours/normal_max_rad",
        "rad",
    ),
    asked(
        "Contacts missed where the ellipsoid goes deeper than 1e-3 of its radius, parry 0.30",
        "",
        "/parry/missed_clearly",
        "",
    ),
    asked(
        "Contacts where it stays away by more than 1e-3 of its radius, parry 0.30",
        "",
        "/parry/invented_clearly",
        "",
    ),
    asked(
        "Time of contact, largest error, parry 0.30",
        "",
        "/parry/time_max",
        "of the way",
    ),
    asked(
        "Time of contact, error that 99 % stay below, worst kind, parry 0.30",
        "",
        "/parry/time_p99",
        "of the way",
    ),
    asked(
        "Time of contact, error that 99 % stay below, worst kind",
        "",
        "/ours/time_p99",
        "of the way",
    ),
    asked(
        "Sweeps a second over parry 0.30, one triangle each, median of the kinds",
        "",
        "/over/parry",
        "ratio",
    ),
    asked(
        "Contacts missed where the ellipsoid goes deeper than 1e-3 of its radius, parry 0.30, sweep of points with radii",
        "",
        "/parry_toi/missed_clearly",
        "",
    ),
    asked(
        "Time of contact, error that 99 % stay below, worst kind, parry 0.30, sweep of points with radii",
        "",
        "/parry_toi/time_p99",
        "of the way",
    ),
    asked(
        "Sweeps a second over parry 0.30's sweep of points with radii, one triangle each, median of the kinds",
        "",
        "/over/parry_toi",
        "ratio",
    ),
];

const fn asked(
    what: &'static str,
    asked: &'static str,
    at: &'static str,
    unit: &'static str,
) -> Asked {
    Asked {
        what,
        asked,
        at,
        unit,
    }
}

fn ours(case: &Sweep) -> Touch {
    let ellipsoid = Ellipsoid::upright(case.center.into(), case.radii.into());
    let found = sweep(
        &ellipsoid,
        case.way.into(),
        &[case.corners.map(DVec3::from)],
    );
    found
        .ok()
        .flatten()
        .map(|contact| (contact.time, contact.normal))
}

/// What the first row of a kind and method is about.
const TIME: &str = "time of contact";

/// Sweeps of a kind that are timed.
const TIMED: usize = 4096;

fn once(cases: &[Sweep], method: fn(&Sweep) -> Touch) -> f64 {
    let start = Instant::now();
    for case in cases {
        black_box(method(black_box(case)));
    }
    start.elapsed().as_secs_f64() * 1e9 / cases.len().max(1) as f64
}

/// Nanoseconds of each method, medians of rounds in which all have their turn.
fn timed(cases: &[Sweep], repeats: usize, methods: &[SweepMethod]) -> Vec<f64> {
    let mut times = vec![Vec::new(); methods.len()];
    for _ in 0..repeats.max(1) {
        for ((_, method), times) in methods.iter().zip(&mut times) {
            times.push(once(cases, *method));
        }
    }
    let medians = times.into_iter().map(median);
    medians.map(|time| time.unwrap_or(f64::NAN)).collect()
}

fn run(options: &Options) -> Report {
    let count = options.count.unwrap_or(20_000).max(1);
    let mut methods: Vec<SweepMethod> = vec![("ours", ours)];
    methods.extend(SWEEPS);
    let mut rows = Vec::new();
    let mut totals = vec![Total::default(); methods.len()];
    for kind in 0..KINDS {
        eprintln!("sweep: {}", hostile::name(kind));
        let mut tallies: Vec<Tally> = methods.iter().map(|_| Tally::default()).collect();
        // Kept for the clock; the others are made, judged and forgotten.
        let mut kept = Vec::new();
        let mut random = Random::new(mixed(options.seed, kind as u32));
        for _ in 0..count {
            let case = hostile::sweep(&mut random, kind);
            let truth = swept(&case);
            for ((_, method), tally) in methods.iter().zip(&mut tallies) {
                tally.add(method(&case), &truth);
            }
            if kept.len() < TIMED {
                kept.push(case);
            }
        }
        let times = timed(&kept, options.repeats, &methods);
        for (i, tally) in tallies.into_iter().enumerate() {
            rows.extend(row_pair(kind, methods[i].0, &tally, times[i]));
            totals[i].add(tally, times[i]);
        }
    }
    let mut summary = Map::new();
    summary.insert("sweeps".into(), json!(count * KINDS));
    let over = (1..methods.len()).map(|i| {
        let kinds = totals[i].ns.iter().zip(&totals[0].ns);
        let ratio = median(kinds.map(|(theirs, ours)| theirs / ours).collect());
        (methods[i].0.to_owned(), json!(ratio))
    });
    summary.insert("over".into(), over.collect::<Map<_, _>>().into());
    for ((name, _), total) in methods.iter().zip(&totals) {
        summary.insert((*name).into(), total.to_json());
    }
    let figure = figure(&rows, &methods);
    Report {
        study: STUDY.name,
        rows,
        figures: vec![figure],
        notes: vec![
            format!(
                "a contact is missed where the least distance of the way is below the radius by {DOUBT:e} of it, and \
                 clearly missed by {CLEARLY:e}; times and normals are judged of contacts alone that are not in doubt"
            ),
            NOTE.into(),
        ],
        summary: summary.into(),
    }
}

/// The errors of one kind by one method.
fn row_pair(kind: usize, method: &str, tally: &Tally, ns: f64) -> [Row; 2] {
    let row = |quantity: &str, unit: &str, errors: &[f64]| Row {
        sweep: hostile::name(kind).into(),
        method: method.into(),
        parameter: format!(
            "missed={} clearly={} invented={} clearly={}",
            tally.missed, tally.missed_clearly, tally.invented, tally.invented_clearly
        ),
        parameter_value: tally.missed as f64,
        quantity: quantity.into(),
        error: ErrorStats::of(errors.iter().copied()).map(ErrorNumbers::from),
        error_unit: unit.into(),
        time_ns: Some(ns),
        bytes: None,
        vertices: None,
        hash: Some(tally.hash.finish()),
        device: "one core".into(),
    };
    [
        row(TIME, "of the way", &tally.times),
        row("normal", "rad", &tally.normals),
    ]
}

/// Kind by kind, what 99 % of the times of contact of each method err by less than.
fn figure(rows: &[Row], methods: &[SweepMethod]) -> Figure {
    let of = |method: &str| {
        let own = rows
            .iter()
            .filter(move |row| row.method == method && row.quantity == TIME);
        // A logarithm of no error is none: the rounding of one stands for it.
        let error = |row: &Row| row.error.map(|error| error.p99.max(f64::EPSILON));
        (1..)
            .zip(own)
            .filter_map(move |(kind, row)| Some((f64::from(kind), error(row)?)))
            .collect::<Vec<_>>()
    };
    let names = (0..KINDS).map(|kind| format!("{} {}", kind + 1, hostile::name(kind)));
    Figure {
        name: "sweep_times".into(),
        caption: format!(
            "Errors of the time of contact that 99 % stay below, kind by kind: {}.",
            names.collect::<Vec<_>>().join(", ")
        ),
        chart: Chart {
            title: "Time of contact".into(),
            x_label: "kind of sweep".into(),
            y_label: "error of 99 %, parts of the way".into(),
            axes: Axes::Logarithmic,
            curves: (0..)
                .zip(methods)
                .map(|(colour, (name, _))| Curve {
                    name: (*name).into(),
                    colour,
                    points: of(name),
                })
                .collect(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_run_holds_what_is_promised() {
        let options = Options {
            count: Some(100),
            repeats: 1,
            ..Options::default()
        };
        let report = run(&options);
        let summary = report.summary;
        let ours = &summary["ours"];
        assert_eq!(
            (&ours["missed"], &ours["invented"]),
            (&json!(0), &json!(0)),
            "{summary}"
        );
        assert!(ours["time_max"].as_f64().unwrap() <= 1e-6, "{summary}");
        assert!(
            ours["normal_max_rad"].as_f64().unwrap() <= 1e-4,
            "{summary}"
        );
        // The others are judged by the same: f32 errs by more than f64 does.
        for (name, _) in SWEEPS {
            let time = summary[name]["time_max"].as_f64().unwrap();
            assert!(time > 1e-9, "{summary}");
        }
        // Every kind has its place in the figure, and ours lies below the others.
        let curves = &report.figures[0].chart.curves;
        for other in &curves[1..] {
            assert_eq!((curves[0].points.len(), other.points.len()), (KINDS, KINDS));
            let above = curves[0].points.iter().zip(&other.points);
            assert!(above.filter(|(ours, other)| ours.1 < other.1).count() >= KINDS / 2);
        }
    }
}
