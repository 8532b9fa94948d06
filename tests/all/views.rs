//! Pictures of what the ground and the lighting make, by the console's table, against colours that are known beforehand.

use crate::support::app;
use crate::support::camera;
use crate::support::hills::Hills;
use crate::support::picture;
use crate::support::views::{assert_is, shown, switch};

use std::time::Duration;

use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::math::DVec2;
use bevy::pbr::DefaultOpaqueRendererMethod;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::PipelineCache;
use dolomite::DolomitePlugins;
use dolomite::deferred::pyramid::Pyramid;
use dolomite::deferred::{DeferredLighting, Way};
use dolomite::ground::render::inspect::InspectionPasses;
use dolomite::ground::{GroundInspection, GroundPlugin, TerrainView};
use dolomite::inspector::InspectorPlugin;
use dolomite::inspector::picture::colours::{
    LEVELS, MORE, MOST_OVERDRAW, NOTHING, distance_grey, level_colour, ramp,
};
use dolomite::inspector::picture::legend::{level_at, may_cover, more_at, ramp_at};
use dolomite::inspector::picture::{FramePicture, PicturePasses};
use dolomite::terrain::Fractal;

const SIZE: UVec2 = UVec2::new(320, 160);

fn app() -> Option<App> {
    app::app(Duration::from_millis(16), |app| {
        // A relief map would come in the middle of the pictures. The group adds the plugin again, which does nothing.
        app.add_plugins((
            GroundPlugin { relief_side: 0 },
            DolomitePlugins,
            InspectorPlugin,
        ))
        .insert_resource(DefaultOpaqueRendererMethod::deferred());
        dolomite::pictures(app);
    })
}

fn at(pixels: &[[u8; 4]], place: UVec2) -> [u8; 4] {
    pixels[(place.y * SIZE.x + place.x) as usize]
}

/// Level of the cells of a root where nothing is finer: it is drawn by all of its 16 × 16.
const ROOT: u32 = 4;

/// Passes of inspections and of pictures, pipelines of both, and how many cameras have an inspection.
fn census(app: &mut App) -> [u64; 4] {
    let world = app.sub_app(RenderApp).world();
    let queued = world.resource::<PipelineCache>().pipelines().filter(|one| {
        let text = format!("{:?}", one.descriptor);
        ["ground_inspection", "dolomite_picture"]
            .iter()
            .any(|label| text.contains(&format!("label: Some(\"{label}\")")))
    });
    let queued = queued.count() as u64;
    let passes = world.resource::<InspectionPasses>().count();
    let pictures = app.world().resource::<PicturePasses>().count();
    let world = app.world_mut();
    let inspected = world.query::<&GroundInspection>().iter(world).count();
    [passes, pictures, queued, inspected as u64]
}

mod gpu {
    use super::*;

    /// Ground of 200 m at one height, seen from 40 m above its southern border towards its northern one.
    fn flat() -> Option<(App, Handle<Image>, Entity)> {
        let mut app = app()?;
        Hills {
            centre: DVec2::ZERO,
            side: 200.0,
            noise: Fractal {
                // As good as none.
                amplitude: 1e-20,
                ..default()
            },
            base: 0.0,
            sea: None,
        }
        .spawn(&mut app);
        let place =
            Transform::from_xyz(0.0, 40.0, 100.0).looking_to(Vec3::new(0.0, -0.2, -1.0), Vec3::Y);
        let parts = (DepthPrepass, DeferredPrepass, TerrainView, place);
        let (camera, target) = camera::camera(&mut app, SIZE, parts);
        picture::picture(&mut app, &target, 12);
        Some((app, target, camera))
    }

    #[test]
    fn flat_ground_is_a_root_without_error_that_is_shaded_once() {
        let Some((mut app, target, camera)) = flat() else {
            return;
        };
        let before = picture::picture(&mut app, &target, 2);
        assert_eq!(census(&mut app), [0; 4], "off, nothing");
        // Below the middle is ground, and above it sky.
        let (ground, sky) = (UVec2::new(220, 120), UVec2::new(220, 10));
        for (name, expected, what) in [
            ("ground_level", level_colour(ROOT), GroundInspection::Level),
            ("ground_error", ramp(0.0), GroundInspection::Error),
            (
                "ground_overdraw",
                ramp(1.0 / MOST_OVERDRAW),
                GroundInspection::Overdraw,
            ),
        ] {
            let pixels = shown(&mut app, &target, name);
            assert_eq!(app.world().get(camera), Some(&what), "lent");
            assert_is(at(&pixels, ground), expected, name);
            assert_is(at(&pixels, sky), NOTHING, name);
            if name == "ground_level" {
                for level in 0..LEVELS {
                    let swatch = at(&pixels, level_at(level, SIZE));
                    assert_is(swatch, level_colour(level), "a swatch");
                }
            } else {
                for column in 0..64 {
                    let share = (column as f32 + 0.5) / 64.0;
                    assert_is(at(&pixels, ramp_at(column, SIZE)), ramp(share), "the ramp");
                }
                assert_is(at(&pixels, more_at(SIZE)), MORE, "beyond the ramp");
            }
            // No other colour is there but in the legend, at the border of the ground too.
            for (k, pixel) in (0..).zip(&pixels) {
                let place = UVec2::new(k % SIZE.x, k / SIZE.x);
                if !may_cover(place, SIZE) {
                    let bytes = |colour: Vec3| (colour * 255.0).round().to_array();
                    let own = [pixel[0], pixel[1], pixel[2]].map(f32::from);
                    let near = |colour| {
                        let pairs = own.into_iter().zip(bytes(colour));
                        pairs.into_iter().all(|(a, b)| (a - b).abs() <= 1.0)
                    };
                    assert!(
                        near(expected) || near(NOTHING),
                        "{name}: {pixel:?} at {place}"
                    );
                }
            }
        }
        let [passes, pictures, queued, _] = census(&mut app);
        assert!(
            passes > 0 && pictures > 0 && queued == 6,
            "the counts count"
        );
        switch(&mut app, "ground_overdraw", false);
        let after = picture::picture(&mut app, &target, 4);
        assert_eq!(after.data, before.data, "the frame is as it was");
        let [passes, pictures, _, inspected] = census(&mut app);
        assert_eq!(inspected, 0, "taken back");
        picture::picture(&mut app, &target, 2);
        assert_eq!(census(&mut app), [passes, pictures, 6, 0], "off, no pass");
        // What the app gave its camera stays.
        app.world_mut()
            .entity_mut(camera)
            .insert(GroundInspection::Level);
        shown(&mut app, &target, "ground_level");
        switch(&mut app, "ground_level", false);
        app.update();
        assert_eq!(app.world().get(camera), Some(&GroundInspection::Level));
    }

    /// A wall 5 m away over the first columns of the picture, and lamps enough for a pyramid.
    #[test]
    fn texels_of_the_pyramid_are_the_farthest_under_them() {
        const COLUMNS: u32 = 101;
        const AWAY: f32 = 5.0;
        let Some(mut app) = app() else { return };
        let lighting = DeferredLighting { way: Way::Tiled };
        let (_, target) = camera::camera(&mut app, SIZE, lighting);
        let world = app.world_mut();
        let mesh = world
            .resource_mut::<Assets<Mesh>>()
            .add(Rectangle::new(40.0, 40.0));
        let material = world
            .resource_mut::<Assets<StandardMaterial>>()
            .add(StandardMaterial::default());
        // Bevy's usual field of view is 45 degrees high.
        let focal = 0.5 * SIZE.y as f32 / bevy::math::ops::tan(std::f32::consts::FRAC_PI_8);
        let edge = (COLUMNS as f32 - 0.5 * SIZE.x as f32) * AWAY / focal;
        world.spawn((
            Mesh3d(mesh),
            MeshMaterial3d(material),
            Transform::from_xyz(edge - 20.0, 0.0, -AWAY),
        ));
        for lamp in 0..300 {
            let (column, row) = ((lamp % 20) as f32, (lamp / 20) as f32);
            world.spawn((
                PointLight {
                    range: 0.5,
                    ..default()
                },
                Transform::from_xyz(0.1 * column - 1.0, 0.1 * row - 0.7, 0.3 - AWAY),
            ));
        }
        // Near plane over distance.
        let depth = PerspectiveProjection::default().near / AWAY;
        let depths: Vec<f32> = (0..SIZE.x * SIZE.y)
            .map(|k| if k % SIZE.x < COLUMNS { depth } else { 0.0 })
            .collect();
        let pyramid = Pyramid::new(&depths, SIZE).expect("a view");
        let usual = FramePicture::default();
        let wall = Vec3::splat(distance_grey(AWAY, usual.near, usual.far));
        for index in [1, 3, 6, 16] {
            app.world_mut().resource_mut::<FramePicture>().level = index;
            let pixels = shown(&mut app, &target, "depth_pyramid");
            // The last of 320 pixels has one texel: 2 to the 9th are more.
            let index = index.min(9);
            let level = dolomite::deferred::pyramid::level(SIZE, index);
            for (k, pixel) in (0..).zip(&pixels) {
                let texel = UVec2::new(k % SIZE.x, k / SIZE.x) >> index;
                let at = level.first + texel.y * level.size.x + texel.x;
                let is_wall = pyramid.texels()[at as usize] > 0.0;
                let expected = if is_wall {
                    wall
                } else {
                    Vec3::new(0.0, 0.0, 0.125)
                };
                assert_is(*pixel, expected, "a texel");
            }
        }
        switch(&mut app, "depth_pyramid", false);
    }

    /// Hills, for the eye.
    #[test]
    #[ignore = "pictures for the page of the plugin: look at them"]
    fn pictures_of_hills() {
        let Some(mut app) = app() else { return };
        Hills {
            centre: DVec2::ZERO,
            side: 2048.0,
            noise: Fractal {
                amplitude: 120.0,
                wavelength: 500.0,
                octaves: 8,
                ..default()
            },
            base: 30.0,
            sea: Some(0.0),
        }
        .spawn(&mut app);
        let place =
            Transform::from_xyz(0.0, 120.0, 600.0).looking_to(Vec3::new(0.1, -0.2, -1.0), Vec3::Y);
        let parts = (DepthPrepass, DeferredPrepass, TerrainView, place);
        let (_, target) = camera::camera(&mut app, UVec2::new(640, 360), parts);
        picture::picture(&mut app, &target, 12);
        for name in ["ground_level", "ground_error", "ground_overdraw"] {
            shown(&mut app, &target, name);
        }
    }
}
