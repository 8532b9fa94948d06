//! What lies about and is taken.

use super::zone::{Zone, ZoneKind, ZoneMessage};
use crate::action::Output;
use crate::clock::LogicClock;
use crate::names::Key;
use crate::value::Value;
use crate::values::Values;
use bevy::ecs::prelude::*;
use bevy::math::Vec3;
use bevy::reflect::prelude::*;

/// Who enters its [`Zone`] and is a [`Collector`] has `amount` more of `name`. Output: [`Key::TAKEN`] with who took it.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[require(Zone = Zone::new(Vec3::splat(0.5)))]
pub struct PickUp {
    /// The value of the collector that changes.
    pub name: Key,
    /// Added to a number; any other value takes its place.
    pub amount: Value,
    /// Seconds after which it is there again, in the next step at the earliest; `None`, or what is no time: never.
    pub again: Option<f32>,
    /// Whether it is there.
    pub there: bool,
    /// The step in which it is there again.
    pub back: u64,
}

impl PickUp {
    /// That is taken once.
    #[must_use]
    pub fn new(name: Key, amount: impl Into<Value>) -> Self {
        Self {
            name,
            amount: amount.into(),
            again: None,
            there: true,
            back: 0,
        }
    }
}

/// Takes what it comes to.
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Clone)]
#[require(super::zone::Visitor, Values)]
pub struct Collector;

/// A value with an amount added: whole numbers stop at their ends. `None` if they do not go together.
fn added(before: Option<Value>, amount: Value) -> Option<Value> {
    match (before, amount) {
        (None, new) => Some(new),
        (Some(Value::Int(n)), Value::Int(m)) => Some(Value::Int(n.saturating_add(m))),
        (Some(Value::Float(x)), Value::Float(y)) => Some(Value::Float(x + y)),
        (Some(before), new) => (before.kind() == new.kind()).then_some(new),
    }
}

pub(super) fn run(
    clock: Res<LogicClock>,
    mut messages: MessageReader<ZoneMessage>,
    mut pick_ups: Query<&mut PickUp>,
    mut collectors: Query<&mut Values, With<Collector>>,
    mut outputs: MessageWriter<Output>,
) {
    for mut pick_up in &mut pick_ups {
        if !pick_up.there && pick_up.back != 0 && clock.step >= pick_up.back {
            pick_up.there = true;
        }
    }
    for message in messages.read() {
        if message.kind != ZoneKind::Enter {
            continue;
        }
        let Ok(mut pick_up) = pick_ups.get_mut(message.zone) else {
            continue;
        };
        let Ok(mut values) = collectors.get_mut(message.visitor) else {
            continue;
        };
        if !pick_up.there {
            continue;
        }
        // It stays where its value cannot be had: another kind, or a sum that is not finite.
        let sum = added(values.get(pick_up.name), pick_up.amount);
        if sum.is_none_or(|sum| values.set(pick_up.name, sum).is_err()) {
            continue;
        }
        pick_up.there = false;
        let again = pick_up.again.filter(|seconds| *seconds >= 0.0);
        pick_up.back = again.map_or(0, |seconds| {
            clock.step + u64::from(clock.steps(seconds).unwrap_or(1))
        });
        outputs.write(Output::new(message.zone, Key::TAKEN, message.visitor));
    }
}
