//! Movers that fly through one box, in an app.

use super::oracle::Flight;
use bevy::MinimalPlugins;
use bevy::app::App;
use bevy::ecs::message::Messages;
use bevy::ecs::prelude::*;
use bevy::math::Vec3;
use bevy::time::TimeUpdateStrategy;
use bevy::transform::components::Transform;
use dolomite_collision::{
    CharacterBody, CollisionPlugin, MoveWish, Trigger, TriggerKind, TriggerMessage,
};
use dolomite_testkit::places::{direction, size};
use dolomite_testkit::random::Random;
use std::time::{Duration, Instant};

/// Movers of a wave.
pub const MOVERS: usize = 256;

/// Steps a second.
pub const RATE: f64 = 64.0;

/// One box, and movers that come near it.
pub struct Wave {
    /// Where the middle of the box lies.
    pub place: Vec3,
    half: Vec3,
    movers: Vec<Plan>,
    /// Steps until all are past it.
    pub steps: u32,
}

struct Plan {
    start: Vec3,
    radii: Vec3,
    way: Vec3,
}

/// What an app said of a wave.
pub struct Said {
    /// Step, mover and message, in the order in which they came.
    pub messages: Vec<(u32, usize, TriggerMessage)>,
    /// Nanoseconds a mover and step, of everything.
    pub ns: f64,
}

fn vector(random: &mut Random, low: f64, high: f64) -> Vec3 {
    let mut one = || size(random, low, high) as f32;
    Vec3::new(one(), one(), one())
}

impl Wave {
    /// Ways of a step of `slow` to `fast` metres a second. One of eight waves lies 10⁵ m away; in one of eight all
    /// numbers are multiples of a power of two, so that steps end where the box is touched exactly.
    pub fn new(random: &mut Random, slow: f64, fast: f64) -> Self {
        let speed = size(random, slow, fast);
        let step = speed / RATE;
        let exact = random.below(8) == 0;
        // Places there are multiples of 8 mm: slow movers would start anywhere.
        let far = step > 0.05 && !exact && random.below(8) == 0;
        let far = if far { 1e5 } else { 50.0 };
        let mut place = (direction(random) * far).as_vec3();
        let mut half = vector(random, 0.2 * step, 8.0 * step);
        if exact {
            place = (place / 64.0).round() * 64.0;
            half = power(half);
        }
        let mut steps = 0.0_f64;
        let movers = (0..MOVERS)
            .map(|_| {
                let mut radii = vector(random, 0.2 * step, 8.0 * step);
                let mut way = (direction(random) * step * (0.5 + random.unit())).as_vec3();
                let mut near = Vec3::ZERO;
                if exact {
                    // Along one axis, and at its start a whole number of steps before it touches.
                    let axis = random.below(3);
                    let length = power(Vec3::splat(step as f32)).x;
                    way = Vec3::ZERO;
                    way[axis] = length;
                    radii = power(radii);
                } else {
                    // Most go through it, some past it.
                    let part = |random: &mut Random| (random.signed_unit() * 1.4) as f32;
                    near = half * Vec3::new(part(random), part(random), part(random));
                }
                // From 1.4 half sizes beside the middle of the box to where both are apart, whatever the way.
                let apart = f64::from((half * 2.4 + radii).length() * 1.01 / way.length());
                let before = (apart + 1.0 + random.unit() * 3.0).ceil();
                // Those that begin before its side, and not before its middle, have both sizes ahead.
                let past = apart.max(f64::from(2.0 * (half + radii).length() / way.length()));
                steps = steps.max(before + past + 4.0);
                let start = if exact {
                    let axis = way.max_position();
                    let mut start = Vec3::ZERO;
                    start[axis] = -(half[axis] + radii[axis] + way[axis] * before as f32);
                    place + start
                } else {
                    place + near - way * before as f32
                };
                Plan { start, radii, way }
            })
            .collect();
        Self {
            place,
            half,
            movers,
            steps: steps as u32 + 4,
        }
    }

    /// The flight of a mover, as f64 has it.
    pub fn flight(&self, mover: usize) -> Flight {
        let plan = &self.movers[mover];
        Flight {
            from: plan.start.as_dvec3() - self.place.as_dvec3(),
            way: plan.way.as_dvec3(),
            radii: plan.radii.as_dvec3(),
            half: self.half.as_dvec3(),
        }
    }

    /// Flies it.
    pub fn fly(&self) -> Said {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, CollisionPlugin))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
                1.0 / RATE,
            )));
        // The first frame takes no time.
        app.update();
        let place = Transform::from_translation(self.place);
        app.world_mut().spawn((
            Trigger {
                half_size: self.half,
            },
            place,
        ));
        let movers: Vec<Entity> = self
            .movers
            .iter()
            .map(|plan| {
                let body = CharacterBody {
                    radii: plan.radii,
                    ..CharacterBody::default()
                };
                let start = Transform::from_translation(plan.start);
                app.world_mut().spawn((body, start)).id()
            })
            .collect();
        let mut messages = Vec::new();
        let begun = Instant::now();
        for step in 0..self.steps {
            for (mover, plan) in movers.iter().zip(&self.movers) {
                if let Some(mut wish) = app.world_mut().get_mut::<MoveWish>(*mover) {
                    wish.0 = plan.way;
                }
            }
            app.update();
            let mut said = app.world_mut().resource_mut::<Messages<TriggerMessage>>();
            messages.extend(said.drain().filter_map(|message| {
                let mover = movers.iter().position(|mover| *mover == message.mover)?;
                Some((step, mover, message))
            }));
        }
        let seconds = begun.elapsed().as_secs_f64();
        Said {
            messages,
            ns: seconds * 1e9 / (f64::from(self.steps) * MOVERS as f64),
        }
    }
}

/// The powers of two below.
fn power(v: Vec3) -> Vec3 {
    v.map(|x| f32::from_bits(x.to_bits() & 0xff80_0000))
}

/// Whether a message says that somebody comes or goes.
pub fn crosses(message: &TriggerMessage) -> bool {
    message.kind != TriggerKind::Stay
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the reference takes for granted, and what a crossing needs to be told whole.
    #[test]
    fn all_begin_and_end_apart() {
        let mut random = Random::new(5);
        for number in 0..400 {
            let slow = [0.1, 1.0, 10.0, 100.0][number % 4];
            let wave = Wave::new(&mut random, slow, slow * 10.0);
            for mover in 0..MOVERS {
                let flight = wave.flight(mover);
                let ends = [0.0, f64::from(wave.steps)].map(|time| flight.distance(time));
                assert!(
                    ends.iter().all(|end| *end > 1.0),
                    "{number} {mover}: {ends:?}"
                );
            }
        }
    }
}
