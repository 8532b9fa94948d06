//! All ways give the same picture, and it is Bevy's.

use bevy::camera::Viewport;
use bevy::prelude::*;
use dolomite_deferred::DeferredLighting;
use dolomite_testkit::random::Random;

use dolomite_testkit::light::{self as support, WAYS};

/// A floor, spheres of many materials, and lamps above them.
pub fn scene(app: &mut App, seed: u32, points: usize, spots: usize) {
    let mut random = Random::new(seed);
    let mut unit = move || random.unit_f32();
    let sphere = app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(Sphere::new(0.9).mesh().uv(48, 24));
    let floor = app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(Plane3d::default().mesh().size(40.0, 40.0));
    for i in 0..25 {
        let material = StandardMaterial {
            base_color: Color::linear_rgb(unit(), unit(), unit()),
            metallic: if i % 3 == 0 { 1.0 } else { 0.0 },
            perceptual_roughness: 0.15 + 0.85 * unit(),
            reflectance: unit(),
            emissive: if i % 7 == 0 {
                LinearRgba::rgb(2.0 * unit(), unit(), 0.0)
            } else {
                LinearRgba::BLACK
            },
            clearcoat: if i % 5 == 0 { 1.0 } else { 0.0 },
            clearcoat_perceptual_roughness: 0.3,
            ..default()
        };
        let material = app
            .world_mut()
            .resource_mut::<Assets<StandardMaterial>>()
            .add(material);
        let place = Vec3::new((i % 5) as f32 * 2.2 - 4.4, 0.9, (i / 5) as f32 * -2.2);
        app.world_mut().spawn((
            Mesh3d(sphere.clone()),
            MeshMaterial3d(material.clone()),
            Transform::from_translation(place),
        ));
        if i == 0 {
            app.world_mut()
                .spawn((Mesh3d(floor.clone()), MeshMaterial3d(material)));
        }
    }
    let mut place = {
        let mut random = Random::new(seed + 1);
        move || {
            let mut unit = || random.unit_f32();
            Vec3::new(unit() * 14.0 - 7.0, 0.3 + 3.0 * unit(), 3.0 - 14.0 * unit())
        }
    };
    for i in 0..points {
        app.world_mut().spawn((
            PointLight {
                color: Color::linear_rgb(unit(), unit(), unit()),
                intensity: 4000.0 * unit(),
                range: 1.0 + 6.0 * unit(),
                radius: if i % 4 == 0 { 0.2 } else { 0.0 },
                ..default()
            },
            Transform::from_translation(place()),
        ));
    }
    for _ in 0..spots {
        let outer = 0.05 + 1.5 * unit();
        app.world_mut().spawn((
            SpotLight {
                color: Color::linear_rgb(unit(), unit(), unit()),
                intensity: 9000.0,
                range: 2.0 + 9.0 * unit(),
                inner_angle: outer * unit(),
                outer_angle: outer,
                ..default()
            },
            Transform::from_translation(place() + Vec3::Y)
                .looking_to(Vec3::new(unit() - 0.5, -unit(), unit() - 0.5), Vec3::X),
        ));
    }
}

pub fn sun(app: &mut App) {
    app.world_mut().spawn((
        DirectionalLight {
            illuminance: 30.0,
            ..default()
        },
        Transform::default().looking_to(Vec3::new(-1.0, -1.5, -0.6), Vec3::Y),
    ));
    app.insert_resource(GlobalAmbientLight {
        brightness: 3.0,
        ..default()
    });
}

pub fn eye() -> Transform {
    Transform::from_xyz(3.0, 4.5, 7.0).looking_at(Vec3::new(0.0, 0.5, -4.0), Vec3::Y)
}

#[test]
fn three_ways_give_the_same_picture_and_it_is_bevys() {
    let Some(mut app) = support::app(true) else {
        return;
    };
    scene(&mut app, 1, 40, 20);
    sun(&mut app);
    let camera = support::camera(&mut app, [323, 181], eye(), ());
    let bevys = support::picture(&mut app, camera, 12);
    support::keep(&bevys, 20.0, "ways-bevy");
    let pictures = WAYS.map(|way| support::lit_by(&mut app, camera, Some(way)));
    for (way, picture) in WAYS.iter().zip(&pictures) {
        support::keep(picture, 20.0, &format!("ways-{way:?}"));
        assert_eq!(picture.nonsense(), 0, "{way:?}");
        let apart = picture.relative_difference(&pictures[0], 1e-3);
        eprintln!("{way:?}: {apart:e} from brute force");
        assert!(apart <= 1e-5, "{way:?} is {apart} from brute force");
        let mut apart: Vec<f32> = picture
            .pixels
            .iter()
            .zip(&bevys.pixels)
            .map(|(a, b)| {
                (0..3)
                    .map(|c| (a[c] - b[c]).abs() / b[c].max(0.01))
                    .fold(0.0, f32::max)
            })
            .collect();
        apart.sort_by(f32::total_cmp);
        let at = |part: f64| apart[((apart.len() - 1) as f64 * part) as usize];
        eprintln!(
            "{way:?}: from Bevy's p50 {:e} p99 {:e} p99.9 {:e} max {:e}",
            at(0.5),
            at(0.99),
            at(0.999),
            at(1.0)
        );
    }
    assert!(pictures[0].lit() > 20_000 && pictures[0].brightest() > 1.0);
    let again = support::lit_by(&mut app, camera, None);
    assert_eq!(
        again.pixels, bevys.pixels,
        "without the component it is Bevy's"
    );
}

#[test]
fn viewports_and_orthographic_views_are_lit_alike() {
    let Some(mut app) = support::app(true) else {
        return;
    };
    scene(&mut app, 3, 30, 20);
    let part = Viewport {
        physical_position: UVec2::new(21, 13),
        physical_size: UVec2::new(75, 50),
        ..default()
    };
    let camera = support::camera(&mut app, [128, 72], eye(), ());
    let window = Camera {
        viewport: Some(part),
        ..default()
    };
    app.world_mut().entity_mut(camera).insert(window);
    let flat = Projection::Orthographic(OrthographicProjection {
        near: -2.0,
        far: 60.0,
        scale: 0.1,
        ..OrthographicProjection::default_3d()
    });
    for name in ["perspective", "orthographic"] {
        if name == "orthographic" {
            app.world_mut().entity_mut(camera).insert(flat.clone());
        }
        let bevys = support::lit_by(&mut app, camera, None);
        let pictures = WAYS.map(|way| support::lit_by(&mut app, camera, Some(way)));
        support::keep(&pictures[2], 20.0, &format!("viewport-{name}"));
        for (way, picture) in WAYS.iter().zip(&pictures) {
            let apart = picture.relative_difference(&pictures[0], 1e-3);
            let from_bevys = picture.relative_difference(&bevys, 1e-2);
            eprintln!("{name} {way:?}: {apart:e} from brute force, {from_bevys:e} from Bevy's");
            assert!(apart <= 1e-5, "{name} {way:?}: {apart}");
            // Bevy's highlights lose digits.
            assert!(from_bevys <= 1e-2, "{name} {way:?}: {from_bevys}");
        }
        assert!(pictures[0].lit() > 1000, "{name}");
    }
}

/// Times of whole frames by each way for more and more lights: what `Auto` is chosen by.
#[test]
#[ignore = "measures"]
fn times_of_the_ways() {
    let Some(mut app) = support::app(true) else {
        return;
    };
    let camera = support::camera(&mut app, [320, 180], eye(), ());
    scene(&mut app, 1, 0, 0);
    let mut all = 0;
    for count in [1, 4, 16, 64, 256, 1024] {
        let mut random = Random::new(count);
        for _ in all..count {
            let place = Vec3::new(
                random.range(-7.0, 7.0),
                random.range(0.3, 3.0),
                random.range(-11.0, 3.0),
            );
            let light = PointLight {
                range: 3.0,
                ..default()
            };
            app.world_mut()
                .spawn((light, Transform::from_translation(place)));
        }
        all = count;
        let mut times = WAYS.map(|_| Vec::new());
        for _ in 0..5 {
            for (way, times) in WAYS.iter().zip(&mut times) {
                let way = DeferredLighting { way: *way };
                app.world_mut().entity_mut(camera).insert(way);
                support::frames(&mut app, 2);
                let start = std::time::Instant::now();
                support::frames(&mut app, 1);
                times.push(start.elapsed().as_secs_f64() * 1e3);
            }
        }
        let medians = times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            times[2]
        });
        eprintln!("{count} lights: {WAYS:?} {medians:.1?} ms a frame");
    }
}
