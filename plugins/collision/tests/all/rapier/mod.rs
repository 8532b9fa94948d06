//! Rapier's bodies on tiles of the ground, beside movers, under `MinimalPlugins`.

mod movers;
mod roll;
mod tiles;

use bevy::MinimalPlugins;
use bevy::app::App;
use bevy::ecs::prelude::*;
use bevy::math::{DVec2, Vec3};
use bevy::time::TimeUpdateStrategy;
use bevy::transform::components::Transform;
use bevy_rapier3d::prelude::{
    Collider as RapierCollider, RapierContextSimulation, RapierRigidBodyHandle, RapierRigidBodySet,
    RigidBody, Velocity,
};
use dolomite_collision::rapier::{BridgeCounters, GroundTiles, RapierBridgePlugin, TileError};
use dolomite_terrain::{Ground, GroundSample};
use std::sync::Arc;
use std::time::Duration;

/// Heights by a function.
struct Hills(fn(DVec2) -> f64);

impl Ground for Hills {
    fn sample(&self, xz: DVec2) -> GroundSample {
        GroundSample {
            height: (self.0)(xz),
            gradient: DVec2::ZERO,
        }
    }
}

fn ground(height: fn(DVec2) -> f64) -> Arc<dyn Ground> {
    Arc::new(Hills(height))
}

fn ground_tiles(height: fn(DVec2) -> f64, cells: u32) -> GroundTiles {
    GroundTiles::new(ground(height), 1.0, cells).expect("the samples are usable")
}

/// One step of 1/64 s a frame.
fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, RapierBridgePlugin))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
            1.0 / 64.0,
        )));
    app.finish();
    app.cleanup();
    // The first frame takes no time.
    app.update();
    app
}

fn steps(app: &mut App, count: usize) {
    for _ in 0..count {
        app.update();
    }
}

fn place(app: &App, entity: Entity) -> Vec3 {
    app.world()
        .get::<Transform>(entity)
        .expect("every body has a place")
        .translation
}

fn counters(app: &App) -> BridgeCounters {
    *app.world().resource::<BridgeCounters>()
}

fn asleep(app: &mut App, entity: Entity) -> bool {
    let handle = app
        .world()
        .get::<RapierRigidBodyHandle>(entity)
        .expect("the world knows the body")
        .0;
    let mut sets = app.world_mut().query::<&RapierRigidBodySet>();
    let set = sets.single(app.world()).expect("there is one set");
    set.bodies
        .get(handle)
        .expect("the world knows the body")
        .is_sleeping()
}

fn ball(app: &mut App, radius: f32, at: Vec3, velocity: Vec3) -> Entity {
    let body = (
        RigidBody::Dynamic,
        RapierCollider::ball(radius),
        Transform::from_translation(at),
        Velocity::linear(velocity),
    );
    app.world_mut().spawn(body).id()
}

fn cube(app: &mut App, half: f32, at: Vec3) -> Entity {
    let body = (
        RigidBody::Dynamic,
        RapierCollider::cuboid(half, half, half),
        Transform::from_translation(at),
    );
    app.world_mut().spawn(body).id()
}

fn flat(_: DVec2) -> f64 {
    0.0
}

fn slope(xz: DVec2) -> f64 {
    -0.02 * xz.x
}

/// Waves of 16 m and 0.5 m height, without a sine.
fn waves(xz: DVec2) -> f64 {
    let wave = |x: f64| {
        let part = (x / 16.0).rem_euclid(1.0) * 2.0 - 1.0;
        (1.0 - part * part) * (1.0 - part * part)
    };
    0.25 * (wave(xz.x) + wave(xz.y + 3.0)) - 0.05 * xz.x
}

#[test]
fn nothing_there_is_nothing_done() {
    let mut app = app();
    steps(&mut app, 3);
    let mut worlds = app.world_mut().query::<&RapierContextSimulation>();
    assert_eq!(worlds.iter(app.world()).count(), 0);
    assert_eq!(counters(&app), BridgeCounters::default());
    // The counterpart: one body, and there is a world.
    cube(&mut app, 0.5, Vec3::ZERO);
    steps(&mut app, 1);
    assert_eq!(worlds.iter(app.world()).count(), 1);
}

#[test]
fn hostile_bodies_and_grounds_are_survived() {
    assert!(matches!(
        GroundTiles::new(ground(flat), 0.3, 8),
        Err(TileError::Step(_))
    ));
    assert!(matches!(
        GroundTiles::new(ground(flat), f32::NAN, 8),
        Err(TileError::Step(_))
    ));
    assert!(matches!(
        GroundTiles::new(ground(flat), 1.0, 0),
        Err(TileError::Cells(0))
    ));
    let mut app = app();
    app.world_mut().spawn(ground_tiles(
        |xz| if xz.x > 4.0 { f64::NAN } else { 0.0 },
        8,
    ));
    let sound = cube(&mut app, 0.5, Vec3::new(0.0, 0.6, 0.0));
    ball(&mut app, 0.5, Vec3::new(1e9, 1.0, 0.0), Vec3::ZERO);
    ball(&mut app, 0.5, Vec3::new(30.0, 5.0, 0.0), Vec3::splat(1e6));
    ball(&mut app, 4000.0, Vec3::new(0.0, 9000.0, 0.0), Vec3::ZERO);
    steps(&mut app, 60);
    let at = place(&app, sound);
    assert!((at.y - 0.5).abs() < 0.02, "{at}");
    let counters = counters(&app);
    assert!(
        counters.refused > 0 && counters.tiles < 1200,
        "{counters:?}"
    );
}
