//! Crowds: everybody who goes where a field leads, without running into each other.
//!
//! A step has five stages over arrays: *gather* (from the world), *sort* (into a grid, so that who is near is near in
//! memory), *flow* (where each wants to go), *avoid* (ORCA), *go* (never off the walkable ground, and back into the
//! world). Wishes and avoidance of one agent are worked out in every second step, of one whom nobody hindered in every
//! fourth, or more rarely where [`Attention`] says so; it moves in every step.

use super::flow::FlowField;
use super::ground::{WalkGrid, WalkGround};
use super::orca::{Disc, Line, NEIGHBOURS, half_plane, velocity};
use crate::clock::LogicClock;
use crate::grid::Grid;
use crate::need::{Asleep, Attention};
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::math::{Vec2, Vec3Swizzles};
use bevy::reflect::prelude::*;
use bevy::tasks::{ComputeTaskPool, ParallelSliceMut, TaskPool};
use bevy::transform::components::Transform;
use std::sync::Arc;
use std::time::Instant;

/// One of a crowd. Its entity's `Transform`, if it has one, follows it, at the height of the ground.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Clone, PartialEq)]
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
    /// Whether nobody hindered it when it decided last: it decides half as often then.
    pub calm: bool,
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
            calm: false,
        }
    }

    /// Words for a hash of the state.
    pub(crate) fn bits(&self) -> [u32; 5] {
        [
            self.place.x.to_bits(),
            self.place.y.to_bits(),
            self.velocity.x.to_bits(),
            self.velocity.y.to_bits(),
            u32::from(self.field) | u32::from(self.calm) << 16,
        ]
    }
}

/// The fields of this world, by number.
#[derive(Resource, Clone, Debug, Default)]
pub struct FlowFields(pub Vec<Arc<FlowField>>);

/// How walkers avoid each other.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct WalkSettings {
    /// Steps from one decision of a walker to the next; twice as many of one whom nobody hindered.
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
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct WalkCounters {
    /// Walkers.
    pub walkers: u32,
    /// Walkers that decided anew.
    pub steered: u32,
    /// Bytes of arrays beside the world's.
    pub bytes: u64,
}

/// What the stages of the last step took, milliseconds.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct WalkTimes {
    /// From the world.
    pub gather: f32,
    /// The grid.
    pub sort: f32,
    /// Wishes.
    pub flow: f32,
    /// Avoidance.
    pub avoid: f32,
    /// Places, and back into the world.
    pub go: f32,
}

/// One walker of a step.
#[derive(Clone, Copy, Debug, Default)]
struct Walk {
    velocity: Vec2,
    radius: f32,
    /// 0 of one who stands or is nobody's neighbour.
    speed: f32,
    field: u16,
    due: bool,
    calm: bool,
}

/// Arrays that steps use again.
#[derive(Default)]
pub(super) struct Arrays {
    /// In the order of the world.
    places: Vec<Vec2>,
    walks: Vec<Walk>,
    grid: Grid,
    /// In the order of the grid.
    discs: Vec<Disc>,
    sorted: Vec<Walk>,
    steps: Vec<Step>,
}

/// What becomes of a walker.
#[derive(Clone, Copy, Debug, Default)]
struct Step {
    place: Vec2,
    /// The wish, then the velocity.
    velocity: Vec2,
    calm: bool,
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
        places,
        walks,
        grid,
        discs,
        sorted,
        steps,
    } = &mut *arrays;
    let begun = Instant::now();
    walks.clear();
    places.clear();
    let every = settings.every.max(1);
    for (entity, walker, _, attention) in &walkers {
        let every = every.max(attention.map_or(1, Attention::steps));
        let every = every.saturating_mul(1 + u32::from(walker.calm));
        let step = (clock.step as u32).wrapping_add(entity.index_u32());
        // Who has no place, or no size, is nobody's neighbour and stays.
        let whole = walker.place.is_finite()
            && walker.velocity.is_finite()
            && walker.radius.is_finite()
            && walker.radius >= 0.0;
        let speed = if whole && walker.speed.is_finite() {
            walker.speed.max(0.0)
        } else {
            0.0
        };
        walks.push(Walk {
            velocity: walker.velocity,
            radius: if whole { walker.radius } else { 0.0 },
            speed,
            field: walker.field,
            due: step.is_multiple_of(every),
            calm: walker.calm,
        });
        places.push(walker.place);
    }
    let gathered = Instant::now();
    let reach = if settings.reach > 0.0 && settings.reach.is_finite() {
        settings.reach
    } else {
        WalkSettings::default().reach
    };
    grid.build(places, reach);
    discs.clear();
    sorted.clear();
    for &number in grid.order() {
        let walk = walks[number as usize];
        sorted.push(walk);
        discs.push(Disc {
            place: places[number as usize],
            velocity: if walk.velocity.is_finite() {
                walk.velocity
            } else {
                Vec2::ZERO
            },
            radius: walk.radius,
        });
    }
    let ordered = Instant::now();
    steps.clear();
    steps.resize(sorted.len(), Step::default());
    let (fields, sorted, discs) = (&fields.0, &*sorted, &*discs);
    steps.par_chunk_map_mut(pool, CHUNK, |chunk_number, chunk| {
        let first = chunk_number * CHUNK;
        for (at, step) in (first..).zip(chunk) {
            let walk = &sorted[at];
            if walk.due && walk.speed > 0.0 {
                let field = fields.get(usize::from(walk.field));
                let way = field.map_or(Vec2::ZERO, |field| field.way(discs[at].place));
                step.velocity = way * walk.speed;
            }
        }
    });
    let flowed = Instant::now();
    let crowd = Crowd {
        walks: sorted,
        discs,
        grid,
        settings: &settings,
        reach,
        delta: clock.delta,
    };
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
            step.place = discs[at].place;
            go(step, sorted[at].speed, ground, seconds);
        }
    });
    let mut steered = 0;
    for ((_, mut walker, transform, _), &slot) in walkers.iter_mut().zip(grid.slots()) {
        let step = steps[slot as usize];
        steered += u32::from(sorted[slot as usize].due);
        // Who stands is not marked as changed.
        if (walker.place, walker.velocity, walker.calm) == (step.place, step.velocity, step.calm) {
            continue;
        }
        if !(step.place.is_finite() && step.velocity.is_finite()) {
            continue;
        }
        walker.place = step.place;
        walker.velocity = step.velocity;
        walker.calm = step.calm;
        if let Some(mut transform) = transform {
            let height = ground.map_or(transform.translation.y, |g| g.height(step.place));
            transform.translation = step.place.extend(height).xzy();
        }
    }
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
        walkers: walks.len() as u32,
        steered,
        bytes: (size_of::<Walk>() * (walks.capacity() + sorted.len())
            + size_of::<Vec2>() * places.capacity()
            + size_of::<Disc>() * discs.len()
            + size_of::<Step>() * steps.capacity()
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

/// Places that are compared at once: what a compiler keeps in two registers of a processor of 2008.
const WIDE: usize = 8;

impl Crowd<'_> {
    /// The nearest others of a walker, their places in the order of the grid, and how many.
    #[inline]
    fn nearest(&self, at: usize) -> ([u32; NEIGHBOURS], usize) {
        let own = self.discs[at].place;
        let mut squares = [f32::INFINITY; NEIGHBOURS];
        let mut numbers = [0_u32; NEIGHBOURS];
        let mut count = 0;
        let mut limit = self.reach * self.reach;
        let mut left = self.settings.looks as usize;
        let reach = Vec2::splat(self.reach);
        for span in self.grid.rows(own - reach, own + reach) {
            let end = span
                .end
                .min(span.start + left + usize::from(span.contains(&at)));
            left -= (end - span.start).min(left);
            let mut first = span.start;
            for discs in self.discs[span.start..end].chunks(WIDE) {
                let mut apart = [f32::INFINITY; WIDE];
                for (apart, disc) in apart.iter_mut().zip(discs) {
                    *apart = disc.place.distance_squared(own);
                }
                for (other, square) in (first..).zip(apart) {
                    // Also refuses NaN.
                    if square < limit && other != at {
                        count = (count + 1).min(NEIGHBOURS);
                        let mut to = count - 1;
                        while to > 0 && squares[to - 1] > square {
                            squares[to] = squares[to - 1];
                            numbers[to] = numbers[to - 1];
                            to -= 1;
                        }
                        squares[to] = square;
                        numbers[to] = other as u32;
                        if count == NEIGHBOURS {
                            limit = squares[NEIGHBOURS - 1];
                        }
                    }
                }
                first += WIDE;
            }
            if left == 0 {
                break;
            }
        }
        (numbers, count)
    }

    /// The next velocity of the walker that is so far down the order of the grid, and whether nobody hindered it.
    fn steer(&self, at: usize, wish: Vec2) -> (Vec2, bool) {
        let walk = &self.walks[at];
        if !walk.due {
            return (walk.velocity, walk.calm);
        }
        if walk.speed == 0.0 {
            return (Vec2::ZERO, true);
        }
        let own = &self.discs[at];
        let (near, count) = self.nearest(at);
        let mut lines = [Line::default(); NEIGHBOURS];
        let step = self.delta * self.settings.every.max(1) as f32;
        let horizon = self.settings.horizon.max(step);
        for (line, &other) in lines.iter_mut().zip(&near[..count]) {
            let other = other as usize;
            *line = half_plane(own, &self.discs[other], horizon, step, at < other);
        }
        let result = velocity(&lines[..count], walk.speed, wish);
        if result.is_finite() {
            // What is longer than the speed is shortened, which hinders nobody.
            (result, result.distance_squared(wish) < 1e-6)
        } else {
            (Vec2::ZERO, false)
        }
    }
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
