//! Errors of a slide by the advances that it may have.

use super::method::{SECONDS, Walkers};
use super::movers::Movers;
use super::terrain::Terrain;
use super::walkers::wish;
use bevy::math::DVec3;
use dolomite_collision::{Body, MoveOutcome, MoveSettings, Mover, Scratch, World, advance};
use std::time::Instant;

/// Advances of a slide that are tried for the curve of errors.
pub const ITERATIONS: [u32; 5] = [1, 2, 3, 4, 5];

/// Advances of the reference: more than any step takes.
const REFERENCE: u32 = 64;

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
            movers.advance(ball, wishes[ball]);
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
