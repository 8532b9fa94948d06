//! Lights and targets as nobody should make them: refused by name, clamped, or drawn right; never a NaN pixel.

use bevy::prelude::*;
use dolomite_deferred::{DeferredLighting, DeferredStats, Way};
use dolomite_testkit::random::Random;

use dolomite_testkit::light::{self as support, WAYS};

pub fn floor(app: &mut App) {
    let mesh = app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(Plane3d::default().mesh().size(30.0, 30.0));
    let material = app
        .world_mut()
        .resource_mut::<Assets<StandardMaterial>>()
        .add(StandardMaterial {
            perceptual_roughness: 0.1,
            clearcoat: 0.5,
            ..default()
        });
    app.world_mut()
        .spawn((Mesh3d(mesh), MeshMaterial3d(material)));
}

pub fn eye() -> Transform {
    Transform::from_xyz(0.0, 2.0, 6.0).looking_at(Vec3::ZERO, Vec3::Y)
}

pub fn lamp(change: impl FnOnce(&mut PointLight)) -> (PointLight, Transform) {
    let mut light = PointLight {
        intensity: 5000.0,
        range: 6.0,
        ..default()
    };
    change(&mut light);
    (light, Transform::from_xyz(0.5, 1.0, 0.0))
}

pub fn torch(change: impl FnOnce(&mut SpotLight)) -> (SpotLight, Transform) {
    let mut light = SpotLight {
        intensity: 5000.0,
        range: 6.0,
        ..default()
    };
    change(&mut light);
    (
        light,
        Transform::from_xyz(-1.0, 2.0, 0.0).looking_to(Vec3::NEG_Y, Vec3::X),
    )
}

#[test]
fn hostile_lights_leave_no_nonsense_in_any_way() {
    let Some(mut app) = support::app(true) else {
        return;
    };
    floor(&mut app);
    app.world_mut().spawn(lamp(|_| {}));
    app.world_mut().spawn(torch(|_| {}));
    // Only high dynamic range keeps what is no number: elsewhere tone mapping, Bevy's, makes it 0.
    let camera = support::camera(&mut app, [96, 54], eye(), bevy::camera::Hdr);
    let clean = WAYS.map(|way| support::lit_by(&mut app, camera, Some(way)));
    assert!(clean[0].lit() > 1000);
    let mut hostile = Vec::new();
    for bad in [0.0, -5.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        hostile.push(app.world_mut().spawn(lamp(|l| l.intensity = bad)).id());
        hostile.push(app.world_mut().spawn(torch(|l| l.intensity = bad)).id());
        if bad.is_nan() || bad <= 0.0 {
            hostile.push(app.world_mut().spawn(lamp(|l| l.range = bad)).id());
            hostile.push(app.world_mut().spawn(torch(|l| l.range = bad)).id());
        }
    }
    for bad in [f32::NAN, f32::INFINITY] {
        hostile.push(app.world_mut().spawn(torch(|l| l.inner_angle = bad)).id());
    }
    hostile.push(
        app.world_mut()
            .spawn(torch(|l| l.outer_angle = f32::NAN))
            .id(),
    );
    for illuminance in [-5.0, f32::NAN, f32::INFINITY, 1e30] {
        let sun = DirectionalLight {
            illuminance,
            ..default()
        };
        hostile.push(app.world_mut().spawn(sun).id());
    }
    let (light, _) = lamp(|_| {});
    hostile.push(
        app.world_mut()
            .spawn((light, Transform::from_xyz(f32::NAN, 0.0, 0.0)))
            .id(),
    );
    for (way, clean) in WAYS.iter().zip(&clean) {
        let picture = support::lit_by(&mut app, camera, Some(*way));
        assert_eq!(picture.nonsense(), 0, "{way:?}");
        // `inner_angle` of infinity is clamped to the outer one by Bevy, and shines.
        let views = app.world().resource::<DeferredStats>().views();
        eprintln!("{way:?}: {} refused of {}", views[0].refused, hostile.len());
        assert!(views[0].refused >= 16);
        assert!(
            picture.relative_difference(clean, 1e-3) < 1.0,
            "refused lights light nothing"
        );
    }
    for light in hostile {
        app.world_mut().despawn(light);
    }
    // What is clamped shines.
    let clamped = [
        app.world_mut().spawn(lamp(|l| l.radius = f32::NAN)).id(),
        app.world_mut().spawn(lamp(|l| l.radius = -1.0)).id(),
        app.world_mut()
            .spawn(lamp(|l| l.radius = f32::INFINITY))
            .id(),
        app.world_mut()
            .spawn(lamp(|l| l.range = f32::INFINITY))
            .id(),
        app.world_mut().spawn(torch(|l| l.outer_angle = 7.0)).id(),
        app.world_mut().spawn(torch(|l| l.outer_angle = -1.0)).id(),
        app.world_mut().spawn(torch(|l| l.outer_angle = 0.0)).id(),
    ];
    let pictures = WAYS.map(|way| support::lit_by(&mut app, camera, Some(way)));
    for (way, picture) in WAYS.iter().zip(&pictures) {
        assert_eq!(picture.nonsense(), 0, "{way:?}");
        let apart = picture.relative_difference(&pictures[0], 1e-3);
        assert!(apart <= 1e-5, "{way:?}: {apart}");
    }
    assert!(pictures[0].brightest() > clean[0].brightest());
    for light in clamped {
        app.world_mut().despawn(light);
    }
    for bad in [f32::NAN, f32::INFINITY] {
        app.insert_resource(GlobalAmbientLight {
            brightness: bad,
            ..default()
        });
        for way in WAYS {
            let picture = support::lit_by(&mut app, camera, Some(way));
            assert_eq!(picture.nonsense(), 0, "{way:?}, ambient light of {bad}");
        }
    }
}

#[test]
fn lights_around_the_camera_across_its_near_plane_and_below_a_pixel_are_not_missed() {
    let Some(mut app) = support::app(true) else {
        return;
    };
    floor(&mut app);
    let mut random = Random::new(11);
    let mut lights = Vec::new();
    let camera = support::camera(&mut app, [97, 61], eye(), ());
    // `DOLOMITE_CAMERAS` asks for more of them, each with 150 lights of its own.
    let rounds = std::env::var("DOLOMITE_CAMERAS").map_or(6, |n| n.parse().expect("a number"));
    let (mut lit, mut worst) = (0, 0.0_f32);
    for round in 0..rounds {
        for light in lights.drain(..) {
            app.world_mut().despawn(light);
        }
        let at = Vec3::new(
            random.range(-8.0, 8.0),
            random.range(0.05, 3.0),
            random.range(-8.0, 8.0),
        );
        let to = Vec3::new(
            random.range(-1.0, 1.0),
            random.range(-0.7, 0.1),
            random.range(-1.0, 1.0),
        );
        let eye = Transform::from_translation(at).looking_to(to, Vec3::Y);
        app.world_mut().entity_mut(camera).insert(eye);
        for _ in 0..150 {
            // From millimetres to the whole scene; near the floor, near the camera.
            let range = bevy::math::ops::exp2(random.range(-8.0, 5.0));
            let around = if random.unit_f32() < 0.3 {
                at
            } else {
                Vec3::ZERO
            };
            let spread = if around == at { range } else { 9.0 };
            let mut place = around
                + Vec3::new(
                    random.range(-1.0, 1.0),
                    random.range(-1.0, 1.0),
                    random.range(-1.0, 1.0),
                ) * spread;
            if random.unit_f32() < 0.5 {
                place.y = range * random.range(-0.9, 0.9);
            }
            let place = Transform::from_translation(place);
            let intensity = 1000.0 * range * range;
            let light = if random.unit_f32() < 0.5 {
                app.world_mut()
                    .spawn((
                        PointLight {
                            intensity,
                            range,
                            ..default()
                        },
                        place,
                    ))
                    .id()
            } else {
                let outer_angle = random.range(0.01, 1.57);
                let to = Vec3::new(
                    random.range(-1.0, 1.0),
                    random.range(-1.0, 1.0),
                    random.range(-1.0, 1.0),
                );
                let spot = SpotLight {
                    intensity,
                    range,
                    outer_angle,
                    inner_angle: outer_angle * 0.5,
                    ..default()
                };
                app.world_mut()
                    .spawn((spot, place.looking_to(to, Vec3::X)))
                    .id()
            };
            lights.push(light);
        }
        let all = support::lit_by(&mut app, camera, Some(Way::BruteForce));
        for way in [Way::Tiled, Way::Volumes] {
            let picture = support::lit_by(&mut app, camera, Some(way));
            let other = picture
                .pixels
                .iter()
                .zip(&all.pixels)
                .filter(|(a, b)| a != b)
                .count();
            let apart = picture.relative_difference(&all, 1e-6);
            eprintln!(
                "round {round} {way:?}: {other} pixels differ, by {apart:e}; {} lit",
                all.lit()
            );
            assert!(apart <= 1e-5, "{way:?}: {apart}");
            worst = worst.max(apart);
            let missed = picture.pixels.iter().zip(&all.pixels);
            let dark = |pixel: &[f32; 4]| pixel[..3].iter().all(|channel| *channel <= 0.0);
            assert_eq!(missed.filter(|(a, b)| dark(a) && !dark(b)).count(), 0);
        }
        lit += all.lit();
    }
    eprintln!("{rounds} cameras of 150 lights: {lit} lit pixels, none missed, {worst:e} apart");
    assert!(lit > 0);
}

#[test]
fn the_smallest_and_the_flattest_target_and_multisampling_are_drawn() {
    let Some(mut app) = support::app(true) else {
        return;
    };
    floor(&mut app);
    for k in 0..12 {
        let place = Transform::from_xyz(k as f32 - 6.0, 1.0, -1.0);
        app.world_mut().spawn((lamp(|l| l.range = 4.0).0, place));
    }
    for size in [[1, 1], [4097, 3], [16, 17]] {
        let camera = support::camera(&mut app, size, eye(), Msaa::Sample4);
        let pictures = WAYS.map(|way| support::lit_by(&mut app, camera, Some(way)));
        for (way, picture) in WAYS.iter().zip(&pictures) {
            assert_eq!(picture.nonsense(), 0);
            let apart = picture.relative_difference(&pictures[0], 1e-4);
            assert!(apart <= 1e-5, "{way:?} {size:?}: {apart}");
            assert!(picture.lit() > 0, "{way:?} {size:?}");
        }
        app.world_mut().despawn(camera);
    }
}

pub fn check(app: &mut App, camera: Entity, ways: &[Way]) {
    let first = support::lit_by(app, camera, Some(ways[0]));
    assert!(first.lit() > 100);
    for way in &ways[1..] {
        let picture = support::lit_by(app, camera, Some(*way));
        let apart = picture.relative_difference(&first, 1e-3);
        eprintln!("{way:?}: {apart:e}");
        assert!(apart <= 1e-5 && picture.nonsense() == 0, "{way:?}: {apart}");
    }
}

#[test]
fn ten_thousand_overlapping_lights() {
    let Some(mut app) = support::app(true) else {
        return;
    };
    floor(&mut app);
    let mut random = Random::new(5);
    for _ in 0..10_000 {
        let place = Transform::from_xyz(
            random.range(-1.0, 1.0),
            random.range(0.5, 1.5),
            random.range(-1.0, 1.0),
        );
        let intensity = random.range(0.0, 1.0);
        app.world_mut().spawn((
            PointLight {
                intensity,
                range: 20.0,
                ..default()
            },
            place,
        ));
    }
    let camera = support::camera(&mut app, [24, 14], eye(), ());
    check(&mut app, camera, &WAYS);
}

/// So many small lights over a floor, most of them in view.
fn small_lights(count: u32) {
    let Some(mut app) = support::app(true) else {
        return;
    };
    floor(&mut app);
    // Most of the floor lies within reach of one, however many there are.
    let reach = (25_000.0 / count as f32).sqrt();
    let mut random = Random::new(6);
    for _ in 0..count {
        let place = Transform::from_xyz(
            random.range(-40.0, 40.0),
            random.range(0.1, 1.5),
            random.range(-40.0, 4.0),
        );
        app.world_mut().spawn((
            PointLight {
                intensity: 100.0,
                range: reach,
                ..default()
            },
            place,
        ));
    }
    let camera = support::camera(&mut app, [24, 14], eye(), ());
    check(&mut app, camera, &[Way::Tiled, Way::Volumes]);
    app.world_mut()
        .entity_mut(camera)
        .insert(DeferredLighting::default());
    support::frames(&mut app, 2);
    let seen = app.world().resource::<DeferredStats>().views()[0].lights;
    eprintln!("{seen} of {count} in view");
    // Some 45 of 100 lie before the camera.
    assert!(seen > count / 3);
}

#[test]
fn ten_thousand_small_lights() {
    small_lights(10_000);
}

#[test]
#[ignore = "minutes on software Vulkan; ten times as many as `ten_thousand_small_lights`"]
fn a_hundred_thousand_small_lights() {
    small_lights(100_000);
}
