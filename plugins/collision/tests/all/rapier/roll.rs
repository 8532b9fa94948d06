//! Bodies that roll and slide over borders of tiles, against ground without borders.

use super::*;
use bevy::math::Quat;
use bevy_rapier3d::parry::shape::{HeightField, HeightFieldFlags, SharedShape};
use bevy_rapier3d::parry::utils::Array2;
use dolomite_collision::rapier::Diagonals;

type Height = fn(DVec2) -> f64;

/// Grounds that are rolled over.
const GROUNDS: [(&str, Height); 3] = [("flat", flat), ("slope", slope), ("waves", waves)];

/// Where bodies start, and how fast.
const START: DVec2 = DVec2::new(16.3, 100.7);
const VELOCITY: Vec3 = Vec3::new(4.0, 0.0, 0.7);

/// What lies under a body.
#[derive(Clone, Copy)]
enum Under {
    /// Tiles of so many cells.
    Tiles(u32, Diagonals),
    /// One height field of parry's of 256 m, cells cut all alike, whose middle lies so far from where ours is.
    Parry(f32),
}

fn put(app: &mut App, height: Height, under: Under) {
    match under {
        Under::Tiles(cells, diagonals) => {
            let tiles = ground_tiles(height, cells).with_diagonals(diagonals);
            app.world_mut().spawn(tiles);
        }
        Under::Parry(by) => {
            let first = by as i32;
            let side = 0..=256_i32;
            let samples = side.clone().flat_map(|x| {
                let place = move |z: i32| DVec2::new((x + first).into(), (z + first).into());
                side.clone().map(move |z| height(place(z)) as f32)
            });
            let field = HeightField::with_flags(
                Array2::new(257, 257, samples.collect()),
                Vec3::new(256.0, 1.0, 256.0),
                HeightFieldFlags::FIX_INTERNAL_EDGES,
            );
            app.world_mut().spawn((
                RapierCollider::from(SharedShape::new(field)),
                Transform::from_xyz(128.0 + by, 0.0, 128.0 + by),
            ));
        }
    }
}

/// Where a body of this shape is in each step, until it has gone 100 m or `most` steps.
fn path(height: Height, under: Under, shape: RapierCollider, most: usize) -> Vec<Vec3> {
    let mut app = app();
    put(&mut app, height, under);
    let start = Vec3::new(START.x as f32, height(START) as f32 + 0.52, START.y as f32);
    let body = (
        RigidBody::Dynamic,
        shape,
        Transform::from_translation(start),
        Velocity::linear(VELOCITY),
    );
    let body = app.world_mut().spawn(body).id();
    let mut path = Vec::new();
    for _ in 0..most {
        app.update();
        path.push(place(&app, body));
        if path.last().is_some_and(|place| place.x > start.x + 100.0) {
            break;
        }
    }
    path
}

fn rolled(height: Height, under: Under) -> Vec<Vec3> {
    let path = path(height, under, RapierCollider::ball(0.5), 4000);
    let end = path.last().expect("the path has a point");
    assert!(end.x > 116.3, "100 m are gone: {end}");
    path
}

/// The farthest of two paths from each other, metres.
fn apart(one: &[Vec3], other: &[Vec3]) -> f32 {
    let off = one.iter().zip(other).map(|(a, b)| a.distance(*b));
    off.fold(0.0, f32::max)
}

/// Tiles of any size are one ground: not nearly, but to the bit.
#[test]
fn borders_of_tiles_are_no_matter() {
    for (name, height) in GROUNDS {
        let on = |cells| rolled(height, Under::Tiles(cells, Diagonals::Alternating));
        // One tile of 256 m holds all of it.
        let whole = on(256);
        assert_eq!(on(8), whole, "{name}");
    }
    // The counterpart: where cells are cut another way the path is another.
    let turns = rolled(waves, Under::Tiles(8, Diagonals::Alternating));
    let alike = rolled(waves, Under::Tiles(8, Diagonals::Alike));
    assert!(apart(&turns, &alike) > 1e-3);
}

/// What has corners, edges and parts meets many triangles at once, of as many as four tiles.
#[test]
fn what_is_not_round_knows_no_borders() {
    let part = |x: f32| {
        let at = Vec3::new(x, 0.0, 0.0);
        (at, Quat::IDENTITY, RapierCollider::cuboid(0.3, 0.3, 0.5))
    };
    let shapes = [
        RapierCollider::cuboid(0.5, 0.4, 0.5),
        RapierCollider::capsule_x(0.6, 0.4),
        RapierCollider::compound(vec![part(-0.5), part(0.5)]),
    ];
    for shape in shapes {
        let on = |cells| {
            let under = Under::Tiles(cells, Diagonals::Alternating);
            path(waves, under, shape.clone(), 300)
        };
        let whole = on(256);
        assert_eq!(on(1), whole);
        let (first, last) = (whole[0], whole[whole.len() - 1]);
        assert!(first.distance(last) > 1.5, "it went over borders: {last}");
    }
}

/// Against parry's own height field, where cells are cut as it cuts them. What f32 makes of the same ground is a path
/// that drifts away: parry's field differs from itself, with its origin elsewhere, by 8 mm on flat ground, 0.6 mm on a
/// slope and 22 mm over waves. So much is allowed, and no more than a half besides.
#[test]
fn it_is_the_ground_that_parry_knows() {
    let bounds = [("flat", 8.2e-3), ("slope", 0.6e-3), ("waves", 22.2e-3)];
    for ((name, height), (of, bound)) in GROUNDS.into_iter().zip(bounds) {
        assert_eq!(name, of);
        let ours = rolled(height, Under::Tiles(8, Diagonals::Alike));
        let parry = rolled(height, Under::Parry(0.0));
        let off = apart(&ours, &parry);
        println!("{name}: {off} m from parry's field");
        assert!(off < 1.5 * bound, "{name}: {off} m");
    }
}

/// A ball on flat ground keeps to its line. Places are f32, 8 µm apart so far from the origin, which was measured to add
/// up to 4.5 mm over 100 m, and to 3 mm on parry's field; from 50 m it is 1.1 mm, from 1.4 km 74 mm. Twice is allowed.
#[test]
fn flat_ground_is_rolled_over_in_a_straight_line() {
    let way = VELOCITY.normalize();
    let from = Vec3::new(START.x as f32, 0.0, START.y as f32);
    let path = rolled(flat, Under::Tiles(8, Diagonals::Alternating));
    let side = |place: &Vec3| (*place - from).with_y(0.0).reject_from(way).length();
    let beside = path.iter().map(side).fold(0.0, f32::max);
    assert!(beside < 9e-3, "{beside}");
    // It sinks in by what Rapier lets it, and does not hop.
    let heights = || path.iter().skip(64).map(|place| place.y);
    let (low, high) = (heights().fold(9.0, f32::min), heights().fold(0.0, f32::max));
    assert!(low > 0.49 && high - low < 1e-5, "{low} to {high}");
}

/// Bodies that are there before the ground is meet it the other way round in Rapier's pairs.
#[test]
fn ground_may_come_after_bodies() {
    let late = |cells| {
        let mut app = app();
        let start = Vec3::new(START.x as f32, height_above(waves), START.y as f32);
        let body = ball(&mut app, 0.5, start, VELOCITY);
        steps(&mut app, 2);
        put(&mut app, waves, Under::Tiles(cells, Diagonals::Alternating));
        let mut path = Vec::new();
        for _ in 0..600 {
            app.update();
            path.push(place(&app, body));
        }
        path
    };
    let whole = late(256);
    assert_eq!(late(8), whole);
    let end = whole[whole.len() - 1];
    let surface = waves(DVec2::new(end.x.into(), end.z.into())) as f32;
    assert!(end.x > 40.0 && end.y > surface, "{end}");
}

fn height_above(height: Height) -> f32 {
    height(START) as f32 + 1.5
}
