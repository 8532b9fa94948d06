//! Several terrains and several cameras: each camera sees all visible terrains, by its own rule.

#![cfg(feature = "render")]

mod app;

use bevy::math::DVec2;
use bevy::prelude::*;
use dolomite_geometry::GeometryStats;
use dolomite_ground::detail::TerrainLod;
use dolomite_ground::{
    GroundLayer, GroundMaterial, MOST_TERRAINS, PatchDetail, Surface, TerrainView,
};
use dolomite_terrain::{
    GroundProbe, GroundRect, Hill, Layer, Source, Terrain, TerrainData, TerrainPlugin,
};

const RED: [f32; 3] = [0.8, 0.02, 0.02];
const GREEN: [f32; 3] = [0.02, 0.8, 0.02];

/// A square of 100 m about x, of one colour, with a hill of 10 m.
fn ground(x: f64, colour: [f32; 3]) -> (Terrain, GroundMaterial) {
    let centre = DVec2::new(x, 0.0);
    let hill = Hill {
        centre,
        radius: 40.0,
        height: 10.0,
    };
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(centre, 100.0),
        layers: vec![Layer {
            source: Source::Hill(hill),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
    });
    let surface = Surface::Flat {
        colour,
        roughness: 0.9,
    };
    let material = GroundMaterial {
        layers: vec![GroundLayer::new("", surface)],
    };
    (terrain.expect("valid"), material)
}

/// From above, north at the top.
fn above(x: f32, height: f32) -> Transform {
    Transform::from_xyz(x, height, 0.0).looking_to(Vec3::NEG_Y, Vec3::NEG_Z)
}

/// What is seen in the middle of the left and of the right half.
#[derive(Debug, PartialEq, Eq, Clone, Copy)]
enum Seen {
    Nothing,
    Red,
    Green,
}

fn halves(app: &mut App, target: &Handle<Image>) -> [Seen; 2] {
    let picture = app::picture(app, target);
    let size = picture.texture_descriptor.size;
    let data = picture.data.expect("pixels");
    [1, 3].map(|quarter| {
        let at = (size.height / 2 * size.width + size.width * quarter / 4) as usize * 4;
        match data[at..at + 3] {
            [0, 0, 0] => Seen::Nothing,
            [r, g, _] if r > 2 * g.max(10) => Seen::Red,
            [r, g, _] if g > 2 * r.max(10) => Seen::Green,
            ref other => panic!("{other:?} is no colour of these terrains"),
        }
    })
}

#[test]
fn gpu_two_terrains_with_a_camera_each_and_one_for_both() {
    let Some(mut app) = app::app() else { return };
    app.add_plugins(TerrainPlugin);
    app.insert_resource(GlobalAmbientLight {
        brightness: 3000.0,
        ..default()
    });
    let west = app.world_mut().spawn(ground(-60.0, RED)).id();
    let east = app.world_mut().spawn(ground(60.0, GREEN)).id();
    let targets = [64, 64, 128].map(|width| app::target(&mut app, width, 64));
    let places = [above(-60.0, 60.0), above(60.0, 60.0), above(0.0, 110.0)];
    let mut cameras = Vec::new();
    for (target, place) in targets.iter().zip(places) {
        cameras.push(app::camera(&mut app, target, (TerrainView, place)));
    }
    let seen = |app: &mut App| {
        app::frames(app, 12);
        [0, 1, 2].map(|k: usize| halves(app, &targets[k]))
    };
    use Seen::{Green, Nothing, Red};
    assert_eq!(seen(&mut app), [[Red; 2], [Green; 2], [Red, Green]]);

    // One camera by patches, the others as before.
    app.world_mut()
        .entity_mut(cameras[0])
        .insert(PatchDetail::default());
    assert_eq!(seen(&mut app), [[Red; 2], [Green; 2], [Red, Green]]);
    app.world_mut()
        .entity_mut(cameras[0])
        .remove::<PatchDetail>();

    // What is hidden is not drawn, and answers all the same.
    app.world_mut().entity_mut(east).insert(Visibility::Hidden);
    let place = Transform::from_xyz(60.0, 0.0, 0.0);
    let probe = app.world_mut().spawn((GroundProbe::default(), place)).id();
    assert_eq!(seen(&mut app), [[Red; 2], [Nothing; 2], [Red, Nothing]]);
    let answer = app
        .world()
        .get::<GroundProbe>(probe)
        .and_then(|probe| probe.sample);
    assert_eq!(answer.map(|ground| ground.height), Some(10.0));

    app.world_mut().entity_mut(east).insert(Visibility::Visible);
    app.world_mut().entity_mut(west).despawn();
    assert_eq!(seen(&mut app), [[Nothing; 2], [Green; 2], [Nothing, Green]]);
}

#[test]
fn gpu_more_terrains_than_are_drawn() {
    let Some(mut app) = app::app() else { return };
    app.insert_resource(GlobalAmbientLight {
        brightness: 3000.0,
        ..default()
    });
    let terrains: Vec<Entity> = (0..=MOST_TERRAINS)
        .map(|k| app.world_mut().spawn(ground(120.0 * k as f64, GREEN)).id())
        .collect();
    let target = app::target(&mut app, 32, 32);
    let last = 120.0 * MOST_TERRAINS as f32;
    app::camera(&mut app, &target, (TerrainView, above(last, 60.0)));
    app::frames(&mut app, 12);
    assert_eq!(halves(&mut app, &target), [Seen::Nothing; 2]);
    // As the warning says: hide one that is far away.
    app.world_mut()
        .entity_mut(terrains[0])
        .insert(Visibility::Hidden);
    app::frames(&mut app, 12);
    assert_eq!(halves(&mut app, &target), [Seen::Green; 2]);
}

/// Bytes that all views share, and those of each view.
fn bytes(app: &App) -> (u64, Vec<u64>) {
    let pools = &app.world().resource::<GeometryStats>().pools;
    let of = |shared: bool| {
        pools
            .iter()
            .filter(move |pool| pool.camera.is_none() == shared)
    };
    (
        of(true).map(|pool| pool.allocated).sum(),
        of(false).map(|pool| pool.allocated).collect(),
    )
}

#[test]
fn gpu_what_does_not_depend_on_the_view_is_kept_once() {
    let Some(mut app) = app::app() else { return };
    app.world_mut().spawn(ground(0.0, GREEN));
    let detail = TerrainLod {
        max_vertices: 1 << 14,
        ..default()
    };
    let target = app::target(&mut app, 32, 32);
    let look = |app: &mut App, x: f32| {
        app::camera(app, &target, (TerrainView, detail, above(x, 60.0)));
        app::frames(app, 12);
        bytes(app)
    };
    let (shared, views) = look(&mut app, 0.0);
    // 113 bytes a cell, four cells a vertex, and corners of one root; see `TerrainLod::max_vertices`.
    assert_eq!(shared, 113 * (4 << 14) + 16 + 4 * 16);
    assert_eq!(views.len(), 1);
    let (both, of_each) = look(&mut app, 30.0);
    assert_eq!((both, of_each), (shared, vec![views[0]; 2]));
}
