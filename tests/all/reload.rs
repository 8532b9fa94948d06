//! Scenes and their maps that change while the game runs, without renderer and window.

use std::time::Duration;

use bevy::math::DVec2;
use bevy::prelude::*;
use dolomite::terrain::{Ground, Terrain};
use dolomite_game::play::Landscape;
use dolomite_game::scene::reload::{SceneFault, reload_changed};

use crate::headless::{FEET, figure, game, terrain};

#[test]
fn a_broken_scene_keeps_the_last_good_one_and_a_mended_one_is_taken_over() {
    let folder = std::env::temp_dir().join(format!("dolomite-reload-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the temporary folder can be written");
    let file = folder.join("scene.ron");
    let hill = |height: f32, more: &str| {
        let text = format!(
            "(extent: ((-99.0, -99.0), (99.0, 99.0)), layers: [(source: Hill(centre: (0.0, 0.0), \
             radius: 90.0, height: {height:.1}))]{more})"
        );
        std::fs::write(&file, text).expect("the scene can be written");
    };
    // File systems may keep times as coarse as a few milliseconds.
    let wait = || std::thread::sleep(Duration::from_millis(30));
    hill(20.0, "");
    let mut app = game(&file.to_string_lossy());
    let top = |app: &mut App| {
        let world = app.world_mut();
        world
            .query_filtered::<&Terrain, With<Landscape>>()
            .single(world)
            .expect("there is one landscape")
            .height(DVec2::ZERO)
    };
    let reload = |app: &mut App| {
        app.world_mut()
            .run_system_cached(reload_changed)
            .expect("the system runs");
        app.update();
    };
    assert_eq!(top(&mut app), 20.0);

    wait();
    hill(50.0, ", nonsense: 1");
    reload(&mut app);
    assert_eq!(top(&mut app), 20.0);
    let fault = app
        .world()
        .resource::<SceneFault>()
        .0
        .clone()
        .expect("the fault is told");
    assert!(
        fault.contains("nonsense") && fault.contains("scene.ron"),
        "{fault}"
    );

    wait();
    hill(50.0, "");
    reload(&mut app);
    assert_eq!(top(&mut app), 50.0);
    assert_eq!(app.world().resource::<SceneFault>().0, None);
    // The figure was set back on the new ground.
    app.update();
    let feet = figure(&mut app).1.translation.as_dvec3();
    let ground = terrain(&mut app).height(feet.xz());
    assert!((ground - feet.y).abs() <= FEET);
    std::fs::remove_dir_all(&folder).expect("the temporary folder can be removed");
}

#[test]
fn a_map_that_is_missing_is_waited_for() {
    let folder = std::env::temp_dir().join(format!("dolomite-map-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the temporary folder can be written");
    let file = folder.join("scene.ron");
    let hill = "(source: Hill(centre: (0.0, 0.0), radius: 90.0, height: 20.0))";
    let map = "(source: Map(path: \"late.f32\", format: Raw(format: F32, width: 2, height: 2), \
               scale: 1.0, offset: 0.0, spacing: (200.0, 200.0)))";
    let save = |layers: &str| {
        let text = format!("(extent: ((-99.0, -99.0), (99.0, 99.0)), layers: [{layers}])");
        std::fs::write(&file, text).expect("the scene can be written");
    };
    let wait = || std::thread::sleep(Duration::from_millis(30));
    save(hill);
    let mut app = game(&file.to_string_lossy());
    let reload = |app: &mut App| {
        app.world_mut()
            .run_system_cached(reload_changed)
            .expect("the system runs");
        app.update();
        app.world().resource::<SceneFault>().0.clone()
    };
    assert_eq!(reload(&mut app), None);

    wait();
    save(&format!("{hill}, {map}"));
    let fault = reload(&mut app).expect("the map is missing");
    assert!(fault.contains("late.f32"), "{fault}");
    assert_eq!(reload(&mut app), Some(fault), "nothing has changed");

    // The map appears; the scene is not touched.
    let samples: Vec<u8> = [7.0_f32; 4].iter().flat_map(|s| s.to_le_bytes()).collect();
    std::fs::write(folder.join("late.f32"), samples).expect("the map can be written");
    assert_eq!(reload(&mut app), None);
    assert_eq!(terrain(&mut app).height(DVec2::ZERO), 27.0);

    // Away for a moment, as a file is that is being written: what is there stays.
    std::fs::remove_file(folder.join("late.f32")).expect("it is there");
    assert_eq!(reload(&mut app), None);
    std::fs::remove_dir_all(&folder).expect("the temporary folder can be removed");
}

#[test]
fn a_map_that_has_another_name_now_is_taken_over() {
    let folder = std::env::temp_dir().join(format!("dolomite-renamed-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the temporary folder can be written");
    let file = folder.join("scene.ron");
    let save = |map: &str, offset: f32| {
        let text = format!(
            "(extent: ((-99.0, -99.0), (99.0, 99.0)), layers: [(source: Map(path: \"{map}\", \
             format: Raw(format: F32, width: 2, height: 2), scale: 1.0, offset: {offset:.1}, \
             spacing: (200.0, 200.0)))])"
        );
        std::fs::write(&file, text).expect("the scene can be written");
    };
    let wait = || std::thread::sleep(Duration::from_millis(30));
    let (old, new) = (folder.join("old.f32"), folder.join("new.f32"));
    let samples: Vec<u8> = [7.0_f32; 4].iter().flat_map(|s| s.to_le_bytes()).collect();
    std::fs::write(&old, samples).expect("the map can be written");
    save("old.f32", 0.0);
    let mut app = game(&file.to_string_lossy());
    let reload = |app: &mut App| {
        app.world_mut()
            .run_system_cached(reload_changed)
            .expect("the system runs");
        app.update();
        app.world().resource::<SceneFault>().0.clone()
    };
    assert_eq!(terrain(&mut app).height(DVec2::ZERO), 7.0);

    // Alone it could be a map that is being written.
    std::fs::rename(&old, &new).expect("it is there");
    assert_eq!(reload(&mut app), None);
    assert_eq!(terrain(&mut app).height(DVec2::ZERO), 7.0);

    // The scene changes and names what is gone: that is a fault, and it is told.
    wait();
    save("old.f32", 2.0);
    let fault = reload(&mut app).expect("the map is missing");
    assert!(fault.contains("old.f32"), "{fault}");

    wait();
    save("new.f32", 1.0);
    assert_eq!(reload(&mut app), None);
    assert_eq!(terrain(&mut app).height(DVec2::ZERO), 8.0);

    // At once, between two looks at the files.
    wait();
    std::fs::rename(&new, &old).expect("it is there");
    save("old.f32", 3.0);
    assert_eq!(reload(&mut app), None);
    assert_eq!(terrain(&mut app).height(DVec2::ZERO), 10.0);
    std::fs::remove_dir_all(&folder).expect("the temporary folder can be removed");
}
