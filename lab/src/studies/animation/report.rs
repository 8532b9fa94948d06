//! The figures that the study was made for, and its chart.

use super::model::Model;
use crate::csv::Row;
use crate::plot::{Axes, Chart, Curve};
use crate::study::{Figure, Report};
use serde_json::{Map, Value, json};

/// Libraries that are not built in, and how they are.
pub fn left_out() -> Vec<String> {
    vec![
        "ozz-animation-rs 0.11 is left out: it needs `portable_simd`, which stable compilers have not, as it \
         was before `Mask::to_int` was renamed"
            .to_owned(),
    ]
}

/// Puts it together.
pub fn report(rows: Vec<Row>, notes: Vec<String>, model: &Model, figures: usize) -> Report {
    let errors = |sweep: &str, quantity: &str| -> Map<String, Value> {
        let chosen = rows
            .iter()
            .filter(|row| row.sweep == sweep && row.quantity == quantity);
        chosen
            .map(|row| (row.method.clone(), json!(row.error.map(|error| error.max))))
            .collect()
    };
    let times = |quantity: &str| -> Map<String, Value> {
        let chosen = rows
            .iter()
            .filter(|row| row.sweep == "speed" && row.quantity == quantity);
        chosen
            .map(|row| (row.method.clone(), json!(row.time_ns)))
            .collect()
    };
    let blended = times("sampled and blended");
    let ours = blended.get("ours").and_then(Value::as_f64);
    let ratios: Map<String, Value> = blended
        .iter()
        .filter(|(name, _)| *name != "ours")
        .map(|(name, time)| {
            (
                name.clone(),
                json!(time.as_f64().zip(ours).map(|(time, ours)| time / ours)),
            )
        })
        .collect();
    let mut summary = json!({
        "model": model.name,
        "figures": figures,
        "joint_error_max_m": errors("sampling", "joint position"),
        "blend_error_max_rad": errors("blending", "rotation"),
        "order_difference_max_rad": errors("blending", "difference between orders"),
        "ns_per_joint": blended,
        "ns_per_joint_with_matrices": times("and model matrices"),
        "time_over_ours": ratios,
    });
    let of_skinning = |quantity: &str| {
        let row = rows
            .iter()
            .find(|row| row.sweep == "skinning" && row.quantity == quantity);
        row.and_then(|row| row.error).map(|error| error.max)
    };
    if let (Some(cpu), Some(exact)) = (
        of_skinning("GPU against CPU"),
        of_skinning("GPU against f64"),
    ) {
        summary["gpu_skinning_max_m"] = json!({ "cpu": cpu, "f64": exact });
    }
    Report {
        study: super::STUDY.name,
        figures: vec![chart(&rows)],
        rows,
        notes,
        summary,
    }
}

/// Time against error: a point a method.
fn chart(rows: &[Row]) -> Figure {
    let sampled = rows.iter().filter(|row| row.sweep == "sampling");
    let curves = sampled.enumerate().map(|(colour, row)| {
        let time = rows
            .iter()
            .find(|other| {
                other.sweep == "speed"
                    && other.method == row.method
                    && other.quantity == "sampled and blended"
            })
            .and_then(|other| other.time_ns);
        let point = time.zip(row.error.map(|error| error.max));
        Curve {
            name: row.method.clone(),
            colour,
            points: point.into_iter().collect(),
        }
    });
    Figure {
        name: "animation_time_error".into(),
        caption: "Three clips sampled and blended, nanoseconds of processor time a joint, and the greatest \
                  error of a joint's position when one clip is sampled."
            .into(),
        chart: Chart {
            title: "Animation: time and error".into(),
            x_label: "ns a joint".into(),
            y_label: "greatest error, m".into(),
            axes: Axes::Logarithmic,
            curves: curves.collect(),
        },
    }
}
