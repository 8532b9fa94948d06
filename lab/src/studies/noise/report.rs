//! What the measurements come to: figures, notes, summary.

use super::OCTAVES;
use super::measure::{GRADIENT_UNIT, VALUE_UNIT};
use super::ours;
use crate::csv::Row;
use crate::plot::{Axes, Chart, Curve};
use crate::study::{Figure, Report};
use serde_json::{Map, Value, json};

/// Largest error of a value that is to be reached, at any distance, of the amplitude.
pub const VALUE_REACH: f64 = 1e-5;
/// Largest error of a gradient that is to be reached, of amplitude / wavelength.
pub const GRADIENT_REACH: f64 = 1e-4;
/// Times as fast as `noise` 0.9 (value only) that the batch with gradient is to be.
const SPEED_OVER_NOISE: f64 = 8.0;
/// Times as fast as `noiz` 0.5 (value only) that the batch with gradient is to be.
const SPEED_OVER_NOIZ: f64 = 1.5;

/// What a reader must know of the baselines, whatever came out.
pub fn standing_notes() -> Vec<String> {
    [
        "noise 0.9 computes in f64 and is its own definition: no error is given. Its permutation has \
         256 entries, so its ground repeats after 256 wavelengths.",
        "noiz 0.5: the definition is its documented layered Perlin noise, written in f64 over its own \
         hash and gradients.",
        "noise-functions 0.8: the definition is the same noise (FastNoise Lite's) with positions in \
         f64; within a cell that one computes in f32, so errors below 3e-7 are not resolved. It has no \
         gradients.",
        "fastnoise-lite 1.1 is built with its f64 feature: positions in f64, the rest in f32. There is \
         no f64 definition beside it: no error is given. It has no gradients.",
        "noise 0.9 has no gradients.",
        "Positions are exact multiples of 2^-20 m; a method that takes f32 rounds them, and that is \
         part of its error.",
        "The time of a gradient row is that of value and gradient together.",
        "The WGSL's time is from the dispatch to the end of the GPU's work, without upload and read-back.",
    ]
    .map(str::to_owned)
    .to_vec()
}

/// Names of the methods, in the order in which they first appear.
fn names(rows: &[Row]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for row in rows {
        if !names.contains(&row.method.as_str()) {
            names.push(&row.method);
        }
    }
    names
}

/// The curves of one sweep and quantity, a point a row; `point` may leave a row out.
fn curves(
    rows: &[Row],
    sweep: &str,
    quantity: &str,
    point: impl Fn(&Row) -> Option<(f64, f64)>,
) -> Vec<Curve> {
    let of_sweep = |row: &&Row| row.sweep == sweep && row.quantity == quantity;
    let mut curves = Vec::new();
    for (colour, name) in names(rows).into_iter().enumerate() {
        let mine = rows
            .iter()
            .filter(of_sweep)
            .filter(|row| row.method == name);
        let points: Vec<(f64, f64)> = mine.filter_map(&point).collect();
        if !points.is_empty() {
            curves.push(Curve {
                name: name.to_owned(),
                colour,
                points,
            });
        }
    }
    curves
}

fn figures(rows: &[Row]) -> Vec<Figure> {
    let mut figures = Vec::new();
    for (quantity, unit) in [("value", VALUE_UNIT), ("gradient", GRADIENT_UNIT)] {
        let error_label = format!("largest error of the {quantity} ({unit})");
        figures.push(Figure {
            name: format!("noise_distance_{quantity}"),
            caption: format!(
                "Largest error of the {quantity} against the method's own definition in f64, by \
                 distance from the origin; {OCTAVES} octaves, the first of 256 m. A method without a \
                 definition but itself is left out."
            ),
            chart: Chart {
                title: format!("Error of the {quantity} against distance"),
                x_label: "distance from the origin (m)".into(),
                y_label: error_label.clone(),
                axes: Axes::Logarithmic,
                curves: curves(rows, "distance", quantity, |row| {
                    Some((row.parameter_value, row.error?.max))
                }),
            },
        });
        for layout in ["tile", "scattered"] {
            figures.push(Figure {
                name: format!("noise_time_{layout}_{quantity}"),
                caption: format!(
                    "Time of a sample against the largest error of the {quantity}, points {layout}; \
                     along each curve 1, 2, 4, 8 and 12 octaves. Below and to the left is better."
                ),
                chart: Chart {
                    title: format!("Time against error of the {quantity}, {layout} points"),
                    x_label: error_label.clone(),
                    y_label: "time of a sample (ns)".into(),
                    axes: Axes::Logarithmic,
                    curves: curves(rows, &format!("octaves, {layout}"), quantity, |row| {
                        Some((row.error?.max, row.time_ns?))
                    }),
                },
            });
        }
    }
    for layout in ["tile", "scattered"] {
        figures.push(Figure {
            name: format!("noise_octaves_{layout}"),
            caption: format!(
                "Time of a sample (value alone) by number of octaves, points {layout}: every method, \
                 those without a definition in f64 too."
            ),
            chart: Chart {
                title: format!("Time against octaves, {layout} points, value alone"),
                x_label: "octaves".into(),
                y_label: "time of a sample (ns)".into(),
                axes: Axes::Logarithmic,
                curves: curves(rows, &format!("octaves, {layout}"), "value", |row| {
                    Some((row.parameter_value, row.time_ns?))
                }),
            },
        });
    }
    figures
}

/// Largest error of each method and quantity over the whole distance sweep, and its growth from the
/// nearest kilometre to the farthest place.
fn errors_over_distance(rows: &[Row]) -> Value {
    let mut methods = Map::new();
    let sweep: Vec<Row> = rows
        .iter()
        .filter(|r| r.sweep == "distance")
        .cloned()
        .collect();
    for name in names(&sweep) {
        let mut numbers = Map::new();
        for quantity in ["value", "gradient"] {
            let errors: Vec<(f64, f64)> = sweep
                .iter()
                .filter(|r| r.method == name && r.quantity == quantity)
                .filter_map(|r| Some((r.parameter_value, r.error?.max)))
                .collect();
            let worst = errors.iter().map(|e| e.1).reduce(f64::max);
            numbers.insert(quantity.into(), json!(worst));
            let at = |d: f64| errors.iter().find(|e| e.0 == d).map(|e| e.1);
            let growth = at(1e7).zip(at(1e3)).map(|(far, near)| far / near);
            numbers.insert(format!("{quantity}_growth_1e3_to_1e7_m"), json!(growth));
        }
        methods.insert(name.to_owned(), numbers.into());
    }
    methods.into()
}

/// Nanoseconds a sample with [`OCTAVES`] octaves.
fn time_of(rows: &[Row], method: &str, layout: &str, quantity: &str) -> Option<f64> {
    let sweep = format!("octaves, {layout}");
    rows.iter()
        .find(|r| {
            r.method == method
                && r.sweep == sweep
                && r.quantity == quantity
                && r.parameter_value == f64::from(OCTAVES)
        })
        .and_then(|r| r.time_ns)
}

fn summary(rows: &[Row]) -> Value {
    let mut times = Map::new();
    for name in names(rows) {
        let of = |layout: &str| {
            json!({
                "value": time_of(rows, name, layout, "value"),
                "value_and_gradient": time_of(rows, name, layout, "gradient"),
            })
        };
        times.insert(
            name.into(),
            json!({ "tile": of("tile"), "scattered": of("scattered") }),
        );
    }
    let ratio = |baseline: &str, layout: &str| {
        let ours = time_of(rows, ours::BATCH, layout, "gradient")?;
        Some(time_of(rows, baseline, layout, "value")? / ours)
    };
    let speed = |baseline: &str, reach: f64| {
        json!({
            "tile": ratio(baseline, "tile"),
            "scattered": ratio(baseline, "scattered"),
            "reach": reach,
        })
    };
    json!({
        "octaves": OCTAVES,
        "error_max_over_distance": errors_over_distance(rows),
        "error_units": { "value": VALUE_UNIT, "gradient": GRADIENT_UNIT },
        "error_reach": { "value": VALUE_REACH, "gradient": GRADIENT_REACH },
        "ns_per_sample": times,
        "batch_with_gradient_over_noise_0_9_value": speed("noise 0.9 (f64)", SPEED_OVER_NOISE),
        "batch_with_gradient_over_noiz_0_5_value": speed("noiz 0.5 (f32)", SPEED_OVER_NOIZ),
    })
}

/// Puts the measurements together.
pub fn report(rows: Vec<Row>, notes: Vec<String>) -> Report {
    let figures = figures(&rows)
        .into_iter()
        .filter(|f| !f.chart.curves.is_empty())
        .collect();
    Report {
        study: "noise",
        summary: summary(&rows),
        figures,
        notes,
        rows,
    }
}
