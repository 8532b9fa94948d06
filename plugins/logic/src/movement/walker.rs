//! Crowds: everybody who goes where a field leads, without running into each other.
//!
//! A step has five stages over arrays: *gather* (from the world), *flow* (where each wants to go), *sort* (into a grid,
//! so that who is near is near in memory), *avoid* (ORCA), *move* (never off the walkable ground, and back into the
//! world). Wishes and avoidance of one agent are worked out in every second step, or more rarely where [`Attention`]
//! says so; it moves in every step.

use super::flow::FlowField;
use super::ground::{WalkGrid, WalkGround};
use super::orca::{Disc, Line, NEIGHBOURS, half_plane, velocity};
use crate::clock::LogicClock;
use crate::grid::Grid;
use crate::need::{Asleep, Attention};
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::math::{Vec2, Vec3Swizzles};
use bevy::tasks::{ComputeTaskPool, ParallelSliceMut, TaskPool};
use bevy::transform::components::Transform;
use std::sync::Arc;
use std::time::Instant;

/// One of a crowd. Its entity's `Transform`, if it has one, follows it, at the height of the ground.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[require(Logic)]
pub struct Walker {
    /// Where it is: x and z.
    pub place: Vec2,
    /// Metres a second.
    pub velocity: Vec2,
    /// Metres.
    pub radius: f32,
    /// The speed that it wants, m/s; what is not above 0 or not finite stands.
    pub speed: f32,
    /// The field that it follows, by its number in [`FlowFields`]; one that is not there leads nowhere.
    pub field: u16,
}

impl Walker {
    /// A figure at a place that follows a field.
    #[must_use]
    pub const fn new(place: Vec2, field: u16) -> Self {
        Self {
            place,
            velocity: Vec2::ZERO,
            radius: 0.3,
            speed: 1.4,
            field,
        }
    }

    /// Words for a hash of the state.
    pub(crate) fn bits(&self) -> [u32; 5] {
        [
            self.place.x.to_bits(),
            self.place.y.to_bits(),
            self.velocity.x.to_bits(),
            self.velocity.y.to_bits(),
            u32::from(self.field),
        ]
    }
}

/// The fields of this world, by number.
#[derive(Resource, Clone, Debug, Default)]
pub struct FlowFields(pub Vec<Arc<FlowField>>);

/// How walkers avoid each other.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct WalkSettings {
    /// Steps from one decision of a walker to the next.
    pub every: u32,
    /// Seconds within which two are not to meet.
    pub horizon: f32,
    /// Farthest neighbour, metres.
    pub reach: f32,
    /// Most others that are looked at for the nearest: a crowd in one place costs no more.
    pub looks: u32,
}

impl Default for WalkSettings {
    /// Every second step; 1 s; 2 m; 48.
    fn default() -> Self {
        Self {
            every: 2,
            horizon: 1.0,
            reach: 2.0,
            looks: 48,
        }
    }
}

/// What the last step of walkers did.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WalkCounters {
    /// Walkers.
    pub walkers: u32,
    /// Walkers that decided anew.
    pub steered: u32,
    /// Bytes of arrays beside the world's.
    pub bytes: u64,
}

/// What the stages of the last step took, milliseconds.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct WalkTimes {
    /// From the world.
    pub gather: f32,
    /// Wishes.
    pub flow: f32,
    /// The grid.
    pub sort: f32,
    /// Avoidance.
    pub avoid: f32,
    /// Places, and back into the world.
    pub go: f32,
}

/// One walker of a step.
#[derive(Clone, Copy, Debug, Default)]
struct Walk {
    disc: Disc,
    wish: Vec2,
    speed: f32,
    field: u16,
    due: bool,
    next: Vec2,
}

/// Arrays that steps use again.
#[derive(Default)]
pub(super) struct Arrays {
    walks: Vec<Walk>,
    places: Vec<Vec2>,
    /// In the order of the grid.
    discs: Vec<Disc>,
    grid: Grid,
    velocities: Vec<Vec2>,
}

/// Walkers of one task.
const CHUNK: usize = 1024;

type Walkers<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static mut Walker,
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
    mut arrays: Local<Arrays>,
) {
    let pool = ComputeTaskPool::get_or_init(TaskPool::default);
    let Arrays {
        walks,
        places,
        discs,
        grid,
        velocities,
    } = &mut *arrays;
    let begun = Instant::now();
    walks.clear();
    places.clear();
    let every = settings.every.max(1);
    for (entity, walker, _, attention) in &walkers {
        let every = every.max(attention.map_or(1, Attention::steps));
        let step = (clock.step as u32).wrapping_add(entity.index_u32());
        // Who has no place, or no size, is nobody's neighbour and stays.
        let whole = walker.place.is_finite()
            && walker.velocity.is_finite()
            && walker.radius.is_finite()
            && walker.radius >= 0.0;
        let speed = if walker.speed.is_finite() {
            walker.speed.max(0.0)
        } else {
            0.0
        };
        walks.push(Walk {
            disc: Disc {
                place: walker.place,
                velocity: if whole { walker.velocity } else { Vec2::ZERO },
                radius: if whole { walker.radius } else { 0.0 },
            },
            wish: Vec2::ZERO,
            speed: if whole { speed } else { 0.0 },
            field: walker.field,
            due: step.is_multiple_of(every),
            next: walker.velocity,
        });
        places.push(walker.place);
    }
    let gathered = Instant::now();
    let fields = &fields.0;
    walks.par_chunk_map_mut(pool, CHUNK, |_, chunk| {
        for walk in chunk.iter_mut().filter(|walk| walk.due) {
            let field = fields.get(usize::from(walk.field));
            let way = field.map_or(Vec2::ZERO, |field| field.way(walk.disc.place));
            walk.wish = way * walk.speed;
        }
    });
    let flowed = Instant::now();
    let reach = if settings.reach > 0.0 && settings.reach.is_finite() {
        settings.reach
    } else {
        WalkSettings::default().reach
    };
    grid.build(places, reach);
    discs.clear();
    discs.extend(
        grid.order()
            .iter()
            .map(|&number| walks[number as usize].disc),
    );
    let sorted = Instant::now();
    velocities.clear();
    velocities.resize(walks.len(), Vec2::ZERO);
    let crowd = Crowd {
        walks,
        discs,
        grid,
        settings: &settings,
        reach,
        delta: clock.delta,
    };
    velocities.par_chunk_map_mut(pool, CHUNK, |chunk_number, chunk| {
        for (at, velocity) in chunk.iter_mut().enumerate() {
            *velocity = crowd.steer(chunk_number * CHUNK + at);
        }
    });
    let avoided = Instant::now();
    let mut steered = 0;
    // The order of the grid is that of the velocities.
    for (&number, velocity) in grid.order().iter().zip(&*velocities) {
        let walk = &mut walks[number as usize];
        walk.next = *velocity;
        steered += u32::from(walk.due);
    }
    let ground = ground.as_ref().map(|ground| &*ground.0);
    let seconds = clock.delta;
    walks.par_chunk_map_mut(pool, CHUNK, |_, chunk| {
        for walk in chunk {
            go(walk, ground, seconds);
        }
    });
    for ((_, mut walker, transform, _), walk) in walkers.iter_mut().zip(&*walks) {
        // Who stands is not marked as changed.
        if walker.place == walk.disc.place && walker.velocity == walk.next {
            continue;
        }
        if !(walk.disc.place.is_finite() && walk.next.is_finite()) {
            continue;
        }
        walker.place = walk.disc.place;
        walker.velocity = walk.next;
        if let Some(mut transform) = transform {
            let height = ground.map_or(transform.translation.y, |g| g.height(walk.disc.place));
            transform.translation = walk.disc.place.extend(height).xzy();
        }
    }
    let gone = Instant::now();
    let ms = |from: Instant, to: Instant| to.duration_since(from).as_secs_f32() * 1e3;
    *times = WalkTimes {
        gather: ms(begun, gathered),
        flow: ms(gathered, flowed),
        sort: ms(flowed, sorted),
        avoid: ms(sorted, avoided),
        go: ms(avoided, gone),
    };
    *counters = WalkCounters {
        walkers: walks.len() as u32,
        steered,
        bytes: (size_of::<Walk>() * walks.capacity()
            + size_of::<Vec2>() * (places.capacity() + velocities.capacity())
            + size_of::<Disc>() * discs.capacity()
            + grid.bytes()) as u64,
    };
}

/// What a walker sees of the others.
struct Crowd<'a> {
    walks: &'a [Walk],
    discs: &'a [Disc],
    grid: &'a Grid,
    settings: &'a WalkSettings,
    reach: f32,
    delta: f32,
}

impl Crowd<'_> {
    /// The next velocity of the walker that is so far down the order of the grid.
    fn steer(&self, at: usize) -> Vec2 {
        let walk = &self.walks[self.grid.order()[at] as usize];
        if !walk.due {
            return walk.next;
        }
        if walk.speed == 0.0 {
            return Vec2::ZERO;
        }
        let own = &self.discs[at];
        let mut near = [(f32::INFINITY, 0_usize); NEIGHBOURS];
        let mut count = 0;
        let mut left = self.settings.looks;
        let reach = Vec2::splat(self.reach);
        'rows: for span in self.grid.rows(own.place - reach, own.place + reach) {
            for other in span {
                if other == at {
                    continue;
                }
                if left == 0 {
                    break 'rows;
                }
                left -= 1;
                let square = self.discs[other].place.distance_squared(own.place);
                // Also refuses NaN.
                if square < self.reach * self.reach
                    && (count < NEIGHBOURS || square < near[count - 1].0)
                {
                    count = (count + 1).min(NEIGHBOURS);
                    let mut to = count - 1;
                    while to > 0 && near[to - 1].0 > square {
                        near[to] = near[to - 1];
                        to -= 1;
                    }
                    near[to] = (square, other);
                }
            }
        }
        let mut lines = [Line::default(); NEIGHBOURS];
        let step = self.delta * self.settings.every.max(1) as f32;
        let horizon = self.settings.horizon.max(step);
        for (line, &(_, other)) in lines.iter_mut().zip(&near[..count]) {
            *line = half_plane(own, &self.discs[other], horizon, step, at < other);
        }
        let result = velocity(&lines[..count], walk.speed, walk.wish);
        if result.is_finite() {
            result
        } else {
            Vec2::ZERO
        }
    }
}

/// One step of one walker, in parts no longer than a cell.
fn go(walk: &mut Walk, ground: Option<&WalkGrid>, seconds: f32) {
    let way = walk.next * seconds;
    let from = walk.disc.place;
    if !(from.is_finite() && way.is_finite()) {
        return;
    }
    let Some(ground) = ground else {
        walk.disc.place = from + way;
        return;
    };
    // Where the ground was closed under somebody, they come out to where it is open.
    if !ground.is_open(from) {
        if let Some(open) = ground.nearest_open(from, 4) {
            let out = open - from;
            let step = walk.speed * seconds;
            let place = from + out.clamp_length_max(step);
            walk.disc.place = if out.length() <= step { open } else { place };
        }
        return;
    }
    if way == Vec2::ZERO {
        return;
    }
    // Ten thousand cells a step are a mistake: who is so fast stays.
    let parts = (way.abs().max_element() / ground.cell()).ceil();
    if parts > 1e4 {
        walk.next = Vec2::ZERO;
        return;
    }
    let mut place = from;
    for _ in 0..parts as u32 {
        place = ground.step(place, place + way / parts);
    }
    walk.disc.place = place;
    // What a wall took is not kept as speed; who slides goes as far as they went.
    if place != from + way {
        walk.next = (place - from) / seconds;
    }
}
