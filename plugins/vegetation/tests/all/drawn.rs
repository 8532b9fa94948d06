//! What is drawn in an app: pictures, and what costs nothing.

use std::sync::Arc;

use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::{PipelineCache, PipelineDescriptor};
use dolomite_ground::{GroundCanopy, GroundMaterial, GroundPlugin, Sea, TerrainView};
use dolomite_terrain::{Fractal, GroundRect, Layer, Source, Terrain, TerrainData};
use dolomite_vegetation::render::lists::{CHAINS, FLOWERS};
use dolomite_vegetation::render::{
    VegetationCount, VegetationCulling, VegetationPool, VegetationStats,
};
use dolomite_vegetation::{Kinds, Vegetation, VegetationPlugin, VegetationView};

use crate::app;

const KINDS: &str = "(kinds: [
    (name: \"grass\", density: 12.0, reach: 60.0, shape: Blade((
        length: (0.3, 0.6), width: 0.02,
        look: (root: (0.0, 0.4, 0.0), tip: (0.1, 0.9, 0.1), dry: (0.4, 0.35, 0.15)))))])";

/// Flowers whose heads are red, and kelp that is blue: no ground is.
const SHAPES: &str = "(kinds: [
    (name: \"tulip\", density: 9.0, reach: 60.0, height: (from: 0.0, to: 1e3), shape: Flower((
        stem: (length: (0.4, 0.6), width: 0.01,
            look: (root: (0.0, 0.4, 0.0), tip: (0.1, 0.9, 0.1), dry: (0.4, 0.35, 0.15))),
        petals: 6, radius: 0.09, colour: (0.9, 0.0, 0.0), middle: (0.9, 0.1, 0.1)))),
    (name: \"kelp\", density: 4.0, reach: 60.0, height: (from: -60.0, to: -2.0), shape: Chain((
        segment: 0.3, segments: 16, rise: (0.3, 0.8), width: 0.2, twist: 0.2,
        look: (root: (0.0, 0.0, 0.5), tip: (0.0, 0.0, 0.9), dry: (0.0, 0.0, 0.9)))))])";

/// Low hills with a camera on them, without plants.
fn hills() -> Option<(App, Handle<Image>)> {
    hills_at(20.0)
}

/// Hills about a height.
fn hills_at(base: f32) -> Option<(App, Handle<Image>)> {
    hills_in(base, None)
}

/// Hills about a height, in a sea of some height.
fn hills_in(base: f32, sea_level: Option<f32>) -> Option<(App, Handle<Image>)> {
    let mut app = app::app(|app| {
        app::bevys(app);
        app.insert_resource(bevy::pbr::DefaultOpaqueRendererMethod::deferred())
            // A relief map would arrive between two pictures.
            .add_plugins((GroundPlugin { relief_side: 0 }, VegetationPlugin));
    })?;
    let hills = Fractal {
        seed: 4,
        octaves: 5,
        amplitude: 6.0,
        wavelength: 90.0,
        ..default()
    };
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::ZERO, 400.0),
        layers: vec![Layer {
            source: Source::Fractal(hills),
            mask: None,
        }],
        base,
        sea_level,
    })
    .expect("in range");
    let height = terrain.sample_f64(DVec2::ZERO).height as f32;
    let world = app.world_mut();
    let terrain = world.spawn((terrain, GroundMaterial::default())).id();
    if sea_level.is_some() {
        world.entity_mut(terrain).insert(Sea::default());
    }
    world.spawn((
        // With shadows the ground beside the picture is kept.
        DirectionalLight {
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::default().looking_to(Vec3::new(-1.0, -1.2, -0.5), Vec3::Y),
    ));
    let eye = Transform::from_xyz(0.0, height + 1.6, 0.0)
        .looking_to(Vec3::new(0.3, -0.15, -1.0), Vec3::Y);
    world.spawn((
        Camera3d::default(),
        Msaa::Off,
        TerrainView,
        VegetationView,
        eye,
    ));
    let target = app::target(&mut app, [160, 90]);
    app::retarget(&mut app, &target);
    Some((app, target))
}

fn plant(app: &mut App) -> Entity {
    plant_kinds(app, KINDS)
}

fn plant_kinds(app: &mut App, kinds: &str) -> Entity {
    let kinds = Kinds::parse(kinds, "test.ron".as_ref()).expect("a good list");
    let world = app.world_mut();
    let mut terrains = world.query_filtered::<Entity, With<Terrain>>();
    let terrain = terrains.single(world).expect("one");
    let vegetation = Vegetation {
        kinds: Arc::new(kinds),
        ..default()
    };
    world.entity_mut(terrain).insert(vegetation);
    terrain
}

fn count(app: &App) -> VegetationCount {
    app.world().resource::<VegetationStats>().get()
}

/// Pipelines of the whole app whose label begins so.
fn pipelines(app: &App, name: &str) -> usize {
    let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
    let ours = cache.pipelines().filter(|pipeline| {
        let label = match &pipeline.descriptor {
            PipelineDescriptor::RenderPipelineDescriptor(descriptor) => &descriptor.label,
            PipelineDescriptor::ComputePipelineDescriptor(descriptor) => &descriptor.label,
        };
        label.as_ref().is_some_and(|label| label.starts_with(name))
    });
    ours.count()
}

/// Frames until nothing is dispatched any more, and the ground knows what it looks like from afar.
fn settle(app: &mut App) -> u64 {
    for _ in 0..300 {
        let before = count(app).dispatches;
        app::frames(app, 6);
        let now = count(app).dispatches;
        let mut canopies = app.world_mut().query::<&GroundCanopy>();
        if now == before && now > 0 && canopies.iter(app.world()).next().is_some() {
            return now;
        }
    }
    panic!("it does not come to rest: {:?}", count(app));
}

#[test]
fn it_rests_and_nothing_is_there_without_it_gpu() {
    let Some((mut app, target)) = hills() else {
        return;
    };
    app::frames(&mut app, 12);
    let nothing = count(&app);
    assert_eq!(
        (nothing.bytes, nothing.dispatches, nothing.draws),
        (0, 0, 0)
    );
    assert_eq!(pipelines(&app, "vegetation"), 0);
    let terrain = plant(&mut app);
    let rests = settle(&mut app);
    let grown = count(&app);
    println!("{grown:?}");
    assert!(grown.records.iter().sum::<u32>() > 500 && grown.cut == 1.0);
    // Of shapes that nobody asked for there is nothing.
    assert_eq!(grown.records[FLOWERS..], [0; 5]);
    let others = ["vegetation_flowers", "vegetation_chains"];
    assert_eq!(others.map(|name| pipelines(&app, name)), [0, 0]);
    // Time goes on, and the wind with it: blades are drawn, and nothing is dispatched.
    app.world_mut()
        .insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(
            std::time::Duration::from_millis(16),
        ));
    let draws = count(&app).draws;
    app::frames(&mut app, 10);
    assert_eq!(count(&app).dispatches, rests);
    assert_eq!(count(&app).draws, draws + 10);
    // Green pixels are there.
    let picture = app::picture(&mut app, &target);
    let green = app::count(&picture, 0, 160, |c| {
        c.green > 1.5 * c.red && c.green > 2.0 * c.blue
    });
    assert!(green > 1000, "{green} pixels are green");
    app::keep(picture, "grass.png");
    app.world_mut().entity_mut(terrain).remove::<Vegetation>();
    app::frames(&mut app, 3);
    assert_eq!((count(&app).bytes, count(&app).views), (0, 0));
}

/// Turns the eye about the vertical, and up or down.
fn look(app: &mut App, turn: f32, up: f32) {
    let world = app.world_mut();
    let mut cameras = world.query_filtered::<&mut Transform, With<Camera3d>>();
    for mut eye in cameras.iter_mut(world) {
        eye.rotation = Quat::from_euler(EulerRot::YXZ, turn, up, 0.0);
    }
}

/// What is culled is not seen, to whichever side one looks: the pictures are the same to the byte. That a thousandth of the
/// blades were missing would be seen: with so many fewer the pictures are others.
#[test]
fn what_is_left_out_is_not_seen_gpu() {
    let Some((mut app, target)) = hills() else {
        return;
    };
    let terrain = plant(&mut app);
    settle(&mut app);
    let (mut few, mut many, mut differ) = (0, 0, 0);
    for k in 0..8 {
        let turn = 0.3 + k as f32 * std::f32::consts::TAU / 8.0;
        look(&mut app, turn, 0.3 - 0.12 * k as f32);
        let with = |app: &mut App, culled, density| {
            app.insert_resource(VegetationCulling(culled));
            let mut all = app.world_mut().query::<&mut Vegetation>();
            let mut grown = all.get_mut(app.world_mut(), terrain).expect("there");
            grown.density = density;
            app::frames(app, 3);
            settle(app);
            let records = count(app).wanted;
            (app::picture(app, &target), records)
        };
        let (culled, less) = with(&mut app, true, 1.0);
        let (all, more) = with(&mut app, false, 1.0);
        let (thinner, _) = with(&mut app, false, 0.999);
        assert!(culled.data == all.data, "looking {turn} rad to the left");
        differ += u32::from(thinner.data != all.data);
        (few, many) = (few + less, many + more);
    }
    println!("{few} of {many} records; {differ} of 8 pictures show that a thousandth is missing");
    // The ground has left out most of what is beside the picture; what it keeps for shadows is culled here.
    assert!(4 * many > 5 * few, "{few} of {many}");
    assert!(differ >= 6, "{differ}");
}

#[test]
fn a_pool_of_a_kibibyte_thins_and_says_so_gpu() {
    let Some((mut app, _)) = hills() else { return };
    app.insert_resource(VegetationPool {
        records: 64,
        pieces: 1 << 16,
    });
    plant(&mut app);
    settle(&mut app);
    app::frames(&mut app, 4);
    let thin = count(&app);
    println!("{thin:?}");
    assert!(thin.cut < 0.5 && thin.wanted > 500, "{thin:?}");
    assert!(thin.records.iter().sum::<u32>() <= 64, "{thin:?}");
}

/// Where blades end the ground is as green as they are; without plants it is what it was.
#[test]
fn far_ground_is_covered_gpu() {
    let Some((mut app, target)) = hills() else {
        return;
    };
    app::frames(&mut app, 12);
    let bare = app::picture(&mut app, &target);
    let short = KINDS.replace("density: 12.0, reach: 60.0", "density: 60.0, reach: 15.0");
    let terrain = plant_kinds(&mut app, &short);
    settle(&mut app);
    let far = app::picture(&mut app, &target);
    // The same without the ground's part.
    let canopy = app.world_mut().entity_mut(terrain).take::<GroundCanopy>();
    assert!(canopy.is_some_and(|canopy| canopy.layers.len() == 1));
    app::frames(&mut app, 6);
    let near = app::picture(&mut app, &target);
    app.world_mut().entity_mut(terrain).remove::<Vegetation>();
    app::frames(&mut app, 12);
    let after = app::picture(&mut app, &target);
    let green = [&bare, &far, &near, &after].map(|picture| {
        app::count(picture, 0, 160, |c| {
            c.green > 1.5 * c.red && c.green > 2.0 * c.blue
        })
    });
    println!("green pixels {green:?}");
    app::keep(far, "far.png");
    app::keep(near, "near.png");
    assert!(green[0] < 10 && green[1] > green[2] + 500, "{green:?}");
    assert!(green[3] < 10, "nothing is left of it: {green:?}");
}

/// Pixels of a picture that are mostly of one part: 0 red, 2 blue.
fn of_part(picture: &Image, part: usize) -> u32 {
    app::count(picture, 0, 160, |c| {
        let parts = [c.red, c.green, c.blue];
        let others = [0, 1, 2].into_iter().filter(|k| *k != part);
        others.into_iter().all(|k| parts[part] > 2.0 * parts[k])
    }) as u32
}

#[test]
fn flowers_have_heads_gpu() {
    let Some((mut app, target)) = hills() else {
        return;
    };
    app::frames(&mut app, 12);
    let bare = app::picture(&mut app, &target);
    plant_kinds(&mut app, SHAPES);
    settle(&mut app);
    let records = count(&app).records;
    let picture = app::picture(&mut app, &target);
    let red = [&bare, &picture].map(|picture| of_part(picture, 0));
    println!("{records:?}; red pixels {red:?}");
    app::keep(picture, "flowers.png");
    assert!(
        records[FLOWERS] > 3 && records[FLOWERS + 1] > 200,
        "{records:?}"
    );
    assert_eq!(records[CHAINS..], [0; 3], "no kelp on dry land");
    assert!(red[0] == 0 && red[1] > 100, "{red:?}");
}

/// Kelp stands on the bed and goes with the water: its pixels move, and nothing is dispatched for it.
#[test]
fn kelp_follows_the_swell_gpu() {
    let Some((mut app, target)) = hills_at(-9.0) else {
        return;
    };
    let terrain = plant_kinds(&mut app, SHAPES);
    app.world_mut()
        .entity_mut(terrain)
        .insert(dolomite_vegetation::Wind::default());
    let rests = settle(&mut app);
    let records = count(&app).records;
    assert!(records[CHAINS..].iter().sum::<u32>() > 200, "{records:?}");
    assert_eq!(records[FLOWERS], 0, "no flowers under water: {records:?}");
    app.world_mut()
        .insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(
            std::time::Duration::from_millis(700),
        ));
    app::frames(&mut app, 3);
    let pictures = [0, 1].map(|_| {
        app::frames(&mut app, 1);
        app::picture(&mut app, &target)
    });
    let blue = pictures.each_ref().map(|picture| of_part(picture, 2));
    println!("{records:?}; blue pixels {blue:?}");
    assert!(blue[0] > 500 && blue[1] > 500, "{blue:?}");
    assert!(pictures[0].data != pictures[1].data, "it moves");
    assert_eq!(count(&app).dispatches, rests);
    let [_, last] = pictures;
    app::keep(last, "kelp.png");
}

/// Kelp that is longer than the water is deep lies on the opaque surface of a sea, and is seen from above; shorter kelp is
/// below it, and is not.
#[test]
fn kelp_floats_on_an_opaque_sea_gpu() {
    let mut blue = Vec::new();
    for rise in ["(1.3, 2.0)", "(0.3, 0.8)"] {
        let Some((mut app, target)) = hills_in(-7.0, Some(0.0)) else {
            return;
        };
        let world = app.world_mut();
        let mut cameras = world.query_filtered::<&mut Transform, With<Camera3d>>();
        for mut eye in cameras.iter_mut(world) {
            *eye =
                Transform::from_xyz(0.0, 5.0, 0.0).looking_to(Vec3::new(0.3, -0.5, -1.0), Vec3::Y);
        }
        let kinds = SHAPES.replace("rise: (0.3, 0.8)", &format!("rise: {rise}"));
        plant_kinds(&mut app, &kinds.replace("segments: 16", "segments: 64"));
        settle(&mut app);
        let records = count(&app).records;
        let picture = app::picture(&mut app, &target);
        println!("{records:?}");
        assert!(records[CHAINS..].iter().sum::<u32>() > 200, "{records:?}");
        blue.push(of_part(&picture, 2));
        app::keep(picture, &format!("kelp {}.png", blue.len()));
    }
    println!("blue pixels {blue:?}");
    assert!(blue[0] > 500 && blue[1] == 0, "{blue:?}");
}
