//! Tiles of the ground under bodies: where they are, and what becomes of bodies when they change.

use super::*;
use bevy::ecs::system::{RunSystemOnce as _, SystemParam};
use bevy::math::Quat;
use bevy::transform::StaticTransformOptimizations;
use bevy_rapier3d::parry::query::{Ray, ShapeCastOptions};
use bevy_rapier3d::prelude::{
    ActiveEvents, ActiveHooks, BevyPhysicsHooks, CoefficientCombineRule, CollisionEvent,
    ContactModificationContextView, Friction, QueryFilter, RapierPhysicsPlugin, ReadRapierContext,
    TimestepMode,
};
use dolomite_collision::rapier::Diagonals;
use dolomite_testkit::random::Random;
use std::sync::atomic::{AtomicUsize, Ordering};

#[test]
fn the_surface_is_that_of_parry() {
    let mut random = Random::new(1);
    for diagonals in [Diagonals::Alternating, Diagonals::Alike] {
        let mut app = app();
        let tiles = ground_tiles(waves, 8).with_diagonals(diagonals);
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
    let ground_entity = app.world_mut().spawn(ground_tiles(flat, 8)).id();
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
    app.world_mut().spawn(ground_tiles(waves, 8));
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
    let tiles = ground_tiles(waves, 8);
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

/// Rapier's queries see tiles, and not the one collider that bodies are in contact with.
#[test]
fn casts_meet_the_ground_once() {
    let mut app = app();
    app.world_mut().spawn(ground_tiles(flat, 8));
    let body = ball(&mut app, 0.5, Vec3::new(3.0, 0.5, 3.0), Vec3::ZERO);
    steps(&mut app, 2);
    let (ray, cast, overlaps, nearest) = app
        .world_mut()
        .run_system_once(move |context: ReadRapierContext| {
            let context = context.single().expect("there is one world");
            let filter = QueryFilter::default().exclude_rigid_body(body);
            let from = Vec3::new(2.3, 4.0, 2.6);
            let ray = context.cast_ray(from, Vec3::NEG_Y, 100.0, true, filter);
            let shape = RapierCollider::ball(0.25);
            let cast = context.cast_shape(
                from,
                Quat::IDENTITY,
                Vec3::NEG_Y,
                &*shape.raw,
                ShapeCastOptions::default(),
                filter,
            );
            let mut overlaps = 0;
            let at = Vec3::new(2.3, 0.1, 2.6);
            context.intersect_shape(at, Quat::IDENTITY, &*shape.raw, filter, |_| {
                overlaps += 1;
                true
            });
            let nearest = context.project_point(from, 100.0, true, filter);
            (ray, cast, overlaps, nearest)
        })
        .expect("the system runs");
    let (_, time) = ray.expect("there is ground below");
    assert!((time - 4.0).abs() < 1e-5, "{time}");
    let (_, hit) = cast.expect("there is ground below");
    // Parry's casts end within 1e-4 of contact.
    assert!((hit.time_of_impact - 3.75).abs() < 1e-3, "{hit:?}");
    assert_eq!(overlaps, 1);
    let (_, nearest) = nearest.expect("there is ground below");
    assert!((nearest.point.y).abs() < 1e-5, "{nearest:?}");
}

/// Ground that is gone lets bodies fall, and another bears them; contacts say which ground it was.
#[test]
fn ground_that_is_gone_bears_nothing() {
    let mut app = app();
    let first = app.world_mut().spawn(ground_tiles(flat, 8)).id();
    let body = cube(&mut app, 0.5, Vec3::new(1.0, 0.6, 1.0));
    app.world_mut()
        .entity_mut(body)
        .insert(ActiveEvents::COLLISION_EVENTS);
    steps(&mut app, 400);
    assert!(asleep(&mut app, body));
    app.world_mut().despawn(first);
    steps(&mut app, 64);
    assert!(place(&app, body).y < -2.0, "{}", place(&app, body));
    assert_eq!(counters(&app).tiles, 0);
    let second = app.world_mut().spawn(ground_tiles(|_| -20.0, 8)).id();
    let mut touched = Vec::new();
    for _ in 0..200 {
        steps(&mut app, 1);
        let mut events = app.world_mut().resource_mut::<Messages<CollisionEvent>>();
        touched.extend(events.drain());
    }
    let at = place(&app, body);
    // Rapier lets what lies sink in by some millimetres.
    assert!((at.y + 19.5).abs() < 0.02, "{at}");
    let of_second = |event: &CollisionEvent| match event {
        CollisionEvent::Started(one, two, _) => *one == second || *two == second,
        CollisionEvent::Stopped(..) => false,
    };
    assert!(touched.iter().any(of_second), "{touched:?}");
}

/// What a ground is made of holds from the next step on.
#[test]
fn a_ground_turns_to_ice() {
    let mut app = app();
    let ground = app
        .world_mut()
        .spawn((ground_tiles(|xz| -0.2 * xz.x, 8), Friction::new(1.0)))
        .id();
    let start = Vec3::new(4.0, -0.8 + 0.52, 4.0);
    let body = cube(&mut app, 0.5, start);
    steps(&mut app, 128);
    let stood = place(&app, body);
    assert!(stood.distance(start) < 0.1, "{stood}");
    app.world_mut().entity_mut(ground).insert(Friction {
        coefficient: 0.0,
        combine_rule: CoefficientCombineRule::Min,
    });
    // A small push, since what stood may sleep.
    app.world_mut()
        .entity_mut(body)
        .insert(Velocity::linear(Vec3::new(0.1, 0.0, 0.0)));
    steps(&mut app, 128);
    // Two seconds down a slope of 0.2 without friction: half of 9.81 · 0.196 · 4, level, is 3.8 m.
    assert!(place(&app, body).x > stood.x + 3.0, "{}", place(&app, body));
}

/// How often Rapier asked [`OwnHooks`].
#[derive(Resource, Default)]
struct Asked(AtomicUsize);

/// Hooks of an app that knows nothing of ground.
#[derive(SystemParam)]
struct OwnHooks<'w> {
    asked: Res<'w, Asked>,
}

impl BevyPhysicsHooks for OwnHooks<'_> {
    fn modify_solver_contacts(&self, _: ContactModificationContextView) {
        self.asked.0.fetch_add(1, Ordering::Relaxed);
    }
}

/// Rapier as an app has set it up, with its own hooks: the bridge adds no second one, and borders are none there too.
#[test]
fn an_app_keeps_its_own_rapier() {
    let rolled = |cells| {
        let mut app = App::new();
        app.add_plugins((
            MinimalPlugins,
            RapierPhysicsPlugin::<OwnHooks>::default().in_fixed_schedule(),
            RapierBridgePlugin,
        ))
        .init_resource::<Asked>()
        .init_resource::<StaticTransformOptimizations>()
        .insert_resource(TimestepMode::Fixed {
            dt: 1.0 / 64.0,
            substeps: 1,
        })
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
            1.0 / 64.0,
        )));
        app.finish();
        app.cleanup();
        app.update();
        app.world_mut().spawn(ground_tiles(waves, cells));
        let start = Vec3::new(2.3, 1.2, 3.4);
        let body = ball(&mut app, 0.5, start, Vec3::new(4.0, 0.0, 0.7));
        app.world_mut()
            .entity_mut(body)
            .insert(ActiveHooks::MODIFY_SOLVER_CONTACTS);
        let mut path = Vec::new();
        for _ in 0..300 {
            app.update();
            path.push(place(&app, body));
        }
        let mut worlds = app.world_mut().query::<&RapierContextSimulation>();
        assert_eq!(worlds.iter(app.world()).count(), 1);
        let asked = app.world().resource::<Asked>().0.load(Ordering::Relaxed);
        assert!(asked > 100, "{asked}");
        path
    };
    let whole = rolled(64);
    let end = whole[whole.len() - 1];
    let surface = waves(DVec2::new(end.x.into(), end.z.into())) as f32;
    assert!(end.x > 12.0 && end.y > surface, "{end}");
    assert_eq!(rolled(1), whole);
}

/// An edit reaches the tiles under it and the bodies on them, and no others.
#[test]
fn edited_ground_is_met_and_nothing_beside_it_is_touched() {
    use dolomite_terrain::{Edit, EditKind, GroundRect, Terrain, TerrainData, TerrainEdits};
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 400.0),
        layers: Vec::new(),
        base: 0.0,
        sea_level: None,
    })
    .expect("valid");
    let mut app = app();
    let tiles = GroundTiles::new(Arc::new(terrain.clone()), 1.0, 8).expect("usable");
    let ground_entity = app.world_mut().spawn(tiles).id();
    let near = cube(&mut app, 0.4, Vec3::new(0.5, 0.41, 0.5));
    let far = cube(&mut app, 0.4, Vec3::new(60.5, 0.41, 0.5));
    steps(&mut app, 400);
    assert!(asleep(&mut app, near) && asleep(&mut app, far));
    let mut edits = TerrainEdits::new(&terrain).expect("fits");
    let mut edit = |terrain: &Terrain, x: f64, kind| {
        let brush = Edit {
            kind,
            place: DVec2::new(x, 0.0),
            radius: 6.0,
            strength: 1.5,
            falloff: 0.5,
        };
        edits.apply(terrain, &brush).expect("valid").terrain
    };
    let set = |app: &mut App, ground: &Terrain| {
        let mut tiles = app
            .world_mut()
            .get_mut::<GroundTiles>(ground_entity)
            .expect("spawned above");
        tiles.set_ground(Arc::new(ground.clone()));
    };
    let now = edit(&terrain, 0.0, EditKind::Raise);
    let before = counters(&app);
    set(&mut app, &now);
    steps(&mut app, 2);
    assert!(!asleep(&mut app, near) && asleep(&mut app, far));
    assert_eq!(counters(&app).woken - before.woken, 1);
    assert_eq!(counters(&app).lifted - before.lifted, 1);
    steps(&mut app, 400);
    let at = place(&app, near);
    let height = now.height(DVec2::new(at.x.into(), at.z.into()));
    assert!(
        (f64::from(at.y) - height - 0.4).abs() < 0.05,
        "{at} over {height}"
    );
    // Both awake, each on tiles of its own: those of one alone are looked at.
    for (entity, x) in [(near, 0.5), (far, 60.5)] {
        let lifted = Transform::from_xyz(x, 2.5, 0.5);
        app.world_mut().entity_mut(entity).insert(lifted);
    }
    steps(&mut app, 20);
    let before = counters(&app);
    assert!(before.tiles >= 4, "{}", before.tiles);
    let lower = edit(&now, 60.0, EditKind::Lower);
    set(&mut app, &lower);
    steps(&mut app, 1);
    let after = counters(&app);
    let (looked, replaced) = (
        after.looked_at - before.looked_at,
        after.replaced - before.replaced,
    );
    assert!(
        looked >= 1 && looked < u64::from(before.tiles),
        "{looked} of {}",
        before.tiles
    );
    assert!(replaced >= 1 && replaced <= looked);
    steps(&mut app, 300);
    let at = place(&app, far);
    let height = lower.height(DVec2::new(at.x.into(), at.z.into()));
    assert!(
        (f64::from(at.y) - height - 0.4).abs() < 0.1,
        "{at} over {height}"
    );
}
