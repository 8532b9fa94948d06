//! Figures in an app without a renderer.

use crate::support;

use bevy::app::App;
use bevy::diagnostic::DiagnosticsStore;
use bevy::ecs::prelude::*;
use bevy::math::{DVec2, Quat, Vec3};
use bevy::reflect::TypeData;
use bevy::reflect::std_traits::ReflectDefault;
use bevy::time::TimeUpdateStrategy;
use bevy::transform::components::Transform;
use dolomite_character::feet::Footing;
use dolomite_character::gait::Motion;
use dolomite_character::{
    Character, CharacterCounters, CharacterEye, CharacterGround, CharacterJoints, CharacterLod,
    CharacterMotion, CharacterPlugin, CharacterPose, MotionFromTransform, Sampling,
};
use dolomite_terrain::{Ground, GroundRect, Hill, Layer, Source, Terrain, TerrainData};
use std::any::TypeId;
use std::sync::Arc;
use std::time::Duration;
use support::person;

fn app() -> App {
    let mut app = App::new();
    app.add_plugins((bevy::MinimalPlugins, CharacterPlugin))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(
            16,
        )));
    app.update();
    app
}

fn walks(speed: f32) -> CharacterMotion {
    CharacterMotion(Motion {
        speed,
        ..Default::default()
    })
}

fn person() -> Character {
    Character {
        figure: Arc::new(person::figure()),
    }
}

fn pose(app: &App, entity: Entity) -> &CharacterPose {
    app.world().get(entity).expect("a figure")
}

#[test]
fn headless_tests_see_joint_positions() {
    let mut app = app();
    let place = Transform::from_xyz(10.0, 2.0, -3.0).with_rotation(Quat::from_rotation_y(1.0));
    let figure = app.world_mut().spawn((person(), place, walks(1.1))).id();
    let head = person::skeleton().find("head").unwrap();
    let foot = person::skeleton().find("foot_l").unwrap();
    let mut feet = Vec::new();
    for _ in 0..90 {
        app.update();
        let pose = pose(&app, figure);
        let world = |joint| Vec3::from(pose.world(joint).unwrap().translation);
        assert!(
            (world(head) - Vec3::new(10.0, 3.6, -3.0)).length() < 0.2,
            "{}",
            world(head)
        );
        feet.push(Vec3::from(pose.model[foot].translation).z);
    }
    let (least, most) = feet
        .iter()
        .fold((1.0_f32, -1.0_f32), |(a, b), z| (a.min(*z), b.max(*z)));
    assert!(least < -0.2 && most > 0.2, "{least} {most}");
}

#[test]
fn feet_stand_on_a_ground_of_ones_own() {
    let mut app = app();
    app.insert_resource(CharacterGround::new(|xz: DVec2| {
        Some(Footing {
            height: 5.0 + 0.3 * xz.x,
            gradient: DVec2::new(0.3, 0.0),
        })
    }));
    let place = Transform::from_xyz(0.0, 5.0, 0.0);
    let character = person();
    let figure = character.figure.clone();
    let entity = app.world_mut().spawn((character, place)).id();
    for _ in 0..60 {
        app.update();
    }
    let pose = pose(&app, entity);
    for side in 0..2 {
        for point in figure.sole(side, &pose.model).unwrap() {
            let world = pose.place.transform_point3(point);
            assert!((world.y - 5.0 - 0.3 * world.x).abs() < 1e-3, "{world}");
        }
    }
}

#[test]
fn every_figure_stands_on_the_terrain_at_its_place() {
    let mut app = app();
    // From x = -50 to 50, level; from 150 to 250, a slope that the first one's ground lies far below.
    let flat = TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 100.0),
        layers: Vec::new(),
        base: 1.0,
        sea_level: None,
    };
    let hilly = TerrainData {
        extent: GroundRect::square(DVec2::new(200.0, 0.0), 100.0),
        layers: vec![Layer {
            source: Source::Hill(Hill {
                centre: DVec2::new(180.0, 0.0),
                radius: 60.0,
                height: 10.0,
            }),
            mask: None,
        }],
        base: 4.0,
        sea_level: None,
    };
    let terrains = [flat, hilly].map(|data| Terrain::new(data).expect("valid"));
    for terrain in &terrains {
        app.world_mut().spawn(terrain.clone());
    }
    for (x, terrain) in [0.0, 200.0].into_iter().zip(&terrains) {
        let ground = |x: f32, z: f32| terrain.height(DVec2::new(f64::from(x), f64::from(z))) as f32;
        let character = person();
        let figure = character.figure.clone();
        let place = Transform::from_xyz(x, ground(x, 0.0), 0.0);
        let entity = app.world_mut().spawn((character, place)).id();
        for _ in 0..60 {
            app.update();
        }
        let pose = pose(&app, entity);
        for side in 0..2 {
            // A sole lies on the plane under its ankle; the hill bends away from it by less than a centimetre.
            for point in figure.sole(side, &pose.model).unwrap() {
                let world = pose.place.transform_point3(point);
                let above = world.y - ground(world.x, world.z);
                assert!(above.abs() < 0.01, "x = {x} m: {above} m above the ground");
            }
        }
    }
}

#[test]
fn who_is_far_small_or_out_of_sight_is_sampled_less() {
    let mut app = app();
    let eye = CharacterEye::default();
    app.world_mut()
        .spawn((eye, Transform::from_xyz(0.0, 1.0, 0.0)));
    let mut spawn = |x: f32, z: f32| {
        let place = Transform::from_xyz(x, 0.0, z);
        app.world_mut().spawn((person(), place, walks(1.1))).id()
    };
    // 1.67 m at 10 m are 156 pixels, at 30 m 52, at 500 m 3.
    let near = spawn(0.0, -10.0);
    let far = spawn(0.0, -30.0);
    let tiny = spawn(0.0, -500.0);
    let behind = spawn(0.0, 100.0);
    let shadow = spawn(0.0, 10.0);
    app.update();
    let start = |app: &App, entity| app.world().get::<CharacterLod>(entity).unwrap().samples;
    let before = [near, far, tiny, behind, shadow].map(|entity| start(&app, entity));
    let (mut sampled, mut interpolated) = (0, 0);
    for _ in 0..40 {
        app.update();
        let counters = app.world().resource::<CharacterCounters>();
        sampled += counters.sampled;
        interpolated += counters.interpolated;
        assert_eq!(counters.resting, 2);
    }
    let after = [near, far, tiny, behind, shadow].map(|entity| start(&app, entity));
    let samples: Vec<u64> = after
        .iter()
        .zip(before)
        .map(|(after, before)| after - before)
        .collect();
    assert_eq!(samples, [40, 20, 0, 0, 20]);
    assert_eq!((sampled, interpolated), (80, 40));
    let store = app.world().resource::<DiagnosticsStore>();
    let found: Vec<&str> = store
        .iter()
        .map(|diagnostic| diagnostic.path().as_str())
        .filter(|path| path.starts_with("dolomite/character/"))
        .collect();
    assert_eq!(found.len(), 3, "{found:?}");
    // Without an eye everybody is sampled again.
    let eyes: Vec<Entity> = app
        .world_mut()
        .query_filtered::<Entity, With<CharacterEye>>()
        .iter(app.world())
        .collect();
    app.world_mut().despawn(eyes[0]);
    app.update();
    let lod = app.world().get::<CharacterLod>(tiny).unwrap();
    assert_eq!((lod.sampling, lod.samples), (Sampling::Full, 1));
}

#[test]
fn half_the_rate_is_hardly_seen() {
    // The same figure twice: once sampled every frame, once every second one.
    let mut app = app();
    app.world_mut()
        .spawn((CharacterEye::default(), Transform::from_xyz(0.0, 1.0, 0.0)));
    let place = |z: f32| Transform::from_xyz(0.0, 0.0, z);
    let near = app
        .world_mut()
        .spawn((person(), place(-10.0), walks(1.1)))
        .id();
    let far = app
        .world_mut()
        .spawn((person(), place(-30.0), walks(1.1)))
        .id();
    let mut most = 0.0_f32;
    let mut history: Vec<Vec<Vec3>> = Vec::new();
    for frame in 0..200 {
        app.update();
        let joints = |entity| -> Vec<Vec3> {
            pose(&app, entity)
                .model
                .iter()
                .map(|joint| joint.translation.into())
                .collect()
        };
        history.push(joints(near));
        if frame > 60 {
            // It is shown a frame late at most: compared with both.
            for (joint, late) in joints(far).iter().enumerate() {
                let now = history[frame][joint].distance(*late);
                let before = history[frame - 1][joint].distance(*late);
                most = most.max(now.min(before));
            }
        }
    }
    eprintln!("half rate: {most:.4} m");
    // Half-way between two poses is beside the one between them by half of what the speed changes in a
    // frame; a foot that lands or leaves changes its own by up to 1.5 m/s: 12 mm.
    assert!(most < 0.012, "{most} m");
}

#[test]
fn entities_of_a_scene_follow() {
    let mut app = app();
    let figure = app
        .world_mut()
        .spawn((person(), Transform::default(), walks(1.1)))
        .id();
    app.update();
    assert!(app.world().get::<CharacterJoints>(figure).is_none());
    // As a scene is spawned: some levels down, by name, and with what is no joint.
    let scene = app
        .world_mut()
        .spawn((Transform::default(), ChildOf(figure)))
        .id();
    let mesh = app
        .world_mut()
        .spawn((Name::new("mesh"), Transform::default(), ChildOf(scene)))
        .id();
    let mut hang = |name: &'static str, from| {
        app.world_mut()
            .spawn((Name::new(name), Transform::default(), ChildOf(from)))
            .id()
    };
    let hips = hang("hips", scene);
    let thigh = hang("thigh_l", hips);
    for _ in 0..30 {
        app.update();
    }
    let joint = person::skeleton().find("thigh_l").unwrap();
    let followed = *app.world().get::<Transform>(thigh).unwrap();
    let local = pose(&app, figure).local.get(joint);
    assert_eq!(
        (followed.rotation, followed.translation),
        (local.rotation, local.translation)
    );
    assert_ne!(followed.rotation, Quat::IDENTITY);
    assert_eq!(
        *app.world().get::<Transform>(mesh).unwrap(),
        Transform::default()
    );
    app.world_mut().despawn(scene);
    app.update();
}

#[test]
fn motion_may_be_measured() {
    let mut app = app();
    let entity = app
        .world_mut()
        .spawn((
            person(),
            Transform::default(),
            MotionFromTransform::default(),
        ))
        .id();
    for frame in 0..50 {
        let yaw = 0.5 * frame as f32 * 0.016;
        let mut place = app.world_mut().get_mut::<Transform>(entity).unwrap();
        let ahead = Quat::from_rotation_y(yaw) * Vec3::Z;
        place.translation += ahead * (2.0 * 0.016);
        place.rotation = Quat::from_rotation_y(yaw);
        app.update();
    }
    let motion = app.world().get::<CharacterMotion>(entity).unwrap().0;
    assert!(
        (motion.speed - 2.0).abs() < 1e-2 && (motion.turn_rate - 0.5).abs() < 1e-2,
        "{motion:?}"
    );
    // Put somewhere else it is not fast.
    app.world_mut()
        .get_mut::<Transform>(entity)
        .unwrap()
        .translation
        .x += 500.0;
    app.update();
    assert_eq!(
        app.world().get::<CharacterMotion>(entity).unwrap().0.speed,
        0.0
    );
}

/// Whether a type is known to the app, can be made without arguments, and is what `kind` says.
fn is_registered<T: 'static, Kind: TypeData>(app: &App) -> bool {
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let id = TypeId::of::<T>();
    registry.get_type_data::<ReflectDefault>(id).is_some()
        && registry.get_type_data::<Kind>(id).is_some()
}

#[test]
fn settings_and_answers_are_in_the_registry() {
    let app = app();
    for (name, is) in [
        ("eye", is_registered::<CharacterEye, ReflectComponent>(&app)),
        (
            "joints",
            is_registered::<CharacterJoints, ReflectComponent>(&app),
        ),
        (
            "level",
            is_registered::<CharacterLod, ReflectComponent>(&app),
        ),
        (
            "motion",
            is_registered::<CharacterMotion, ReflectComponent>(&app),
        ),
        (
            "measured",
            is_registered::<MotionFromTransform, ReflectComponent>(&app),
        ),
        (
            "counters",
            is_registered::<CharacterCounters, ReflectResource>(&app),
        ),
    ] {
        assert!(is, "{name}");
    }
}

#[cfg(feature = "render")]
#[test]
fn crowds_are_in_the_registry() {
    use dolomite_character::render::{Crowd, CrowdPlugin};
    let mut app = App::new();
    app.add_plugins((bevy::MinimalPlugins, CrowdPlugin));
    assert!(is_registered::<Crowd, ReflectComponent>(&app));
}

#[test]
fn no_figure_no_work() {
    let mut app = app();
    for _ in 0..3 {
        app.update();
    }
    assert_eq!(
        *app.world().resource::<CharacterCounters>(),
        CharacterCounters::default()
    );
}
