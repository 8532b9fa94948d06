//! Several terrains and several cameras: each camera sees all visible terrains, by its own rule.

use crate::app;
use crate::app::bytes;

use bevy::camera::Viewport;
use bevy::camera::visibility::RenderLayers;
use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::render::render_resource::ShaderType;
use dolomite_geometry::GeometryStats;
use dolomite_ground::blocks::layout::{
    LEAST_SLOTS, SAMPLE_BYTES, SEEN_BYTES, SLOT_BYTES, STOCK_HEAD_BYTES, list_words,
};
use dolomite_ground::detail::{Metric, TerrainLod};
use dolomite_ground::render::{GroundLook, TerrainRelief};
use dolomite_ground::{
    GroundLayer, GroundMaterial, MOST_TERRAINS, PatchDetail, Surface, TerrainView,
};
use dolomite_terrain::{
    Fractal, GroundProbe, GroundRect, Hill, Layer, Source, Terrain, TerrainData,
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
        let pixel = [0, 1, 2].map(|channel| u32::from(data[at + channel]));
        match pixel {
            [0, 0, 0] => Seen::Nothing,
            [r, g, _] if r > 2 * g.max(10) => Seen::Red,
            [r, g, _] if g > 2 * r.max(10) => Seen::Green,
            other => panic!("{other:?} is no colour of these terrains"),
        }
    })
}

#[test]
fn gpu_two_terrains_with_a_camera_each_and_one_for_both() {
    let Some(mut app) = app::app() else { return };
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

/// Until the relief map of a terrain is there and drawn with.
fn await_relief(app: &mut App, terrain: Entity) {
    for _ in 0..600 {
        app::frames(app, 1);
        if app.world().get::<TerrainRelief>(terrain).is_some() {
            app::frames(app, 12);
            return;
        }
    }
    panic!("no relief map was made");
}

#[test]
fn gpu_what_does_not_depend_on_the_view_is_kept_once() {
    let Some(mut app) = app::app() else { return };
    let (terrain, material) = ground(0.0, GREEN);
    let heights = terrain.gpu();
    let terrain = app.world_mut().spawn((terrain, material)).id();
    let detail = TerrainLod {
        max_vertices: 1 << 14,
        ..default()
    };
    // A slot for every 38 vertices that a view may have, see `TerrainLod::max_vertices`.
    let slots = |vertices: u64| (vertices / 38).max(u64::from(LEAST_SLOTS));
    let blocks = |vertices: u64| SLOT_BYTES * slots(vertices) + STOCK_HEAD_BYTES + SAMPLE_BYTES;
    let target = app::target(&mut app, 32, 32);
    let look =
        |app: &mut App, x: f32| app::camera(app, &target, (TerrainView, detail, above(x, 60.0)));
    let see = |app: &mut App, camera: Entity, detail: TerrainLod| {
        app.world_mut().entity_mut(camera).insert(detail);
        app::frames(app, 12);
        bytes(app)
    };
    let first = look(&mut app, 0.0);
    await_relief(&mut app, terrain);
    let (shared, views) = see(&mut app, first, detail);
    // The relief map has 64 texels a side and eight bytes a texel.
    let relief: u64 = (0..=6).map(|level: u32| 8 * (64_u64 >> level).pow(2)).sum();
    let heights = (size_of_val(&*heights.layers) + size_of_val(&*heights.data)) as u64;
    let uniforms = 16 + GroundLook::min_size().get();
    let data = relief + heights + uniforms;
    assert_eq!(shared, blocks(1 << 14) + data);
    assert_eq!(views.len(), 1);

    // So many slots of a view, and its pools: 20 bytes a vertex and 24 of triangles.
    let twice = TerrainLod {
        max_vertices: 1 << 15,
        ..detail
    };
    let (more, larger) = see(&mut app, first, twice);
    assert_eq!(larger.len(), 1);
    assert_eq!(more - shared, blocks(1 << 15) - blocks(1 << 14));
    let of_view = |vertices: u64| {
        let slots = slots(vertices);
        44 * vertices + SEEN_BYTES * slots + 4 * list_words(slots as u32)
    };
    assert_eq!(larger[0] - views[0], of_view(1 << 15) - of_view(1 << 14));

    let second = look(&mut app, 30.0);
    let (both, of_each) = see(&mut app, first, detail);
    assert_eq!((both, of_each), (shared, vec![views[0]; 2]));

    // Another smallest cell has blocks of its own, until nobody asks for it.
    let finer = TerrainLod {
        finest: 0.25,
        ..detail
    };
    let (apart, of_each) = see(&mut app, second, finer);
    assert_eq!(
        (apart, of_each),
        (2 * blocks(1 << 14) + data, vec![views[0]; 2])
    );
    let (both, _) = see(&mut app, second, detail);
    assert_eq!(both, shared);
}

#[test]
fn gpu_a_hidden_terrain_keeps_nothing() {
    let Some(mut app) = app::app() else { return };
    let target = app::target(&mut app, 32, 32);
    app::camera(&mut app, &target, (TerrainView, above(0.0, 60.0)));
    app::frames(&mut app, 12);
    let kept = |app: &App| (bytes(app), app.world().resource::<Assets<Image>>().len());
    let nothing = kept(&app);
    assert_eq!(nothing.0, (0, Vec::new()));
    let terrain = app
        .world_mut()
        .spawn((ground(0.0, GREEN), Visibility::Hidden));
    let terrain = terrain.id();
    app::frames(&mut app, 24);
    assert_eq!(kept(&app), nothing);
    let show = |app: &mut App, visibility: Visibility| {
        app.world_mut().entity_mut(terrain).insert(visibility);
    };
    show(&mut app, Visibility::Visible);
    await_relief(&mut app, terrain);
    let ((shared, views), images) = kept(&app);
    assert!(shared > 0 && views.len() == 1, "{shared} {views:?}");
    assert_eq!(images, nothing.1 + 1, "its relief map");
    show(&mut app, Visibility::Hidden);
    app::frames(&mut app, 12);
    assert_eq!(kept(&app), nothing);
}

#[test]
fn gpu_layers_of_a_terrain_say_who_sees_it() {
    let Some(mut app) = app::app() else { return };
    app.insert_resource(GlobalAmbientLight {
        brightness: 3000.0,
        ..default()
    });
    let terrain = app.world_mut().spawn(ground(0.0, GREEN)).id();
    let targets = [32, 32].map(|side| app::target(&mut app, side, side));
    let place = above(0.0, 60.0);
    let patches = (TerrainView, PatchDetail::default(), place);
    let cameras = [
        app::camera(&mut app, &targets[0], (TerrainView, place)),
        app::camera(&mut app, &targets[1], patches),
    ];
    let seen = |app: &mut App| {
        app::frames(app, 12);
        [0, 1].map(|k: usize| halves(app, &targets[k]))
    };
    use Seen::{Green, Nothing};
    assert_eq!(seen(&mut app), [[Green; 2]; 2]);
    app.world_mut()
        .entity_mut(terrain)
        .insert(RenderLayers::layer(1));
    assert_eq!(seen(&mut app), [[Nothing; 2]; 2]);
    for camera in cameras {
        app.world_mut()
            .entity_mut(camera)
            .insert(RenderLayers::from_layers(&[1, 2]));
    }
    assert_eq!(seen(&mut app), [[Green; 2]; 2]);
    app.world_mut().entity_mut(terrain).remove::<RenderLayers>();
    assert_eq!(seen(&mut app), [[Nothing; 2]; 2]);
}

#[test]
fn gpu_a_camera_that_lost_its_detail_sees_by_the_default() {
    let Some(mut app) = app::app() else { return };
    app.insert_resource(GlobalAmbientLight {
        brightness: 3000.0,
        ..default()
    });
    // Ground that the coarsest triangles, 6 m wide, do not show to a pixel.
    let (_, material) = ground(0.0, GREEN);
    let rough = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 100.0),
        layers: vec![Layer {
            source: Source::Fractal(Fractal {
                octaves: 4,
                amplitude: 4.0,
                wavelength: 16.0,
                ..default()
            }),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
    });
    app.world_mut().spawn((rough.expect("valid"), material));
    let target = app::target(&mut app, 128, 64);
    let place = Transform::from_xyz(0.0, 30.0, 80.0).looking_at(Vec3::Y * 5.0, Vec3::Y);
    let camera = app::camera(&mut app, &target, (TerrainView, place));
    let seen = |app: &mut App| {
        app::frames(app, 12);
        let drawn = app.world().resource::<GeometryStats>().primitives;
        (drawn, halves(app, &target))
    };
    let (by_default, halves) = seen(&mut app);
    assert_eq!(halves, [Seen::Green; 2]);
    let coarse = TerrainLod {
        metric: Metric::ErrorBound { pixels: 64.0 },
        ..default()
    };
    app.world_mut().entity_mut(camera).insert(coarse);
    let (fewer, _) = seen(&mut app);
    assert!(fewer < by_default, "{fewer} of {by_default}");
    app.world_mut().entity_mut(camera).remove::<TerrainLod>();
    assert_eq!(seen(&mut app), (by_default, [Seen::Green; 2]));
}

/// The pixels of a part of a picture, and whether all the others are black.
fn part(picture: &Image, at: UVec2, size: UVec2) -> (Vec<[u8; 4]>, bool) {
    let width = picture.texture_descriptor.size.width;
    let data = picture.data.as_ref().expect("pixels");
    let (mut inside, mut black) = (Vec::new(), true);
    for (index, pixel) in (0..).zip(data.chunks_exact(4)) {
        let place = UVec2::new(index % width, index / width);
        if place.cmpge(at).all() && place.cmplt(at + size).all() {
            inside.push([pixel[0], pixel[1], pixel[2], pixel[3]]);
        } else {
            black &= pixel[..3] == [0, 0, 0];
        }
    }
    (inside, black)
}

#[test]
fn gpu_two_cameras_share_a_picture() {
    let Some(mut app) = app::app() else { return };
    app.insert_resource(GlobalAmbientLight {
        brightness: 3000.0,
        ..default()
    });
    app.world_mut().spawn(ground(-60.0, RED));
    app.world_mut().spawn(ground(60.0, GREEN));
    let target = app::target(&mut app, 128, 64);
    // Between them, and above the lower one, nobody draws.
    let parts = [
        (UVec2::new(0, 0), UVec2::new(48, 64)),
        (UVec2::new(64, 16), UVec2::new(64, 48)),
    ];
    let cameras = [(0, -60.0), (1, 60.0)].map(|(order, x)| {
        let (physical_position, physical_size) = parts[order];
        let viewport = Viewport {
            physical_position,
            physical_size,
            ..default()
        };
        let camera = Camera {
            order: order as isize,
            viewport: Some(viewport),
            ..default()
        };
        app::camera(&mut app, &target, (TerrainView, camera, above(x, 60.0)))
    });
    let picture = |app: &mut App, active: [bool; 2]| {
        for (camera, is_active) in cameras.into_iter().zip(active) {
            let mut camera = app.world_mut().get_mut::<Camera>(camera).expect("there");
            camera.is_active = is_active;
        }
        app::frames(app, 12);
        app::picture(app, &target)
    };
    let alone = [[true, false], [false, true]].map(|active| picture(&mut app, active));
    let both = picture(&mut app, [true, true]);
    for (k, (at, size)) in parts.into_iter().enumerate() {
        let (own, black) = part(&alone[k], at, size);
        assert!(black, "camera {k} drew outside of its part");
        let strongest = |pixel: &[u8; 4]| pixel[k] > 20 && pixel[k] / 2 > pixel[1 - k];
        let coloured = own.iter().filter(|pixel| strongest(pixel)).count();
        assert!(2 * coloured > own.len(), "{coloured} of {}", own.len());
        assert!(part(&both, at, size).0 == own, "part {k} is another one");
    }
    let (gap, _) = part(&both, UVec2::new(48, 0), UVec2::new(16, 64));
    assert!(gap.iter().all(|pixel| pixel[..3] == [0, 0, 0]));
}
