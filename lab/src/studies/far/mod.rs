//! Study `far`: the same frame far from the origin.
//!
//! A scene is shifted as a whole by 0, 10⁴, 10⁶ and 10⁹ m and drawn by Dolomite's lighting and by Bevy's. All places
//! are put on the grid that f32 has there first, in the unshifted frame too, so that both are the same scene. What is
//! left has two parts. Bevy's meshes are placed in world coordinates of f32, so that the G-buffer itself changes;
//! `gbuffer` is the share of pixels where it does. Where it does not, the rest is lighting: `same` counts pixels of
//! an unchanged G-buffer that are off by more than 1/255, and `arithmetic` is the error against the oracle fed the
//! G-buffer, which knows all places in f64.

use bevy::math::DVec3;
use bevy::prelude::App;
use dolomite_deferred::{BlinnPhongPlugin, DeferredPlugin, Way};
use dolomite_light_oracle::ledger::Ledger;
use dolomite_light_oracle::model::SplitSum;
use dolomite_light_oracle::scene::LampKind;
use dolomite_light_oracle::shade::{Lights, shade};
use dolomite_light_oracle::{Image, Recipe, Scene, generate};
use dolomite_testkit::light::{self, GBufferPlugin, Pixel};
use serde_json::{Value, json};

use crate::csv::{ErrorNumbers, Row};
use crate::studies::light::way::{self, Lit};
use crate::study::{Asked, Options, Report, Study};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "far",
    about: "the same lit frame 0, 10 km, 1 000 km and 10^6 km from the origin, by Dolomite's lighting and by Bevy's",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 5] = [
    Asked {
        what: "Shifted by 10⁶ m: pixels off by more than 1/255 where the G-buffer is the same",
        asked: "0",
        at: "/shifts/2/tiled/same",
        unit: "",
    },
    Asked {
        what: "The same by Bevy's pass",
        asked: "",
        at: "/shifts/2/bevy/same",
        unit: "",
    },
    Asked {
        what: "Shifted by 10⁶ m: share of pixels whose G-buffer Bevy's meshes change",
        asked: "",
        at: "/shifts/2/gbuffer",
        unit: "",
    },
    Asked {
        what: "Shifted by 10⁶ m: arithmetic, p99.9 relative error",
        asked: "≤ 1e-5",
        at: "/shifts/2/tiled/arithmetic_p999",
        unit: "",
    },
    Asked {
        what: "The same by Bevy's pass",
        asked: "",
        at: "/shifts/2/bevy/arithmetic_p999",
        unit: "",
    },
];

/// Metres along x and along z.
const SHIFTS: [f64; 4] = [0.0, 1e4, 1e6, 1e9];

/// Radiance below which a pixel counts as dark.
const FLOOR: f64 = 1e-3;

/// Who lights.
const LITS: [Lit; 2] = [Lit::Ours(Way::Tiled), Lit::Bevy];

fn run(options: &Options) -> Report {
    let mut report = Report {
        study: STUDY.name,
        rows: Vec::new(),
        figures: Vec::new(),
        notes: Vec::new(),
        summary: Value::Null,
    };
    let app = light::app_with(|app| {
        app.add_plugins((DeferredPlugin, BlinnPhongPlugin, GBufferPlugin));
    });
    match app {
        Some(mut app) => measure(&mut app, options, &mut report),
        None => report
            .notes
            .push("no Vulkan device: nothing was measured".into()),
    }
    report
}

/// The distance of two f32 that far out, with room for the scene.
fn grid(shift: f64) -> f64 {
    let far = (shift + 32.0) as f32;
    f64::from(f32::from_bits(far.to_bits() + 1) - far)
}

/// The scene with all places on a grid, shifted.
fn shifted(scene: &Scene, grid: f64, shift: f64) -> Scene {
    let place = |p: DVec3| (p / grid).round() * grid + DVec3::new(shift, 0.0, shift);
    let mut scene = scene.clone();
    for object in &mut scene.objects {
        object.pose.translation = place(object.pose.translation);
    }
    for lamp in &mut scene.lamps {
        match &mut lamp.kind {
            LampKind::Point { position, .. } | LampKind::Spot { position, .. } => {
                *position = place(*position);
            }
            LampKind::Directional { .. } => {}
        }
    }
    scene.camera.position = place(scene.camera.position);
    scene
}

/// A drawn scene.
struct Drawn {
    /// By each of [`LITS`].
    frames: Vec<Vec<[f32; 4]>>,
    gbuffer: Vec<Pixel>,
}

fn draw(app: &mut App, scene: &Scene) -> Drawn {
    let spawned = light::spawn(app, scene, ());
    let mut frames = Vec::new();
    for lit in LITS {
        frames.push(way::frame(app, spawned.camera, lit).pixels);
    }
    let gbuffer = light::pixels(app);
    way::despawn(app, spawned);
    Drawn { frames, gbuffer }
}

/// Whether two pixels hold another surface; depths may be rounded differently.
fn differ(a: &Pixel, b: &Pixel) -> bool {
    a.words != b.words || a.id != b.id || (a.depth - b.depth).abs() > 1e-5 * a.depth.max(b.depth)
}

/// Pixels of which a channel, cut to `0..=1`, is off by more than 1/255, among those that `counts` takes.
fn off(a: &[[f32; 4]], b: &[[f32; 4]], counts: impl Fn(usize) -> bool) -> usize {
    let cut = |c: f32| {
        if c.is_finite() {
            c.clamp(0.0, 1.0)
        } else {
            9.0
        }
    };
    let differ = |(a, b): (&[f32; 4], &[f32; 4])| {
        a.iter()
            .zip(b)
            .take(3)
            .any(|(a, b)| (cut(*a) - cut(*b)).abs() > 1.0 / 255.0)
    };
    let pixels = a.iter().zip(b).enumerate();
    pixels
        .filter(|(index, pair)| counts(*index) && differ(*pair))
        .count()
}

fn measure(app: &mut App, options: &Options, report: &mut Report) {
    let [width, height] = options.size;
    let scene = generate(&Recipe {
        seed: options.seed.into(),
        lights: options.lights,
        width,
        height,
        ..Recipe::default()
    });
    let mut shifts = Vec::new();
    for shift in SHIFTS {
        let grid = grid(shift);
        let near = draw(app, &shifted(&scene, grid, 0.0));
        let there = shifted(&scene, grid, shift);
        let far = draw(app, &there);
        let changed = |index: usize| match (near.gbuffer.get(index), far.gbuffer.get(index)) {
            (Some(a), Some(b)) => differ(a, b),
            _ => true,
        };
        let pixels = far.gbuffer.len();
        let share =
            (0..pixels).filter(|index| changed(*index)).count() as f64 / pixels.max(1) as f64;
        let lights = Lights::new(
            &there.lamps,
            &there.ambient,
            there.camera.exposure,
            SplitSum::Karis,
        );
        let texels = light::decoded(&far.gbuffer, &there.camera);
        let Ok(fed) = shade(&lights, width, height, there.background, &texels) else {
            report.notes.push("a target without pixels".into());
            return;
        };
        let mut entry = json!({ "shift_m": shift, "grid_m": grid, "gbuffer": share });
        for ((lit, a), b) in LITS.iter().zip(&near.frames).zip(&far.frames) {
            let ledger = Image::from_rgba(width, height, b)
                .and_then(|frame| Ledger::new(&frame, &fed, FLOOR));
            let Ok(ledger) = ledger else {
                report.notes.push(format!("{}: no frame", lit.name()));
                continue;
            };
            entry[lit.name()] = json!({
                "off": off(a, b, |_| true),
                "same": off(a, b, |index| !changed(index)),
                "arithmetic_p50": ledger.p50,
                "arithmetic_p999": ledger.p999,
                "nan": ledger.not_finite,
            });
            report.rows.push(row(*lit, shift, &ledger));
        }
        eprintln!("{entry}");
        shifts.push(entry);
    }
    report.notes.push("grid_m is the distance of neighbouring f32; at 10⁹ m it is 64 m, so that all bodies stand on few places".into());
    report.summary = json!({
        "seed": options.seed,
        "size": options.size,
        "lights": options.lights,
        "shifts": shifts,
    });
}

fn row(lit: Lit, shift: f64, ledger: &Ledger) -> Row {
    Row {
        sweep: "shift".into(),
        method: lit.name().into(),
        parameter: format!("{shift:e} m"),
        parameter_value: shift,
        quantity: "radiance, fed the G-buffer; rms is the median".into(),
        error: Some(ErrorNumbers {
            max: ledger.max,
            rms: ledger.p50,
            p99: ledger.p999,
        }),
        error_unit: "relative, p99 is p99.9".into(),
        time_ns: None,
        bytes: None,
        vertices: None,
        hash: None,
        device: String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shifted_places_are_numbers_of_f32() {
        let scene = generate(&Recipe::default());
        for shift in SHIFTS {
            let there = shifted(&scene, grid(shift), shift);
            for p in there.objects.iter().map(|object| object.pose.translation) {
                assert_eq!(p.as_vec3().as_dvec3(), p, "{shift}");
            }
        }
        assert_eq!([1e6, 1e9].map(grid), [0.0625, 64.0]);
    }

    #[test]
    fn a_small_frame_is_the_same_a_thousand_kilometres_away() {
        let options = Options {
            size: [48, 27],
            lights: 5,
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
        for (k, shift) in SHIFTS.iter().enumerate().take(3) {
            let ours = &report.summary["shifts"][k]["tiled"];
            assert_eq!(
                (&ours["same"], &ours["nan"]),
                (&json!(0), &json!(0)),
                "{shift}"
            );
            let p999 = ours["arithmetic_p999"].as_f64();
            assert!(p999.is_some_and(|x| x <= 1e-5), "{shift}: {p999:?}");
        }
    }

    #[test]
    fn pixels_are_counted_by_what_is_seen() {
        let [a, b] = [[0.5, 2.0, 0.0, 1.0], [0.5, 3.0, 0.01, 1.0]];
        assert_eq!(off(&[a, a], &[b, a], |_| true), 1);
        assert_eq!(off(&[a, a], &[b, a], |index| index == 1), 0);
        assert_eq!(off(&[a], &[[f32::NAN; 4]], |_| true), 1);
    }
}
