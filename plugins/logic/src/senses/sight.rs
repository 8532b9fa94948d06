//! Who sees whom.
//!
//! Rays of all pairs would be as many as the square of the crowd. Here a grid finds who is in range and in the field;
//! each observer looks in every few steps, in turn; and of each pair is kept what hid it, which is asked first, since
//! what hid somebody a moment ago mostly still does (P. Terdiman, on caching the last blocker). What is left is cast,
//! the nearest first, and at most so many of one observer's rays a look; a pair for which none is left stays as it was.

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
use bevy::transform::components::Transform;

/// Can be seen, by everybody but its own [`Team`].
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
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
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
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
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
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
    grid: Grid,
}

/// Whether somebody at `to` is in range and field of an eye.
#[must_use]
pub fn in_field(eye: Vec3, forward: Vec3, range: f32, cos_field: f32, to: Vec3) -> bool {
    let way = to - eye;
    let square = way.length_squared();
    // Nobody sees out of themselves. Also refuses NaN.
    square > 0.0 && square <= range * range && way.dot(forward) >= cos_field * square.sqrt()
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
    let (targets, grid, bodies) = (&*targets, &*grid, &*bodies);
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
            let hides = |blocker: Option<u64>, target: &Target, left: &mut u32| {
                if let (Some(blocker), Some(rays)) = (blocker, rays)
                    && blocker != NOT_CAST
                    && rays.still_blocks(blocker, eye, target.place)
                {
                    return Some(blocker);
                }
                *left -= 1;
                let stop = rays.and_then(|rays| rays.cast(eye, target.place));
                stop.map(|stop| stop.blocker).or_else(|| {
                    let (from, way) = (eye.as_dvec3(), (target.place - eye).as_dvec3());
                    let skips = |other: Entity| other == entity || other == target.who;
                    let hit = settings
                        .bodies
                        .then(|| bodies.cast(from, way, false, |body| skips(body.entity)));
                    // Bodies move: they are not asked again.
                    hit.flatten().map(|_| NOT_CAST)
                })
            };
            look(
                sight,
                eye,
                forward,
                team.copied(),
                entity,
                targets,
                grid,
                settings.rays,
                hides,
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

/// One look of one observer.
fn look(
    sight: &mut Sight,
    eye: Vec3,
    forward: Vec3,
    team: Option<Team>,
    own: Entity,
    targets: &[Target],
    grid: &Grid,
    most: u32,
    hides: impl Fn(Option<u64>, &Target, &mut u32) -> Option<u64>,
) {
    sight.rays = 0;
    let range = sight.range;
    if !(range > 0.0 && range.is_finite() && eye.is_finite() && forward.is_finite()) {
        sight.known.clear();
        return;
    }
    let cos_field = ops::cos(sight.half_field.clamp(0.0, std::f32::consts::PI));
    let (middle, reach) = (eye.xz(), Vec2::splat(range));
    let mut found: Vec<(f32, &Target)> = grid
        .near(middle - reach, middle + reach)
        .map(|number| &targets[number as usize])
        .filter(|target| {
            let friend = team.is_some() && target.team == team;
            !friend && target.who != own && in_field(eye, forward, range, cos_field, target.place)
        })
        .map(|target| (target.place.distance_squared(eye), target))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.who.cmp(&b.1.who)));
    let mut left = most;
    let mut known: Vec<Known> = Vec::with_capacity(found.len());
    for (_, target) in found {
        let before = sight
            .known
            .binary_search_by_key(&target.who, |known| known.who)
            .ok()
            .map(|at| sight.known[at].blocker);
        let blocker = if left > 0 {
            hides(before.flatten(), target, &mut left)
        } else {
            before.unwrap_or(Some(NOT_CAST))
        };
        known.push(Known {
            who: target.who,
            blocker,
        });
    }
    sight.rays = most - left;
    known.sort_unstable_by_key(|known| known.who);
    sight.known = known;
}
