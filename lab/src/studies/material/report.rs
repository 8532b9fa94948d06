//! What came out: rows, curves and the numbers that are asked for.

use super::measure::{ACROSS, COMPARED, Case, Measured, TIMED};
use super::ways::{PRESETS, WAYS};
use crate::csv::{ErrorNumbers, Row};
use crate::plot::{Axes, Chart, Curve};
use crate::study::{Figure, Report};
use serde_json::{Map, Value, json};

fn rows(case: &Case, device: &str) -> Vec<Row> {
    let pixels = f64::from(TIMED.element_product());
    let ways = WAYS.iter().zip(&case.ways);
    ways.flat_map(|(way, measured)| {
        let row = |quantity: &str, mean: f64, error| Row {
            sweep: case.place.into(),
            method: way.name.into(),
            parameter: format!("{:?}", case.kind),
            parameter_value: mean,
            quantity: quantity.into(),
            error,
            error_unit: "1".into(),
            time_ns: Some(measured.ms * 1e6 / pixels),
            bytes: None,
            vertices: None,
            hash: None,
            device: device.into(),
        };
        let of = |mean: f64, p99: f64| {
            Some(ErrorNumbers {
                max: p99.max(mean),
                rms: mean,
                p99,
            })
        };
        [
            row(
                "linear colour, to the truth",
                measured.mean_error,
                Some(measured.errors.into()),
            ),
            row(
                "FLIP to the truth (rms: the mean; max: p99)",
                measured.flip,
                of(measured.flip, measured.flip_p99),
            ),
            row(
                "FLIP to Full (the mean)",
                measured.flip_to_full,
                of(measured.flip_to_full, measured.flip_to_full),
            ),
            row(
                "FLIP of half a pixel (the mean)",
                measured.shimmer,
                of(measured.shimmer, measured.shimmer),
            ),
        ]
    })
    .collect()
}

/// The mean over cases of a number of a way.
fn mean(cases: &[&Case], of: impl Fn(&Case) -> f64) -> f64 {
    cases.iter().map(|case| of(case)).sum::<f64>() / cases.len() as f64
}

fn told(cases: &[&Case]) -> Value {
    let mut told = Map::new();
    for (k, way) in WAYS.iter().enumerate() {
        let number = |pick: fn(&Measured) -> f64| mean(cases, |case| pick(&case.ways[k]));
        let full = |pick: fn(&Measured) -> f64| mean(cases, |case| pick(&case.ways[0]));
        let values = json!({
            "ms": number(|m| m.ms),
            "time_over_full": number(|m| m.ms) / full(|m| m.ms),
            "flip": number(|m| m.flip),
            "flip_over_full": number(|m| m.flip) - full(|m| m.flip),
            "flip_to_full": number(|m| m.flip_to_full),
            "mean_error": number(|m| m.mean_error),
            "shimmer": number(|m| m.shimmer),
            "shimmer_over_full": number(|m| m.shimmer) / full(|m| m.shimmer),
            "shimmer_over_truth": number(|m| m.shimmer) / mean(cases, |case| case.shimmer),
        });
        told.insert(way.name.into(), values);
    }
    Value::Object(told)
}

/// FLIP against time: a curve a ground, a point a way.
fn figure(study: &str, cases: &[Case]) -> Figure {
    let curves = ["mountain", "jacksboro"].into_iter().enumerate();
    let curves = curves.flat_map(|(colour, place)| {
        let of: Vec<&Case> = cases.iter().filter(|case| case.place == place).collect();
        let points = |pick: fn(&Measured) -> f64| {
            let ways = 0..WAYS.len();
            ways.map(|k| {
                let ms = mean(&of, |case| case.ways[k].ms);
                (ms, mean(&of, |case| pick(&case.ways[k])))
            })
            .collect::<Vec<_>>()
        };
        let curve = |name: &str, colour, points| Curve {
            name: format!("{place}, {name}"),
            colour,
            points,
        };
        [
            curve("to 64 samples", 2 * colour, points(|m| m.flip)),
            curve("to Full", 2 * colour + 1, points(|m| m.flip_to_full)),
        ]
    });
    Figure {
        name: format!("{study}_time_flip"),
        caption: "Mean FLIP of the ground's pictures against the time of their G-buffer, to the full material at 64 \
                  samples a pixel and at one; a point for each way of shading, Full at the right"
            .into(),
        chart: Chart {
            title: "Ground's pixels".into(),
            x_label: "G-buffer of 640 × 360 pixels, ms".into(),
            y_label: "mean FLIP".into(),
            axes: Axes::Logarithmic,
            curves: curves.collect(),
        },
    }
}

/// Of what was measured.
#[must_use]
pub fn report(study: &'static str, cases: &[Case], device: &str) -> Report {
    let all: Vec<&Case> = cases.iter().collect();
    let of = |place: &str| {
        let of = cases.iter().filter(|case| case.place == place);
        told(&of.collect::<Vec<_>>())
    };
    let views = cases.iter().map(|case| {
        let ways = PRESETS.iter().map(|&k| {
            let Measured { ms, flip, flip_to_full, shimmer, .. } = &case.ways[k];
            json!({ "way": WAYS[k].name, "ms": ms, "flip": flip, "flip_to_full": flip_to_full, "shimmer": shimmer })
        });
        json!({
            "place": case.place,
            "view": format!("{:?}", case.kind),
            "shimmer_of_truth": case.shimmer,
            "ways": ways.collect::<Vec<_>>(),
        })
    });
    Report {
        study,
        rows: cases.iter().flat_map(|case| rows(case, device)).collect(),
        figures: vec![figure(study, cases)],
        notes: vec![
            format!(
                "Times are those of the G-buffer's pass at {} × {}; pictures have {} × {} pixels, the truth is Full \
                 at {} samples a pixel.",
                TIMED.x,
                TIMED.y,
                COMPARED.x,
                COMPARED.y,
                ACROSS * ACROSS
            ),
            "Light is a stand-in for the engine's: a sun, a sky, haze, a film's curve.".into(),
            "Shimmer is the mean FLIP between two pictures that are half a pixel apart.".into(),
        ],
        summary: json!({
            "device": device,
            "all": told(&all),
            "mountain": of("mountain"),
            "jacksboro": of("jacksboro"),
            "views": views.collect::<Vec<_>>(),
        }),
    }
}

/// Of a machine on which nothing could be measured.
#[must_use]
pub fn none(study: &'static str, why: &str) -> Report {
    Report {
        study,
        rows: Vec::new(),
        figures: Vec::new(),
        notes: vec![format!("Nothing was measured: {why}")],
        summary: Value::Null,
    }
}
