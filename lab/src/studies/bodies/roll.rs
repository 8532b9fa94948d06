//! Balls of Rapier's on tiles of the ground: how they roll over borders, and whether they fall through.

use bevy::MinimalPlugins;
use bevy::app::App;
use bevy::ecs::prelude::*;
use bevy::math::{DVec2, Vec3};
use bevy::time::TimeUpdateStrategy;
use bevy::transform::components::Transform;
use bevy_rapier3d::parry::shape::{HeightField, HeightFieldFlags, SharedShape};
use bevy_rapier3d::parry::utils::Array2;
use bevy_rapier3d::prelude::{Collider, RigidBody, Velocity};
use dolomite_collision::rapier::{BridgeCounters, Diagonals, GroundTiles, RapierBridgePlugin};
use dolomite_terrain::{Ground, GroundSample};
use dolomite_testkit::random::Random;
use std::sync::Arc;
use std::time::Duration;

/// Heights by a function of a place, metres.
pub type Height = fn(DVec2) -> f64;

/// Grounds that balls roll over.
pub const GROUNDS: [(&str, Height); 3] = [("flat", flat), ("slope", slope), ("waves", waves)];

/// What lies under a ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Under {
    /// Tiles of so many cells of 1 m, cut in this way.
    Tiles(u32, Diagonals),
    /// One height field of parry's of 256 m, cells cut all alike, that begins so many metres from the origin.
    Parry(i32),
}

/// A way along X of this length, metres, is judged.
const WAY: f32 = 100.0;

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

struct Heights(Height);

impl Ground for Heights {
    fn sample(&self, xz: DVec2) -> GroundSample {
        GroundSample {
            height: (self.0)(xz),
            gradient: DVec2::ZERO,
        }
    }
}

/// An app in steps of 1/64 s.
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

fn ground(app: &mut App, height: Height, under: Under) {
    match under {
        Under::Tiles(cells, diagonals) => {
            let tiles = GroundTiles::new(Arc::new(Heights(height)), 1.0, cells)
                .expect("the sizes of this study are allowed")
                .with_diagonals(diagonals);
            app.world_mut().spawn(tiles);
        }
        Under::Parry(first) => {
            let side = first..=first + 256;
            let samples = side.clone().flat_map(|x| {
                side.clone()
                    .map(move |z| height(DVec2::new(x.into(), z.into())) as f32)
            });
            let field = HeightField::with_flags(
                Array2::new(257, 257, samples.collect()),
                Vec3::new(256.0, 1.0, 256.0),
                HeightFieldFlags::FIX_INTERNAL_EDGES,
            );
            let middle = first as f32 + 128.0;
            app.world_mut().spawn((
                Collider::from(SharedShape::new(field)),
                Transform::from_xyz(middle, 0.0, middle),
            ));
        }
    }
}

/// Where a ball of 0.5 m is in each step until it has gone [`WAY`], and how many tiles were made.
pub fn path(height: Height, under: Under, start: DVec2, velocity: Vec3) -> (Vec<Vec3>, u64) {
    let mut app = app();
    ground(&mut app, height, under);
    let at = Vec3::new(start.x as f32, height(start) as f32 + 0.52, start.y as f32);
    let ball = app
        .world_mut()
        .spawn((
            RigidBody::Dynamic,
            Collider::ball(0.5),
            Transform::from_translation(at),
            Velocity::linear(velocity),
        ))
        .id();
    let mut path = Vec::new();
    for _ in 0..4000 {
        app.update();
        let Some(place) = app.world().get::<Transform>(ball) else {
            break;
        };
        path.push(place.translation);
        if place.translation.x > at.x + WAY {
            break;
        }
    }
    (path, app.world().resource::<BridgeCounters>().made)
}

/// The farthest of two paths from each other, metres; infinite where one does not get there.
pub fn apart(one: &[Vec3], other: &[Vec3], start: DVec2) -> f64 {
    let there = |path: &[Vec3]| {
        path.last()
            .is_some_and(|place| f64::from(place.x) > start.x + f64::from(WAY))
    };
    if !there(one) || !there(other) {
        return f64::INFINITY;
    }
    let distances = one
        .iter()
        .zip(other)
        .map(|(a, b)| f64::from(a.distance(*b)));
    distances.fold(0.0, f64::max)
}

/// The farthest that a path gets from the straight level line from its start, metres: on flat ground it is that line.
pub fn beside(path: &[Vec3], start: DVec2, velocity: Vec3) -> f64 {
    let way = DVec2::new(velocity.x.into(), velocity.z.into()).normalize();
    let off = path.iter().map(|place| {
        let from = DVec2::new(place.x.into(), place.z.into()) - start;
        from.perp_dot(way).abs()
    });
    off.fold(0.0, f64::max)
}

/// What became of balls at 100 m/s over ground that is replaced under them.
pub struct Fast {
    /// Balls.
    pub balls: usize,
    /// Times at which one was below the ground.
    pub below: u64,
    /// Tiles that were replaced.
    pub replaced: u64,
}

/// Balls of 0.1 m at 100 m/s onto waves that move every half second by up to a metre.
pub fn fast(seed: u32, balls: usize) -> Fast {
    const GROUNDS: [Height; 3] = [
        waves,
        |xz| waves(xz + DVec2::new(5.0, 3.0)) + 0.6,
        |xz| waves(xz) - 0.4,
    ];
    let mut app = app();
    let mut tiles = GroundTiles::new(Arc::new(Heights(waves)), 1.0, 8)
        .expect("the sizes of this study are allowed");
    let entity = app.world_mut().spawn(tiles.clone()).id();
    let mut random = Random::new(seed);
    let side = (balls as f64).sqrt().ceil().max(1.0) as usize;
    let bodies: Vec<Entity> = (0..balls)
        .map(|i| {
            let way = Vec3::new(
                random.range(-1.0, 1.0),
                -random.unit_f32() - 0.02,
                random.range(-1.0, 1.0),
            );
            let at = Vec3::new(40.0 * (i % side) as f32, 30.0, 40.0 * (i / side) as f32);
            let body = (
                RigidBody::Dynamic,
                Collider::ball(0.1),
                Transform::from_translation(at),
                Velocity::linear(way.normalize() * 100.0),
            );
            app.world_mut().spawn(body).id()
        })
        .collect();
    let mut below = 0;
    for step in 0..320 {
        if step % 32 == 31 {
            let next = Arc::new(Heights(GROUNDS[step / 32 % 3]));
            tiles.set_ground(next.clone());
            if let Some(mut there) = app.world_mut().get_mut::<GroundTiles>(entity) {
                there.set_ground(next);
            }
        }
        app.update();
        for body in &bodies {
            let Some(place) = app.world().get::<Transform>(*body) else {
                continue;
            };
            let at = place.translation.as_dvec3();
            let surface = tiles.surface(DVec2::new(at.x, at.z));
            below += u64::from(!surface.is_some_and(|surface| at.y > surface));
        }
    }
    Fast {
        balls,
        below,
        replaced: app.world().resource::<BridgeCounters>().replaced,
    }
}
