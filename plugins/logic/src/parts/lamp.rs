//! Lamps, and the hour of the day that switches them.

use super::sum;
use crate::action::{Action, Output};
use crate::clock::LogicClock;
use crate::names::Key;
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::reflect::prelude::*;

/// A lamp; a renderer looks at whether it is lit. Actions: [`Key::ON`], [`Key::OFF`], [`Key::TOGGLE`].
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Logic)]
pub struct Lamp {
    /// Whether it is lit.
    pub lit: bool,
    /// Whether it is lit by night and not by day, of itself, when a [`DayClock`] says so.
    pub by_night: bool,
}

/// The hour of the day. Outputs: [`Key::DAWN`], [`Key::DUSK`]. An hour or a pace that is not finite stands still.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[require(Logic)]
pub struct DayClock {
    /// 0 to 24.
    pub hour: f32,
    /// Hours that pass in a second.
    pub pace: f32,
    /// When the day begins.
    pub dawn: f32,
    /// When the night begins, later than `dawn`.
    pub dusk: f32,
    day: Option<bool>,
    /// What rounding added to [`Self::hour`].
    rest: f32,
}

impl DayClock {
    /// At an hour, with so many hours a second; the day is from 6 to 20 o'clock.
    #[must_use]
    pub const fn new(hour: f32, pace: f32) -> Self {
        Self {
            hour,
            pace,
            dawn: 6.0,
            dusk: 20.0,
            day: None,
            rest: 0.0,
        }
    }

    /// Whether it is day.
    #[must_use]
    pub fn is_day(&self) -> bool {
        self.hour >= self.dawn && self.hour < self.dusk
    }

    /// One step on; the output if day or night began, also in the first step.
    pub fn advance(&mut self, seconds: f32) -> Option<Key> {
        let (mut hour, mut rest) = (self.hour, self.rest);
        sum::add(&mut hour, &mut rest, self.pace * seconds);
        if hour.is_finite() {
            (self.hour, self.rest) = (hour.rem_euclid(24.0), rest);
        }
        let day = self.is_day();
        if self.day == Some(day) {
            return None;
        }
        self.day = Some(day);
        Some(if day { Key::DAWN } else { Key::DUSK })
    }
}

pub(super) fn run_clocks(
    clock: Res<LogicClock>,
    mut days: Query<(Entity, &mut DayClock)>,
    mut lamps: Query<&mut Lamp>,
    mut outputs: MessageWriter<Output>,
) {
    for (entity, mut day) in &mut days {
        let Some(name) = day.advance(clock.delta) else {
            continue;
        };
        outputs.write(Output::new(entity, name, ()));
        for mut lamp in &mut lamps {
            if lamp.by_night && lamp.lit != (name == Key::DUSK) {
                lamp.lit = !lamp.lit;
            }
        }
    }
}

pub(super) fn run_lamps(mut actions: MessageReader<Action>, mut lamps: Query<&mut Lamp>) {
    for action in actions.read() {
        let Ok(mut lamp) = lamps.get_mut(action.target) else {
            continue;
        };
        match action.verb {
            Key::ON => lamp.lit = true,
            Key::OFF => lamp.lit = false,
            Key::TOGGLE => lamp.lit = !lamp.lit,
            _ => (),
        }
    }
}
