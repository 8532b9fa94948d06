//! Ground by the level of detail with and without the triangles that the camera does not see, beyond its
//! borders, facing away, or behind nearer ground: the same picture, byte for byte, shadows and all.

use crate::support::app;
use crate::support::camera;
use crate::support::hills;
use crate::support::picture;
use crate::support::rest;

use std::time::Duration;

use bevy::camera::{OrthographicProjection, ScalingMode};
use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::light::CascadeShadowConfigBuilder;
use bevy::math::DVec2;
use bevy::prelude::*;
use dolomite::DolomitePlugins;
use dolomite::ground::detail::{Metric, TerrainLod};
use dolomite::ground::{GroundPlugin, TerrainView};
use dolomite::terrain::{Fractal, Ground, Terrain};
use dolomite::tessellation::GeometryCamera;
use dolomite::tessellation::render::GeometryStats;

/// Steep ground, as many slopes away from the eye as towards it.
fn steep(app: &mut App) -> Terrain {
    let hills = hills::Hills {
        centre: DVec2::ZERO,
        side: 1024.0,
        noise: Fractal {
            octaves: 8,
            amplitude: 120.0,
            wavelength: 160.0,
            ..Fractal::default()
        },
        base: 0.0,
        sea: None,
    };
    hills.spawn(app)
}

/// The picture once it rests, and triangles of the camera.
fn at_rest(app: &mut App, target: &Handle<Image>) -> (Vec<u8>, u32) {
    let rests = rest::comes_to_rest(5, || {
        app.update();
        rest::is_settled(app) && app.world().resource::<GeometryStats>().dispatches == 0
    });
    assert!(rests, "it does not come to rest");
    let stats = app.world().resource::<GeometryStats>().clone();
    let image = picture::picture(app, target, 0);
    (image.data.expect("pixels"), stats.primitives)
}

#[test]
fn gpu_a_picture_is_the_same_without_what_it_does_not_show() {
    let Some(mut app) = app::app(Duration::ZERO, |app| {
        // A relief map would arrive in the middle of the pictures. The group adds the plugin again, which does nothing.
        app.add_plugins((GroundPlugin { relief_side: 0 }, DolomitePlugins));
    }) else {
        return;
    };
    let ground = steep(&mut app);
    let height = |x: f32, z: f32| ground.height(DVec2::new(x.into(), z.into())) as f32;
    let light = DirectionalLight {
        shadow_maps_enabled: true,
        ..default()
    };
    app.world_mut().spawn((
        light,
        CascadeShadowConfigBuilder {
            num_cascades: 2,
            maximum_distance: 400.0,
            ..default()
        }
        .build(),
        Transform::default().looking_to(Vec3::new(-2.0, -1.0, -1.0), Vec3::Y),
    ));
    let prepasses = (DepthPrepass, DeferredPrepass);
    let view = (prepasses, TerrainView);
    let (camera, target) = camera::camera(&mut app, UVec2::new(128, 72), view);
    let eye = Vec3::new(20.0, height(20.0, 30.0) + 6.0, 30.0);
    let level = Transform::from_translation(eye).looking_to(Vec3::new(0.3, -0.05, -1.0), Vec3::Y);
    let down = Transform::from_xyz(0.0, 400.0, 0.0).looking_to(Vec3::NEG_Y, Vec3::X);
    let below = Transform::from_translation(eye - Vec3::Y * 60.0)
        .looking_to(Vec3::new(0.2, 0.4, -1.0), Vec3::Y);
    let turned = level.looking_to(Vec3::new(-0.6, -0.4, 1.0), Vec3::NEG_Y);
    let slanted = Transform::from_xyz(-100.0, 300.0, 200.0).looking_at(Vec3::ZERO, Vec3::Y);
    let wide = |fov: f32| {
        Projection::Perspective(PerspectiveProjection {
            fov: fov.to_radians(),
            ..default()
        })
    };
    let parallel = Projection::Orthographic(OrthographicProjection {
        scaling_mode: ScalingMode::FixedVertical {
            viewport_height: 150.0,
        },
        ..OrthographicProjection::default_3d()
    });
    // Of the triangles around the eye at most so many hundredths are the camera's.
    let views = [
        ("level", level, wide(60.0), 60),
        ("wide", level, wide(120.0), 65),
        ("narrow", level, wide(5.0), 30),
        ("down", down, wide(60.0), 70),
        ("below the ground", below, wide(60.0), 45),
        ("upside down", turned, wide(60.0), 55),
        ("parallel", slanted, parallel, 65),
    ];
    for (name, place, projection, most) in views {
        let mut found = Vec::new();
        for (culled, occluded) in [(false, false), (true, false), (true, true)] {
            let detail = TerrainLod {
                metric: Metric::ErrorBound { pixels: 2.0 },
                finest: 0.5,
                culled,
                occluded,
                ..TerrainLod::default()
            };
            app.world_mut()
                .entity_mut(camera)
                .insert((place, projection.clone(), detail));
            found.push(at_rest(&mut app, &target));
        }
        let [(all, triangles), (turned, facing), (seen, drawn)] = &found[..] else {
            unreachable!("three pictures");
        };
        eprintln!("{name}: {drawn} of {facing} of {triangles} triangles");
        assert!(*triangles > 300, "{name}: {triangles}");
        assert!(
            drawn * 100 <= triangles * most,
            "{name}: {drawn} of {triangles}"
        );
        for other in [turned, seen] {
            let others = all.iter().zip(other).filter(|(a, b)| a != b).count();
            assert_eq!(others, 0, "{name}: bytes differ");
        }
        // There is something to differ in.
        let shades = all.chunks(4).collect::<std::collections::HashSet<_>>();
        if name != "below the ground" {
            assert!(shades.len() > 50, "{name}: {} colours", shades.len());
        }
    }
    // Edges alone hide nothing.
    let edges = GeometryCamera {
        fill: false,
        lines: true,
        ..GeometryCamera::default()
    };
    let mut found = Vec::new();
    for occluded in [false, true] {
        let detail = TerrainLod {
            metric: Metric::ErrorBound { pixels: 4.0 },
            finest: 0.5,
            occluded,
            ..TerrainLod::default()
        };
        app.world_mut()
            .entity_mut(camera)
            .insert((level, wide(60.0), detail, edges.clone()));
        found.push(at_rest(&mut app, &target));
    }
    assert!(found[0] == found[1], "edges behind ridges were lost");

    // The comparison can fail: with a culling that takes the smallest triangles that face the eye for such
    // as face away, few are missing, and it is seen.
    let filled = GeometryCamera::default();
    too_much_is_culled(&mut app);
    let mut found = Vec::new();
    for culled in [false, true] {
        let detail = TerrainLod {
            metric: Metric::ErrorBound { pixels: 2.0 },
            finest: 0.5,
            culled,
            occluded: false,
            ..TerrainLod::default()
        };
        app.world_mut()
            .entity_mut(camera)
            .insert((level, wide(60.0), detail, filled.clone()));
        found.push(at_rest(&mut app, &target));
    }
    let [(all, _), (wrong, _)] = &found[..] else {
        unreachable!("two pictures");
    };
    let others = all.iter().zip(wrong).filter(|(a, b)| a != b).count();
    eprintln!("culled too much: {others} of {} bytes differ", all.len());
    assert!(others > 0, "triangles are missing, and nobody sees it");
}

/// Changes the culling of a running app: triangles that face the eye with less than half a pixel are left
/// out.
fn too_much_is_culled(app: &mut App) {
    let mut shaders = app.world_mut().resource_mut::<Assets<Shader>>();
    let right = "< -off * (around + 4.0 * off)";
    let found = shaders.iter().find_map(|(id, shader)| {
        let source = shader.source.as_str();
        let culls = source.contains("#define_import_path dolomite::detail::cull");
        culls.then(|| (id, source.replace(right, "< 1.0"), shader.path.clone()))
    });
    let (id, source, path) = found.expect("the culling is a shader of the app");
    assert!(!source.contains(right) && source.contains("< 1.0"));
    shaders
        .insert(id, Shader::from_wgsl(source, path))
        .expect("it was there");
    for _ in 0..4 {
        app.update();
    }
}
