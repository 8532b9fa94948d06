//! Who sees whom.
//!
//! Rays of all pairs would be as many as the square of the crowd. Here a grid finds who is in range and in the field;
//! each observer looks in every few steps, in turn; and of each pair is kept what hid it, which is asked first, since
//! what hid somebody a moment ago mostly still does (P. Terdiman, on caching the last blocker). What is left is cast,
//! the nearest first, and at most so many of one observer's rays a look; a pair for which none is left stays as it was.

use super::field::Places;
use super::memory::Memory;
use crate::bodies::BodyIndex;
use crate::clock::LogicClock;
use crate::grid::Grid;
use crate::need::{Asleep, Attention};
use crate::parts::Team;
use crate::rays::{RayWorld, Rays};
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::math::{Vec2, Vec3, Vec3Swizzles, ops};
use bevy::reflect::prelude::*;
use bevy::transform::components::Transform;

/// Can be seen, by everybody but its own [`Team`].
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Logic, Transform)]
pub struct Visible {
    /// The point that is looked for, from the entity's place, in world axes, metres.
    pub offset: Vec3,
}

/// Sees what is [`Visible`], along its entity's −Z. Who is seen is in [`Self::seen`], and in a [`Memory`].
#[derive(Component, Clone, Debug, PartialEq)]
#[require(Logic, Transform)]
pub struct Sight {
    /// Metres.
    pub range: f32,
    /// From the middle of the field to its edge, radians.
    pub half_field: f32,
    /// From the entity's place to the eye, in world axes, metres.
    pub eye: Vec3,
    known: Vec<Known>,
    rays: u32,
}

/// One whom an observer could see but for what stands between.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Known {
    who: Entity,
    /// What hides it; `None` of one that is seen.
    blocker: Option<u64>,
}

/// Says that nobody knows what hides it: no ray was left for it.
const NOT_CAST: u64 = u64::MAX;

impl Default for Sight {
    /// 60 m, 60° to each side, 0.7 m above the middle of a figure.
    fn default() -> Self {
        Self::new(60.0, std::f32::consts::FRAC_PI_3)
    }
}

impl Sight {
    /// Of this range, and so many radians to each side.
    #[must_use]
    pub const fn new(range: f32, half_field: f32) -> Self {
        Self {
            range,
            half_field,
            eye: Vec3::new(0.0, 0.7, 0.0),
            known: Vec::new(),
            rays: 0,
        }
    }

    /// Who is seen, in the order of entities.
    pub fn seen(&self) -> impl Iterator<Item = Entity> {
        let seen = self.known.iter().filter(|known| known.blocker.is_none());
        seen.map(|known| known.who)
    }

    /// Whether somebody is seen.
    #[must_use]
    pub fn sees(&self, who: Entity) -> bool {
        let at = self.known.binary_search_by_key(&who, |known| known.who);
        at.is_ok_and(|at| self.known[at].blocker.is_none())
    }

    /// Rays of its last look.
    #[must_use]
    pub const fn rays(&self) -> u32 {
        self.rays
    }
}

/// How sight is shared out.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct SightSettings {
    /// Steps from one look of an observer to the next: who comes into view is seen at most so much later.
    pub every: u32,
    /// Most rays of one observer's look.
    pub rays: u32,
    /// Whether bodies ([`crate::bodies::Hitbox`]) hide who is behind them.
    pub bodies: bool,
}

impl Default for SightSettings {
    /// 6 steps, at 64 steps a second 94 ms; 64 rays; bodies do not hide.
    fn default() -> Self {
        Self {
            every: 6,
            rays: 64,
            bodies: false,
        }
    }
}

/// What the last step of sight did.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct SightCounters {
    /// Observers that looked.
    pub looks: u32,
    /// Rays that were cast.
    pub rays: u32,
    /// Pairs that are in range and in the field, of those who looked.
    pub pairs: u32,
}

/// One who can be seen.
#[derive(Clone, Copy)]
struct Target {
    who: Entity,
    place: Vec3,
    team: Option<Team>,
}

/// Lists that steps use again.
#[derive(Default)]
pub(super) struct Lists {
    targets: Vec<Target>,
    places: Vec<Vec2>,
    /// In the order of the grid, as their places by axes are.
    sorted: Vec<Target>,
    fields: Places,
    grid: Grid,
}

pub(super) fn see(
    settings: Res<SightSettings>,
    clock: Res<LogicClock>,
    world: Option<Res<RayWorld>>,
    bodies: Res<BodyIndex>,
    visible: Query<(Entity, &Visible, &Transform, Option<&Team>)>,
    mut observers: Query<
        (
            Entity,
            &mut Sight,
            &Transform,
            Option<&Team>,
            Option<&mut Memory>,
            Option<&Attention>,
        ),
        Without<Asleep>,
    >,
    mut counters: ResMut<SightCounters>,
    mut lists: Local<Lists>,
) {
    let Lists {
        targets,
        places,
        sorted,
        fields,
        grid,
    } = &mut *lists;
    targets.clear();
    places.clear();
    for (who, visible, transform, team) in &visible {
        let place = transform.translation + visible.offset;
        if place.is_finite() {
            targets.push(Target {
                who,
                place,
                team: team.copied(),
            });
            places.push(place.xz());
        }
    }
    grid.build(places, 16.0);
    sorted.clear();
    sorted.extend(grid.order().iter().map(|&number| targets[number as usize]));
    fields.fill(sorted.iter().map(|target| target.place));
    let (targets, fields, grid, bodies) = (&*sorted, &*fields, &*grid, &*bodies);
    let rays: Option<&dyn Rays> = world.as_ref().map(|world| &*world.0);
    let every = settings.every.max(1);
    let due = |entity: Entity, attention: Option<&Attention>| {
        let every = every.max(attention.map_or(1, Attention::steps));
        (clock.step as u32)
            .wrapping_add(entity.index_u32())
            .is_multiple_of(every)
    };
    observers
        .par_iter_mut()
        .for_each(|(entity, mut sight, transform, team, memory, attention)| {
            if !due(entity, attention) {
                return;
            }
            let sight = sight.bypass_change_detection();
            let eye = transform.translation + sight.eye;
            let forward = transform.rotation * Vec3::NEG_Z;
            let by_bodies = |target: &Target| {
                let (from, way) = (eye.as_dvec3(), (target.place - eye).as_dvec3());
                let skips = |other: Entity| other == entity || other == target.who;
                bodies
                    .cast(from, way, false, |body| skips(body.entity))
                    .is_some()
            };
            look(
                sight,
                eye,
                forward,
                team.copied(),
                entity,
                targets,
                fields,
                grid,
                settings.rays,
                rays,
                settings
                    .bodies
                    .then_some(&by_bodies as &dyn Fn(&Target) -> bool),
            );
            if let Some(mut memory) = memory {
                for &who in &sight.seen().collect::<Vec<_>>() {
                    // Who is seen is a target of this step.
                    if let Ok((_, _, at, _)) = visible.get(who) {
                        memory.note(Some(who), at.translation, 1.0);
                    }
                }
            }
        });
    *counters = SightCounters::default();
    for (entity, sight, .., attention) in &observers {
        if due(entity, attention) {
            counters.looks += 1;
            counters.rays += sight.rays;
            counters.pairs += sight.known.len() as u32;
        }
    }
}

/// What a look uses again.
#[derive(Default)]
struct Found {
    /// Square of the distance, and number of the target in the order of the grid.
    near: Vec<(f32, u32)>,
    /// Who is to be looked for by a ray, and what hides them.
    places: Vec<Vec3>,
    asked: Vec<u32>,
    blockers: Vec<Option<u64>>,
    known: Vec<Known>,
}

thread_local! {
    static FOUND: std::cell::RefCell<Found> = std::cell::RefCell::default();
}

/// One look of one observer. `targets` are in the order of the grid.
fn look(
    sight: &mut Sight,
    eye: Vec3,
    forward: Vec3,
    team: Option<Team>,
    own: Entity,
    targets: &[Target],
    fields: &Places,
    grid: &Grid,
    most: u32,
    rays: Option<&dyn Rays>,
    bodies: Option<&dyn Fn(&Target) -> bool>,
) {
    sight.rays = 0;
    let range = sight.range;
    if !(range > 0.0 && range.is_finite() && eye.is_finite() && forward.is_finite()) {
        sight.known.clear();
        return;
    }
    let cos_field = ops::cos(sight.half_field.clamp(0.0, std::f32::consts::PI));
    let (middle, reach) = (eye.xz(), Vec2::splat(range));
    FOUND.with_borrow_mut(|found| {
        let Found {
            near,
            places,
            asked,
            blockers,
            known,
        } = found;
        near.clear();
        for span in grid.rows(middle - reach, middle + reach) {
            fields.in_field(span, eye, forward, range, cos_field, |number, square| {
                let target = &targets[number];
                let friend = team.is_some() && target.team == team;
                if !friend && target.who != own {
                    near.push((square, number as u32));
                }
            });
        }
        // The nearest come first where there are not rays enough for all.
        if near.len() > most as usize {
            near.sort_unstable_by(|a, b| {
                let who = |number: u32| targets[number as usize].who;
                a.0.total_cmp(&b.0).then_with(|| who(a.1).cmp(&who(b.1)))
            });
        }
        places.clear();
        asked.clear();
        known.clear();
        for &(_, number) in &*near {
            let target = &targets[number as usize];
            let before = sight
                .known
                .binary_search_by_key(&target.who, |known| known.who)
                .ok()
                .map(|at| sight.known[at].blocker);
            let has_left = (asked.len() as u32) < most;
            let blocker = match before.flatten() {
                _ if !has_left => before.unwrap_or(Some(NOT_CAST)),
                Some(blocker)
                    if blocker != NOT_CAST
                        && rays
                            .is_some_and(|rays| rays.still_blocks(blocker, eye, target.place)) =>
                {
                    Some(blocker)
                }
                _ => {
                    asked.push(known.len() as u32);
                    places.push(target.place);
                    None
                }
            };
            known.push(Known {
                who: target.who,
                blocker,
            });
        }
        blockers.clear();
        blockers.resize(places.len(), None);
        if let Some(rays) = rays {
            rays.hide(eye, places, blockers);
        }
        for (&at, blocker) in asked.iter().zip(&*blockers) {
            let hidden = bodies.is_some_and(|hides| {
                blocker.is_none() && hides(&targets[near[at as usize].1 as usize])
            });
            // Bodies move: they are not asked again.
            known[at as usize].blocker = if hidden { Some(NOT_CAST) } else { *blocker };
        }
        sight.rays = asked.len() as u32;
        known.sort_unstable_by_key(|known| known.who);
        sight.known.clear();
        sight.known.extend_from_slice(known);
    });
}
