//! Ranks in each pixel, against the candidates that stand near where the pixel looks.

use std::collections::HashMap;
use std::sync::Arc;

use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::{
    BufferDescriptor, BufferUsages, Extent3d, MapMode, PipelineCache, PollType,
    TexelCopyBufferInfo, TexelCopyBufferLayout,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use dolomite_ground::{GroundMaterial, GroundPlugin, TerrainView};
use dolomite_terrain::{GroundPoint, GroundRect, Terrain, TerrainData};
use dolomite_vegetation::render::VegetationStats;
use dolomite_vegetation::render::ranks::{RankPasses, ViewRanks};
use dolomite_vegetation::{
    Growth, Kinds, Vegetation, VegetationPlugin, VegetationRanks, VegetationView,
};

use crate::app;

const SIZE: [u32; 2] = [160, 90];
/// Where the ground is, and the eye above it, metres.
const GROUND: f32 = 20.0;
const ABOVE: f32 = 4.0;
/// Of the longest blade, metres.
const LENGTH: f32 = 0.5;

const KINDS: &str = "(kinds: [
    (name: \"grass\", density: 30.0, reach: 60.0, shape: Blade((
        length: (0.3, 0.5), width: 0.04,
        look: (root: (0.0, 0.4, 0.0), tip: (0.1, 0.9, 0.1), dry: (0.4, 0.35, 0.15)))))])";

/// Grass on flat ground, seen from straight above.
fn meadow(place: DVec2) -> Option<(App, Entity, Kinds)> {
    let mut app = app::app(|app| {
        app::bevys(app);
        app.insert_resource(bevy::pbr::DefaultOpaqueRendererMethod::deferred())
            .add_plugins((GroundPlugin::default(), VegetationPlugin));
    })?;
    let kinds = Kinds::parse(KINDS, "test.ron".as_ref()).expect("a good list");
    let terrain = Terrain::new(TerrainData {
        extent: GroundRect::square(place, 100.0),
        layers: Vec::new(),
        base: GROUND,
        sea_level: None,
    })
    .expect("in range");
    let world = app.world_mut();
    world.spawn((
        terrain,
        GroundMaterial::default(),
        Vegetation {
            kinds: Arc::new(kinds.clone()),
            ..default()
        },
    ));
    let eye = Vec3::new(place.x as f32, GROUND + ABOVE, place.y as f32);
    let camera = world
        .spawn((
            Camera3d::default(),
            Msaa::Off,
            TerrainView,
            VegetationView,
            Transform::from_translation(eye).looking_to(Vec3::NEG_Y, Vec3::X),
        ))
        .id();
    let target = app::target(&mut app, SIZE);
    app::retarget(&mut app, &target);
    for _ in 0..100 {
        app::frames(&mut app, 4);
        let stats = app.world().resource::<VegetationStats>().get();
        if stats.records.iter().sum::<u32>() > 0 {
            return Some((app, camera, kinds));
        }
    }
    panic!("nothing grows");
}

/// What each pixel has, once it is asked for.
fn found(app: &mut App, camera: Entity) -> Vec<[f32; 2]> {
    app.world_mut().entity_mut(camera).insert(VegetationRanks);
    app::frames(app, 6);
    let world = app.sub_app_mut(RenderApp).world_mut();
    let own = world.query::<&ViewRanks>().iter(world).next().cloned();
    let own = own.expect("it was asked for");
    let (device, queue) = (
        world.resource::<RenderDevice>(),
        world.resource::<RenderQueue>(),
    );
    let row = (8 * SIZE[0]).next_multiple_of(256);
    let staging = device.create_buffer(&BufferDescriptor {
        label: None,
        size: u64::from(row * SIZE[1]),
        usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&default());
    encoder.copy_texture_to_buffer(
        own.found.texture.as_image_copy(),
        TexelCopyBufferInfo {
            buffer: &staging,
            layout: TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(row),
                rows_per_image: None,
            },
        },
        Extent3d {
            width: SIZE[0],
            height: SIZE[1],
            depth_or_array_layers: 1,
        },
    );
    queue.submit([encoder.finish()]);
    staging.slice(..).map_async(MapMode::Read, |mapped| {
        mapped.expect("it is read back");
    });
    device.poll(PollType::wait_indefinitely()).expect("done");
    let bytes = staging.slice(..).get_mapped_range().to_vec();
    let lines = bytes.chunks_exact(row as usize);
    let lines = lines.map(|line| &line[..8 * SIZE[0] as usize]);
    lines
        .flat_map(bytemuck::pod_collect_to_vec::<u8, [f32; 2]>)
        .collect()
}

/// Pipelines of ranks, passes, and whether a view has a texture.
fn census(app: &mut App) -> (usize, u64, bool) {
    let passes = app.world().resource::<RankPasses>().count();
    let world = app.sub_app_mut(RenderApp).world_mut();
    let is_there = world.query::<&ViewRanks>().iter(world).next().is_some();
    let queued = world.resource::<PipelineCache>().pipelines();
    let label = "label: Some(\"vegetation_ranks\")";
    let queued = queued.filter(|one| format!("{:?}", one.descriptor).contains(label));
    (queued.count(), passes, is_there)
}

/// Where on the ground a pixel looks, relative to below the eye, metres. The picture's top is +X.
fn looks_at(pixel: usize) -> DVec2 {
    let [width, height] = SIZE.map(f64::from);
    let (x, y) = (
        (pixel % SIZE[0] as usize) as f64 + 0.5 - 0.5 * width,
        0.5 * height - (pixel / SIZE[0] as usize) as f64 - 0.5,
    );
    // Half of Bevy's usual field of view: an eighth of a half turn.
    let tangent = std::f64::consts::SQRT_2 - 1.0;
    let metre = f64::from(ABOVE) * tangent / (0.5 * height);
    DVec2::new(y, x) * metre
}

#[test]
fn pixels_have_the_ranks_of_what_stands_there_gpu() {
    // Off the origin, where the anchor's metres count.
    for place in [DVec2::ZERO, DVec2::new(-70_001.0, 123_457.0)] {
        let Some((mut app, camera, kinds)) = meadow(place) else {
            return;
        };
        assert_eq!(census(&mut app), (0, 0, false), "off, nothing");
        let pixels = found(&mut app, camera);
        let growth = Growth::new(&kinds.kinds[0], Vegetation::default().seed);
        let least = GroundPoint::new(place - 8.0);
        let most = GroundPoint::new(place + 8.0);
        // Candidates by rank, relative to below the eye.
        let mut stands: HashMap<u32, Vec<DVec2>> = HashMap::new();
        for cell in growth.lattice.cells(least, most) {
            let root = growth.lattice.root(cell);
            if growth.stands(root, GROUND, 0.0) {
                let at = growth.lattice.place(root).to_dvec2() - place;
                stands.entry(root.rank).or_default().push(at);
            }
        }
        let (mut seen, mut near, mut ranks) = (0, 0, Vec::new());
        for (k, [share, full]) in pixels.iter().enumerate() {
            if *share < 0.0 {
                assert_eq!((*share, *full), (-1.0, 1.0));
                continue;
            }
            seen += 1;
            assert_eq!(*full, growth.full);
            let rank = (share * 16_777_216.0) as u32;
            let places = stands.get(&rank);
            let places = places.unwrap_or_else(|| panic!("{rank} stands nowhere near"));
            // A blade reaches as far as it is long, and stands towards the eye by perspective.
            let at = looks_at(k);
            let reach = 0.05 + f64::from(LENGTH) * (1.0 + at.length() / f64::from(ABOVE - LENGTH));
            near += u32::from(places.iter().any(|place| place.distance(at) <= reach));
            ranks.push(rank);
        }
        ranks.sort_unstable();
        ranks.dedup();
        println!(
            "{place}: {seen} pixels of {} ranks, {near} where they stand",
            ranks.len()
        );
        assert!(seen > 500 && ranks.len() > 50, "{seen} {}", ranks.len());
        assert_eq!(near, seen, "each stands where it is seen");
        // That can fail: half of the picture away they stand elsewhere.
        let moved = pixels.iter().enumerate().filter(|(k, [share, _])| {
            let rank = (share * 16_777_216.0) as u32;
            let at = looks_at((k + pixels.len() / 2) % pixels.len());
            let places = stands.get(&rank);
            places.is_some_and(|all| all.iter().any(|place| place.distance(at) <= 0.6))
        });
        assert!(10 * moved.count() < 2 * seen as usize, "any place would do");

        let (queued, passes, is_there) = census(&mut app);
        assert!(queued == 3 && passes > 0 && is_there, "the counts count");
        app.world_mut()
            .entity_mut(camera)
            .remove::<VegetationRanks>();
        app::frames(&mut app, 2);
        let (_, passes, is_there) = census(&mut app);
        assert!(!is_there, "off, no texture");
        app::frames(&mut app, 2);
        assert_eq!(census(&mut app), (3, passes, false), "off, no pass");
    }
}
