//! Study `occlusion`: ambient occlusion in screen space against rays, by quality, resolution and radius, and its time.
//!
//! Truth is the share of 4 096 rays, spread as the cosine, that meet nothing within the radius, in f64 and in the whole
//! scene: also what the camera does not see blocks them, so a part of the error is of every method that knows one picture.
//! `limit` is what is left of it with 24 slices of 2 × 24 steps on the CPU, fed the same G-buffer. What a frame's
//! occlusion is comes from two frames, with it and without, in white light from everywhere.

mod measured;

use dolomite_deferred::{OcclusionQuality, OcclusionResolution};
use serde_json::{Value, json};

use crate::csv::{ErrorNumbers, Row};
use crate::plot::{Axes, Chart, Curve};
use crate::study::{Asked, Figure, Options, Report, Study};
use measured::{Measured, Method};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "occlusion",
    about: "ambient occlusion in screen space against 4 096 rays: error by quality, resolution and radius, and its time",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 8] = [
    Asked {
        what: "Ambient occlusion against rays, radius 0.25 m: RMSE, `High`, all pixels",
        asked: "≤ 0.06",
        at: "/radii/0/high/rmse",
        unit: "",
    },
    Asked {
        what: "The same, radius 0.5 m",
        asked: "≤ 0.06",
        at: "/radii/1/high/rmse",
        unit: "",
    },
    Asked {
        what: "The same, radius 1 m",
        asked: "≤ 0.06",
        at: "/radii/2/high/rmse",
        unit: "",
    },
    Asked {
        what: "The same, radius 2 m",
        asked: "≤ 0.06",
        at: "/radii/3/high/rmse",
        unit: "",
    },
    Asked {
        what: "What no sampling of one picture is better than there, radius 2 m",
        asked: "",
        at: "/radii/3/limit/rmse",
        unit: "",
    },
    Asked {
        what: "RMSE of a quarter of the pixels over all, `High`, worst radius",
        asked: "≤ 1.2",
        at: "/half/error",
        unit: "ratio",
    },
    Asked {
        what: "Time of a quarter of the pixels over all, `High`",
        asked: "≤ 0.4",
        at: "/half/time",
        unit: "ratio",
    },
    Asked {
        what: "RMSE of Bevy's at its own radius (0.73 m), over ours of `High` there",
        asked: "",
        at: "/bevy/over_ours",
        unit: "ratio",
    },
];

/// Metres. Bevy's has one radius, of which the fourth part fades out.
const RADII: [f32; 5] = [0.25, 0.5, 1.0, 2.0, 0.7285];

/// Of Bevy's.
const BEVYS: usize = 4;

fn run(options: &Options) -> Report {
    let mut report = Report {
        study: STUDY.name,
        rows: Vec::new(),
        figures: Vec::new(),
        notes: Vec::new(),
        summary: Value::Null,
    };
    match measured::measure(options, &RADII) {
        Some(measured) => tell(&measured, options, &mut report),
        None => report
            .notes
            .push("no Vulkan device: nothing was measured".into()),
    }
    report
}

fn ours(quality: OcclusionQuality, resolution: OcclusionResolution) -> Method {
    Method::Ours(quality, resolution)
}

fn tell(measured: &Measured, options: &Options, report: &mut Report) {
    let mut radii = Vec::new();
    for (k, radius) in RADII.iter().enumerate() {
        let mut of_radius = serde_json::Map::new();
        of_radius.insert("radius".into(), json!(radius));
        for method in measured.methods() {
            let Some(error) = measured.error(method, k) else {
                continue;
            };
            let ms = measured.ms(method);
            of_radius.insert(
                method.name(),
                json!({ "rmse": error.rms, "bias": error.bias, "p99": error.p99, "ms": ms }),
            );
            report.rows.push(Row {
                sweep: "quality".into(),
                method: method.name(),
                parameter: format!("radius {radius} m"),
                parameter_value: f64::from(*radius),
                quantity: "share of the light from everywhere".into(),
                error: Some(ErrorNumbers {
                    max: error.max,
                    rms: error.rms,
                    p99: error.p99,
                }),
                error_unit: "of 1".into(),
                time_ns: ms.map(|ms| ms * 1e6),
                bytes: None,
                vertices: None,
                hash: None,
                device: measured.device.clone(),
            });
        }
        radii.push(Value::Object(of_radius));
    }
    let high = |resolution| ours(OcclusionQuality::High, resolution);
    let (full, half) = (
        high(OcclusionResolution::Full),
        high(OcclusionResolution::Half),
    );
    let rms = |method, k| {
        measured
            .error(method, k)
            .map_or(f64::NAN, |error| error.rms)
    };
    let worst = (0..RADII.len())
        .map(|k| rms(half, k) / rms(full, k))
        .fold(0.0, f64::max);
    let time = measured.ms(half).unwrap_or(f64::NAN) / measured.ms(full).unwrap_or(f64::NAN);
    report.figures.push(figure(measured));
    report.notes.push(format!(
        "{} scenes of seed {} on, {} x {} pixels; times are of frames of the first, less one without occlusion, medians of {}",
        measured.scenes, options.seed, options.size[0], options.size[1], options.repeats
    ));
    report.notes.push(
        "Bevy's fades out over its radius; rays do not. Its time is with its own normal prepass"
            .into(),
    );
    report.summary = json!({
        "seed": options.seed,
        "size": options.size,
        "scenes": measured.scenes,
        "rays": measured::RAYS,
        "device": measured.device,
        "radii": radii,
        "half": { "error": worst, "time": time },
        "bevy": {
            "over_ours": rms(Method::Bevy, BEVYS) / rms(full, BEVYS),
            "time_over_ours": measured.ms(Method::Bevy).unwrap_or(f64::NAN) / measured.ms(full).unwrap_or(f64::NAN),
        },
    });
}

fn figure(measured: &Measured) -> Figure {
    let resolutions = [OcclusionResolution::Full, OcclusionResolution::Half];
    let mut curves: Vec<Curve> = Vec::new();
    for (k, radius) in RADII.iter().enumerate().take(BEVYS) {
        for resolution in resolutions {
            let points = measured::QUALITIES
                .iter()
                .filter_map(|quality| {
                    let method = ours(*quality, resolution);
                    Some((
                        measured.ms(method)?.max(1e-3),
                        measured.error(method, k)?.rms,
                    ))
                })
                .collect();
            curves.push(Curve {
                name: format!("{radius} m, {resolution:?}"),
                colour: curves.len(),
                points,
            });
        }
    }
    Figure {
        name: "occlusion_time_error".into(),
        caption: "Time of ambient occlusion against its error, by radius and resolution; a curve's points are the qualities".into(),
        chart: Chart {
            title: "Ambient occlusion".into(),
            x_label: "ms".into(),
            y_label: "RMSE".into(),
            axes: Axes::Logarithmic,
            curves,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gpu_a_small_run_has_what_is_asked_for() {
        let options = Options {
            size: [64, 36],
            repeats: 1,
            count: Some(1),
            ..Options::default()
        };
        let report = run(&options);
        if report.summary.is_null() {
            assert!(std::env::var_os("CI").is_none(), "{:?}", report.notes);
            return;
        }
        for asked in &ASKED {
            let number = report.summary.pointer(asked.at);
            assert!(number.is_some_and(Value::is_number), "{}", asked.at);
        }
        for (k, radius) in RADII.iter().enumerate() {
            let of = |name: &str| {
                let number = &report.summary["radii"][k][name]["rmse"];
                number.as_f64().expect("a number")
            };
            // More is better, but for what is hidden from the camera; no occlusion at all is the worst.
            assert!(of("ultra") <= of("low") + 0.01, "radius {radius}");
            assert!(of("high") < of("none"), "radius {radius}");
        }
    }
}
