//! What a number comes to: a section of the JSON object, rows of the table, figures.

use crate::csv::{ErrorNumbers, Row};
use crate::plot::{Axes, Chart, Curve};
use crate::study::{Figure, Report};
use dolomite_tessellation::{Domain, Mode, Spacing};
use serde_json::{Map, Value, json};

/// One number that was asked for.
#[derive(Debug, Clone)]
pub struct Section {
    /// Its name in the JSON object.
    pub name: &'static str,
    /// In words.
    pub asked: &'static str,
    /// What came out; null if it was not measured.
    pub reached: Value,
    /// Whether that is what was asked for; `None` if it was not measured.
    pub holds: Option<bool>,
    /// Everything behind it.
    pub details: Value,
    /// Of the table.
    pub rows: Vec<Row>,
    /// Charts.
    pub figures: Vec<Figure>,
    /// What a reader must know.
    pub notes: Vec<String>,
}

impl Section {
    /// A section of what was not measured.
    #[must_use]
    pub const fn open(name: &'static str, asked: &'static str) -> Self {
        Self {
            name,
            asked,
            reached: Value::Null,
            holds: None,
            details: Value::Null,
            rows: Vec::new(),
            figures: Vec::new(),
            notes: Vec::new(),
        }
    }
}

/// Puts the sections together.
#[must_use]
pub fn report(study: &'static str, adapter: Option<&str>, sections: Vec<Section>) -> Report {
    let build = if cfg!(debug_assertions) {
        "Built with debug assertions (profile dev, optimisation level 1 where Cargo.toml is as it was)."
    } else {
        "Built without debug assertions (profile release)."
    };
    let mut report = Report {
        study,
        rows: Vec::new(),
        figures: Vec::new(),
        notes: vec![build.to_owned()],
        summary: Value::Null,
    };
    let mut summary = Map::new();
    for section in sections {
        summary.insert(
            section.name.to_owned(),
            json!({
                "asked": section.asked,
                "reached": section.reached,
                "holds": section.holds,
                "details": section.details,
            }),
        );
        report.rows.extend(section.rows);
        report.figures.extend(section.figures);
        let named = |note| format!("{}: {note}", section.name);
        report.notes.extend(section.notes.into_iter().map(named));
    }
    summary.insert("adapter".to_owned(), json!(adapter));
    summary.insert("debug_assertions".to_owned(), json!(cfg!(debug_assertions)));
    report.summary = Value::Object(summary);
    report
}

/// A row with one number.
#[must_use]
pub fn row(
    sweep: &str,
    method: &str,
    (parameter, value): (&str, f64),
    (quantity, number, unit): (&str, f64, &str),
    device: &str,
) -> Row {
    Row {
        sweep: sweep.to_owned(),
        method: method.to_owned(),
        parameter: format!("{parameter}={value}"),
        parameter_value: value,
        quantity: quantity.to_owned(),
        error: Some(ErrorNumbers {
            max: number,
            rms: number,
            p99: number,
        }),
        error_unit: unit.to_owned(),
        time_ns: None,
        bytes: None,
        vertices: None,
        hash: None,
        device: device.to_owned(),
    }
}

/// A chart of named curves, coloured in their order.
#[must_use]
pub fn figure(
    name: &str,
    caption: String,
    [title, x_label, y_label]: [&str; 3],
    curves: Vec<(String, Vec<(f64, f64)>)>,
) -> Figure {
    Figure {
        name: name.to_owned(),
        caption,
        chart: Chart {
            title: title.to_owned(),
            x_label: x_label.to_owned(),
            y_label: y_label.to_owned(),
            axes: Axes::Logarithmic,
            curves: curves
                .into_iter()
                .enumerate()
                .map(|(colour, (name, points))| Curve {
                    name,
                    colour,
                    points,
                })
                .collect(),
        },
    }
}

/// As it is named in tables.
#[must_use]
pub const fn domain_name(domain: Domain) -> &'static str {
    match domain {
        Domain::Triangles => "triangles",
        Domain::Quads => "quads",
        Domain::Isolines => "isolines",
    }
}

/// As it is named in tables.
#[must_use]
pub const fn spacing_name(spacing: Spacing) -> &'static str {
    match spacing {
        Spacing::Equal => "equal",
        Spacing::FractionalEven => "fractional even",
        Spacing::FractionalOdd => "fractional odd",
    }
}

/// As it is named in tables.
#[must_use]
pub const fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Exact => "exact",
        Mode::D3d => "d3d",
    }
}
