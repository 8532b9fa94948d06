//! What pictures are drawn with: what is off costs no pass, and a scaled scene below a sharp panel.

use crate::support::adapter;

use std::collections::BTreeSet;

use bevy::diagnostic::DiagnosticsStore;
use bevy::math::UVec2;
use dolomite::deferred::DeferredStats;
use dolomite::ground::GroundShading;
use dolomite_game::run::Setup;
use dolomite_game::run::offscreen::{Offscreen, STEP};
use dolomite_game::scene::{MapOptions, SceneRequest};
use dolomite_game::settings::quality::{AntiAliasing, Occlusion};
use dolomite_game::settings::{Renderer, Settings};
use dolomite_game::view::passes::{Clock, pass_of};
use dolomite_game::view::scaled::PictureSize;
use image::RgbImage;

fn offscreen(settings: Settings, size: UVec2, panels: bool) -> Option<Offscreen> {
    if !adapter::is_there() {
        return None;
    }
    let request = SceneRequest {
        scene: "mountain".to_owned(),
        map: MapOptions::default(),
        detail: None,
        lights: None,
        named: Vec::new(),
    };
    let mut setup = Setup::load(settings, request, None).expect("the scene is there");
    setup.panels = panels;
    let mut offscreen = Offscreen::new(setup, size).expect("it starts");
    offscreen.settle().expect("it settles");
    Some(offscreen)
}

fn change(offscreen: &mut Offscreen, change: impl FnOnce(&mut Settings)) {
    change(&mut offscreen.app.world_mut().resource_mut::<Settings>());
    offscreen.settle().expect("it settles again");
}

/// The passes that run in the next frames.
fn running(offscreen: &mut Offscreen) -> BTreeSet<String> {
    // Times come two or three frames late.
    let step = |offscreen: &mut Offscreen, frames: u32| {
        for _ in 0..frames {
            offscreen.step(STEP).expect("it draws");
        }
    };
    step(offscreen, 5);
    let before = bevy::platform::time::Instant::now();
    step(offscreen, 5);
    let store = offscreen.app.world().resource::<DiagnosticsStore>();
    let new = store.iter().filter(|diagnostic| {
        diagnostic
            .measurement()
            .is_some_and(|newest| newest.time > before)
    });
    new.filter_map(|diagnostic| Some(pass_of(diagnostic, Clock::Cpu)?.to_owned()))
        .collect()
}

#[test]
fn gpu_what_is_off_costs_no_pass() {
    let settings = Settings {
        renderer: Renderer::Bevy,
        ..Settings::default()
    };
    let Some(mut offscreen) = offscreen(settings, UVec2::new(96, 54), false) else {
        return;
    };
    let any = |passes: &BTreeSet<String>, part: &str| passes.iter().any(|pass| pass.contains(part));
    let all = running(&mut offscreen);
    println!("all on: {all:?}");
    for part in ["bloom", "smaa", "shadow", "geometry_gbuffer", "tonemapping"] {
        assert!(any(&all, part), "{part} is not among {all:?}");
    }
    change(&mut offscreen, |settings| {
        settings.bloom = Some(false);
        settings.anti_aliasing = Some(AntiAliasing::Off);
        settings.shadow_cascades = Some(0);
    });
    let few = running(&mut offscreen);
    println!("off: {few:?}");
    for part in ["bloom", "smaa", "fxaa", "shadow"] {
        assert!(!any(&few, part), "{part} is among {few:?}");
    }
    assert!(any(&few, "geometry_gbuffer"), "{few:?}");
    assert!(few.is_subset(&all), "nothing comes in their place");
    change(&mut offscreen, |settings| {
        settings.anti_aliasing = Some(AntiAliasing::Fxaa);
        settings.shadow_cascades = Some(2);
    });
    let some = running(&mut offscreen);
    assert!(
        any(&some, "fxaa") && any(&some, "shadow") && !any(&some, "smaa"),
        "{some:?}"
    );
    // Light from everywhere is blocked in Dolomite's light alone, and by a pass that goes with the setting.
    change(&mut offscreen, |settings| {
        settings.renderer = Renderer::Dolomite;
        settings.occlusion = Some(Occlusion::Full);
    });
    assert!(any(&running(&mut offscreen), "deferred_occlusion"));
    let bytes = |offscreen: &Offscreen| {
        let stats = offscreen.app.world().resource::<DeferredStats>();
        stats.views().iter().map(|view| view.bytes).sum::<u64>()
    };
    let with = bytes(&offscreen);
    change(&mut offscreen, |settings| {
        settings.occlusion = Some(Occlusion::Off);
    });
    assert!(!any(&running(&mut offscreen), "deferred_occlusion"));
    // Twelve bytes a pixel, and the settings.
    assert_eq!(with - bytes(&offscreen), 96 * 54 * 12 + 32);
    assert!(!any(&some, "deferred_occlusion"), "in Bevy's light");
    let shading = |offscreen: &mut Offscreen| -> Vec<GroundShading> {
        let world = offscreen.app.world_mut();
        world
            .query::<&GroundShading>()
            .iter(world)
            .copied()
            .collect()
    };
    assert_eq!(shading(&mut offscreen), [GroundShading::Fine]);
    change(&mut offscreen, |settings| {
        settings.shading = Some(GroundShading::Balanced);
    });
    assert_eq!(shading(&mut offscreen), [GroundShading::Balanced]);
}

/// Neighbours in a row that differ as much as the edges of letters do.
fn edges(picture: &RgbImage) -> usize {
    let light = |x, y| i32::from(picture.get_pixel(x, y).0[1]);
    let pairs = (0..picture.height()).flat_map(|y| (1..picture.width()).map(move |x| (x, y)));
    pairs
        .filter(|&(x, y)| (light(x, y) - light(x - 1, y)).abs() > 90)
        .count()
}

#[test]
fn gpu_a_scaled_scene_has_a_sharp_panel_and_the_asked_size() {
    let size = UVec2::new(320, 180);
    let Some(mut offscreen) = offscreen(Settings::default(), size, true) else {
        return;
    };
    let sizes = |offscreen: &Offscreen| *offscreen.app.world().resource::<PictureSize>();
    let whole = offscreen.capture().expect("a picture");
    assert_eq!(sizes(&offscreen).drawn, size);
    let cameras = |offscreen: &mut Offscreen| {
        let world = offscreen.app.world_mut();
        world.query::<&bevy::camera::Camera>().iter(world).count()
    };
    let alone = cameras(&mut offscreen);
    change(&mut offscreen, |settings| settings.resolution = Some(0.5));
    assert_eq!(sizes(&offscreen).drawn, size / 2);
    assert_eq!(cameras(&mut offscreen), alone + 1);
    let scaled = offscreen.capture().expect("a picture");
    assert_eq!(scaled.dimensions(), (size.x, size.y));
    let (sharp, still_sharp) = (edges(&whole), edges(&scaled));
    println!("edges of letters: {sharp}, scaled {still_sharp}");
    assert!(sharp > 300, "there is no text");
    // The scene itself has some such edges, and figures in the panel change.
    assert!(
        still_sharp as f64 > 0.75 * sharp as f64,
        "the panel is blurred"
    );
    // A panel that is drawn with the scene and enlarged is found out.
    let small = image::imageops::resize(&whole, 160, 90, image::imageops::FilterType::Triangle);
    let blurred = image::imageops::resize(&small, 320, 180, image::imageops::FilterType::Triangle);
    assert!((edges(&blurred) as f64) < 0.5 * sharp as f64);
    for (name, picture) in [("whole", &whole), ("scaled", &scaled)] {
        let file =
            std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("quality-{name}.png"));
        picture.save(file).expect("it can be written");
    }
    // And back: as many pixels as the display has, through the same picture.
    change(&mut offscreen, |settings| settings.resolution = Some(1.0));
    assert_eq!(
        (sizes(&offscreen).drawn, cameras(&mut offscreen)),
        (size, alone + 1)
    );
    let back = offscreen.capture().expect("a picture");
    assert!(edges(&back) as f64 > 0.75 * sharp as f64);
}

#[test]
fn gpu_pictures_of_one_pixel_and_of_the_greatest_width_are_scaled() {
    for (size, resolution, drawn) in [
        (UVec2::new(1, 1), 0.25, UVec2::new(1, 1)),
        (UVec2::new(3, 2), 0.25, UVec2::new(1, 1)),
        (UVec2::new(4096, 1), 0.5, UVec2::new(2048, 1)),
    ] {
        let settings = Settings {
            resolution: Some(resolution),
            ..Settings::default()
        };
        let Some(mut offscreen) = offscreen(settings, size, false) else {
            return;
        };
        assert_eq!(offscreen.app.world().resource::<PictureSize>().drawn, drawn);
        let picture = offscreen.capture().expect("a picture");
        assert_eq!(picture.dimensions(), (size.x, size.y));
    }
}
