//! Pictures of the light and of what grows: the difference against the reference, which shadow maps were drawn, ranks of
//! grass; against what is known of the scene.

use crate::support::app;
use crate::support::camera;
use crate::support::hills::Hills;
use crate::support::picture;
use crate::support::views::{assert_is, off, shown, switch};

use std::sync::Arc;
use std::time::Duration;

use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::math::DVec2;
use bevy::pbr::DefaultOpaqueRendererMethod;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::PipelineCache;
use bevy::shader::Shader;
use dolomite::DolomitePlugins;
use dolomite::deferred::render::ViewDifference;
use dolomite::deferred::{DeferredLighting, LightingDifference, StillShadows, StillStats, Way};
use dolomite::ground::{GroundPlugin, TerrainView};
use dolomite::inspector::InspectorPlugin;
use dolomite::inspector::picture::colours::{DRAWN, KEPT, MORE, NOTHING, ramp};
use dolomite::inspector::picture::legend::{may_cover, more_at};
use dolomite::terrain::{Fractal, Terrain};
use dolomite::vegetation::{Kinds, Vegetation, VegetationRanks, VegetationView};

const SIZE: UVec2 = UVec2::new(320, 160);

fn app() -> Option<App> {
    app::app(Duration::from_millis(16), |app| {
        app.add_plugins((
            GroundPlugin { relief_side: 0 },
            DolomitePlugins,
            InspectorPlugin,
        ))
        .insert_resource(DefaultOpaqueRendererMethod::deferred());
        dolomite::pictures(app);
    })
}

/// Pipelines of a label.
fn pipelines(app: &App, label: &str) -> usize {
    let world = app.sub_app(RenderApp).world();
    let label = format!("label: Some(\"{label}\")");
    let all = world.resource::<PipelineCache>().pipelines();
    all.filter(|one| format!("{:?}", one.descriptor).contains(&label))
        .count()
}

/// Pixels beside the legend, with their places.
fn beside(pixels: &[[u8; 4]]) -> impl Iterator<Item = (UVec2, [u8; 4])> {
    let places = (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| UVec2::new(x, y)));
    let all = places.zip(pixels.iter().copied());
    all.filter(|(place, _)| !may_cover(*place, SIZE))
}

mod gpu {
    use super::*;

    /// A wall over the left half of the picture, 5 m away, and 300 lamps before it, lit by tiles.
    fn lamps() -> Option<(App, Handle<Image>, Entity)> {
        const AWAY: f32 = 5.0;
        let mut app = app()?;
        let lighting = DeferredLighting { way: Way::Tiled };
        let (camera, target) = camera::camera(&mut app, SIZE, lighting);
        let world = app.world_mut();
        let mesh = world
            .resource_mut::<Assets<Mesh>>()
            .add(Rectangle::new(40.0, 40.0));
        let material = world
            .resource_mut::<Assets<StandardMaterial>>()
            .add(StandardMaterial::default());
        world.spawn((
            Mesh3d(mesh),
            MeshMaterial3d(material),
            Transform::from_xyz(-20.0, 0.0, -AWAY),
        ));
        for lamp in 0..300 {
            let (column, row) = ((lamp % 20) as f32, (lamp / 20) as f32);
            world.spawn((
                PointLight {
                    // Neither black nor white where some of them meet.
                    intensity: 200.0,
                    range: 0.5,
                    ..default()
                },
                Transform::from_xyz(0.2 * column - 4.1, 0.2 * row - 1.5, 0.3 - AWAY),
            ));
        }
        Some((app, target, camera))
    }

    #[test]
    fn the_light_of_tiles_is_that_of_all_lights_and_a_mistake_in_them_is_seen() {
        let Some((mut app, target, camera)) = lamps() else {
            return;
        };
        let before = picture::picture(&mut app, &target, 12);
        let label = "dolomite_deferred_difference";
        assert_eq!(pipelines(&app, label), 0, "off, no pipeline");
        // As many samples of the wall as there are of nothing.
        let pixels = shown(&mut app, &target, "light_difference");
        assert_eq!(app.world().get(camera), Some(&LightingDifference), "lent");
        assert_eq!(pipelines(&app, label), 1, "the count counts");
        for (place, pixel) in beside(&pixels) {
            let expected = if place.x < SIZE.x / 2 {
                ramp(0.0)
            } else {
                NOTHING
            };
            assert_is(pixel, expected, &format!("at {place}"));
        }
        // Tiles leave out each seventh light: where one shone there is more than a percent less.
        let file = dolomite_shaders::find("deferred/tiles.wgsl");
        let (right, wrong) = (
            "if reaches(listed[i], tile, slices) {",
            "if reaches(listed[i], tile, slices) && i % 7u != 3u {",
        );
        assert!(file.source.contains(right));
        put(&mut app, file.path, &file.source.replace(right, wrong));
        let wrong = shown(&mut app, &target, "light_difference");
        let beyond = beside(&wrong).filter(|(_, pixel)| off(*pixel, MORE) <= 1.0);
        let beyond = beyond.count();
        println!(
            "{beyond} of {} pixels are off by more than a percent",
            SIZE.element_product()
        );
        assert!(beyond > 2000, "{beyond} pixels");
        assert_is(at(&wrong, more_at(SIZE)), MORE, "the legend");
        put(&mut app, file.path, file.source);
        switch(&mut app, "light_difference", false);
        let after = picture::picture(&mut app, &target, 6);
        assert_eq!(after.data, before.data, "the frame is as it was");
        assert!(app.world().get::<LightingDifference>(camera).is_none());
        let world = app.sub_app_mut(RenderApp).world_mut();
        assert_eq!(world.query::<&ViewDifference>().iter(world).count(), 0);
    }

    fn at(pixels: &[[u8; 4]], place: UVec2) -> [u8; 4] {
        pixels[(place.y * SIZE.x + place.x) as usize]
    }

    /// Replaces a file's text under its own handle.
    fn put(app: &mut App, path: &str, source: &str) {
        let mut shaders = app.world_mut().resource_mut::<Assets<Shader>>();
        let known = shaders.iter().filter(|(_, shader)| shader.path == path);
        let ids: Vec<_> = known.map(|(id, _)| id).collect();
        assert_eq!(ids.len(), 1, "{path}");
        for id in ids {
            let shader = Shader::from_wgsl(source.to_owned(), path.to_owned());
            shaders.insert(id, shader).expect("it is there");
        }
    }

    /// A lamp between walls, on which a box may move.
    fn room(components: impl Bundle) -> Option<(App, Handle<Image>, Entity, Entity)> {
        let mut app = app()?;
        let (_, target) = camera::camera(&mut app, SIZE, DeferredLighting::default());
        let world = app.world_mut();
        let mesh = world
            .resource_mut::<Assets<Mesh>>()
            .add(Cuboid::new(1.0, 1.0, 1.0));
        let material = world
            .resource_mut::<Assets<StandardMaterial>>()
            .add(StandardMaterial::default());
        let mut cube = |place: Vec3| {
            let parts = (Mesh3d(mesh.clone()), MeshMaterial3d(material.clone()));
            world
                .spawn((parts, Transform::from_translation(place)))
                .id()
        };
        let moves = cube(Vec3::new(3.0, 0.0, -6.0));
        for place in [Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
            cube(3.0 * place + Vec3::NEG_Z * 6.0);
        }
        let light = PointLight {
            shadow_maps_enabled: true,
            ..default()
        };
        let lamp = world
            .spawn((light, components, Transform::from_xyz(0.0, 0.0, -6.0)))
            .id();
        Some((app, target, lamp, moves))
    }

    /// The colour of the frame of each of the first maps, three in a row.
    fn frames_of(pixels: &[[u8; 4]], maps: u32) -> Vec<[u8; 4]> {
        let corner = |k: u32| SIZE * UVec2::new(k % 3, k / 3) / 3 + 1;
        (0..maps).map(|k| at(pixels, corner(k))).collect()
    }

    fn count(frames: &[[u8; 4]], colour: Vec3) -> u32 {
        frames
            .iter()
            .filter(|pixel| off(**pixel, colour) <= 1.0)
            .count() as u32
    }

    #[test]
    fn faces_of_a_still_lamp_are_framed_as_they_were_drawn_or_kept() {
        let Some((mut app, target, lamp, moves)) = room(()) else {
            return;
        };
        let pixels = shown(&mut app, &target, "point_shadow_maps");
        let frames = frames_of(&pixels, 6);
        assert_eq!(count(&frames, DRAWN), 6, "Bevy draws all: {frames:?}");
        // What stands at each side is in its map, farther than nothing.
        for k in 0..6 {
            let middle = SIZE * UVec2::new(k % 3, k / 3) / 3 + SIZE / 6;
            let pixel = at(&pixels, middle);
            assert!(pixel[0] > 60 && pixel[0] == pixel[1], "{k}: {pixel:?}");
        }
        app.world_mut()
            .entity_mut(lamp)
            .insert(StillShadows::default());
        let pixels = shown(&mut app, &target, "point_shadow_maps");
        let frames = frames_of(&pixels, 6);
        assert_eq!(count(&frames, KEPT), 6, "at rest: {frames:?}");
        // A box that moves in each frame is seen by some faces.
        app.add_systems(
            Update,
            move |mut all: Query<&mut Transform>, mut turn: Local<bool>| {
                *turn = !*turn;
                let mut place = all.get_mut(moves).expect("it is there");
                place.translation.y = if *turn { 0.1 } else { 0.0 };
            },
        );
        let pixels = shown(&mut app, &target, "point_shadow_maps");
        let frames = frames_of(&pixels, 6);
        let stats = app.world().resource::<StillStats>();
        let (drawn, kept) = (stats.drawn(), stats.kept());
        assert!(drawn > 0 && kept > 0, "{drawn} {kept}");
        assert_eq!((count(&frames, DRAWN), count(&frames, KEPT)), (drawn, kept));
        // Beyond the last face there is nothing.
        assert_is(
            at(&pixels, SIZE * UVec2::new(0, 2) / 3 + 8),
            Vec3::new(0.0, 0.0, 0.125),
            "no map",
        );
    }

    #[test]
    fn cascades_and_spots_are_framed_as_drawn() {
        let Some((mut app, target, ..)) = room(()) else {
            return;
        };
        let shadow_maps_enabled = true;
        let down = Transform::from_xyz(0.0, 4.0, 0.0).looking_at(Vec3::NEG_Z * 6.0, Vec3::Y);
        let spot = SpotLight {
            shadow_maps_enabled,
            ..default()
        };
        app.world_mut().spawn((spot, down));
        let sun = DirectionalLight {
            shadow_maps_enabled,
            ..default()
        };
        app.world_mut().spawn((sun, down));
        // Four cascades, as Bevy has them, and the spot: five maps, three in a row.
        let pixels = shown(&mut app, &target, "shadow_maps");
        let frames = frames_of(&pixels, 5);
        assert_eq!(count(&frames, DRAWN), 5, "{frames:?}");
        let after = SIZE * UVec2::new(2, 1) / 3 + 1;
        assert_is(
            at(&pixels, after),
            Vec3::new(0.0, 0.0, 0.125),
            "no sixth map",
        );
    }

    #[test]
    fn ranks_of_grass_are_on_the_ramp_and_nothing_is_left_of_them() {
        let Some(mut app) = app() else { return };
        Hills {
            centre: DVec2::ZERO,
            side: 200.0,
            noise: Fractal {
                // As good as none.
                amplitude: 1e-20,
                ..default()
            },
            base: 20.0,
            sea: None,
        }
        .spawn(&mut app);
        let text = "(kinds: [(name: \"grass\", density: 12.0, reach: 60.0, shape: Blade((
            length: (0.3, 0.6), width: 0.03,
            look: (root: (0.0, 0.4, 0.0), tip: (0.1, 0.9, 0.1), dry: (0.4, 0.35, 0.15)))))])";
        let kinds = Kinds::parse(text, "test.ron".as_ref()).expect("a good list");
        let world = app.world_mut();
        let mut terrains = world.query_filtered::<Entity, With<Terrain>>();
        let terrain = terrains.single(world).expect("one");
        world.entity_mut(terrain).insert(Vegetation {
            kinds: Arc::new(kinds),
            ..default()
        });
        let place =
            Transform::from_xyz(0.0, 21.6, 0.0).looking_to(Vec3::new(0.0, -0.25, -1.0), Vec3::Y);
        let parts = (
            DepthPrepass,
            DeferredPrepass,
            TerrainView,
            VegetationView,
            place,
        );
        let (camera, target) = camera::camera(&mut app, SIZE, parts);
        picture::picture(&mut app, &target, 40);
        assert_eq!(pipelines(&app, "vegetation_ranks"), 0, "off, no pipeline");
        let pixels = shown(&mut app, &target, "grass_rank");
        assert_eq!(app.world().get(camera), Some(&VegetationRanks), "lent");
        // The colours of a thousand ranks, and nothing else.
        let colours: Vec<_> = (0..=1000).map(|k| ramp(k as f32 / 1000.0)).collect();
        let (mut grass, mut low, mut high) = (0, 0, 0);
        for (place, pixel) in beside(&pixels) {
            if off(pixel, NOTHING) <= 1.0 {
                continue;
            }
            let near = colours.iter().position(|colour| off(pixel, *colour) <= 1.5);
            let share = near.unwrap_or_else(|| panic!("{pixel:?} at {place} is no rank"));
            grass += 1;
            low += u32::from(share < 300);
            high += u32::from(share > 700);
        }
        println!("{grass} pixels of grass: {low} of low ranks, {high} of high ones");
        // Near the eye ranks of all sorts stand; far away those of low ones.
        assert!(
            grass > 2000 && low > 200 && high > 200,
            "{grass} {low} {high}"
        );
        switch(&mut app, "grass_rank", false);
        picture::picture(&mut app, &target, 3);
        assert!(app.world().get::<VegetationRanks>(camera).is_none());
    }
}
