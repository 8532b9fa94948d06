//! Health and teams.

use crate::action::{Action, Output};
use crate::names::Key;
use crate::value::Value;
use crate::values::{Logic, Values};
use bevy::ecs::prelude::*;
use bevy::reflect::prelude::*;

/// Who belongs together. Nobody of a team is an enemy of its own; who has no team is everybody's.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Logic)]
pub struct Team(pub u8);

/// Health. Actions: [`Key::DAMAGE`] and [`Key::HEAL`] with a number. Outputs: [`Key::HURT`] with the number,
/// [`Key::DIED`] once, with who did it. An entity with [`Values`] has the part that is left as [`Key::HEALTH`], from its
/// first step on.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Logic)]
pub struct Health {
    /// What is left.
    pub now: f32,
    /// At most.
    pub most: f32,
}

impl Default for Health {
    /// 100 of 100.
    fn default() -> Self {
        Self::new(100.0)
    }
}

impl Health {
    /// In full health.
    #[must_use]
    pub const fn new(most: f32) -> Self {
        Self { now: most, most }
    }

    /// Whether any is left.
    #[must_use]
    pub fn is_alive(&self) -> bool {
        self.now > 0.0
    }

    /// Takes some; gives what was taken, and whether it was the last. Nothing is taken by a number that is not above
    /// 0 or not finite, nor of who is dead.
    pub fn damage(&mut self, amount: f32) -> (f32, bool) {
        if !(amount > 0.0 && amount.is_finite() && self.is_alive()) {
            return (0.0, false);
        }
        let taken = amount.min(self.now);
        self.now -= taken;
        (taken, !self.is_alive())
    }

    /// Gives some, up to the most; who has more keeps it. The dead are not healed.
    pub fn heal(&mut self, amount: f32) {
        if amount > 0.0 && amount.is_finite() && self.is_alive() {
            self.now = (self.now + amount).min(self.most).max(self.now);
        }
    }

    /// What is left of full health.
    #[must_use]
    pub fn part(&self) -> f32 {
        if self.most > 0.0 {
            self.now / self.most
        } else {
            0.0
        }
    }
}

pub(super) fn run(
    mut actions: MessageReader<Action>,
    mut all: Query<&mut Health>,
    mut outputs: MessageWriter<Output>,
) {
    for action in actions.read() {
        if !matches!(action.verb, Key::DAMAGE | Key::HEAL) {
            continue;
        }
        let Ok(mut health) = all.get_mut(action.target) else {
            continue;
        };
        let amount = action.parameter.number();
        if action.verb == Key::HEAL {
            health.heal(amount);
        } else {
            let (taken, died) = health.damage(amount);
            if taken > 0.0 {
                outputs.write(Output::new(action.target, Key::HURT, taken));
            }
            if died {
                outputs.write(Output::new(action.target, Key::DIED, action.source));
            }
        }
    }
}

/// Writes what is left where it changed, whoever changed it, and where nobody knows it yet: who was never hurt is in full
/// health, which behaviours would take for none.
pub(super) fn tell(mut all: Query<(&Health, &mut Values), Or<(Changed<Health>, Added<Values>)>>) {
    for (health, mut values) in &mut all {
        // Refused only where somebody else made it another kind, or where it is no number.
        let _ = values.set(Key::HEALTH, Value::Float(health.part()));
    }
}
