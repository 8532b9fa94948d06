//! Thousands of balls that walk: our movers, and Rapier's character controller.

use super::controller::Controller;
use super::method::{RADIUS, SECONDS, Walkers};
use super::terrain::{HALF, Terrain, leaves};
use bevy::math::{DVec3, ops};
use dolomite_collision::{Body, MoveOutcome, MoveSettings, Mover, Scratch, World, advance};
use dolomite_testkit::metrics::{Hash64, median};
use dolomite_testkit::random::{Random, mixed};
use std::time::Instant;

/// How fast they want to go, metres a second.
const SPEED: f64 = 4.0;

/// Steps after which they turn.
const TURN: u32 = 30;

/// Advances of a slide that are tried for the curve of errors.
pub const ITERATIONS: [u32; 5] = [1, 2, 3, 4, 5];

/// Advances of the reference: more than any step takes.
const REFERENCE: u32 = 64;

/// Ours.
pub struct Movers<'a> {
    world: World<'a>,
    settings: MoveSettings,
    movers: Vec<Mover>,
    scratch: Scratch,
    outcome: MoveOutcome,
}

impl<'a> Movers<'a> {
    /// At these places.
    pub fn new(bodies: &'a [Body<'a>], places: &[DVec3]) -> Self {
        let mover = |&place| Mover::new(place, DVec3::splat(RADIUS));
        Self {
            world: World::new(bodies),
            settings: MoveSettings::default(),
            movers: places.iter().map(mover).collect(),
            scratch: Scratch::default(),
            outcome: MoveOutcome::default(),
        }
    }
}

impl Walkers for Movers<'_> {
    fn step(&mut self, ball: usize, wish: DVec3) -> bool {
        let mover = &mut self.movers[ball];
        let (scratch, outcome) = (&mut self.scratch, &mut self.outcome);
        advance(&self.world, mover, wish, &self.settings, scratch, outcome);
        outcome.grounded
    }

    fn center(&self, ball: usize) -> DVec3 {
        self.movers[ball].center
    }
}

/// What became of all balls of one method.
#[derive(Clone, Default)]
pub struct Walked {
    /// Nanoseconds a step, medians over the steps of all.
    pub ns: f64,
    /// The deepest that a ball was in a triangle, metres.
    pub depth: f64,
    /// Distances of standing balls from the surface, metres.
    pub gaps: Vec<f64>,
    /// The part of steps that went nowhere although the ball stood and wished to go.
    pub still: f64,
    /// The part of steps after which a ball did not stand.
    pub airborne: f64,
    /// Balls that are below the surface at the end, or nowhere.
    pub lost: u64,
    /// Of where they are.
    pub hash: u64,
}

/// Places on the surface, each its own.
pub fn places(terrain: &Terrain, count: usize, seed: u32) -> Vec<DVec3> {
    let mut random = Random::new(seed);
    (0..count)
        .map(|_| {
            let half = HALF - 3.0;
            let at = DVec3::new(
                random.signed_unit() * half,
                0.0,
                random.signed_unit() * half,
            );
            // Above the highest triangle that it may touch.
            let around = [-1.0, 0.0, 1.0];
            let top = around
                .iter()
                .flat_map(|x| around.map(|z| at + DVec3::new(x * RADIUS, 0.0, z * RADIUS)))
                .filter_map(|place| terrain.surface(place))
                .fold(-10.0, f64::max);
            at.with_y(top + RADIUS + 0.1)
        })
        .collect()
}

/// The way a ball wants to go in a step, level.
fn wish(ball: usize, step: u32, place: DVec3) -> DVec3 {
    let bits = mixed(ball as u32, step / TURN);
    let angle = (bits >> 8) as f32 / 16_777_216.0 * std::f32::consts::TAU;
    let (sin, cos) = ops::sin_cos(angle);
    let way = DVec3::new(f64::from(cos), 0.0, f64::from(sin)) * (SPEED * SECONDS);
    if leaves(place, way) {
        (-place).with_y(0.0).normalize_or(DVec3::X) * (SPEED * SECONDS)
    } else {
        way
    }
}

struct Run<'a> {
    walkers: &'a mut dyn Walkers,
    falling: Vec<f64>,
    stands: Vec<bool>,
    times: Vec<f64>,
    still: u64,
    standing: u64,
    walked: Walked,
}

/// Walks all methods in turns: first they fall onto the ground, then they walk.
pub fn walk(
    terrain: &Terrain,
    places: &[DVec3],
    steps: u32,
    methods: &mut [&mut dyn Walkers],
) -> Vec<Walked> {
    /// Steps in which they fall and come to rest.
    const FALL: u32 = 30;
    let count = places.len();
    let mut runs: Vec<Run> = methods
        .iter_mut()
        .map(|walkers| Run {
            walkers: &mut **walkers,
            falling: vec![0.0; count],
            stands: vec![false; count],
            times: Vec::new(),
            still: 0,
            standing: 0,
            walked: Walked::default(),
        })
        .collect();
    let mut before = vec![DVec3::ZERO; count];
    let mut wishes = vec![DVec3::ZERO; count];
    for step in 0..FALL + steps {
        let walks = step >= FALL;
        for run in &mut runs {
            for ball in 0..count {
                let place = run.walkers.center(ball);
                before[ball] = place;
                let level = if walks {
                    wish(ball, step, place)
                } else {
                    DVec3::ZERO
                };
                run.falling[ball] = if run.stands[ball] {
                    0.0
                } else {
                    run.falling[ball]
                } - 9.81 * SECONDS;
                wishes[ball] = level + DVec3::Y * (run.falling[ball] * SECONDS);
            }
            let begun = Instant::now();
            for (ball, wish) in wishes.iter().enumerate() {
                run.stands[ball] = run.walkers.step(ball, *wish);
            }
            if !walks {
                continue;
            }
            run.times
                .push(begun.elapsed().as_secs_f64() * 1e9 / count.max(1) as f64);
            for ball in 0..count {
                let place = run.walkers.center(ball);
                if let Some(nearest) = terrain.tree.nearest(place, RADIUS + 0.1) {
                    let gap = nearest.distance - RADIUS;
                    run.walked.depth = run.walked.depth.max(-gap);
                    if run.stands[ball] {
                        run.walked.gaps.push(gap);
                    }
                }
                let (wished, went) = (wishes[ball].with_y(0.0), place - before[ball]);
                let part = went.with_y(0.0).dot(wished) / wished.length_squared();
                run.still += u64::from(run.stands[ball] && part.abs() < 1e-3);
                run.standing += u64::from(run.stands[ball]);
            }
        }
    }
    runs.into_iter()
        .map(|run| {
            let all = (count as f64 * f64::from(steps)).max(1.0);
            let mut hash = Hash64::default();
            let mut walked = run.walked;
            for ball in 0..count {
                let place = run.walkers.center(ball);
                let over = terrain
                    .surface(place)
                    .is_some_and(|height| place.y > height);
                walked.lost += u64::from(!over);
                for x in place.to_array() {
                    hash.add(x.to_bits());
                }
            }
            walked.ns = median(run.times).unwrap_or(f64::NAN);
            walked.still = run.still as f64 / all;
            walked.airborne = 1.0 - run.standing as f64 / all;
            walked.hash = hash.finish();
            walked
        })
        .collect()
}

/// Nanoseconds and errors (metres, against [`REFERENCE`] advances from the same place) of slides of at most so many
/// advances, and the part of steps that differ at all.
pub struct Curve {
    /// Of [`ITERATIONS`].
    pub ns: [f64; 5],
    /// Mean error.
    pub mean: [f64; 5],
    /// Largest error.
    pub max: [f64; 5],
    /// Part of steps with an error above a micrometre.
    pub wrong: [f64; 5],
}

/// Walks with many advances, and asks in every step what fewer would have done.
pub fn curve(terrain: &Terrain, places: &[DVec3], steps: u32) -> Curve {
    let bodies = [Body::fixed(&terrain.tree)];
    let mut movers = Movers::new(&bodies, places);
    movers.settings.iterations = REFERENCE;
    let world = World::new(&bodies);
    let mut scratch = Scratch::default();
    let mut outcome = MoveOutcome::default();
    let mut errors = [(); 5].map(|()| Vec::new());
    let mut times = [0.0; 5];
    let count = places.len();
    let mut ends = vec![DVec3::ZERO; count];
    let mut wishes = vec![DVec3::ZERO; count];
    for step in 0..30 + steps {
        let from: Vec<Mover> = movers.movers.clone();
        for ball in 0..count {
            let down = DVec3::Y * (-9.81 * SECONDS * SECONDS);
            wishes[ball] = if step < 30 {
                down * 20.0
            } else {
                wish(ball, step, from[ball].center) + down
            };
            movers.step(ball, wishes[ball]);
            ends[ball] = movers.center(ball);
        }
        if step < 30 {
            continue;
        }
        for (i, iterations) in ITERATIONS.into_iter().enumerate() {
            let settings = MoveSettings {
                iterations,
                ..movers.settings
            };
            let begun = Instant::now();
            for ball in 0..count {
                let mut mover = from[ball];
                let wish = wishes[ball];
                advance(
                    &world,
                    &mut mover,
                    wish,
                    &settings,
                    &mut scratch,
                    &mut outcome,
                );
                errors[i].push(mover.center.distance(ends[ball]));
            }
            times[i] += begun.elapsed().as_secs_f64() * 1e9;
        }
    }
    let all = (count as f64 * f64::from(steps)).max(1.0);
    Curve {
        ns: times.map(|time| time / all),
        mean: [0, 1, 2, 3, 4].map(|i| errors[i].iter().sum::<f64>() / all),
        max: [0, 1, 2, 3, 4].map(|i| errors[i].iter().copied().fold(0.0, f64::max)),
        wrong: [0, 1, 2, 3, 4]
            .map(|i| errors[i].iter().filter(|error| **error > 1e-6).count() as f64 / all),
    }
}

/// Ours and Rapier's, as it is given and as it climbs steps, on one terrain.
pub fn all(terrain: &Terrain, places: &[DVec3], steps: u32) -> Vec<(&'static str, Walked)> {
    let bodies = [Body::fixed(&terrain.tree)];
    let mut ours = Movers::new(&bodies, places);
    let mut plain = Controller::new(terrain, places, false);
    let mut climbing = Controller::new(terrain, places, true);
    let walked = walk(
        terrain,
        places,
        steps,
        &mut [&mut ours, &mut plain, &mut climbing],
    );
    ["ours", "rapier", "rapier_steps"]
        .into_iter()
        .zip(walked)
        .collect()
}
