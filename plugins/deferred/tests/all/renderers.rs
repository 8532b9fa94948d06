//! Renderers that are not those of the other tests: of fewer layers of textures, and such as compile while they draw.

use bevy::light::PointLightShadowMap;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::renderer::RenderDevice;
use bevy::render::settings::{WgpuLimits, WgpuSettings};
use dolomite_deferred::{DeferredLighting, DeferredPlugin, DeferredStats, Way};
use dolomite_testkit::light::{self as support, WAYS};
use dolomite_testkit::random::Random;

use super::hostile::{eye, floor, lamp};

/// Shadow maps of point lights that there may be.
const MAPS: usize = 16;

/// What the adapter gives.
fn limits() -> Option<WgpuLimits> {
    let app = support::app(false)?;
    Some(app.world().resource::<RenderDevice>().limits())
}

/// A texture has so many layers, and Bevy maps for so many lights: others cast no shadows, and not those of another.
#[test]
fn lights_beyond_the_last_shadow_map_cast_none_gpu() {
    let Some(all) = limits() else {
        return;
    };
    let limits = WgpuLimits {
        // As if there were no more: sixteen cubes.
        max_texture_array_layers: 6 * MAPS as u32,
        ..all
    };
    let renderer = RenderPlugin {
        render_creation: WgpuSettings {
            constrained_limits: Some(limits),
            ..default()
        }
        .into(),
        synchronous_pipeline_compilation: true,
        ..default()
    };
    let app = support::app_by(renderer, |app| {
        app.add_plugins(DeferredPlugin);
    });
    let Some(mut app) = app else {
        return;
    };
    app.insert_resource(PointLightShadowMap { size: 64 });
    floor(&mut app);
    let mesh = app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(Cuboid::new(1.0, 1.0, 1.0).mesh().build());
    let white = app
        .world_mut()
        .resource_mut::<Assets<StandardMaterial>>()
        .add(StandardMaterial::default());
    app.world_mut().spawn((
        Mesh3d(mesh),
        MeshMaterial3d(white),
        Transform::from_xyz(0.5, 0.5, 0.0),
    ));
    let spawn = |app: &mut App, count: usize| {
        for _ in 0..count {
            let (lamp, _) = lamp(|l| {
                l.shadow_maps_enabled = true;
                l.range = 12.0;
            });
            // Behind the box: its shadow falls towards the camera.
            let place = Transform::from_xyz(0.5, 1.6, -1.2);
            app.world_mut().spawn((lamp, place));
        }
    };
    // All at one place, so that it does not matter which of them have maps.
    spawn(&mut app, MAPS);
    let camera = support::camera(&mut app, [96, 54], eye(), ());
    let dark = support::lit_by(&mut app, camera, Some(Way::Tiled));
    spawn(&mut app, 3);
    let bevys = support::lit_by(&mut app, camera, None);
    // What the others leave dark, these three light.
    let both = bevys.pixels.iter().zip(&dark.pixels);
    let only = both.filter(|(with, without)| with[0] > 1e-3 && without[0] < 0.01 * with[0]);
    let shadow = only.count();
    assert!(shadow > 200, "{shadow} pixels are in the shadow");
    for way in WAYS {
        let ours = support::lit_by(&mut app, camera, Some(way));
        let differs = |(a, b): &(&[f32; 4], &[f32; 4])| {
            (a[0] - b[0]).abs() > 1e-2 * a[0].abs().max(b[0].abs()).max(1e-3)
        };
        let count = ours
            .pixels
            .iter()
            .zip(&bevys.pixels)
            .filter(differs)
            .count();
        // Where a place lies on a shadow's edge its rounding decides the side.
        assert!(
            count * 20 < shadow,
            "{way:?}: {count} pixels are not Bevy's, {shadow} are in the shadow"
        );
    }
}

/// While the lists of more lights are compiled for, the view is lit as before; here in threads, as in a game.
#[test]
fn a_view_stays_lit_while_its_lights_pass_what_is_compiled_gpu() {
    let renderer = RenderPlugin {
        synchronous_pipeline_compilation: false,
        ..default()
    };
    let app = support::app_by(renderer, |app| {
        app.add_plugins(DeferredPlugin);
    });
    let Some(mut app) = app else {
        return;
    };
    floor(&mut app);
    let mut random = Random::new(9);
    let mut spawn = |app: &mut App, count: usize| {
        for _ in 0..count {
            let place = Transform::from_xyz(
                random.range(-1.0, 1.0),
                random.range(0.5, 1.5),
                random.range(-1.0, 1.0),
            );
            app.world_mut()
                .spawn((lamp(|l| l.intensity = 1.0).0, place));
        }
    };
    // Up to 4096 lights have lists of one size.
    spawn(&mut app, 4000);
    let way = DeferredLighting { way: Way::Tiled };
    let camera = support::camera(&mut app, [24, 14], eye(), way);
    for _ in 0..600 {
        if support::picture(&mut app, camera, 1).lit() > 100 {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    let before = support::picture(&mut app, camera, 0);
    assert!(before.lit() > 100, "it was compiled");
    spawn(&mut app, 200);
    for _ in 0..20 {
        let picture = support::picture(&mut app, camera, 0);
        assert!(picture.lit() > 100, "{} pixels are lit", picture.lit());
        assert!(picture.brightest() > 0.99 * before.brightest());
    }
    let views = app.world().resource::<DeferredStats>().views();
    assert!(views[0].lights > 4096, "{}", views[0].lights);
}
