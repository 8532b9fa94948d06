//! The bench over ways to make the triangles of a city: by the bound and at one level, on the GPU and on the CPU, filled
//! and as lines; and on the GPU by distance, as the literature has it.
//!
//! The CPU makes the faces of the blocks that the GPU has as patches, by the same levels, and hands them to Bevy as one
//! mesh: anew whenever the camera moved, or once. Posts, lamps and what is far are not in it.

use std::path::Path as FilePath;

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use dolomite::city::levels::{Eye, PatchLevels};
use dolomite::city::maps::maps;
use dolomite::city::streets::{cell_at, has_cell};
use dolomite::city::{
    Block, City, CityDetail, CityPatch, CityView, Classic, DisplacementMap, ErrorBound, Faces,
};
use dolomite::tessellation::{Domain, Levels, Spacing, tessellate};

use super::classic::matrix::{Row, SHOWN};
use super::path::Path;
use super::{BenchError, Spread, fly, summary, write};
use crate::play::Switches;
use crate::play::camera::FreeCamera;
use crate::run::Setup;
use crate::run::offscreen::Offscreen;
use crate::scene::city::CityScene;

/// Pixels that triangles may be off.
const TOLERANCE: f32 = 1.0;

/// The level of ways that have one.
const LEVEL: f32 = 8.0;

/// A way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Gpu,
    Distance,
    StaticGpu,
    Cpu,
    StaticCpu,
}

impl Way {
    const ALL: [Self; 5] = [
        Self::Gpu,
        Self::Distance,
        Self::StaticGpu,
        Self::Cpu,
        Self::StaticCpu,
    ];

    const fn name(self) -> &'static str {
        match self {
            Self::Gpu => "gpu",
            Self::Distance => "gpu-distance",
            Self::StaticGpu => "static-gpu",
            Self::Cpu => "cpu",
            Self::StaticCpu => "static-cpu",
        }
    }

    fn detail(self) -> CityDetail {
        match self {
            Self::Gpu | Self::Cpu => CityDetail::ErrorBound(TOLERANCE),
            Self::Distance => CityDetail::Classic(Classic::default()),
            Self::StaticGpu | Self::StaticCpu => CityDetail::Static(LEVEL),
        }
    }
}

/// Faces that the CPU divides.
#[derive(Resource)]
struct CpuFaces {
    city: CityScene,
    maps: Vec<DisplacementMap>,
    way: Way,
    lines: bool,
    pixels_per_radian: f32,
    cell: Option<[i32; 2]>,
    patches: Vec<CityPatch>,
    at: Option<Vec3>,
    mesh: Handle<Mesh>,
    entity: Entity,
    /// Vertices and triangles of the mesh, and bytes handed over so far.
    counts: [u64; 3],
}

/// Flies `frames` of `path` by every way of making and drawing triangles, each after it has settled at the start.
/// Writes the rows to `file` if there is one.
///
/// # Errors
/// [`BenchError`]: no device, a wrong size, no frames, a file that cannot be written.
pub fn matrix(
    setup: Setup,
    path: Path,
    size: UVec2,
    frames: u32,
    file: Option<&FilePath>,
) -> Result<Vec<Row>, BenchError> {
    if frames == 0 {
        return Err(BenchError::NoFrames);
    }
    if let Some(file) = file {
        write(file, "[]")?;
    }
    let scene = setup.scene.clone();
    let Some(city) = scene.city.clone() else {
        return Ok(Vec::new());
    };
    let mut offscreen = Offscreen::new(setup, size)?;
    offscreen
        .app
        .add_systems(PostUpdate, divide.run_if(resource_exists::<CpuFaces>));
    let mut rows = Vec::new();
    for way in Way::ALL {
        for (shown, fill, lines) in SHOWN {
            let cpu = matches!(way, Way::Cpu | Way::StaticCpu);
            // One mesh of the CPU is either.
            if cpu && fill && lines {
                continue;
            }
            let world = offscreen.app.world_mut();
            let switches = *world.resource::<Switches>();
            world.insert_resource(Switches {
                fill,
                lines,
                ..switches
            });
            choose(world, way, lines, &city, size);
            let flown = fly(&mut offscreen, path, &scene, frames)?;
            let mut summary = summary(&flown, &offscreen, path, &scene, size);
            summary.mode = way.name();
            summary.metric = match way {
                Way::Gpu | Way::Cpu => "error",
                Way::Distance => "distance",
                Way::StaticGpu | Way::StaticCpu => "level",
            };
            if let Some(faces) = offscreen.app.world().get_resource::<CpuFaces>() {
                let [vertices, triangles, uploaded] = faces.counts;
                (summary.vertices, summary.triangles) = (vertices, triangles);
                (summary.bytes, summary.uploaded) = (vertices * 40 + triangles * 12, uploaded);
            }
            let Spread { median, p99 } = summary.frame_ms;
            eprintln!(
                "dolomite: {} {shown}: median {median:.1} ms, p99 {p99:.1} ms",
                way.name()
            );
            rows.push(Row {
                mode: way.name(),
                shown,
                summary,
            });
        }
    }
    if let Some(file) = file {
        let text = serde_json::to_string_pretty(&rows)
            .expect("numbers, strings and maps with string keys always become JSON");
        write(file, &text)?;
    }
    Ok(rows)
}

/// Shows the city by a way: as patches, or as a mesh of the CPU in their place.
fn choose(world: &mut World, way: Way, lines: bool, city: &CityScene, size: UVec2) {
    if let Some(old) = world.remove_resource::<CpuFaces>() {
        world.despawn(old.entity);
    }
    let mut cities = world.query_filtered::<Entity, With<City>>();
    let known: Vec<Entity> = cities.iter(world).collect();
    if !matches!(way, Way::Cpu | Way::StaticCpu) {
        if known.is_empty() {
            let place = Transform::from_translation(city.origin.as_vec3());
            let rules = city.rules.clone();
            let detail = way.detail();
            world.spawn((
                City {
                    rules,
                    detail,
                    ..default()
                },
                place,
            ));
        }
        let mut cities = world.query::<&mut City>();
        for mut city in cities.iter_mut(world) {
            city.detail = way.detail();
        }
        return;
    }
    for entity in known {
        world.despawn(entity);
    }
    let mut cameras = world.query::<&FreeCamera>();
    let fov = cameras.iter(world).next().map_or(60.0, |camera| camera.fov);
    let mesh = world.resource_mut::<Assets<Mesh>>().add(empty(lines));
    let material = StandardMaterial {
        perceptual_roughness: 0.9,
        unlit: lines,
        ..default()
    };
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(material);
    let entity = world
        .spawn((
            Mesh3d(mesh.clone()),
            MeshMaterial3d(material),
            bevy::camera::visibility::NoFrustumCulling,
        ))
        .id();
    world.insert_resource(CpuFaces {
        city: city.clone(),
        maps: maps().to_vec(),
        way,
        lines,
        pixels_per_radian: size.y as f32 / fov.to_radians(),
        cell: None,
        patches: Vec::new(),
        at: None,
        mesh,
        entity,
        counts: [0; 3],
    });
}

fn empty(lines: bool) -> Mesh {
    let topology = if lines {
        PrimitiveTopology::LineList
    } else {
        PrimitiveTopology::TriangleList
    };
    Mesh::new(topology, RenderAssetUsages::default())
}

/// Divides the faces near the camera anew where it has moved; at one level where it has come into another cell.
fn divide(
    mut faces: ResMut<CpuFaces>,
    mut meshes: ResMut<Assets<Mesh>>,
    cameras: Query<(&Transform, Option<&CityView>), With<FreeCamera>>,
    mut places: Query<&mut Transform, Without<FreeCamera>>,
) {
    let Some((camera, view)) = cameras.iter().next() else {
        return;
    };
    let faces = &mut *faces;
    let rules = faces.city.rules.clone();
    let away = camera.translation.as_dvec3() - faces.city.origin;
    let Some(cell) = cell_at(&rules, [away.x, away.z]) else {
        return;
    };
    let pitch = f64::from(rules.pitch);
    let corner =
        bevy::math::DVec3::new(f64::from(cell[0]) * pitch, 0.0, f64::from(cell[1]) * pitch);
    let another = faces.cell != Some(cell);
    if another {
        let near = view.copied().unwrap_or_default().near;
        let reach = (near / rules.pitch).ceil() as i32;
        let mut made = Faces::new(&rules, &faces.maps, cell);
        let within =
            |c: [i32; 2]| has_cell(&rules, c) && (0..2).all(|k| (c[k] - cell[k]).abs() <= reach);
        for z in cell[1] - reach..=cell[1] + reach {
            for x in (cell[0] - reach..=cell[0] + reach).filter(|x| within([*x, z])) {
                made.block(&Block::new(&rules, [x, z]), within);
            }
        }
        faces.patches = made.patches;
        faces.cell = Some(cell);
        if let Ok(mut place) = places.get_mut(faces.entity) {
            place.translation = (faces.city.origin + corner).as_vec3();
        }
    }
    let still = faces.at == Some(camera.translation);
    if !another && (faces.way == Way::StaticCpu || still) {
        return;
    }
    faces.at = Some(camera.translation);
    let eye = Eye {
        at: (away - corner).as_vec3(),
        pixels_per_radian: faces.pixels_per_radian,
    };
    let bound = ErrorBound::new(&rules, &faces.maps, TOLERANCE);
    let (mut points, mut normals, mut colours, mut indices) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for patch in &faces.patches {
        let levels = match faces.way {
            Way::StaticCpu => PatchLevels {
                outer: [LEVEL; 4],
                inner: [LEVEL; 2],
            },
            _ => bound.levels(&eye, patch),
        };
        let PatchLevels { outer, inner } = levels;
        let mesh = tessellate(
            Domain::Quads,
            Spacing::FractionalOdd,
            Levels { outer, inner },
        );
        let first = points.len() as u32;
        let map = &faces.maps[patch.data.map[3] as usize];
        for [u, v, _] in &mesh.coordinates {
            let (place, normal) = patch.evaluate(map, rules.relief.band, *u, *v);
            points.push(place.to_array());
            normals.push(normal.normalize().to_array());
            colours.push(colour(patch.data.material() & 7));
        }
        for corners in mesh.primitives.triangles() {
            let [a, b, c] = corners.map(|corner| first + corner);
            if faces.lines {
                indices.extend([a, b, b, c, c, a]);
            } else {
                indices.extend([a, b, c]);
            }
        }
    }
    let triangles = indices.len() as u64 / if faces.lines { 6 } else { 3 };
    let vertices = points.len() as u64;
    faces.counts = [
        vertices,
        triangles,
        faces.counts[2] + vertices * 40 + indices.len() as u64 * 4,
    ];
    let mesh = empty(faces.lines)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, points)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colours)
        .with_inserted_indices(Indices::U32(indices));
    // The handle is one that this table gave.
    let _ = meshes.insert(&faces.mesh, mesh);
}

/// What surfaces look like without a shader of their own.
const fn colour(surface: u32) -> [f32; 4] {
    match surface {
        0 => [0.06, 0.06, 0.06, 1.0],
        1 => [0.2, 0.19, 0.17, 1.0],
        3 => [0.4, 0.17, 0.1, 1.0],
        4 => [0.6, 0.52, 0.4, 1.0],
        5 => [0.3, 0.1, 0.06, 1.0],
        _ => [0.06, 0.11, 0.03, 1.0],
    }
}
