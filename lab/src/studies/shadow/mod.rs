//! Study `shadow`: pixels that a shadow map calls lit and rays call dark, and the other way round.
//!
//! Planes from 0.1 m to 10 km, lit at 0 to 89 degrees by a spot light with the settings that Bevy's lights come with;
//! something stands before each and something on it. A pixel is in shadow where it has less than half of the light that
//! it has without shadows. Pixels whose true edge is nearer than one and a half texels of the map are not counted. The
//! maps are Bevy's; Dolomite's lighting and Bevy's pass read the same ones.

mod receiver;

use bevy::prelude::*;
use bevy::render::renderer::RenderAdapterInfo;
use dolomite_deferred::{DeferredLighting, DeferredPlugin};
use dolomite_testkit::light::{self, Picture};
use serde_json::{Value, json};

use crate::csv::{ErrorNumbers, Row};
use crate::plot::{Axes, Chart, Curve};
use crate::study::{Asked, Figure, Options, Report, Study};
use receiver::{BAND, MAP, Receiver, Truth};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "shadow",
    about: "shadow maps of spot lights against rays, on planes of 0.1 m to 10 km lit at 0 to 89 degrees",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 5] = [
    Asked {
        what: "Receivers with a wrong pixel farther than 1.5 texels from the true edge",
        asked: "0",
        at: "/ours/receivers_wrong",
        unit: "",
    },
    Asked {
        what: "Pixels dark that rays call lit (acne), of all counted",
        asked: "0",
        at: "/ours/acne",
        unit: "",
    },
    Asked {
        what: "Pixels lit that rays call dark (gaps, leaks), of all counted",
        asked: "0",
        at: "/ours/leaks",
        unit: "",
    },
    Asked {
        what: "Receivers",
        asked: "200",
        at: "/receivers",
        unit: "",
    },
    Asked {
        what: "The same receivers by Bevy's pass: receivers with a wrong pixel",
        asked: "",
        at: "/bevy/receivers_wrong",
        unit: "",
    },
];

/// Receivers, where no `--count` says another number.
const RECEIVERS: usize = 200;

/// What one receiver came to.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    counted: usize,
    acne: usize,
    leaks: usize,
}

fn run(options: &Options) -> Report {
    let mut report = Report {
        study: STUDY.name,
        rows: Vec::new(),
        figures: Vec::new(),
        notes: Vec::new(),
        summary: Value::Null,
    };
    match light::app_with(|app| {
        app.add_plugins(DeferredPlugin);
    }) {
        Some(mut app) => measure(&mut app, options, &mut report),
        None => report
            .notes
            .push("no Vulkan device: nothing was measured".into()),
    }
    report
}

fn tally(with: &Picture, without: &Picture, truth: &[Truth]) -> Tally {
    let mut tally = Tally::default();
    let pixels = with.pixels.iter().zip(&without.pixels);
    for ((with, without), truth) in pixels.zip(truth) {
        let dark = with[0] < 0.5 * without[0];
        match truth {
            Truth::Any => continue,
            Truth::Lit => tally.acne += usize::from(dark),
            Truth::Dark => tally.leaks += usize::from(!dark),
        }
        tally.counted += 1;
    }
    tally
}

fn measure(app: &mut App, options: &Options, report: &mut Report) {
    let count = options.count.unwrap_or(RECEIVERS).max(1);
    let info = app.world().resource::<RenderAdapterInfo>();
    let device = format!("{} ({} {})", info.name, info.driver, info.driver_info);
    let mut all: Vec<(f64, f64, [Tally; 2])> = Vec::new();
    for k in 0..count {
        let receiver = Receiver::new(options.seed.into(), k, count, options.size);
        let truth = receiver.truth();
        let spawned = light::spawn(app, &receiver.scene, DeferredLighting::default());
        let shadows = |app: &mut App, on: bool| {
            let mut lamps = app.world_mut().query::<&mut SpotLight>();
            for mut lamp in lamps.iter_mut(app.world_mut()) {
                lamp.shadow_maps_enabled = on;
            }
        };
        shadows(app, false);
        let without = light::picture(app, spawned.camera, 4);
        shadows(app, true);
        let mut tallies = [Tally::default(); 2];
        for (own, result) in [true, false].into_iter().zip(&mut tallies) {
            let mut camera = app.world_mut().entity_mut(spawned.camera);
            if own {
                camera.insert(DeferredLighting::default());
            } else {
                camera.remove::<DeferredLighting>();
            }
            let with = light::picture(app, spawned.camera, 5);
            *result = tally(&with, &without, &truth);
        }
        if (k + 1) % 10 == 0 || k + 1 == count {
            eprintln!("receiver {} of {count}", k + 1);
        }
        all.push((receiver.incidence, receiver.size, tallies));
        app.world_mut().despawn(spawned.camera);
        for other in spawned.others {
            app.world_mut().despawn(other);
        }
    }
    for (by, name) in ["ours", "bevy"].iter().enumerate() {
        for (incidence, size, tallies) in &all {
            let tally = tallies[by];
            let share = (tally.acne + tally.leaks) as f64 / tally.counted.max(1) as f64;
            report.rows.push(Row {
                sweep: "incidence".into(),
                method: (*name).into(),
                parameter: format!("{size:.3} m"),
                parameter_value: *incidence,
                quantity: "share of wrong pixels".into(),
                error: Some(ErrorNumbers {
                    max: share,
                    rms: share,
                    p99: share,
                }),
                error_unit: "of 1".into(),
                time_ns: None,
                bytes: None,
                vertices: None,
                hash: None,
                device: device.clone(),
            });
        }
    }
    let told = |by: usize| {
        let sum =
            |pick: fn(&Tally) -> usize| all.iter().map(|(_, _, t)| pick(&t[by])).sum::<usize>();
        let wrong = |(_, _, t): &&(f64, f64, [Tally; 2])| t[by].acne + t[by].leaks > 0;
        let counted = sum(|t| t.counted).max(1) as f64;
        json!({
            "receivers_wrong": all.iter().filter(wrong).count(),
            "pixels": sum(|t| t.counted),
            "acne": sum(|t| t.acne) as f64 / counted,
            "leaks": sum(|t| t.leaks) as f64 / counted,
        })
    };
    report.figures.push(figure(&all));
    report.notes.push(format!(
        "{count} planes, {} x {} pixels each; a map of {MAP} texels, Bevy's biases and filter; a band of {BAND} texels at true edges is not counted",
        options.size[0], options.size[1]
    ));
    report.summary = json!({
        "seed": options.seed,
        "receivers": count,
        "device": device,
        "ours": told(0),
        "bevy": told(1),
    });
}

fn figure(all: &[(f64, f64, [Tally; 2])]) -> Figure {
    let share =
        |wrong: usize, tally: &Tally| (wrong as f64 / tally.counted.max(1) as f64).max(1e-5);
    let curve = |name: &str, colour, pick: fn(&Tally) -> usize| Curve {
        name: name.into(),
        colour,
        points: all
            .iter()
            .map(|(incidence, _, t)| (*incidence, share(pick(&t[0]), &t[0])))
            .collect(),
    };
    Figure {
        name: "shadow_by_incidence".into(),
        caption: "Share of pixels that the shadow map has wrong beyond the band, by the angle between the light and the plane's normal; 1e-5 stands for none".into(),
        chart: Chart {
            title: "Shadow maps against rays".into(),
            x_label: "degrees".into(),
            y_label: "share of pixels".into(),
            axes: Axes::Logarithmic,
            curves: vec![
                curve("acne", 0, |t| t.acne),
                curve("leaks", 1, |t| t.leaks),
            ],
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gpu_a_small_run_has_what_is_asked_for() {
        let options = Options {
            size: [48, 27],
            count: Some(3),
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
        // Most of a plane is far from an edge, and of that most is right.
        assert!(report.summary["ours"]["pixels"].as_u64() > Some(300));
        for by in ["ours", "bevy"] {
            let wrong = |what: &str| report.summary[by][what].as_f64().expect("a number");
            assert!(wrong("acne") + wrong("leaks") < 0.2, "{}", report.summary);
        }
    }

    #[test]
    fn a_picture_without_shadows_is_all_leaks() {
        let receiver = Receiver::new(1, 0, 4, [64, 36]);
        let truth = receiver.truth();
        let lit = Picture {
            width: 64,
            pixels: vec![[1.0; 4]; truth.len()],
        };
        let black = Picture {
            width: 64,
            pixels: vec![[0.0; 4]; truth.len()],
        };
        let dark = truth.iter().filter(|t| **t == Truth::Dark).count();
        let bright = truth.iter().filter(|t| **t == Truth::Lit).count();
        assert!(dark > 10 && bright > 100, "{dark} {bright}");
        let none = tally(&lit, &lit, &truth);
        assert_eq!((none.leaks, none.acne), (dark, 0));
        let all = tally(&black, &lit, &truth);
        assert_eq!((all.leaks, all.acne), (0, bright));
    }
}
