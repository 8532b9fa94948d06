//! Buildings and hedges beyond the patches: records of 32 bytes in squares of 16 × 16 cells, which come and go with
//! the camera, one or two a frame, nearest first.

use std::collections::HashMap;
use std::sync::Arc;

use bevy::prelude::*;
use dolomite_tessellation::{PatchLayout, PatchMesh, PatchMeshError, Patches};

use super::kinds::CityRecords;
use super::{cell_corner, shown_city};
use crate::block::Block;
use crate::components::{City, CityBlocks, CityView};
use crate::rules::CityRules;
use crate::streets::{Cell, has_cell};
use crate::surface::Surface;

/// Cells along a side of a square.
const SQUARE: i32 = 16;

/// Squares made in a frame: half a millisecond each.
const A_FRAME: usize = 2;

/// Squares that are shown.
#[derive(Resource, Default)]
pub(super) struct FarCity {
    squares: HashMap<Cell, Entity>,
    of: Option<CityRules>,
}

/// The records of so many cells each way from `first`, relative to its corner.
///
/// # Errors
/// If they are more than a buffer holds.
pub fn records_mesh(
    rules: &CityRules,
    first: Cell,
    side: i32,
) -> Result<PatchMesh, PatchMeshError> {
    let mut points: Vec<[f32; 4]> = Vec::new();
    for z in 0..side {
        for x in 0..side {
            let cell = [first[0].wrapping_add(x), first[1].wrapping_add(z)];
            if !has_cell(rules, cell) {
                continue;
            }
            let block = Block::new(rules, cell);
            let corner = [x, z].map(|k| k as f32 * rules.pitch);
            for building in block.buildings(rules) {
                let [east, south] = building.centre;
                let material = building.walls as u32 | (building.lot << 3) | (building.tint << 5);
                points.push([
                    corner[0] + east,
                    corner[1] + south,
                    building.half,
                    building.half,
                ]);
                points.push([
                    building.eaves,
                    building.top - building.eaves,
                    building.inset,
                    material as f32,
                ]);
            }
            for hedge in block.hedges(rules) {
                let [east, south] = hedge.centre;
                points.push([
                    corner[0] + east,
                    corner[1] + south,
                    hedge.half[0],
                    hedge.half[1],
                ]);
                points.push([hedge.height, 0.0, 0.0, Surface::Leaves as u32 as f32]);
            }
        }
    }
    let indices = (0..points.len() as u32).collect();
    PatchMesh::new(PatchLayout::lines(2), points, indices)
}

/// Squares come and go.
pub(super) fn show_far(
    mut commands: Commands,
    mut far: ResMut<FarCity>,
    cities: Query<(Entity, &City, &CityBlocks, &Transform)>,
    views: Query<(Entity, &CityView, &Transform), Without<City>>,
) {
    let far = &mut *far;
    let shown = shown_city(&cities);
    let rules = shown
        .as_ref()
        .and_then(|(_, _, blocks, _)| blocks.rules.as_ref());
    if far.of.as_ref() != rules {
        for (_, entity) in far.squares.drain() {
            commands.entity(entity).despawn();
        }
        far.of = rules.cloned();
    }
    let first = views.iter().min_by_key(|(entity, ..)| entity.index_u32());
    let (Some((_, _, _, place)), Some(rules), Some((_, view, camera))) = (shown, rules, first)
    else {
        return;
    };
    let away = (camera.translation - place.translation).as_dvec3();
    let size = f64::from(rules.pitch) * f64::from(SQUARE);
    let eye = [away.x / size, away.z / size];
    if !eye.iter().all(|k| k.abs() < 1e6) {
        return;
    }
    let reach = f64::from(view.far.clamp(0.0, 20_000.0)) / size;
    // From the eye to the nearest point of a square, in squares.
    let distance = |square: Cell| {
        let along = |k: usize| {
            let low = f64::from(square[k]);
            (low - eye[k]).max(eye[k] - low - 1.0).max(0.0)
        };
        (along(0) * along(0) + along(1) * along(1)).sqrt()
    };
    far.squares.retain(|square, entity| {
        // A quarter farther than where they come, so that none comes and goes with every step.
        let stays = distance(*square) <= reach + 0.25;
        if !stays {
            commands.entity(*entity).despawn();
        }
        stays
    });
    let [x, z] = eye.map(|k| k.floor() as i32);
    let around = reach.ceil() as i32;
    let mut missing: Vec<(f64, Cell)> = Vec::new();
    for i in x - around..=x + around {
        for j in z - around..=z + around {
            let away = distance([i, j]);
            if away <= reach && !far.squares.contains_key(&[i, j]) {
                missing.push((away, [i, j]));
            }
        }
    }
    missing.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for (_, square) in missing.into_iter().take(A_FRAME) {
        let first = square.map(|k| k * SQUARE);
        match records_mesh(rules, first, SQUARE) {
            Ok(mesh) => {
                let cells = Vec4::new(first[0] as f32, first[1] as f32, 0.0, 0.0);
                let patches = Patches::<CityRecords>::new(Arc::new(mesh)).with(0, cells);
                let at = cell_corner(Some(rules), place, first);
                far.squares
                    .insert(square, commands.spawn((patches, at)).id());
            }
            Err(fault) => error!("a part of the city is not shown: {fault}"),
        }
    }
}
