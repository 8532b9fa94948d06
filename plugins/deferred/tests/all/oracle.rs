//! Frames against the ray caster in f64, which knows nothing of our shaders.

use bevy::prelude::*;
use dolomite_deferred::render::DitheredGBufferPlugin;
use dolomite_deferred::{BlinnPhongPlugin, DeferredPlugin};
use dolomite_light_oracle::ledger::Ledger;
use dolomite_light_oracle::model::SplitSum;
use dolomite_light_oracle::shade::{Lights, shade};
use dolomite_light_oracle::{Image, Options, Recipe, generate, render};
use dolomite_testkit::light::{self as support, GBufferPlugin, WAYS};

/// Radiance below which a pixel counts as dark: a thousandth of a cd/m², where white is 1.
const FLOOR: f64 = 1e-3;

fn app() -> Option<App> {
    support::app_with(|app| {
        app.add_plugins((DeferredPlugin, BlinnPhongPlugin, GBufferPlugin));
    })
}

#[test]
fn a_dithered_gbuffer_is_nearer_to_the_truth() {
    let rays = Options {
        shadows: false,
        ..Options::default()
    };
    let scenes = std::env::var("DOLOMITE_SCENES").map_or(2, |n| n.parse().expect("a number"));
    let mut flips = [Vec::new(), Vec::new()];
    for (dithered, flips) in flips.iter_mut().enumerate() {
        let app = support::app_with(|app| {
            app.add_plugins((DeferredPlugin, BlinnPhongPlugin));
            if dithered == 1 {
                app.add_plugins(DitheredGBufferPlugin);
            }
        });
        let Some(mut app) = app else { return };
        for seed in 1..=scenes {
            let recipe = Recipe {
                seed,
                blinn_phong: 0.3,
                width: 160,
                height: 90,
                ..Recipe::default()
            };
            let scene = generate(&recipe);
            let spawned = support::spawn(&mut app, &scene, ());
            let picture = support::lit_by(&mut app, spawned.camera, Some(WAYS[1]));
            let frame = Image::from_rgba(160, 90, &picture.pixels).expect("an image");
            let ledger = Ledger::new(&frame, &render(&scene, &rays), FLOOR).expect("of one size");
            assert_eq!(ledger.not_finite, 0, "seed {seed}");
            flips.push(ledger.ldr_flip_mean);
            app.world_mut().despawn(spawned.camera);
            for other in spawned.others {
                app.world_mut().despawn(other);
            }
        }
    }
    let [plain, dithered] = flips.map(|flips| {
        let most = flips.iter().copied().fold(0.0, f64::max);
        (flips.iter().sum::<f64>() / flips.len() as f64, most)
    });
    eprintln!("{scenes} scenes, mean and worst LDR-FLIP: {plain:.5?}, dithered {dithered:.5?}");
    assert!(dithered.0 < 0.6 * plain.0, "{plain:?} {dithered:?}");
    assert!(dithered.1 <= 0.01, "{dithered:?}");
}

#[test]
fn frames_are_those_of_the_oracle() {
    let Some(mut app) = app() else {
        return;
    };
    let scenes = std::env::var("DOLOMITE_SCENES").map_or(2, |n| n.parse().expect("a number"));
    let [mut flip, mut p50, mut p999, mut max] = [0.0_f64; 4];
    let mut mean_flip = 0.0;
    for seed in 1..=scenes {
        let recipe = Recipe {
            seed,
            blinn_phong: 0.3,
            width: 160,
            height: 90,
            ..Recipe::default()
        };
        let scene = generate(&recipe);
        let rays = Options {
            shadows: false,
            ..Options::default()
        };
        let truth = render(&scene, &rays);
        let spawned = support::spawn(&mut app, &scene, ());
        let camera = &scene.camera;
        let lights = Lights::new(
            &scene.lamps,
            &scene.ambient,
            camera.exposure,
            SplitSum::Karis,
        );
        let mut first = None;
        for way in WAYS {
            let picture = support::lit_by(&mut app, spawned.camera, Some(way));
            // The ways differ by nothing that FLIP could see.
            if let Some(first) = &first {
                let apart = picture.relative_difference(first, 1e-3);
                assert!(apart <= 1e-5, "seed {seed} {way:?}: {apart}");
                continue;
            }
            support::keep(&picture, 1.0, &format!("oracle-{seed}"));
            let frame = Image::from_rgba(picture.width, camera.height, &picture.pixels);
            let frame = frame.expect("an image");
            let whole = Ledger::new(&frame, &truth, FLOOR).expect("of one size");
            // The oracle fed what the G-buffer holds: what is left is arithmetic.
            let texels = support::decoded(&support::pixels(&app), camera);
            let fed = shade(
                &lights,
                camera.width,
                camera.height,
                scene.background,
                &texels,
            );
            let arithmetic =
                Ledger::new(&frame, &fed.expect("an image"), FLOOR).expect("of one size");
            eprintln!(
                "seed {seed}: mean LDR-FLIP {:.5}, missed {} of {}, p50 {:.2e} p99.9 {:.2e}; arithmetic p50 {:.2e} p99.9 {:.2e} max {:.2e}",
                whole.ldr_flip_mean,
                whole.missed,
                whole.lit,
                whole.p50,
                whole.p999,
                arithmetic.p50,
                arithmetic.p999,
                arithmetic.max
            );
            assert_eq!(
                whole.not_finite + arithmetic.not_finite,
                0,
                "seed {seed} {way:?}"
            );
            mean_flip += whole.ldr_flip_mean / scenes as f64;
            flip = flip.max(whole.ldr_flip_mean);
            p50 = p50.max(arithmetic.p50);
            p999 = p999.max(arithmetic.p999);
            max = max.max(arithmetic.max);
            first = Some(picture);
        }
        app.world_mut().despawn(spawned.camera);
        for other in spawned.others {
            app.world_mut().despawn(other);
        }
    }
    eprintln!(
        "{scenes} scenes: mean LDR-FLIP {mean_flip:.5}, of the worst {flip:.5}; arithmetic, worst scene: p50 {p50:.2e} p99.9 {p999:.2e} max {max:.2e}"
    );
    // What FLIP sees is packing, in Bevy's format of 8 bits a channel.
    assert!(mean_flip <= 0.01 && flip <= 0.02, "{mean_flip} {flip}");
    assert!(p999 <= 1e-5, "{p999}");
}

#[test]
fn phongs_lobe_is_that_of_the_oracle() {
    let Some(mut app) = app() else {
        return;
    };
    let recipe = Recipe {
        seed: 5,
        blinn_phong: 0.9,
        phong: 1.0,
        width: 96,
        height: 54,
        ..Recipe::default()
    };
    let scene = generate(&recipe);
    let spawned = support::spawn(&mut app, &scene, ());
    let picture = support::lit_by(&mut app, spawned.camera, Some(WAYS[0]));
    let camera = &scene.camera;
    let texels = support::decoded(&support::pixels(&app), camera);
    let lights = Lights::new(
        &scene.lamps,
        &scene.ambient,
        camera.exposure,
        SplitSum::Karis,
    );
    let fed = shade(&lights, 96, 54, scene.background, &texels).expect("an image");
    let frame = Image::from_rgba(96, 54, &picture.pixels).expect("an image");
    let ledger = Ledger::new(&frame, &fed, FLOOR).expect("of one size");
    eprintln!(
        "p50 {:.2e} p99.9 {:.2e} max {:.2e}",
        ledger.p50, ledger.p999, ledger.max
    );
    assert!(ledger.p999 <= 1e-5 && ledger.not_finite == 0, "{ledger:?}");
    // The same G-buffer read as Blinn's is another picture.
    let mut blinns = texels;
    for texel in blinns.iter_mut().flatten() {
        if let dolomite_light_oracle::scene::Material::BlinnPhong(material) = &mut texel.material {
            material.lobe = dolomite_light_oracle::scene::Lobe::Blinn;
        }
    }
    let other = shade(&lights, 96, 54, scene.background, &blinns).expect("an image");
    let ledger = Ledger::new(&frame, &other, FLOOR).expect("of one size");
    assert!(ledger.p999 > 0.01, "{ledger:?}");
}

#[test]
fn a_wrong_frame_is_seen() {
    let scene = generate(&Recipe {
        width: 32,
        height: 18,
        ..Recipe::default()
    });
    let options = Options {
        shadows: false,
        ..Options::default()
    };
    let truth = render(&scene, &options);
    let mut dimmer = scene.clone();
    for lamp in &mut dimmer.lamps {
        lamp.power *= 0.9;
    }
    let ledger = Ledger::new(&render(&dimmer, &options), &truth, FLOOR).expect("of one size");
    assert!(
        ledger.p999 > 0.05 && ledger.ldr_flip_mean > 0.01,
        "{ledger:?}"
    );
}
