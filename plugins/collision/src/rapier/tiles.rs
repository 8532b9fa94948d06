//! Tiles where bodies are awake: samples of the ground, which its surface looks into, and a collider each, for casts,
//! sensors and continuous collision detection.
//!
//! Rapier wakes bodies whose ground is removed. A tile below a body that sleeps is therefore first taken out of the
//! contacts and islands, by a call that knows no bodies to wake, and then removed: the body sleeps on over nothing, and
//! gets its tile back when it wakes.

use super::bodies::{Bodies, BodyBox};
use super::counters::BridgeCounters;
use super::surfaces::{Components, Material, Surfaces};
use crate::ground::GroundTiles;
use bevy::ecs::prelude::*;
use bevy::math::{DVec2, IRect, IVec2};
use bevy::platform::collections::{HashMap, HashSet};
use bevy::transform::components::Transform;
use bevy_rapier3d::parry::shape::SharedShape;
use bevy_rapier3d::prelude::{
    Collider, DefaultRapierContext, RapierColliderHandle, RapierContextColliders,
    RapierContextSimulation, RapierRigidBodySet,
};
use bevy_rapier3d::rapier::prelude::RigidBodySet;
use dolomite_terrain::GroundRect;
use std::sync::Arc;

/// Steps that a tile stays which nobody needs: a body that rolls to and fro over a border makes none anew.
const LINGER: u32 = 30;

/// Most tiles along a side of what one body gets: more is some body that is larger, or faster, than ground is made
/// for.
const MOST: i32 = 16;

/// A tile of a ground.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TileOf {
    ground: Entity,
}

/// One tile.
struct Tile {
    entity: Entity,
    samples: Arc<[f32]>,
    /// What its shape holds.
    bytes: u64,
    /// Steps for which nobody needed it.
    idle: u32,
}

/// All tiles.
#[derive(Resource, Default)]
pub(super) struct Tiles {
    of: HashMap<(Entity, IVec2), Tile>,
    /// Grounds as they were in the last step.
    last: HashMap<Entity, GroundTiles>,
    /// Bodies that rise with the ground, and by how much.
    lifts: Vec<(Entity, f32)>,
}

/// The tiles below a box; `true` if there were too many.
fn below(ground: &GroundTiles, body: &BodyBox) -> Option<(IRect, bool)> {
    let around = f64::from(ground.margin.max(0.0));
    let far = |p: DVec2| ground.cell(p).map(|cell| ground.tile_of(cell));
    let (min, max) = (far(body.min - around)?, far(body.max + around)?);
    let middle = far((body.min + body.max) * 0.5)?;
    let (least, most) = (middle - MOST / 2, middle + MOST / 2);
    let rect = IRect::from_corners(min.max(least), max.min(most));
    Some((rect, rect.min != min || rect.max != max))
}

fn each(rect: IRect) -> impl Iterator<Item = IVec2> {
    (rect.min.x..=rect.max.x)
        .flat_map(move |x| (rect.min.y..=rect.max.y).map(move |y| IVec2::new(x, y)))
}

/// Makes the tiles that are needed, and removes those that are not.
pub(super) fn keep(
    mut tiles: ResMut<Tiles>,
    mut counters: ResMut<BridgeCounters>,
    surfaces: Res<Surfaces>,
    grounds: Query<(Entity, &GroundTiles, Components)>,
    bodies: Bodies,
    mut worlds: Query<
        (
            &mut RapierContextSimulation,
            &mut RapierContextColliders,
            &RapierRigidBodySet,
        ),
        With<DefaultRapierContext>,
    >,
    handles: Query<&RapierColliderHandle, With<TileOf>>,
    mut commands: Commands,
) {
    let Ok((mut simulation, mut colliders, set)) = worlds.single_mut() else {
        return;
    };
    let boxes = bodies.boxes(set, &colliders);
    let mut needed: HashSet<(Entity, IVec2)> = HashSet::default();
    for (entity, ground, _) in &grounds {
        for body in boxes.iter().filter(|body| body.awake) {
            let Some((rect, cut)) = below(ground, body) else {
                counters.refused += 1;
                continue;
            };
            counters.refused += u64::from(cut);
            needed.extend(each(rect).map(|tile| (entity, tile)));
        }
        // One that sleeps beside them may be hit in this step: all below it is needed then.
        let mut beside = Vec::new();
        for body in boxes.iter().filter(|body| !body.awake) {
            if let Some((rect, _)) = below(ground, body)
                && each(rect).any(|tile| needed.contains(&(entity, tile)))
            {
                beside.extend(each(rect).map(|tile| (entity, tile)));
            }
        }
        needed.extend(beside);
    }
    let mut made: Vec<_> = needed
        .iter()
        .filter(|key| !tiles.of.contains_key(*key))
        .copied()
        .collect();
    // In an order that hashing does not change: Rapier's results depend on it.
    made.sort_unstable_by_key(|(entity, tile)| (*entity, tile.x, tile.y));
    for (entity, tile) in made {
        let Ok((_, ground, components)) = grounds.get(entity) else {
            continue;
        };
        let samples = ground.samples(tile);
        if let Some(surface) = surfaces.get(entity) {
            surface.insert(tile, samples.clone());
        }
        let shape = ground.shape(tile, samples.clone());
        let bytes = shape.bytes();
        let mut spawned = commands.spawn((
            TileOf { ground: entity },
            Collider::from(SharedShape::new(shape)),
            Transform::from_translation(ground.place(tile)),
        ));
        let material = Material::of(components);
        if let Some(friction) = material.friction {
            spawned.insert(friction);
        }
        if let Some(restitution) = material.restitution {
            spawned.insert(restitution);
        }
        if let Some(groups) = material.groups {
            spawned.insert(groups);
        }
        if let Some(groups) = material.solver_groups {
            spawned.insert(groups);
        }
        let made = Tile {
            entity: spawned.id(),
            samples,
            bytes,
            idle: 0,
        };
        counters.made += 1;
        tiles.of.insert((entity, tile), made);
    }
    let mut gone = Vec::new();
    tiles.of.retain(|key, tile| {
        if needed.contains(key) {
            tile.idle = 0;
            return true;
        }
        tile.idle += 1;
        let stays = tile.idle <= LINGER && grounds.contains(key.0);
        if !stays {
            gone.push((grounds.contains(key.0), *key, tile.entity));
        }
        stays
    });
    gone.sort_unstable_by_key(|(_, (entity, tile), _)| (*entity, tile.x, tile.y));
    let mut nobody = RigidBodySet::new();
    for (silent, (ground, tile), entity) in gone {
        if let Some(surface) = surfaces.get(ground) {
            surface.remove(tile);
        }
        if silent && let Ok(handle) = handles.get(entity) {
            let simulation = &mut *simulation;
            // With the islands, whose contacts are numbered as those of the narrow phase are.
            simulation.narrow_phase.handle_user_changes(
                Some(&mut simulation.islands),
                &[],
                &[handle.0],
                &mut colliders.colliders,
                &mut nobody,
                &(),
            );
        }
        commands.entity(entity).try_despawn();
    }
    counters.tiles = tiles.of.len() as u32;
    counters.bytes = tiles.of.values().map(|tile| tile.bytes).sum();
}

/// Where a ground was changed: other samples in the tiles that there are; bodies on them wake, and are lifted with
/// what rises.
pub(super) fn change(
    mut tiles: ResMut<Tiles>,
    mut counters: ResMut<BridgeCounters>,
    surfaces: Res<Surfaces>,
    grounds: Query<(Entity, Ref<GroundTiles>)>,
    bodies: Bodies,
    mut worlds: Query<
        (
            &mut RapierContextSimulation,
            &RapierContextColliders,
            &mut RapierRigidBodySet,
        ),
        With<DefaultRapierContext>,
    >,
    mut commands: Commands,
) {
    let tiles = &mut *tiles;
    tiles.last.retain(|entity, _| grounds.contains(*entity));
    for (entity, ground) in &grounds {
        if !ground.is_changed() {
            continue;
        }
        let Some(last) = tiles.last.insert(entity, GroundTiles::clone(&ground)) else {
            continue;
        };
        let other_lattice = last.side() != ground.side() || last.step() != ground.step();
        let same_cells = !other_lattice && last.diagonals() == ground.diagonals();
        // Where the ground tells what it changed in, all beyond stays as it is.
        let rects = ground
            .ground()
            .changed_rects(&**last.ground())
            .filter(|_| same_cells);
        let touched = |min: DVec2, max: DVec2| {
            rects.as_ref().is_none_or(|rects| {
                let meets =
                    |rect: &GroundRect| min.cmple(rect.max).all() && max.cmpge(rect.min).all();
                rects.iter().any(meets)
            })
        };
        let step = f64::from(ground.step());
        let side = f64::from(ground.side());
        tiles.of.retain(|(of, tile), known| {
            if *of != entity {
                return true;
            }
            if other_lattice {
                commands.entity(known.entity).try_despawn();
                return false;
            }
            // With the step around it.
            let corner = tile.as_dvec2() * side;
            if !touched(corner - step, corner + side + step) {
                return true;
            }
            counters.looked_at += 1;
            let samples = ground.samples(*tile);
            if samples != known.samples || last.diagonals() != ground.diagonals() {
                let shape = ground.shape(*tile, samples.clone());
                commands
                    .entity(known.entity)
                    .insert(Collider::from(SharedShape::new(shape)));
                known.samples = samples;
                counters.replaced += 1;
            }
            true
        });
        if let Some(surface) = surfaces.get(entity) {
            let own = tiles.of.iter().filter(|((of, _), _)| *of == entity);
            let samples = own.map(|((_, tile), known)| (*tile, known.samples.clone()));
            surface.set(GroundTiles::clone(&ground), samples.collect());
        }
        let Ok((mut simulation, colliders, mut set)) = worlds.single_mut() else {
            continue;
        };
        for body in bodies.boxes(&set, colliders) {
            if !touched(body.at_min - step, body.at_max + step) {
                continue;
            }
            let Some(rise) = risen(&last, &ground, &body) else {
                continue;
            };
            if let Some(handle) = body.handle {
                simulation.islands.wake_up(&mut set.bodies, handle, true);
                counters.woken += u64::from(!body.awake);
            }
            if rise > 0.0 {
                tiles.lifts.push((body.entity, rise));
                counters.lifted += 1;
            }
        }
    }
}

/// Lifts what [`change`] said.
pub(super) fn lift(mut tiles: ResMut<Tiles>, mut places: Query<&mut Transform>) {
    for (entity, rise) in tiles.lifts.drain(..) {
        if let Ok(mut place) = places.get_mut(entity) {
            place.translation.y += rise;
        }
    }
}

/// By how much a body has to be lifted when the ground below it changes; `None` where it does not change.
fn risen(last: &GroundTiles, now: &GroundTiles, body: &BodyBox) -> Option<f32> {
    // The samples of all cells that the body covers.
    let (first, end) = (now.cell(body.at_min)?, now.cell(body.at_max)? + 1);
    let most = (MOST * now.cells() as i32).min(512);
    let end = end.min(first + most);
    let (mut rise, mut top, mut changed) = (0.0_f32, f32::NEG_INFINITY, false);
    for x in first.x..=end.x {
        for z in first.y..=end.y {
            let at = IVec2::new(x, z);
            let height = now.sample(at);
            let place = at.as_dvec2() * f64::from(now.step());
            let before = last.surface(place).map_or(height, |height| height as f32);
            changed |= height != before;
            rise = rise.max(height - before);
            top = top.max(height);
        }
    }
    // No more than what brings it above all of it: what flies far above is not moved.
    changed.then(|| rise.min(top - body.bottom).max(0.0))
}
