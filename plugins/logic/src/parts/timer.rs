//! Timers.

use super::sum;
use crate::action::{Action, Output};
use crate::clock::LogicClock;
use crate::names::Key;
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::reflect::prelude::*;

/// Says [`Key::ELAPSED`] when its time is over. Actions: [`Key::START`], [`Key::STOP`], [`Key::RESET`].
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Clone, PartialEq)]
#[require(Logic)]
pub struct LogicTimer {
    /// Seconds; a time that is not above 0 or not finite never elapses.
    pub period: f32,
    /// Whether it begins again.
    pub repeat: bool,
    /// Whether it runs.
    pub running: bool,
    /// Seconds that passed.
    pub passed: f32,
    /// What rounding added to [`Self::passed`].
    #[reflect(ignore)]
    rest: f32,
}

impl LogicTimer {
    /// One that runs and begins again.
    #[must_use]
    pub const fn every(period: f32) -> Self {
        Self {
            period,
            repeat: true,
            running: true,
            passed: 0.0,
            rest: 0.0,
        }
    }

    /// One that runs once.
    #[must_use]
    pub const fn once(period: f32) -> Self {
        Self {
            repeat: false,
            ..Self::every(period)
        }
    }

    /// One step on; whether it elapsed. It does so at most once a step; what is over counts for the next period.
    pub fn advance(&mut self, seconds: f32) -> bool {
        let elapses = self.period > 0.0 && self.period.is_finite();
        if !(self.running && elapses) {
            return false;
        }
        sum::add(&mut self.passed, &mut self.rest, seconds);
        if self.passed < self.period {
            return false;
        }
        if self.repeat {
            self.passed = (self.passed - self.period).min(self.period);
        } else {
            self.set(self.period);
            self.running = false;
        }
        true
    }

    fn set(&mut self, passed: f32) {
        self.passed = passed;
        self.rest = 0.0;
    }
}

pub(super) fn run(
    clock: Res<LogicClock>,
    mut actions: MessageReader<Action>,
    mut timers: Query<(Entity, &mut LogicTimer)>,
    mut outputs: MessageWriter<Output>,
) {
    for action in actions.read() {
        let Ok((_, mut timer)) = timers.get_mut(action.target) else {
            continue;
        };
        match action.verb {
            Key::START => {
                if !timer.running && timer.passed >= timer.period {
                    timer.set(0.0);
                }
                timer.running = true;
            }
            Key::STOP => timer.running = false,
            Key::RESET => timer.set(0.0),
            _ => (),
        }
    }
    for (entity, mut timer) in &mut timers {
        if timer.running && timer.advance(clock.delta) {
            outputs.write(Output::new(entity, Key::ELAPSED, ()));
        }
    }
}
