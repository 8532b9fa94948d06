//! Study `light`: a random scene through each way of deferred lighting and through Bevy's own, against the ray
//! caster in f64.
//!
//! Two references: the oracle's own picture (`whole`), and the oracle fed what the G-buffer holds (`arithmetic`), which
//! leaves out packing and the edges of triangles. Times are those of whole frames with the adapter waited for, the
//! ways taking turns, less the frame in which nothing lights; medians.

pub mod way;

use bevy::prelude::App;
use dolomite_deferred::{BlinnPhongPlugin, DeferredPlugin};
use dolomite_light_oracle::ledger::Ledger;
use dolomite_light_oracle::model::SplitSum;
use dolomite_light_oracle::shade::{Lights, shade};
use dolomite_light_oracle::{Image, Options as Rays, Recipe, generate, render};
use dolomite_testkit::light::{self, GBufferPlugin, UnlitPlugin};
use serde_json::{Value, json};

use crate::csv::{ErrorNumbers, Row};
use crate::plot::{Axes, Chart, Curve};
use crate::study::{Asked, Figure, Options, Report, Study};
use way::{LITS, Lit, Measured};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "light",
    about: "deferred lighting: three ways and Bevy's pass against a ray caster in f64, and their times",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 4] = [
    Asked {
        what: "Shading arithmetic, the oracle fed the decoded G-buffer: p99.9 relative error, worst way",
        asked: "≤ 1e-5",
        at: "/worst/arithmetic_p999",
        unit: "",
    },
    Asked {
        what: "End to end, unshadowed: mean LDR-FLIP, worst way",
        asked: "≤ 0.01",
        at: "/worst/mean_flip",
        unit: "",
    },
    Asked {
        what: "Ways against each other: largest relative difference",
        asked: "≤ 1e-5",
        at: "/worst/apart",
        unit: "",
    },
    Asked {
        what: "Pixels that are no number, all ways",
        asked: "0",
        at: "/worst/nan",
        unit: "",
    },
];

/// Radiance below which a pixel counts as dark: white is 1.
const FLOOR: f64 = 1e-3;

fn run(options: &Options) -> Report {
    let app = light::app_with(|app| {
        app.add_plugins((DeferredPlugin, BlinnPhongPlugin, GBufferPlugin, UnlitPlugin));
    });
    let mut report = Report {
        study: STUDY.name,
        rows: Vec::new(),
        figures: Vec::new(),
        notes: Vec::new(),
        summary: Value::Null,
    };
    match app {
        Some(mut app) => measure(&mut app, options, &mut report),
        None => report
            .notes
            .push("no Vulkan device: nothing was measured".into()),
    }
    report
}

fn measure(app: &mut App, options: &Options, report: &mut Report) {
    let [width, height] = options.size;
    let recipe = Recipe {
        seed: options.seed.into(),
        lights: options.lights,
        blinn_phong: 0.25,
        width,
        height,
        ..Recipe::default()
    };
    let scene = generate(&recipe);
    eprintln!("rays: {width} x {height}, {} lights", options.lights);
    let truth = render(
        &scene,
        &Rays {
            shadows: false,
            ..Rays::default()
        },
    );
    // Bevy knows one shading model; its frame is held to a scene of that alone.
    let plain = generate(&Recipe {
        blinn_phong: 0.0,
        ..recipe
    });
    let plain_truth = render(
        &plain,
        &Rays {
            shadows: false,
            ..Rays::default()
        },
    );
    let spawned = light::spawn(app, &scene, ());
    let mut ours: Vec<Measured> = Vec::new();
    for lit in LITS.iter().filter(|lit| lit.way().is_some()) {
        ours.push(way::frame(app, spawned.camera, *lit));
    }
    let texels = light::decoded(&light::pixels(app), &scene.camera);
    way::despawn(app, spawned);
    let lights = |scene: &dolomite_light_oracle::Scene| {
        Lights::new(
            &scene.lamps,
            &scene.ambient,
            scene.camera.exposure,
            SplitSum::Karis,
        )
    };
    let fed = shade(&lights(&scene), width, height, scene.background, &texels);
    let spawned = light::spawn(app, &plain, ());
    let bevys = way::frame(app, spawned.camera, Lit::Bevy);
    let texels = light::decoded(&light::pixels(app), &plain.camera);
    let plain_fed = shade(&lights(&plain), width, height, plain.background, &texels);
    let times = way::times(app, spawned.camera, options.repeats);
    way::despawn(app, spawned);
    let (Ok(fed), Ok(plain_fed)) = (fed, plain_fed) else {
        report.notes.push("a target without pixels".into());
        return;
    };
    let first = ours[0].pixels.clone();
    let mut entries = serde_json::Map::new();
    let mut worst = [0.0_f64; 4];
    for measured in ours.iter().chain([&bevys]) {
        let is_bevy = measured.lit == Lit::Bevy;
        let (truth, fed) = if is_bevy {
            (&plain_truth, &plain_fed)
        } else {
            (&truth, &fed)
        };
        let ms = times.of(measured.lit);
        let Some((entry, ledgers)) = entry(measured, truth, fed, ms) else {
            report
                .notes
                .push(format!("{}: no frame", measured.lit.name()));
            continue;
        };
        if !is_bevy {
            let apart = way::apart(&measured.pixels, &first, FLOOR as f32);
            let values = [
                ledgers[1].p999,
                ledgers[0].ldr_flip_mean,
                f64::from(apart),
                ledgers[0].not_finite as f64,
            ];
            for (worst, value) in worst.iter_mut().zip(values) {
                *worst = worst.max(value);
            }
        }
        report
            .rows
            .push(row(measured, &ledgers[1], ms, options, &times.device));
        entries.insert(measured.lit.name().into(), entry);
    }
    report.figures.push(figure(&report.rows));
    report.notes.push(
        "Bevy's frame is of the scene with Bevy's material alone, as are all times; ours have a quarter Blinn-Phong".into(),
    );
    report.notes.push("whole: FLIP's reference has the exact edges and materials; arithmetic: those of the G-buffer".into());
    report.summary = json!({
        "seed": options.seed,
        "size": options.size,
        "lights": options.lights,
        "device": times.device,
        "unlit_frame_ms": times.unlit,
        "ways": entries,
        "worst": {
            "arithmetic_p999": worst[0],
            "mean_flip": worst[1],
            "apart": worst[2],
            "nan": worst[3] as u64,
        },
    });
}

/// The numbers of a way, and its two ledgers: against the truth, and against the oracle fed the G-buffer.
fn entry(measured: &Measured, truth: &Image, fed: &Image, ms: f64) -> Option<(Value, [Ledger; 2])> {
    let frame = Image::from_rgba(truth.width, truth.height, &measured.pixels).ok()?;
    let whole = Ledger::new(&frame, truth, FLOOR).ok()?;
    let arithmetic = Ledger::new(&frame, fed, FLOOR).ok()?;
    let relative =
        |ledger: &Ledger| json!({ "p50": ledger.p50, "p999": ledger.p999, "max": ledger.max });
    let value = json!({
        "relative_error": relative(&whole),
        "arithmetic": relative(&arithmetic),
        "flip": {
            "mean": whole.ldr_flip_mean,
            "max": whole.ldr_flip_max,
            "hdr_mean": whole.hdr_flip_mean,
            "hdr_max": whole.hdr_flip_max,
        },
        "lit": whole.lit,
        "missed": whole.missed,
        "nan": whole.not_finite,
        "passes": measured.passes,
        "bytes": measured.bytes,
        "ms": ms,
    });
    Some((value, [whole, arithmetic]))
}

fn row(measured: &Measured, arithmetic: &Ledger, ms: f64, options: &Options, device: &str) -> Row {
    Row {
        sweep: "frame".into(),
        method: measured.lit.name().into(),
        parameter: format!("{} lights", options.lights),
        parameter_value: options.lights as f64,
        quantity: "radiance, fed the G-buffer; rms is the median".into(),
        error: Some(ErrorNumbers {
            max: arithmetic.max,
            rms: arithmetic.p50,
            p99: arithmetic.p999,
        }),
        error_unit: "relative, p99 is p99.9".into(),
        time_ns: Some(ms * 1e6),
        bytes: usize::try_from(measured.bytes).ok(),
        vertices: None,
        hash: None,
        device: device.into(),
    }
}

fn figure(rows: &[Row]) -> Figure {
    let curves = rows
        .iter()
        .enumerate()
        .filter_map(|(colour, row)| {
            let point = (row.time_ns? * 1e-6, row.error?.p99.max(1e-9));
            Some(Curve {
                name: row.method.clone(),
                colour,
                points: vec![point],
            })
        })
        .collect();
    Figure {
        name: "light_time_error".into(),
        caption: "Time of lighting a frame against the relative error of its arithmetic, 99.9th percentile".into(),
        chart: Chart {
            title: "Deferred lighting".into(),
            x_label: "ms".into(),
            y_label: "relative error".into(),
            axes: Axes::Logarithmic,
            curves,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_frame_has_what_is_asked_for() {
        let options = Options {
            size: [64, 36],
            lights: 12,
            repeats: 1,
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
        for lit in LITS {
            let way = &report.summary["ways"][lit.name()];
            assert_eq!(way["nan"], 0, "{}", lit.name());
            assert!(
                way["arithmetic"]["p50"].as_f64().is_some_and(|x| x < 1e-5),
                "{way}"
            );
        }
        assert!(
            report.summary["worst"]["apart"]
                .as_f64()
                .is_some_and(|x| x <= 1e-5)
        );
    }
}
