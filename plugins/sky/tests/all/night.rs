//! Day and night in an app that has assets and no renderer: what is spawned, and what goes again.
use crate::support;

use bevy::camera::Exposure;
use bevy::light::{DirectionalLight, EnvironmentMapLight, Skybox};
use bevy::pbr::DistanceFog;
use bevy::prelude::*;
use dolomite_sky::render::{Dome, DrawnSky, Moon, Star};
use dolomite_sky::{SeenSky, Sky, Sun};
use dolomite_tessellation::{GeometryCamera, Patches};
use support::{app, camera, found, set, small, sun};

/// How many entities of stars and of moons there are.
fn count(app: &mut App) -> [usize; 2] {
    found(app);
    let world = app.world_mut();
    let stars = world.query::<&Patches<Star>>().iter(world).count();
    [stars, world.query::<&Patches<Moon>>().iter(world).count()]
}

#[test]
fn without_a_sky_there_is_nothing() {
    let mut app = app();
    camera(&mut app, ());
    sun(&mut app, -30.0);
    assert_eq!(found(&mut app), (0, 0), "a sun without a sky");
    let mut app = support::app();
    let camera = camera(&mut app, small());
    assert_eq!(found(&mut app), (0, 0), "a sky without a sun");
    assert!(app.world().get::<SeenSky>(camera).is_none());
    // The counts can fail.
    sun(&mut app, -30.0);
    assert_eq!(found(&mut app), (3, 2));
}

#[test]
fn by_day_there_is_neither_star_nor_moon() {
    let mut app = app();
    let camera = camera(&mut app, small());
    let sun = sun(&mut app, 24.0);
    assert_eq!(count(&mut app), [0, 0], "day");
    assert!(
        app.world().get::<GeometryCamera>(camera).is_none(),
        "no patches are looked for"
    );
    for (elevation, expected) in [
        (-1.0, [0, 1]),
        (-30.0, [1, 1]),
        (-40.0, [1, 1]),
        (-90.0, [1, 1]),
        (2.0, [0, 0]),
    ] {
        set(&mut app, sun, elevation);
        assert_eq!(count(&mut app), expected, "{elevation}");
    }
}

#[test]
fn settings_take_stars_and_moon_away() {
    let mut app = app();
    let camera = camera(&mut app, small());
    sun(&mut app, -30.0);
    assert_eq!(count(&mut app), [1, 1]);
    for (sky, expected) in [
        (
            Sky {
                stars: 0.0,
                ..small()
            },
            [0, 1],
        ),
        (
            Sky {
                moon_size: 0.0,
                ..small()
            },
            [1, 0],
        ),
        (small(), [1, 1]),
    ] {
        *app.world_mut().get_mut::<Sky>(camera).expect("a sky") = sky;
        assert_eq!(count(&mut app), expected);
    }
}

#[test]
fn the_dome_follows_its_camera_and_rests_with_it() {
    let mut app = app();
    let eye = camera(&mut app, small());
    sun(&mut app, -30.0);
    assert_eq!(count(&mut app), [1, 1]);
    for at in [
        Vec3::new(300.0, 20.0, -7.0),
        Vec3::new(1e7, -3e6, 2e7),
        Vec3::new(-1e12, 0.0, 1e12),
    ] {
        app.world_mut()
            .get_mut::<Transform>(eye)
            .expect("there")
            .translation = at;
        app.update();
        app.update();
        let tick = app.world_mut().change_tick();
        app.update();
        let world = app.world_mut();
        let now = world.read_change_tick();
        let mut domes = world.query::<(&Dome, Ref<Transform>, Ref<GlobalTransform>)>();
        assert_eq!(domes.iter(world).count(), 2);
        for (dome, place, global) in domes.iter(world) {
            assert_eq!((dome.camera, place.translation), (eye, at + dome.offset));
            assert_eq!(global.translation(), place.translation);
            let rests = !place.last_changed().is_newer_than(tick, now)
                && !global.last_changed().is_newer_than(tick, now);
            assert!(rests, "{at}: {dome:?}");
        }
    }
    // A camera that is nowhere leaves them where they are.
    let place = |app: &mut App| {
        let world = app.world_mut();
        let mut domes = world.query_filtered::<&Transform, With<Dome>>();
        domes.iter(world).copied().collect::<Vec<_>>()
    };
    let before = place(&mut app);
    app.world_mut()
        .get_mut::<Transform>(eye)
        .expect("there")
        .translation
        .x = f32::NAN;
    app.update();
    assert_eq!(place(&mut app), before);
}

#[test]
fn a_camera_may_hang_on_something_that_moves() {
    let mut app = app();
    let head = camera(&mut app, small());
    app.world_mut()
        .get_mut::<Transform>(head)
        .expect("there")
        .translation
        .y = 1.7;
    let body = app
        .world_mut()
        .spawn(Transform::from_xyz(0.0, 0.0, 0.0))
        .id();
    app.world_mut().entity_mut(body).add_child(head);
    sun(&mut app, -30.0);
    count(&mut app);
    app.world_mut()
        .get_mut::<Transform>(body)
        .expect("there")
        .translation
        .x = 40.0;
    app.update();
    let world = app.world_mut();
    for (dome, place) in world.query::<(&Dome, &GlobalTransform)>().iter(world) {
        let eye = Vec3::new(40.0, 1.7, 0.0);
        assert_eq!(place.translation(), eye + dome.offset, "in the same frame");
    }
}

#[test]
fn two_cameras_with_one_sky_share_its_maps_and_have_a_dome_each() {
    let mut app = app();
    let left = camera(&mut app, small());
    let right = camera(&mut app, small());
    let without = camera(&mut app, ());
    sun(&mut app, -30.0);
    assert_eq!(found(&mut app), (3, 4));
    let world = app.world_mut();
    let mut cameras: Vec<Entity> = world
        .query::<(&Dome, &Patches<Star>)>()
        .iter(world)
        .map(|(dome, patches)| {
            assert_eq!(patches.camera, Some(dome.camera), "it sees its own alone");
            dome.camera
        })
        .collect();
    cameras.sort_by_key(|camera| camera.index_u32());
    assert_eq!(cameras, [left, right]);
    assert!(world.get::<Skybox>(without).is_none() && world.get::<DrawnSky>(without).is_none());
    // One goes: what is hers goes with her, in the same frame or the next.
    world.despawn(right);
    assert_eq!(found(&mut app), (3, 2));
}

#[test]
fn a_camera_with_another_sky_sees_the_stars_of_none() {
    let mut app = app();
    let first = camera(&mut app, small());
    camera(
        &mut app,
        Sky {
            dust: 9.0,
            ..small()
        },
    );
    sun(&mut app, -30.0);
    // Each has its maps.
    assert_eq!(found(&mut app), (6, 2));
    let world = app.world_mut();
    assert!(
        world
            .query::<&Dome>()
            .iter(world)
            .all(|dome| dome.camera == first)
    );
}

#[test]
fn stars_are_not_drawn_with_several_samples() {
    let mut app = app();
    let camera = camera(&mut app, small());
    app.world_mut().entity_mut(camera).insert(Msaa::Sample4);
    sun(&mut app, -30.0);
    assert_eq!(found(&mut app), (3, 0));
    assert!(app.world().get::<GeometryCamera>(camera).is_none());
    app.world_mut().entity_mut(camera).insert(Msaa::Off);
    assert_eq!(found(&mut app), (3, 2));
}

#[test]
fn what_a_sky_brings_goes_with_it() {
    let mut app = app();
    let camera = camera(&mut app, small());
    sun(&mut app, -30.0);
    assert_eq!(found(&mut app), (3, 2));
    let has = |app: &App| {
        let camera = app.world().entity(camera);
        [
            camera.contains::<Skybox>(),
            camera.contains::<EnvironmentMapLight>(),
            camera.contains::<AmbientLight>(),
            camera.contains::<DistanceFog>(),
            camera.contains::<DrawnSky>(),
            camera.contains::<SeenSky>(),
        ]
    };
    assert_eq!(has(&app), [true; 6]);
    app.world_mut().entity_mut(camera).remove::<Sky>();
    // An image is let go of an update after its last handle.
    app.update();
    assert_eq!(found(&mut app), (0, 0));
    assert_eq!(has(&app), [false; 6]);
}

#[test]
fn light_and_haze_are_a_choice() {
    let mut app = app();
    let camera = camera(
        &mut app,
        Sky {
            light: false,
            haze: 0.0,
            ..small()
        },
    );
    sun(&mut app, 30.0);
    found(&mut app);
    let has = |app: &App| {
        let camera = app.world().entity(camera);
        [
            camera.contains::<EnvironmentMapLight>(),
            camera.contains::<DistanceFog>(),
        ]
    };
    assert_eq!(has(&app), [false; 2]);
    *app.world_mut().get_mut::<Sky>(camera).expect("a sky") = small();
    found(&mut app);
    assert_eq!(has(&app), [true; 2]);
}

#[test]
fn the_exposure_follows_the_light_or_stays_the_cameras_own() {
    let mut app = app();
    let follows = camera(&mut app, small());
    let own = camera(
        &mut app,
        (
            Sky {
                expose: false,
                ..small()
            },
            Exposure { ev100: 4.0 },
        ),
    );
    let sun = sun(&mut app, 30.0);
    for elevation in [30.0, -5.0, -30.0] {
        set(&mut app, sun, elevation);
        found(&mut app);
        let ev100 = |camera| app.world().get::<Exposure>(camera).expect("exposed").ev100;
        let seen = app.world().get::<SeenSky>(follows).expect("a sky");
        assert_eq!(
            (ev100(follows), ev100(own)),
            (seen.ev100, 4.0),
            "{elevation}"
        );
        let drawn = app.world().get::<DrawnSky>(own).expect("a sky");
        // As Bevy has it.
        assert_eq!(drawn.exposure, 1.0 / (1.2 * 16.0));
    }
    app.world_mut()
        .entity_mut(own)
        .insert(Exposure { ev100: 5.0 });
    found(&mut app);
    let drawn = app.world().get::<DrawnSky>(own).expect("a sky");
    assert_eq!(
        drawn.exposure,
        1.0 / (1.2 * 32.0),
        "a change of its own is followed"
    );
}

#[test]
fn the_light_comes_from_the_sun_by_day_and_from_the_moon_by_night() {
    let mut app = app();
    let sun = sun(&mut app, 30.0);
    let light = |app: &mut App| {
        app.update();
        let entity = app.world().entity(sun);
        let light = *entity.get::<DirectionalLight>().expect("a light");
        (entity.get::<Transform>().expect("turned").back(), light)
    };
    let (towards, day) = light(&mut app);
    let place = *app.world().get::<Sun>(sun).expect("a sun");
    // Through a rotation of f32: some units in the last place.
    assert!(towards.distance(place.towards().expect("a place")) < 1e-5);
    assert!(day.illuminance > 50_000.0 && day.shadow_maps_enabled);
    for elevation in [90.0, -90.0] {
        set(&mut app, sun, elevation);
        let (towards, light) = light(&mut app);
        assert!(
            towards.y > 0.999_99 && towards.is_normalized(),
            "{elevation}: {towards:?}"
        );
        assert_eq!(
            light.illuminance > 1_000.0,
            elevation > 0.0,
            "{elevation}: {light:?}"
        );
    }
    set(&mut app, sun, f32::NAN);
    let (towards, still) = light(&mut app);
    assert!(
        towards.y > 0.999_99 && still.illuminance < 1.0,
        "all stays as it was: {still:?}"
    );
}
