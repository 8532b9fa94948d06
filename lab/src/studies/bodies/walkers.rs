//! Thousands of balls that walk by several methods in turns, and who judges them.

use super::controller::Controller;
use super::messages::ProgramError;
use super::method::{RADIUS, SECONDS, Walkers};
use super::movers::Movers;
use super::program::Program;
use super::terrain::{HALF, Terrain, leaves};
use bevy::math::{DVec3, ops};
use dolomite_collision::Body;
use dolomite_testkit::metrics::{Hash64, median};
use dolomite_testkit::random::{Random, mixed};
use std::path::Path;

/// How fast they want to go, metres a second.
const SPEED: f64 = 4.0;

/// Steps after which they turn.
const TURN: u32 = 30;

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
pub fn wish(ball: usize, step: u32, place: DVec3) -> DVec3 {
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
    fault: Option<ProgramError>,
}

/// Walks all methods in turns: first they fall onto the ground, then they walk. Who fails is left out from then on.
pub fn walk(
    terrain: &Terrain,
    places: &[DVec3],
    steps: u32,
    methods: &mut [&mut dyn Walkers],
) -> Vec<Result<Walked, ProgramError>> {
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
            fault: None,
        })
        .collect();
    let mut before = vec![DVec3::ZERO; count];
    let mut wishes = vec![DVec3::ZERO; count];
    for step in 0..FALL + steps {
        let walks = step >= FALL;
        for run in runs.iter_mut().filter(|run| run.fault.is_none()) {
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
            let ns = match run.walkers.step(&wishes, &mut run.stands) {
                Ok(ns) => ns,
                Err(fault) => {
                    run.fault = Some(fault);
                    continue;
                }
            };
            if !walks {
                continue;
            }
            run.times.push(ns / count.max(1) as f64);
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
            if let Some(fault) = run.fault {
                return Err(fault);
            }
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
            Ok(walked)
        })
        .collect()
}

/// What became of each method on one terrain.
#[derive(Default)]
pub struct Compared {
    /// Those that walked to the end, ours first.
    pub walked: Vec<(&'static str, Walked)>,
    /// Those that did not.
    pub faults: Vec<(&'static str, ProgramError)>,
}

/// Ours and Rapier's, as it is given and as it climbs steps, on one terrain; and those of a program, as it is given and
/// as it holds to the ground.
pub fn all(terrain: &Terrain, places: &[DVec3], steps: u32, program: Option<&Path>) -> Compared {
    let mut compared = Compared::default();
    let bodies = [Body::fixed(&terrain.tree)];
    let mut ours = Movers::new(&bodies, places);
    let mut plain = Controller::new(terrain, places, false);
    let mut climbing = Controller::new(terrain, places, true);
    let mut programs = Vec::new();
    for (name, holds) in [("avian", false), ("avian_snaps", true)] {
        match program.map(|path| Program::start(path)?.on(terrain, places, holds)) {
            Some(Ok(program)) => programs.push((name, program)),
            Some(Err(fault)) => compared.faults.push((name, fault)),
            None => {}
        }
    }
    let mut methods: Vec<(_, &mut dyn Walkers)> = vec![
        ("ours", &mut ours),
        ("rapier", &mut plain),
        ("rapier_steps", &mut climbing),
    ];
    for (name, program) in &mut programs {
        methods.push((name, program));
    }
    let (names, mut walkers): (Vec<&'static str>, Vec<_>) = methods.into_iter().unzip();
    for (name, walked) in names
        .into_iter()
        .zip(walk(terrain, places, steps, &mut walkers))
    {
        match walked {
            Ok(walked) => compared.walked.push((name, walked)),
            Err(fault) => compared.faults.push((name, fault)),
        }
    }
    compared
}
