//! Study `occlusion`: ambient occlusion in screen space against rays, over its radius, quality and resolution; and what
//! it costs.
//!
//! Scenes in light from everywhere alone, so that a frame with occlusion over one without is the share that arrives. The
//! truth is 256 rays a pixel, no longer than the radius, the same that the passes have. Times are those of whole frames less
//! one without occlusion, all taking turns; medians. Bevy's own occlusion stands beside at the one radius that it has.

mod settings;
mod shares;

use bevy::prelude::App;
use dolomite_deferred::{DeferredPlugin, OcclusionQuality, OcclusionResolution};
use dolomite_light_oracle::occlusion::Occlusion;
use dolomite_light_oracle::{Recipe, Scene, generate, per_pixel};
use dolomite_testkit::light::occlusion::in_ambient_light;
use dolomite_testkit::light::{self, GBufferPlugin};
use serde_json::{Value, json};

use crate::csv::{ErrorNumbers, Row};
use crate::plot::{Axes, Chart, Curve};
use crate::studies::light::way;
use crate::study::{Asked, Figure, Options, Report, Study};
use settings::{By, QUALITIES};
use shares::{Errors, drawn, times};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "occlusion",
    about: "ambient occlusion of a picture against rays, by radius and quality; full and half resolution, and Bevy's",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 7] = [
    Asked {
        what: "Ambient occlusion, RMSE against rays, all pixels, quality High, radius 0.25 m",
        asked: "≤ 0.06",
        at: "/radii/0/high/full",
        unit: "",
    },
    Asked {
        what: "The same, radius 0.5 m",
        asked: "≤ 0.06",
        at: "/radii/1/high/full",
        unit: "",
    },
    Asked {
        what: "The same, radius 1 m",
        asked: "≤ 0.06",
        at: "/radii/2/high/full",
        unit: "",
    },
    Asked {
        what: "The same, radius 2 m",
        asked: "≤ 0.06",
        at: "/radii/3/high/full",
        unit: "",
    },
    Asked {
        what: "Half resolution: RMSE over that of all pixels, quality High, mean over the radii",
        asked: "≤ 1.2",
        at: "/half_over_full",
        unit: "ratio",
    },
    Asked {
        what: "Half resolution: its time over that of all pixels, quality High",
        asked: "≤ 0.4",
        at: "/half_time_over_full",
        unit: "ratio",
    },
    Asked {
        what: "Bevy's occlusion, RMSE at its own radius over ours there, both at their quality High",
        asked: "",
        at: "/bevy_over_ours",
        unit: "ratio",
    },
];

/// Metres.
const RADII: [f32; 4] = [0.25, 0.5, 1.0, 2.0];

/// Metres at which Bevy's shader looks for occlusion: a half, and what it scales that by.
const BEVYS_RADIUS: f32 = 0.5 * 1.457;

/// Scenes, from the seed on.
const SCENES: u32 = 2;

/// Rays a pixel.
const RAYS: u32 = 256;

/// The radius at which times are taken.
const TIMED: f32 = 0.5;

fn run(options: &Options) -> Report {
    let mut report = Report {
        study: STUDY.name,
        rows: Vec::new(),
        figures: Vec::new(),
        notes: Vec::new(),
        summary: Value::Null,
    };
    let app = light::app_with(|app| {
        app.add_plugins((DeferredPlugin, GBufferPlugin));
    });
    match app {
        Some(mut app) => measure(&mut app, options, &mut report),
        None => report
            .notes
            .push("no Vulkan device: nothing was measured".into()),
    }
    report
}

fn scene(seed: u32, options: &Options) -> Scene {
    let [width, height] = options.size;
    in_ambient_light(&generate(&Recipe {
        seed: seed.into(),
        width,
        height,
        ..Recipe::default()
    }))
}

/// All that is compared at a radius: ours, and Bevy's at its own.
fn compared(radius: f32) -> Vec<By> {
    let mut all = Vec::new();
    for (_, quality) in QUALITIES {
        for resolution in [OcclusionResolution::Full, OcclusionResolution::Half] {
            all.push(By::Ours(quality, resolution));
        }
        if radius == BEVYS_RADIUS {
            all.push(By::Bevy(quality));
        }
    }
    all
}

/// Each of [`compared`] with its errors over all scenes.
type Found = Vec<(By, Errors)>;

/// So many seeds from one on; after the last of all comes the first.
fn seeds(first: u32, count: u32) -> impl Iterator<Item = u32> {
    (0..count).map(move |k| first.wrapping_add(k))
}

fn measure(app: &mut App, options: &Options, report: &mut Report) {
    let scenes = options.count.unwrap_or(SCENES as usize).max(1) as u32;
    let radii: Vec<f32> = RADII.into_iter().chain([BEVYS_RADIUS]).collect();
    let mut found: Vec<Found> = radii
        .iter()
        .map(|radius| {
            let all = compared(*radius).into_iter();
            all.map(|by| (by, Errors::default())).collect()
        })
        .collect();
    for seed in seeds(options.seed, scenes) {
        let scene = scene(seed, options);
        let spawned = light::spawn(app, &scene, ());
        for (radius, found) in radii.iter().zip(&mut found) {
            eprintln!("seed {seed}: rays of {radius} m");
            let how = Occlusion {
                rays: RAYS,
                distance: (*radius).into(),
                ..Occlusion::default()
            };
            let truth = per_pixel::occlusions(&scene, &how);
            for (by, errors) in found {
                errors.add(&drawn(app, spawned.camera, *by, *radius), &truth);
            }
        }
        way::despawn(app, spawned);
    }
    let spawned = light::spawn(app, &scene(options.seed, options), ());
    let timed: Vec<By> = compared(BEVYS_RADIUS);
    let ms = times(app, spawned.camera, &timed, TIMED, options.repeats);
    way::despawn(app, spawned);
    tell(&radii, &found, &timed, &ms, report);
    report.summary["seed"] = json!(options.seed);
    report.summary["size"] = json!(options.size);
    report.summary["scenes"] = json!(scenes);
}

fn rmse_of(found: &Found, by: By) -> f64 {
    let errors = found.iter().find(|(other, _)| *other == by);
    errors.map_or(f64::NAN, |(_, errors)| errors.rmse())
}

fn tell(radii: &[f32], found: &[Found], timed: &[By], ms: &[f64], report: &mut Report) {
    let time_of = |by: By| {
        let at = timed.iter().position(|other| *other == by);
        at.map_or(f64::NAN, |at| ms[at])
    };
    let (full, half) = (OcclusionResolution::Full, OcclusionResolution::Half);
    let entries: Vec<Value> = radii
        .iter()
        .zip(found)
        .map(|(radius, found)| {
            let mut entry = json!({ "radius_m": radius });
            for (name, quality) in QUALITIES {
                let of = |by: By| found.iter().find(|(other, _)| *other == by);
                let number = |by: By| of(by).map(|(_, errors)| errors.rmse());
                let bias = of(By::Ours(quality, full)).map(|(_, errors)| errors.bias());
                entry[name] = json!({
                    "full": number(By::Ours(quality, full)),
                    "half": number(By::Ours(quality, half)),
                    "bias": bias,
                    "bevy": number(By::Bevy(quality)),
                });
            }
            entry
        })
        .collect();
    let high = OcclusionQuality::High;
    let ratios = found[..RADII.len()]
        .iter()
        .map(|found| rmse_of(found, By::Ours(high, half)) / rmse_of(found, By::Ours(high, full)));
    let half_over_full = ratios.sum::<f64>() / RADII.len() as f64;
    let at_bevys = &found[RADII.len()];
    let mut taken = serde_json::Map::new();
    for (name, quality) in QUALITIES {
        let of = json!({
            "full_ms": time_of(By::Ours(quality, full)),
            "half_ms": time_of(By::Ours(quality, half)),
            "half_over_full": time_of(By::Ours(quality, half)) / time_of(By::Ours(quality, full)),
            "bevy_ms": time_of(By::Bevy(quality)),
        });
        taken.insert(name.into(), of);
    }
    for (radius, found) in radii.iter().zip(found) {
        for (by, errors) in found {
            report.rows.push(row(*by, *radius, errors, time_of(*by)));
        }
    }
    report.figures.push(figure(at_bevys, &time_of));
    report.notes.push(format!(
        "{RAYS} rays a pixel; the mean over the pixels that show something; times at {TIMED} m, Bevy's at {BEVYS_RADIUS} m"
    ));
    report.summary = json!({
        "radii": entries,
        "half_over_full": half_over_full,
        "half_time_over_full": time_of(By::Ours(high, half)) / time_of(By::Ours(high, full)),
        "bevy_over_ours": rmse_of(at_bevys, By::Bevy(high)) / rmse_of(at_bevys, By::Ours(high, full)),
        "times": taken,
    });
}

fn row(by: By, radius: f32, errors: &Errors, ms: f64) -> Row {
    Row {
        sweep: format!("radius {radius} m"),
        method: by.name().into(),
        parameter: by.quality_name().into(),
        parameter_value: radius.into(),
        quantity: "share of the light from everywhere".into(),
        error: Some(ErrorNumbers {
            max: errors.most(),
            rms: errors.rmse(),
            p99: errors.bias().abs(),
        }),
        error_unit: "share; p99 is the size of the mean error".into(),
        time_ns: Some(ms * 1e6),
        bytes: None,
        vertices: None,
        hash: None,
        device: String::new(),
    }
}

/// Error over time, a curve each for all pixels, a quarter of them, and Bevy's.
fn figure(found: &Found, time_of: &dyn Fn(By) -> f64) -> Figure {
    let mut curves: Vec<Curve> = Vec::new();
    for (by, errors) in found {
        let point = (time_of(*by).max(1e-3), errors.rmse());
        match curves.iter_mut().find(|curve| curve.name == by.name()) {
            Some(curve) => curve.points.push(point),
            None => curves.push(Curve {
                name: by.name().into(),
                colour: curves.len(),
                points: vec![point],
            }),
        }
    }
    Figure {
        name: "occlusion_time_error".into(),
        caption: format!(
            "Error of ambient occlusion of {BEVYS_RADIUS} m over its time, by quality from left to right"
        ),
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
    fn the_last_seed_has_scenes_too() {
        let from = |first| seeds(first, 3).collect::<Vec<u32>>();
        assert_eq!(from(7), [7, 8, 9]);
        assert_eq!(from(u32::MAX), [u32::MAX, 0, 1]);
    }

    #[test]
    fn a_small_frame_has_what_is_asked_for() {
        let options = Options {
            size: [64, 36],
            count: Some(1),
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
        // No occlusion at all would be off by as much as there is: a third of that is not found by looking elsewhere.
        for (k, most) in [(0, 0.1), (3, 0.2)] {
            for (name, _) in QUALITIES {
                let rmse = report.summary["radii"][k][name]["full"].as_f64();
                assert!(
                    rmse.is_some_and(|x| x > 0.0 && x < most),
                    "{name}: {rmse:?}"
                );
            }
        }
    }
}
