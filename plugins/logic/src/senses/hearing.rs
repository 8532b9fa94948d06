//! Noises, and who hears them.

use super::memory::Memory;
use crate::grid::Grid;
use crate::need::Asleep;
use crate::parts::Team;
use crate::rays::RayWorld;
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::math::{Vec2, Vec3, Vec3Swizzles};
use bevy::reflect::prelude::*;
use bevy::transform::components::Transform;

/// A noise in this step.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Where.
    pub place: Vec3,
    /// How far it is heard in the open, metres.
    pub range: f32,
    /// Who made it; they do not hear themselves, nor does their team.
    pub source: Option<Entity>,
}

/// Hears noises: they go into its [`Memory`], less surely the farther away, and wake it.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Logic, Transform, Memory)]
pub struct Ear {
    /// Ranges are this many times as long to it.
    pub keen: f32,
}

impl Default for Ear {
    fn default() -> Self {
        Self { keen: 1.0 }
    }
}

/// What stands between an ear and a noise makes it sound twice as far away.
const MUFFLED: f32 = 2.0;

/// Lists that steps use again.
#[derive(Default)]
pub(super) struct Lists {
    ears: Vec<Entity>,
    places: Vec<Vec2>,
    grid: Grid,
}

pub(super) fn hear(
    mut noises: MessageReader<Noise>,
    world: Option<Res<RayWorld>>,
    places: Query<(Entity, &Transform, &Ear)>,
    mut memories: Query<(&Transform, &Ear, &mut Memory, Option<&Team>, Has<Asleep>)>,
    teams: Query<&Team>,
    mut commands: Commands,
    mut lists: Local<Lists>,
) {
    if noises.is_empty() {
        return;
    }
    let Lists {
        ears,
        places: at,
        grid,
    } = &mut *lists;
    ears.clear();
    at.clear();
    let mut keenest = 0.0_f32;
    for (entity, transform, ear) in &places {
        if ear.keen > 0.0 && ear.keen.is_finite() && transform.translation.is_finite() {
            ears.push(entity);
            at.push(transform.translation.xz());
            keenest = keenest.max(ear.keen);
        }
    }
    grid.build(at, 32.0);
    for noise in noises.read() {
        if !(noise.place.is_finite() && noise.range > 0.0 && noise.range.is_finite()) {
            continue;
        }
        let team = noise.source.and_then(|source| teams.get(source).ok());
        let (middle, reach) = (noise.place.xz(), Vec2::splat(noise.range * keenest));
        for number in grid.near(middle - reach, middle + reach) {
            let ear = ears[number as usize];
            let Ok((transform, hears, mut memory, own, asleep)) = memories.get_mut(ear) else {
                continue;
            };
            if noise.source == Some(ear) || (team.is_some() && own == team) {
                continue;
            }
            let range = noise.range * hears.keen;
            let mut distance = transform.translation.distance(noise.place);
            if distance >= range {
                continue;
            }
            if let Some(world) = &world
                && world.0.cast(transform.translation, noise.place).is_some()
            {
                distance *= MUFFLED;
            }
            if distance < range {
                memory.note(noise.source, noise.place, 1.0 - distance / range);
                if asleep {
                    commands.entity(ear).try_remove::<Asleep>();
                }
            }
        }
    }
}
