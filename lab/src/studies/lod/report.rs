//! What the study tells: counts, ratios, rows and the chart.

use super::compare::{PLACES, Row};
use super::guarantee::TAUS;
use super::judge::Count;
use super::measure::{Measured, Tally};
use crate::csv;
use crate::plot::{Axes, Chart, Curve};
use crate::study::Figure;
use serde_json::{Map, Value, json};

/// Errors over the bound, of all counts that `pick` takes.
pub fn counted(counts: &[Count], pick: impl Fn(&Count) -> bool) -> Value {
    let mut all = Tally::default();
    let (mut views, mut worst) = (0, None);
    for count in counts.iter().filter(|count| pick(count)) {
        if count.tally.max > all.max {
            worst = count.worst.map(|(camera, _)| (count.kind, camera.eye));
        }
        all.merge(&count.tally);
        views += count.views;
    }
    let Some(measured) = all.finish() else {
        return json!({ "views": views, "samples": 0 });
    };
    json!({
        "views": views,
        "samples": measured.samples,
        "above": all.above,
        "holes": measured.holes,
        "max": measured.max,
        "p99": measured.p99,
        "rms": measured.rms,
        "worst_camera": worst.map(|(kind, eye)| format!("{kind:?} at {eye}")),
        "worst_place": measured.worst.to_array(),
    })
}

/// The guarantee: all, each tolerance, each kind of camera; and where the finest cell was reached.
pub fn guarantee(counts: &[Count]) -> Value {
    let mut taus = Map::new();
    for tau in TAUS {
        let value = counted(counts, |c| c.tau == tau && !c.reached);
        taus.insert(format!("{tau} px"), value);
    }
    let mut kinds = Map::new();
    for kind in crate::scenes::cameras::KINDS {
        let value = counted(counts, |c| c.kind == kind && !c.reached);
        kinds.insert(format!("{kind:?}"), value);
    }
    json!({
        "all": counted(counts, |c| !c.reached),
        "taus": taus,
        "kinds": kinds,
        "finest_cell_reached": counted(counts, |c| c.reached),
    })
}

/// A row for each tolerance.
pub fn guarantee_rows(counts: &[Count]) -> Vec<csv::Row> {
    let mut rows = Vec::new();
    for (reached, sweep) in [
        (false, "guarantee"),
        (true, "guarantee, finest cell reached"),
    ] {
        for tau in TAUS {
            let mut all = Tally::default();
            for count in counts
                .iter()
                .filter(|c| c.tau == tau && c.reached == reached)
            {
                all.merge(&count.tally);
            }
            if let Some(measured) = all.finish() {
                rows.push(csv::Row {
                    error: Some(numbers(&measured)),
                    error_unit: "bound".into(),
                    ..row(sweep, "ours", format!("tau={tau} px"), tau)
                });
            }
        }
    }
    rows
}

fn numbers(measured: &Measured) -> csv::ErrorNumbers {
    csv::ErrorNumbers {
        max: measured.max,
        rms: measured.rms,
        p99: measured.p99,
    }
}

/// A row that says nothing yet.
pub fn row(sweep: &str, method: &str, parameter: String, value: f64) -> csv::Row {
    csv::Row {
        sweep: sweep.into(),
        method: method.into(),
        parameter,
        parameter_value: value,
        quantity: "surface".into(),
        error: None,
        error_unit: "px".into(),
        time_ns: None,
        bytes: None,
        vertices: None,
        hash: None,
        device: "CPU".into(),
    }
}

/// Methods under cameras at one wanted error.
pub struct Compared {
    /// Pixels.
    pub wanted: f64,
    /// What came out.
    pub rows: Vec<Row>,
}

/// A row for each method, camera and wanted error.
pub fn compared_rows(compared: &[Compared]) -> Vec<csv::Row> {
    let mut rows = Vec::new();
    for Compared { wanted, rows: of } in compared {
        for one in of {
            let sweep = format!("vertices, camera {}, {wanted} px", one.camera);
            let empty = row(&sweep, one.baseline, String::new(), f64::NAN);
            rows.push(match &one.tuned {
                Ok(tuned) => csv::Row {
                    parameter: format!("{}={}", one.knob, tuned.knob),
                    parameter_value: tuned.knob,
                    error: Some(numbers(&tuned.measured)),
                    time_ns: Some(tuned.draw.as_secs_f64() * 1e9),
                    vertices: Some(tuned.vertices),
                    ..empty
                },
                Err(error) => csv::Row {
                    parameter: error.to_string(),
                    ..empty
                },
            });
        }
    }
    rows
}

/// Vertices of each method, and of ours as a share of theirs, for each wanted error and camera.
pub fn compared(compared: &[Compared]) -> Value {
    let mut all = Map::new();
    for Compared { wanted, rows } in compared {
        let mut cameras: Vec<Map<String, Value>> = Vec::new();
        for row in rows {
            if cameras.len() <= row.camera {
                cameras.push(Map::new());
            }
            let ours = rows
                .iter()
                .find(|other| other.camera == row.camera && other.baseline == "ours")
                .and_then(|other| other.tuned.ok());
            let told = match &row.tuned {
                Ok(tuned) => json!({
                    "vertices": tuned.vertices,
                    "triangles": tuned.triangles,
                    "ours_over_this": ours.map(|o| o.vertices as f64 / tuned.vertices as f64),
                    "knob": tuned.knob,
                    "knob_is": row.knob,
                    "max": tuned.measured.max,
                    "p99": tuned.measured.p99,
                    "max_elsewhere": tuned.fresh.max,
                    "holes": tuned.measured.holes,
                    "draws": tuned.draws,
                }),
                Err(error) => json!({ "none": error.to_string() }),
            };
            cameras[row.camera].insert(row.baseline.to_owned(), told);
        }
        all.insert(format!("{wanted} px"), json!(cameras));
    }
    Value::Object(all)
}

/// Vertices over the error, a chart a camera.
pub fn figures(compared: &[Compared]) -> Vec<Figure> {
    let names = ["standing", "flying 150 m up", "4 km up"];
    let mut figures = Vec::new();
    for (camera, name) in names.iter().enumerate() {
        let mut curves: Vec<Curve> = Vec::new();
        for row in compared.iter().flat_map(|c| &c.rows) {
            let Ok(tuned) = row.tuned else { continue };
            if row.camera != camera {
                continue;
            }
            let at = curves.iter().position(|curve| curve.name == row.baseline);
            let at = at.unwrap_or_else(|| {
                curves.push(Curve {
                    name: row.baseline.to_owned(),
                    colour: 0,
                    points: Vec::new(),
                });
                curves.len() - 1
            });
            curves[at]
                .points
                .push((tuned.measured.max, tuned.vertices as f64));
        }
        for (colour, curve) in curves.iter_mut().enumerate() {
            curve.colour = colour;
            curve.points.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        if curves.is_empty() {
            continue;
        }
        figures.push(Figure {
            name: format!("lod_vertices_{camera}"),
            caption: format!(
                "The mountain, 16 km square, {name}: vertices over the largest error at some {PLACES} \
                 places, every method tuned to the same errors."
            ),
            chart: Chart {
                title: format!("Vertices over error: {name}"),
                x_label: "largest error (px)".into(),
                y_label: "vertices".into(),
                axes: Axes::Logarithmic,
                curves,
            },
        });
    }
    figures
}
