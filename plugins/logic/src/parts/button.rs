//! Buttons.

use crate::action::{Action, Output};
use crate::clock::LogicClock;
use crate::names::Key;
use crate::value::Value;
use crate::values::Logic;
use bevy::ecs::prelude::*;

/// Says [`Key::PRESSED`] with its parameter when it is pressed. Actions: [`Key::PRESS`], [`Key::LOCK`],
/// [`Key::UNLOCK`].
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[require(Logic)]
pub struct Button {
    /// Handed on with [`Key::PRESSED`]; [`Value::None`] hands on who pressed.
    pub parameter: Value,
    /// Seconds after a press in which it cannot be pressed; what is not above 0 is none.
    pub pause: f32,
    /// Whether it does not answer.
    pub locked: bool,
    /// How often it was pressed.
    pub presses: u32,
    /// The first step in which it can be pressed again.
    pub ready: u64,
}

impl Button {
    /// With a parameter to hand on.
    #[must_use]
    pub fn new(parameter: impl Into<Value>) -> Self {
        Self {
            parameter: parameter.into(),
            ..Self::default()
        }
    }
}

pub(super) fn run(
    clock: Res<LogicClock>,
    mut actions: MessageReader<Action>,
    mut buttons: Query<&mut Button>,
    mut outputs: MessageWriter<Output>,
) {
    for action in actions.read() {
        let Ok(mut button) = buttons.get_mut(action.target) else {
            continue;
        };
        match action.verb {
            Key::LOCK => button.locked = true,
            Key::UNLOCK => button.locked = false,
            Key::PRESS if !button.locked && clock.step >= button.ready => {
                button.presses = button.presses.saturating_add(1);
                let pause = clock.steps(button.pause).map_or(0, u64::from);
                button.ready = clock.step + pause;
                let parameter = match button.parameter {
                    Value::None => Value::Entity(action.source),
                    own => own,
                };
                outputs.write(Output::new(action.target, Key::PRESSED, parameter));
            }
            _ => (),
        }
    }
}
