//! What an agent remembers, and how it fades.

use crate::clock::LogicClock;
use crate::names::Key;
use crate::need::Asleep;
use crate::value::Value;
use crate::values::{Logic, Values};
use bevy::ecs::prelude::*;
use bevy::math::Vec3;

/// Most that an agent remembers at a time; of more the least certain is forgotten.
pub const TRACES: usize = 8;

/// Somebody or something that was seen or heard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trace {
    /// Who; nobody of a noise that nobody known made.
    pub who: Option<Entity>,
    /// Where.
    pub place: Vec3,
    /// How sure it is: 1 while it is seen, less from then on.
    pub certainty: f32,
}

/// What an agent remembers. The most certain trace is also in its [`Values`]: [`Key::ALERT`], which is 0 of who remembers
/// nothing, [`Key::PLACE`] and, of somebody, [`Key::TARGET`].
#[derive(Component, Clone, Debug, PartialEq)]
#[require(Logic, Values)]
pub struct Memory {
    traces: Vec<Trace>,
    /// Seconds until what was certain is forgotten; what is not above 0 is forgotten at once.
    pub fades: f32,
}

impl Default for Memory {
    /// Forgets within 20 s.
    fn default() -> Self {
        Self {
            traces: Vec::new(),
            fades: 20.0,
        }
    }
}

impl Memory {
    /// What it remembers, the most certain first; of equal ones the one that came first.
    #[must_use]
    pub fn traces(&self) -> &[Trace] {
        &self.traces
    }

    /// Somebody was seen or heard, this surely. A place that is not finite is not remembered.
    pub fn note(&mut self, who: Option<Entity>, place: Vec3, certainty: f32) {
        if !(place.is_finite() && certainty > 0.0) {
            return;
        }
        let certainty = certainty.min(1.0);
        // Noises of nobody within a step of a figure are one.
        let same = |trace: &&mut Trace| match who {
            Some(_) => trace.who == who,
            None => trace.who.is_none() && trace.place.distance_squared(place) < 1.0,
        };
        if let Some(trace) = self.traces.iter_mut().find(same) {
            if certainty >= trace.certainty {
                trace.place = place;
                trace.certainty = certainty;
            }
        } else {
            self.traces.push(Trace {
                who,
                place,
                certainty,
            });
        }
        self.order();
        self.traces.truncate(TRACES);
    }

    fn order(&mut self) {
        self.traces
            .sort_by(|a, b| b.certainty.total_cmp(&a.certainty));
    }

    /// Seconds pass.
    pub fn fade(&mut self, seconds: f32) {
        let less = if self.fades > 0.0 {
            seconds / self.fades
        } else {
            1.0
        };
        for trace in &mut self.traces {
            trace.certainty -= less;
        }
        self.traces.retain(|trace| trace.certainty > 0.0);
    }

    /// Forgets somebody.
    pub fn forget(&mut self, who: Entity) {
        self.traces.retain(|trace| trace.who != Some(who));
    }
}

/// Fades, and writes what is most certain into the values.
pub(super) fn remember(
    clock: Res<LogicClock>,
    mut agents: Query<(&mut Memory, &mut Values), Without<Asleep>>,
) {
    for (mut memory, mut values) in &mut agents {
        let best = memory.traces.first().copied();
        // Who never heard anything is calm, and is told so once.
        let calm = values
            .get(Key::ALERT)
            .is_some_and(|alert| alert.number() == 0.0);
        if best.is_none() && calm {
            continue;
        }
        // Values of another kind are somebody's own, and stay.
        let alert = best.map_or(0.0, |trace| trace.certainty);
        let _ = values.set(Key::ALERT, Value::Float(alert));
        if let Some(trace) = best {
            let _ = values.set(Key::PLACE, Value::Vec3(trace.place));
            if let Some(who) = trace.who {
                let _ = values.set(Key::TARGET, Value::Entity(who));
            }
        }
        if !memory.traces.is_empty() {
            memory.fade(clock.delta);
        }
    }
}
