//! What Bevy's own pass lights with beside lamps is lit with by ours: shadow maps, contact shadows, ambient
//! occlusion, environment maps, fog. The two pictures are compared.

use bevy::pbr::{ContactShadows, DistanceFog, FogFalloff, ScreenSpaceAmbientOcclusion};
use bevy::prelude::*;
use dolomite_deferred::Way;
use dolomite_testkit::light::{self as support, Picture};

fn scene(app: &mut App) {
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    let floor = meshes.add(Plane3d::default().mesh().size(30.0, 30.0));
    let ball = meshes.add(Sphere::new(0.8).mesh().uv(48, 24));
    let mut materials = app.world_mut().resource_mut::<Assets<StandardMaterial>>();
    let plain = materials.add(StandardMaterial {
        base_color: Color::linear_rgb(0.6, 0.5, 0.4),
        perceptual_roughness: 0.6,
        ..default()
    });
    let coated = materials.add(StandardMaterial {
        base_color: Color::linear_rgb(0.2, 0.3, 0.7),
        perceptual_roughness: 0.3,
        clearcoat: 0.7,
        metallic: 0.4,
        ..default()
    });
    let unlit = materials.add(StandardMaterial {
        base_color: Color::linear_rgb(0.1, 0.8, 0.2),
        unlit: true,
        ..default()
    });
    app.world_mut()
        .spawn((Mesh3d(floor), MeshMaterial3d(plain)));
    for (k, material) in [coated.clone(), coated, unlit].into_iter().enumerate() {
        let place = Transform::from_xyz(k as f32 * 2.0 - 2.0, 0.8, 0.0);
        app.world_mut()
            .spawn((Mesh3d(ball.clone()), MeshMaterial3d(material), place));
    }
    let sun = DirectionalLight {
        illuminance: 4.0,
        shadow_maps_enabled: true,
        contact_shadows_enabled: true,
        ..default()
    };
    let towards = Transform::default().looking_to(Vec3::new(-1.0, -1.0, -0.4), Vec3::Y);
    app.world_mut().spawn((sun, towards));
    for x in [-3.0, 1.0] {
        let lamp = PointLight {
            intensity: 1500.0,
            range: 9.0,
            shadow_maps_enabled: x < 0.0,
            contact_shadows_enabled: true,
            ..default()
        };
        app.world_mut()
            .spawn((lamp, Transform::from_xyz(x, 2.5, 1.5)));
        let spot = SpotLight {
            intensity: 3000.0,
            range: 9.0,
            outer_angle: 0.7,
            shadow_maps_enabled: x > 0.0,
            ..default()
        };
        let place = Transform::from_xyz(x, 3.0, 2.0).looking_at(Vec3::ZERO, Vec3::Y);
        app.world_mut().spawn((spot, place));
    }
    app.insert_resource(GlobalAmbientLight {
        brightness: 0.4,
        ..default()
    });
}

/// Share of the pixels that differ by more than `part`.
fn share(a: &Picture, b: &Picture, part: f32) -> f32 {
    let differs = |a: &[f32; 4], b: &[f32; 4]| {
        let apart = |k: usize| (a[k] - b[k]).abs() / a[k].abs().max(b[k].abs()).max(1e-3);
        (0..3).any(|k| apart(k) > part)
    };
    let count = a
        .pixels
        .iter()
        .zip(&b.pixels)
        .filter(|(a, b)| differs(a, b))
        .count();
    count as f32 / a.pixels.len() as f32
}

/// Where a place lies on a shadow's edge its rounding decides the side.
const EDGES: f32 = 0.002;

/// Ours without and with the components that `more` makes, and Bevy's with them.
fn pictures<B: Bundle>(name: &str, more: impl FnOnce(&mut App) -> B) -> Option<[Picture; 3]> {
    let mut app = support::app(true)?;
    scene(&mut app);
    let eye = Transform::from_xyz(1.0, 3.0, 6.0).looking_at(Vec3::new(0.0, 0.4, 0.0), Vec3::Y);
    let camera = support::camera(&mut app, [160, 90], eye, ());
    let plain = support::lit_by(&mut app, camera, Some(Way::Tiled));
    let more = more(&mut app);
    app.world_mut().entity_mut(camera).insert(more);
    let ours = support::lit_by(&mut app, camera, Some(Way::Tiled));
    let bevys = support::lit_by(&mut app, camera, None);
    support::keep(&ours, 4.0, &format!("as-bevys-{name}"));
    support::keep(&bevys, 4.0, &format!("as-bevys-{name}-bevy"));
    let [changed, apart] = [share(&plain, &ours, 1e-3), share(&ours, &bevys, 1e-3)];
    eprintln!("{name}: {changed} of the pixels changed, {apart} are not Bevy's");
    assert_eq!(ours.nonsense(), 0);
    Some([plain, ours, bevys])
}

#[test]
fn shadow_maps_are_bevys() {
    let Some([_, ours, bevys]) = pictures("shadows", |app| {
        app.insert_resource(bevy::light::DirectionalLightShadowMap { size: 1024 });
    }) else {
        return;
    };
    assert!(share(&ours, &bevys, 1e-3) <= EDGES);
}

#[test]
fn fog_is_bevys() {
    let fog = DistanceFog {
        color: Color::linear_rgb(0.4, 0.5, 0.6),
        falloff: FogFalloff::Linear {
            start: 2.0,
            end: 15.0,
        },
        ..default()
    };
    let Some([plain, ours, bevys]) = pictures("fog", |_| fog) else {
        return;
    };
    assert!(share(&ours, &bevys, 1e-3) <= EDGES);
    assert!(share(&plain, &ours, 1e-3) > 0.5);
}

#[test]
fn environment_maps_and_ambient_occlusion_are_bevys() {
    let Some([plain, ours, bevys]) = pictures("occlusion", |app| {
        let mut images = app.world_mut().resource_mut::<Assets<Image>>();
        let sky = [
            Color::linear_rgb(0.2, 0.4, 1.0),
            Color::linear_rgb(0.5, 0.5, 0.5),
            Color::linear_rgb(0.3, 0.2, 0.1),
        ];
        let map = EnvironmentMapLight::hemispherical_gradient(&mut images, sky[0], sky[1], sky[2]);
        (
            ScreenSpaceAmbientOcclusion::default(),
            EnvironmentMapLight {
                intensity: 3.0,
                ..map
            },
        )
    }) else {
        return;
    };
    assert!(share(&ours, &bevys, 1e-3) <= EDGES);
    assert!(share(&plain, &ours, 1e-3) > 0.5);
}

#[test]
fn contact_shadows_are_bevys_but_for_their_noise() {
    let Some([plain, ours, bevys]) = pictures("contact", |_| ContactShadows {
        linear_steps: 32,
        thickness: 0.5,
        length: 2.0,
    }) else {
        return;
    };
    assert!(share(&plain, &ours, 1e-3) > 0.003, "they are there");
    // Their noise is another in each frame.
    let mean = |p: &Picture| p.pixels.iter().map(|p| p[0] + p[1] + p[2]).sum::<f32>();
    let [without, with, theirs] = [mean(&plain), mean(&ours), mean(&bevys)];
    assert!(
        (with - theirs).abs() < 0.1 * (without - theirs).abs(),
        "{without} {with} {theirs}"
    );
}
