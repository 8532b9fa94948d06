//! Rapier's bodies on tiles of the ground, beside movers, under `MinimalPlugins`.

use bevy::MinimalPlugins;
use bevy::app::App;
use bevy::ecs::prelude::*;
use bevy::math::{DVec2, DVec3, Vec3};
use bevy::time::TimeUpdateStrategy;
use bevy::transform::components::Transform;
use bevy_rapier3d::parry::query::Ray;
use bevy_rapier3d::prelude::{
    Collider as RapierCollider, RapierContextSimulation, RapierRigidBodyHandle, RapierRigidBodySet,
    RigidBody, Velocity,
};
use dolomite_collision::rapier::{
    BridgeCounters, Diagonals, GroundTiles, MeetsMovers, Pusher, RapierBridgePlugin, TileError,
};
use dolomite_collision::{
    CharacterBody, Collider, MoveState, MoveWish, TreeSettings, TriangleMesh, TriangleTree,
};
use dolomite_terrain::{Ground, GroundSample};
use dolomite_testkit::random::Random;
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

fn tiles(height: fn(DVec2) -> f64, cells: u32) -> GroundTiles {
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
fn the_surface_is_that_of_parry() {
    let mut random = Random::new(1);
    for diagonals in [Diagonals::Alternating, Diagonals::Alike] {
        let mut app = app();
        let tiles = tiles(waves, 8).with_diagonals(diagonals);
        app.world_mut().spawn(tiles.clone());
        ball(&mut app, 9.0, Vec3::new(0.0, 20.0, 0.0), Vec3::ZERO);
        steps(&mut app, 1);
        let mut query = app
            .world_mut()
            .query_filtered::<(&RapierCollider, &Transform), Without<RigidBody>>();
        let shapes: Vec<_> = query.iter(app.world()).collect();
        assert!(shapes.len() >= 4, "{}", shapes.len());
        let mut met = 0;
        for _ in 0..2000 {
            let at = Vec3::new(8.0 * random.unit_f32(), 50.0, -8.0 * random.unit_f32());
            for (shape, place) in &shapes {
                let ray = Ray::new(at - place.translation, Vec3::NEG_Y);
                let Some(time) = shape.raw.cast_local_ray(&ray, 100.0, false) else {
                    continue;
                };
                let xz = DVec2::new(f64::from(at.x), f64::from(at.z));
                let expected = tiles
                    .surface(xz)
                    .expect("it is there: the body is on the ground");
                // 50 m in f32 are held to 4e-6 m; a wrong diagonal is off by centimetres.
                assert!((f64::from(50.0 - time) - expected).abs() < 2e-5, "{at}");
                met += 1;
            }
        }
        assert!(met >= 1999, "{met}");
    }
}

/// The path of a ball until it has gone 100 m.
fn path(height: fn(DVec2) -> f64, cells: u32, diagonals: Diagonals) -> (Vec<Vec3>, u64) {
    let mut app = app();
    app.world_mut()
        .spawn(tiles(height, cells).with_diagonals(diagonals));
    let xz = DVec2::new(16.3, 100.7);
    let start = Vec3::new(xz.x as f32, height(xz) as f32 + 0.52, xz.y as f32);
    let ball = ball(&mut app, 0.5, start, Vec3::new(4.0, 0.0, 0.7));
    let mut path = Vec::new();
    for _ in 0..4000 {
        app.update();
        path.push(place(&app, ball));
        if path.last().expect("the path has a point").x > 116.3 {
            break;
        }
    }
    (path, counters(&app).made)
}

/// The farthest that a ball on tiles of 8 m gets from one on an unbroken tile of 256 m over 100 m, metres. Wished for
/// is 1 mm. Beside it stands how far balls on two unbroken tiles, of 128 and of 256 m, get from each other: what f32
/// makes of the same ground seen from another middle. Bounds are twice what was measured.
#[test]
fn a_ball_rolls_over_borders_nearly_as_over_unbroken_ground() {
    let grounds = [
        ("flat", flat as fn(DVec2) -> f64, 0.026),
        ("slope", slope, 0.0027),
        ("waves", waves, 0.052),
    ];
    for (name, height, bound) in grounds {
        // One tile of 256 m holds all of it.
        let (whole, one) = path(height, 256, Diagonals::Alternating);
        let (parts, many) = path(height, 8, Diagonals::Alternating);
        let (other, _) = path(height, 128, Diagonals::Alternating);
        let apart = |other: &[Vec3]| {
            let off = whole.iter().zip(other).map(|(a, b)| a.distance(*b));
            off.fold(0.0, f32::max)
        };
        let (off, floor) = (apart(&parts), apart(&other));
        println!(
            "{name}: {off} m after {} steps; {floor} m of two unbroken ones",
            whole.len()
        );
        assert!(
            whole
                .last()
                .expect("it is there: the body is on the ground")
                .x
                > 116.3,
            "{name}: 100 m are gone"
        );
        assert!(one == 1 && many > 12, "{one} and {many} tiles");
        assert!(off < bound, "{name}: {off} m");
    }
}

#[test]
fn ground_that_changes_wakes_what_lies_on_it_and_lets_nothing_through() {
    let heights: [fn(DVec2) -> f64; 5] = [
        |_| 3.0,
        |_| -2.0,
        |xz| 0.3 * xz.x,
        |_| 0.25,
        |xz| 0.5 * (xz.x * 0.37).floor(),
    ];
    let mut app = app();
    let ground_entity = app.world_mut().spawn(tiles(flat, 8)).id();
    let bodies: Vec<Entity> = (0..6)
        .map(|i| {
            cube(
                &mut app,
                0.4,
                Vec3::new(2.7 * i as f32 - 7.0, 0.41, 0.3 * i as f32),
            )
        })
        .collect();
    for height in heights {
        steps(&mut app, 400);
        for &body in &bodies {
            assert!(asleep(&mut app, body), "{}", place(&app, body));
        }
        steps(&mut app, 60);
        assert_eq!(counters(&app).tiles, 0, "none is awake");
        let before = counters(&app).woken;
        app.world_mut()
            .get_mut::<GroundTiles>(ground_entity)
            .expect("it is there: the body is on the ground")
            .set_ground(ground(height));
        steps(&mut app, 2);
        let woken = counters(&app).woken - before;
        assert_eq!(woken, bodies.len() as u64, "all are over other ground");
        let tiles = app
            .world()
            .get::<GroundTiles>(ground_entity)
            .expect("it is there: the body is on the ground")
            .clone();
        for step in 0..300 {
            steps(&mut app, 1);
            for &body in &bodies {
                let at = place(&app, body);
                let surface = tiles
                    .surface(DVec2::new(at.x.into(), at.z.into()))
                    .expect("it is there: the body is on the ground");
                assert!(
                    f64::from(at.y) > surface,
                    "{at} in step {step}, ground {surface}"
                );
            }
        }
    }
    assert!(counters(&app).lifted > 0);
}

#[test]
fn what_sleeps_keeps_no_tile_and_wakes_onto_one() {
    let mut app = app();
    app.world_mut().spawn(tiles(waves, 8));
    let cube = cube(
        &mut app,
        0.5,
        Vec3::new(8.0, waves(DVec2::new(8.0, 8.0)) as f32 + 0.6, 8.0),
    );
    steps(&mut app, 600);
    assert!(asleep(&mut app, cube));
    let rest = place(&app, cube);
    steps(&mut app, 200);
    assert!(
        asleep(&mut app, cube),
        "taking its tile away does not wake it"
    );
    assert_eq!(counters(&app).tiles, 0);
    assert_eq!(place(&app, cube), rest);
    // A ball comes and hits it: both have ground at once.
    let start = rest + Vec3::new(-6.0, 1.0, 0.0);
    ball(&mut app, 0.5, start, Vec3::new(12.0, 0.0, 0.0));
    let mut least = f32::INFINITY;
    for _ in 0..300 {
        steps(&mut app, 1);
        let at = place(&app, cube);
        let surface = waves(DVec2::new(at.x.into(), at.z.into())) as f32;
        least = least.min(at.y - surface);
    }
    assert!(rest.distance(place(&app, cube)) > 0.1, "it was hit");
    // Its lower corners stand on a slope: the middle is some 0.5 m above it.
    assert!(least > 0.4, "{least}");
}

#[test]
fn nothing_goes_through_at_100_metres_a_second() {
    let mut app = app();
    let tiles = tiles(waves, 8);
    app.world_mut().spawn(tiles.clone());
    let mut random = Random::new(7);
    let bodies: Vec<Entity> = (0..60)
        .map(|i| {
            let turn = |random: &mut Random| random.unit_f32() * 2.0 - 1.0;
            let way = Vec3::new(
                turn(&mut random),
                -random.unit_f32() - 0.02,
                turn(&mut random),
            );
            let at = Vec3::new(40.0 * (i % 8) as f32, 30.0, 40.0 * (i / 8) as f32);
            ball(&mut app, 0.1, at, way.normalize() * 100.0)
        })
        .collect();
    for step in 0..400 {
        steps(&mut app, 1);
        for &body in &bodies {
            let at = place(&app, body);
            let surface = tiles
                .surface(DVec2::new(at.x.into(), at.z.into()))
                .expect("it is there: the body is on the ground");
            assert!(
                f64::from(at.y) > surface,
                "{at} in step {step}, ground {surface}"
            );
        }
    }
}

fn floor() -> Arc<TriangleTree> {
    let corner = |x: f64, z: f64| DVec3::new(x, 0.0, z) * 100.0;
    let (a, b, c, d) = (
        corner(-1.0, -1.0),
        corner(-1.0, 1.0),
        corner(1.0, 1.0),
        corner(1.0, -1.0),
    );
    let mesh =
        TriangleMesh::from_triangles(&[[a, b, c], [a, c, d]]).expect("both triangles have an area");
    Arc::new(TriangleTree::new(mesh, TreeSettings::default()))
}

/// A mover on a floor, and the same floor for Rapier.
fn with_mover(force: Option<f32>) -> (App, Entity) {
    let mut app = app();
    app.world_mut().spawn(tiles(flat, 8));
    app.world_mut().spawn(Collider(floor()));
    let figure = (
        CharacterBody::default(),
        Transform::from_xyz(0.0, 0.901, 0.0),
    );
    let mover = app.world_mut().spawn(figure).id();
    if let Some(force) = force {
        app.world_mut().entity_mut(mover).insert(Pusher { force });
    }
    (app, mover)
}

fn walk(app: &mut App, mover: Entity, speed: f32, count: usize) {
    for _ in 0..count {
        let wish = Vec3::new(speed, -1.0, 0.0) / 64.0;
        app.world_mut()
            .get_mut::<MoveWish>(mover)
            .expect("the mover has a wish")
            .0 = wish;
        steps(app, 1);
    }
}

#[test]
fn a_mover_pushes_a_stone_as_hard_as_it_may() {
    let pushed = |force: Option<f32>| {
        let (mut app, mover) = with_mover(force);
        let stone = ball(&mut app, 0.5, Vec3::new(2.0, 0.5, 0.0), Vec3::ZERO);
        app.world_mut().entity_mut(stone).insert(MeetsMovers);
        walk(&mut app, mover, 2.0, 128);
        (place(&app, stone).x, place(&app, mover).x)
    };
    let (still, stopped) = pushed(None);
    assert!((still - 2.0).abs() < 1e-3, "nobody pushes: {still}");
    assert!(stopped < 1.3, "the stone is in the way: {stopped}");
    let (rolled, walked) = pushed(Some(400.0));
    assert!(rolled > 3.0, "{rolled}");
    assert!(walked > 2.0 && walked < rolled, "{walked} behind {rolled}");
    let (weak, _) = pushed(Some(1.0));
    assert!(weak < rolled - 0.3, "{weak} of {rolled}");
}

#[test]
fn a_stone_pushes_a_mover_and_does_not_pass_through() {
    let (mut app, mover) = with_mover(Some(400.0));
    let stone = ball(
        &mut app,
        0.5,
        Vec3::new(-3.0, 0.5, 0.0),
        Vec3::new(5.0, 0.0, 0.0),
    );
    app.world_mut().entity_mut(stone).insert(MeetsMovers);
    for _ in 0..128 {
        walk(&mut app, mover, 0.0, 1);
        let (stone, mover) = (place(&app, stone), place(&app, mover));
        assert!(stone.x < mover.x, "{stone} {mover}");
    }
    assert!(
        app.world()
            .get::<MoveState>(mover)
            .expect("it is there: the body is on the ground")
            .grounded()
    );
    // The stand-in goes with its mover.
    app.world_mut().entity_mut(mover).despawn();
    steps(&mut app, 2);
    let mut kinds = app.world_mut().query::<&RigidBody>();
    assert_eq!(kinds.iter(app.world()).count(), 1, "the stone alone");
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
    app.world_mut()
        .spawn(tiles(|xz| if xz.x > 4.0 { f64::NAN } else { 0.0 }, 8));
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
