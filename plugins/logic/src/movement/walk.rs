//! Crowds: everybody who goes where a field leads, without running into each other.
//!
//! A step has five stages over arrays: *gather* (from the world), *sort* (into a grid, so that who is near is near in
//! memory; every few steps, since nobody gets far in one), *flow* (where each wants to go), *avoid* (ORCA), *go* (never
//! off the walkable ground, and back into the world). Wishes and avoidance of one agent are worked out in every second
//! step, of one whom nobody hindered in every fourth, or more rarely where [`Attention`] says so; it moves in every
//! step.

use super::crowd::{Crowd, Ranks, Step};
use super::ground::{WalkGrid, WalkGround};
use super::walker::{FlowFields, Rank, WalkCounters, WalkSettings, WalkTimes, Walker};
use crate::clock::LogicClock;
use crate::need::{Asleep, Attention};
use bevy::ecs::prelude::*;
use bevy::math::{Vec2, Vec3Swizzles};
use bevy::tasks::{ComputeTaskPool, ParallelSliceMut, TaskPool};
use bevy::transform::components::Transform;
use std::time::Instant;

/// Walkers of one task.
const CHUNK: usize = 1024;

/// What is read and written of a walker.
type Walkers<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static mut Walker,
        &'static mut Rank,
        Option<&'static mut Transform>,
        Option<&'static Attention>,
    ),
    Without<Asleep>,
>;

pub(super) fn walk(
    clock: Res<LogicClock>,
    settings: Res<WalkSettings>,
    ground: Option<Res<WalkGround>>,
    fields: Res<FlowFields>,
    mut walkers: Walkers,
    mut counters: ResMut<WalkCounters>,
    mut times: ResMut<WalkTimes>,
    mut ranks: Local<Ranks>,
    mut steps: Local<Vec<Step>>,
) {
    let pool = ComputeTaskPool::get_or_init(TaskPool::default);
    let begun = Instant::now();
    let reach = if settings.reach > 0.0 && settings.reach.is_finite() {
        settings.reach
    } else {
        WalkSettings::default().reach
    };
    let every = settings.every.max(1);
    let is_kept = ranks.fill(reach, all_of(&walkers, &clock, every));
    let gathered = Instant::now();
    if !is_kept {
        ranks.sort(reach, || all_of(&walkers, &clock, every));
        for ((_, _, mut rank, ..), &now) in walkers.iter_mut().zip(ranks.of_each()) {
            rank.bypass_change_detection().0 = now;
        }
    }
    let ordered = Instant::now();
    let crowd = Crowd::new(&ranks, &settings, reach, clock.delta);
    steps.clear();
    steps.resize(crowd.len(), Step::default());
    let fields = &fields.0;
    steps.par_chunk_map_mut(pool, CHUNK, |chunk_number, chunk| {
        let first = chunk_number * CHUNK;
        for (at, step) in (first..).zip(chunk) {
            if let Some((field, place, speed)) = crowd.asks(at) {
                let field = fields.get(usize::from(field));
                step.velocity = field.map_or(Vec2::ZERO, |field| field.way(place)) * speed;
            }
        }
    });
    let flowed = Instant::now();
    steps.par_chunk_map_mut(pool, CHUNK, |chunk_number, chunk| {
        let first = chunk_number * CHUNK;
        for (at, step) in (first..).zip(chunk) {
            (step.velocity, step.calm) = crowd.steer(at, step.velocity);
        }
    });
    let avoided = Instant::now();
    let ground = ground.as_ref().map(|ground| &*ground.0);
    let seconds = clock.delta;
    steps.par_chunk_map_mut(pool, CHUNK, |chunk_number, chunk| {
        let first = chunk_number * CHUNK;
        for (at, step) in (first..).zip(chunk) {
            step.place = crowd.place(at);
            go(step, crowd.speed(at), ground, seconds);
        }
    });
    let done = &*steps;
    walkers
        .par_iter_mut()
        .for_each(|(_, mut walker, rank, transform, _)| {
            let step = done[rank.0 as usize];
            // Who stands is not marked as changed.
            if (walker.place, walker.velocity, walker.calm)
                == (step.place, step.velocity, step.calm)
            {
                return;
            }
            if !(step.place.is_finite() && step.velocity.is_finite()) {
                return;
            }
            walker.place = step.place;
            walker.velocity = step.velocity;
            walker.calm = step.calm;
            if let Some(mut transform) = transform {
                let height = ground.map_or(transform.translation.y, |g| g.height(step.place));
                transform.translation = step.place.extend(height).xzy();
            }
        });
    let gone = Instant::now();
    let ms = |from: Instant, to: Instant| to.duration_since(from).as_secs_f32() * 1e3;
    *times = WalkTimes {
        gather: ms(begun, gathered),
        sort: ms(gathered, ordered),
        flow: ms(ordered, flowed),
        avoid: ms(flowed, avoided),
        go: ms(avoided, gone),
    };
    *counters = WalkCounters {
        walkers: crowd.len() as u32,
        steered: crowd.due(),
        bytes: (ranks.bytes() + size_of::<Step>() * steps.capacity()) as u64
            + size_of::<Rank>() as u64 * done.len() as u64,
    };
}

/// Every walker as the world has it: whose it is, what it does, and whether it decides in this step.
fn all_of<'a>(
    walkers: &'a Walkers,
    clock: &LogicClock,
    every: u32,
) -> impl Iterator<Item = (Entity, &'a Walker, bool)> {
    let now = clock.step as u32;
    walkers
        .iter()
        .map(move |(entity, walker, _, _, attention)| {
            let every = every.max(attention.map_or(1, Attention::steps));
            let every = every.saturating_mul(1 + u32::from(walker.calm));
            let step = now.wrapping_add(entity.index_u32());
            // Divisions take longer than all the rest of it.
            let due = if every.is_power_of_two() {
                step & (every - 1) == 0
            } else {
                step.is_multiple_of(every)
            };
            (entity, walker, due)
        })
}

/// One step of one walker, in parts no longer than a cell.
fn go(walk: &mut Step, speed: f32, ground: Option<&WalkGrid>, seconds: f32) {
    let way = walk.velocity * seconds;
    let from = walk.place;
    if !(from.is_finite() && way.is_finite()) {
        return;
    }
    let Some(ground) = ground else {
        walk.place = from + way;
        return;
    };
    // Where the ground was closed under somebody, they come out to where it is open.
    if !ground.is_open(from) {
        if let Some(open) = ground.nearest_open(from, 4) {
            let out = open - from;
            let step = speed * seconds;
            let place = from + out.clamp_length_max(step);
            walk.place = if out.length() <= step { open } else { place };
        }
        return;
    }
    if way == Vec2::ZERO {
        return;
    }
    // Ten thousand cells a step are a mistake: who is so fast stays.
    let parts = (way.abs().max_element() / ground.cell()).ceil();
    if parts > 1e4 {
        walk.velocity = Vec2::ZERO;
        return;
    }
    let mut place = from;
    for _ in 0..parts as u32 {
        place = ground.step(place, place + way / parts);
    }
    walk.place = place;
    // What a wall took is not kept as speed; who slides goes as far as they went.
    if place != from + way {
        walk.calm = false;
        walk.velocity = (place - from) / seconds;
    }
}
