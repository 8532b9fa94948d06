//! The figure among boulders, blocks, lifts and stones, without a renderer.

use std::path::Path;
use std::time::Duration;

use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_rapier3d::prelude::RapierContextSimulation;
use dolomite::DolomiteMinimalPlugins;
use dolomite::collision::rapier::BridgeCounters;
use dolomite::collision::{BetweenSteps, CharacterBody};
use dolomite_game::input::PlayerInput;
use dolomite_game::play::SimulationPlugin;
use dolomite_game::play::figure::Figure;
use dolomite_game::play::jump::Jump;
use dolomite_game::play::things::{Lift, Solid};
use dolomite_game::scene::things::Thing;
use dolomite_game::scene::{self, CurrentScene, SceneRequest};
use dolomite_game::settings::paths::AssetsDir;

/// Level ground of height 0, the figure at the origin, the camera looking north.
fn game(name: &str, things: &str) -> App {
    let folder =
        std::env::temp_dir().join(format!("dolomite-things-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the temporary folder can be written");
    let path = folder.join("level.ron");
    let text = format!(
        "(extent: ((-100.0, -100.0), (100.0, 100.0)), start: (camera: (0.0, 5.0, 20.0, 0.0, 0.0), figure: (0.0, 0.0, \
         0.0)), layers: [(source: Hill(centre: (80.0, 80.0), radius: 10.0, height: 1.0))], things: [{things}])"
    );
    std::fs::write(&path, text).expect("the temporary folder can be written");
    let request = SceneRequest::new(path.to_str().expect("the folder has a plain name"));
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let loaded = scene::load(&request, &assets).expect("the scene is good");
    std::fs::remove_dir_all(folder).expect("the temporary folder can be written");
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, DolomiteMinimalPlugins))
        .insert_resource(AssetsDir(assets))
        .insert_resource(request)
        .insert_resource(CurrentScene(loaded))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
            1.0 / 64.0,
        )))
        .add_plugins(SimulationPlugin);
    app.finish();
    app.cleanup();
    app.update();
    app
}

fn steps(app: &mut App, input: PlayerInput, count: u32) {
    for _ in 0..count {
        *app.world_mut().resource_mut::<PlayerInput>() = input;
        app.update();
    }
}

fn north() -> PlayerInput {
    PlayerInput {
        walk: Vec2::Y,
        ..default()
    }
}

fn figure(app: &mut App) -> Figure {
    let world = app.world_mut();
    *world
        .query::<&Figure>()
        .single(world)
        .expect("there is one figure")
}

fn stone(app: &mut App) -> Vec3 {
    let world = app.world_mut();
    let mut things = world.query::<(&Solid, &Transform)>();
    let mut stones = things
        .iter(world)
        .filter(|(solid, _)| matches!(solid.0, Thing::Stone { .. }));
    stones.next().expect("there is a stone").1.translation
}

#[test]
fn a_block_stops_who_walks_into_it_and_is_walked_along() {
    let block = "Block(at: (0.0, -2.0), size: (4.0, 1.6, 0.6))";
    let mut app = game("block", block);
    steps(&mut app, north(), 300);
    let before = figure(&mut app).now;
    // Its side is at -1.7 m, and the figure 0.28 m thick.
    assert!((before.place.y + 1.42).abs() < 1e-3, "{}", before.place);
    assert_eq!(before.jump, Jump::None);
    let aside = PlayerInput {
        walk: Vec2::ONE.normalize(),
        ..default()
    };
    steps(&mut app, aside, 64);
    let after = figure(&mut app).now.place;
    assert!(after.x > 0.5 && (after.y + 1.42).abs() < 1e-3, "{after}");
}

#[test]
fn a_boulder_stops_who_walks_and_carries_who_jumps() {
    let boulder = "Boulder(at: (0.0, -3.0), radius: 1.0, height: 0.4, seed: 1)";
    let mut app = game("boulder", boulder);
    steps(&mut app, north(), 300);
    let stopped = figure(&mut app).now;
    assert!(stopped.place.y > -2.1, "{}", stopped.place);
    assert_eq!(stopped.jump, Jump::None);
    // Back, and on at a run.
    let south = PlayerInput {
        walk: Vec2::NEG_Y,
        ..default()
    };
    steps(&mut app, south, 50);
    let mut highest = 0.0_f64;
    let mut stood = false;
    for step in 0..200 {
        let near = figure(&mut app).now.place.y < -1.3;
        let input = PlayerInput {
            jump: near && step > 30 && !stood,
            ..north()
        };
        steps(&mut app, input, 1);
        if let Jump::On { lift } = figure(&mut app).now.jump {
            stood = true;
            highest = highest.max(lift);
        }
    }
    assert!(stood && (0.3..0.5).contains(&highest), "{highest}");
    // Over it and down on the other side.
    steps(&mut app, north(), 200);
    let behind = figure(&mut app).now;
    assert!(behind.place.y < -4.0, "{}", behind.place);
    assert_eq!(behind.jump, Jump::None);
}

#[test]
fn a_lift_is_walked_onto_and_ridden() {
    let lift = "Lift(at: (0.0, -1.5), size: (2.0, 0.3, 2.0), rise: 3.0, speed: 1.0)";
    let mut app = game("lift", lift);
    let low = |app: &mut App| {
        let world = app.world_mut();
        let mut lifts = world.query::<(&Lift, &Transform, &BetweenSteps)>();
        let (lift, place, steps) = lifts.single(world).expect("there is one lift");
        // Frames are steps here: it is drawn where it was one step ago, as the figure is.
        let now = steps.now().unwrap_or(*place).translation.y;
        assert!((0.0..=1.0 / 64.0 + 1e-5).contains(&(now - place.translation.y).abs()));
        now - lift.low
    };
    let mut highest = 0.0_f64;
    for step in 0..500 {
        let far = figure(&mut app).now.place.y > -1.4;
        let input = if far { north() } else { PlayerInput::default() };
        steps(&mut app, input, 1);
        if let Jump::On { lift } = figure(&mut app).now.jump {
            highest = highest.max(lift);
            let above = f64::from(low(&mut app)) + 0.02;
            // A body is round below: over the edge, which is at -0.5, it stands lower.
            let whole = figure(&mut app).now.place.y < -0.5 - 0.3;
            assert!(
                lift < above + 1e-3 && (!whole || lift > above - 1e-3),
                "{lift} and {above} in step {step}"
            );
        }
    }
    assert!((2.9..3.1).contains(&highest), "{highest}");
}

#[test]
fn a_stone_is_kicked_and_rolls() {
    let mut app = game("stone", "Stone(at: (0.0, -2.0), radius: 0.3)");
    steps(&mut app, PlayerInput::default(), 60);
    let before = stone(&mut app);
    assert!((before.y - 0.3).abs() < 0.02, "{before}");
    assert!(app.world().resource::<BridgeCounters>().made > 0);
    steps(&mut app, north(), 200);
    let after = stone(&mut app);
    assert!(after.z < before.z - 0.5, "{before} {after}");
    assert!((after.y - 0.3).abs() < 0.05, "{after}");
    let place = figure(&mut app).now.place;
    assert!(place.y > f64::from(after.z), "{place} {after}");
}

#[test]
fn without_things_there_are_neither_bodies_nor_a_world_of_rapiers() {
    let mut app = game("nothing", "");
    steps(&mut app, north(), 64);
    let world = app.world_mut();
    assert_eq!(world.query::<&CharacterBody>().iter(world).count(), 0);
    let mut worlds = world.query::<&RapierContextSimulation>();
    assert_eq!(worlds.iter(world).count(), 0);
    assert!(figure(&mut app).now.place.distance(DVec2::ZERO) > 0.5);
}
