//! The blocks around the camera as patches: meshes are made by a task, and shown when they are done.

use std::sync::Arc;

use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on};
use dolomite_tessellation::{PatchLayout, PatchMesh, PatchMeshError, Patches};

use super::kinds::{CityFaces, CityGlobes, CityPosts, CityRecords, FACE_LAYOUT};
use super::{CityMaps, shown_city};
use crate::block::Block;
use crate::components::{City, CityBlocks};
use crate::faces::Faces;
use crate::lamp::lamps;
use crate::map::DisplacementMap;
use crate::relief::{CityPatch, PatchData};
use crate::rules::CityRules;
use crate::streets::Cell;

/// Half of the side of the flat ground beyond, metres.
const GROUND: f32 = 20_000.0;

/// The entities that show what is near, and what is being made.
#[derive(Resource, Default)]
pub(super) struct NearCity {
    entities: Option<[Entity; 3]>,
    task: Option<Task<Result<Near, PatchMeshError>>>,
    /// What is shown or being made is of.
    of: Option<([i32; 2], u32, CityRules)>,
    /// The cells that are patches in what is shown; the records read it.
    shown: Option<Near>,
    /// Microseconds that the last one took to make.
    pub(super) made_in: u64,
}

#[derive(Clone)]
struct Near {
    faces: Arc<PatchMesh>,
    posts: Arc<PatchMesh>,
    globes: Arc<PatchMesh>,
    origin: Cell,
    cells: [i32; 4],
    micros: u64,
}

/// The patches of faces.
///
/// # Errors
/// If they are more than a buffer holds.
pub fn faces_mesh(patches: &[CityPatch]) -> Result<PatchMesh, PatchMeshError> {
    let points: Vec<[f32; 4]> = patches
        .iter()
        .flat_map(|patch| {
            let PatchData {
                across,
                up,
                face,
                map,
            } = patch.data;
            let [a, b, c, d] = patch.corners;
            [a, b, c, d, across, up, face, map]
        })
        .collect();
    PatchMesh::from_patches(FACE_LAYOUT, &points)
}

/// Octants of a globe: corners by twice the axis plus one on its negative side, counter-clockwise from outside.
const OCTANTS: [[u32; 3]; 8] = [
    [0, 2, 4],
    [2, 1, 4],
    [1, 3, 4],
    [3, 0, 4],
    [2, 0, 5],
    [1, 2, 5],
    [3, 1, 5],
    [0, 3, 5],
];

/// Posts and globes of the lamps of blocks, relative to the corner of the `origin` cell.
///
/// # Errors
/// If they are more than a buffer holds.
pub fn lamp_meshes(
    rules: &CityRules,
    cells: impl Iterator<Item = Cell>,
    origin: Cell,
) -> Result<[PatchMesh; 2], PatchMeshError> {
    let (mut posts, mut post_indices) = (Vec::new(), Vec::new());
    let (mut globes, mut globe_indices) = (Vec::new(), Vec::new());
    for cell in cells {
        let corner = [0, 1]
            .map(|k| (f64::from(cell[k].wrapping_sub(origin[k])) * f64::from(rules.pitch)) as f32);
        for lamp in lamps(rules, cell) {
            let [x, z] = [0, 1].map(|k| corner[k] + lamp.place[k]);
            let angle = bevy::math::ops::atan2(lamp.direction[1], lamp.direction[0]);
            let number = posts.len() as u32;
            posts.push([x, z, angle, lamp.height]);
            post_indices.extend([number; 3]);
            let light = lamp.light(rules);
            let first = globes.len() as u32;
            // Whole millimetres, as the control point has room for.
            let radius = (lamp.globe * 1000.0).round();
            for axis in 0..6 {
                globes.push([
                    corner[0] + light[0],
                    light[1],
                    corner[1] + light[2],
                    axis as f32 + 8.0 * radius,
                ]);
            }
            globe_indices.extend(OCTANTS.iter().flatten().map(|corner| first + corner));
        }
    }
    Ok([
        PatchMesh::new(PatchLayout::lines(1), posts, post_indices)?,
        PatchMesh::new(PatchLayout::TRIANGLE, globes, globe_indices)?,
    ])
}

fn make(
    rules: &CityRules,
    maps: &[DisplacementMap],
    blocks: &[Block],
    middle: Cell,
    reach: u32,
) -> Result<Near, PatchMeshError> {
    let start = std::time::Instant::now();
    let known: std::collections::HashSet<Cell> = blocks.iter().map(|block| block.cell).collect();
    let mut faces = Faces::new(rules, maps, middle);
    for block in blocks {
        faces.block(block, |cell| known.contains(&cell));
    }
    faces.far_ground(GROUND);
    let mesh = faces_mesh(&faces.patches)?;
    let [posts, globes] = lamp_meshes(rules, blocks.iter().map(|block| block.cell), middle)?;
    let reach = reach.cast_signed();
    Ok(Near {
        faces: Arc::new(mesh),
        posts: Arc::new(posts),
        globes: Arc::new(globes),
        origin: middle,
        cells: [
            middle[0] - reach,
            middle[1] - reach,
            middle[0] + reach,
            middle[1] + reach,
        ],
        micros: start.elapsed().as_micros() as u64,
    })
}

/// Makes and shows what is near; takes it away with its city.
pub(super) fn show_near(
    mut commands: Commands,
    mut near: ResMut<NearCity>,
    maps: Res<CityMaps>,
    mut records: ResMut<CityRecords>,
    cities: Query<(Entity, &City, &CityBlocks, &Transform)>,
) {
    let Some((_, _, blocks, place)) = shown_city(&cities) else {
        if let Some(entities) = near.entities.take() {
            for entity in entities {
                commands.entity(entity).despawn();
            }
            *near = NearCity::default();
        }
        return;
    };
    if let Some(task) = near.task.take_if(|task| task.is_finished()) {
        match block_on(task) {
            Ok(made) => {
                near.made_in = made.micros;
                let cells = IVec4::from_array(made.cells);
                if records.near != cells {
                    records.near = cells;
                }
                for entity in near.entities.take().into_iter().flatten() {
                    commands.entity(entity).despawn();
                }
                let at = super::cell_corner(blocks.rules.as_ref(), place, made.origin);
                near.entities = Some([
                    commands
                        .spawn((Patches::<CityFaces>::new(made.faces.clone()), at))
                        .id(),
                    commands
                        .spawn((Patches::<CityPosts>::new(made.posts.clone()), at))
                        .id(),
                    commands
                        .spawn((Patches::<CityGlobes>::new(made.globes.clone()), at))
                        .id(),
                ]);
                near.shown = Some(made);
            }
            Err(fault) => error!("the city near the camera stays as it was: {fault}"),
        }
    }
    let Some(rules) = &blocks.rules else {
        return;
    };
    let same = near.of.as_ref().is_some_and(|(middle, reach, of)| {
        *middle == blocks.middle && *reach == blocks.reach && of == rules
    });
    if same || near.task.is_some() || !blocks.known {
        return;
    }
    near.of = Some((blocks.middle, blocks.reach, rules.clone()));
    let (rules, maps) = (rules.clone(), maps.0.clone());
    let (middle, reach) = (blocks.middle, blocks.reach);
    let blocks: Vec<Block> = blocks.around.blocks().copied().collect();
    near.task = Some(
        AsyncComputeTaskPool::get()
            .spawn(async move { make(&rules, &maps, &blocks, middle, reach) }),
    );
}
