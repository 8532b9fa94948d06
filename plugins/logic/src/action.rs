//! Actions, outputs, and the wires between them.
//!
//! An *action* asks one entity to do something. An *output* says that something happened to an entity. *Wires* on an
//! entity turn its outputs into actions on others, now or later: a button knows no lift, a lift no button.

use crate::clock::LogicClock;
use crate::names::Key;
use crate::value::Value;
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::log::warn_once;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Asks `target` to do `verb`.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct Action {
    /// Who is asked. An action on an entity that is gone, or that does not know the verb, does nothing.
    pub target: Entity,
    /// Who asks.
    pub source: Entity,
    /// What for.
    pub verb: Key,
    /// With what.
    pub parameter: Value,
}

impl Action {
    /// On its own behalf.
    #[must_use]
    pub fn new(target: Entity, verb: Key, parameter: impl Into<Value>) -> Self {
        Self {
            target,
            source: target,
            verb,
            parameter: parameter.into(),
        }
    }
}

/// Says that `name` happened at `source`.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// Where.
    pub source: Entity,
    /// What.
    pub name: Key,
    /// With whom, or how much.
    pub parameter: Value,
}

impl Output {
    /// Something happened.
    #[must_use]
    pub fn new(source: Entity, name: Key, parameter: impl Into<Value>) -> Self {
        Self {
            source,
            name,
            parameter: parameter.into(),
        }
    }
}

/// From an output to an action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wire {
    /// The output.
    pub on: Key,
    /// Who is asked.
    pub target: Entity,
    /// What for.
    pub verb: Key,
    /// With what; [`Value::None`] hands on what came with the output.
    pub parameter: Value,
    /// Seconds between both; what is not above 0 is at once, see [`LogicClock::steps`].
    pub delay: f32,
}

impl Wire {
    /// At once, with what came with the output.
    #[must_use]
    pub const fn new(on: Key, target: Entity, verb: Key) -> Self {
        Self {
            on,
            target,
            verb,
            parameter: Value::None,
            delay: 0.0,
        }
    }

    /// With this parameter.
    #[must_use]
    pub fn with(mut self, parameter: impl Into<Value>) -> Self {
        self.parameter = parameter.into();
        self
    }

    /// So many seconds later.
    #[must_use]
    pub const fn after(mut self, seconds: f32) -> Self {
        self.delay = seconds;
        self
    }
}

/// What outputs of an entity ask of others, in this order.
///
/// All wires together send at most 2^20 actions in a step: what is over is left out, with a warning. So wires that lead
/// back to where they begin, and become more in every step, do not fill the memory.
#[derive(Component, Clone, Debug, Default, PartialEq)]
#[require(Logic)]
pub struct Wires(pub Vec<Wire>);

/// Most actions that wires send in a step.
const MOST_SENT: usize = 1 << 20;

/// An action that waits.
#[derive(Clone, Copy, Debug)]
struct Later {
    step: u64,
    /// Of those of a step the one that was sent first comes first.
    number: u64,
    action: Action,
}

impl PartialEq for Later {
    fn eq(&self, other: &Self) -> bool {
        (self.step, self.number) == (other.step, other.number)
    }
}

impl Eq for Later {}

impl PartialOrd for Later {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Later {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (self.step, self.number).cmp(&(other.step, other.number))
    }
}

/// Actions that wait for their time.
#[derive(Resource, Debug, Default)]
pub struct DelayedActions {
    heap: BinaryHeap<Reverse<Later>>,
    sent: u64,
}

impl DelayedActions {
    /// Sends an action in a step to come.
    pub fn send(&mut self, step: u64, action: Action) {
        self.sent += 1;
        self.heap.push(Reverse(Later {
            step,
            number: self.sent,
            action,
        }));
    }

    /// All that wait, in the order in which they are sent: the step and the action.
    pub(crate) fn sorted(&self) -> Vec<(u64, Action)> {
        let mut all: Vec<Later> = self.heap.iter().map(|later| later.0).collect();
        all.sort_unstable();
        all.into_iter()
            .map(|later| (later.step, later.action))
            .collect()
    }

    /// How many wait.
    #[must_use]
    pub fn len(&self) -> usize {
        self.heap.len()
    }

    /// Whether none waits.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.heap.is_empty()
    }
}

/// Whether an action waits: a run condition.
pub(crate) fn any_delayed(delayed: Res<DelayedActions>) -> bool {
    !delayed.is_empty()
}

/// Sends what was to be sent by now.
pub(crate) fn send_delayed(
    clock: Res<LogicClock>,
    mut delayed: ResMut<DelayedActions>,
    mut actions: MessageWriter<Action>,
) {
    while let Some(later) = delayed.heap.peek()
        && later.0.step <= clock.step
    {
        actions.write(later.0.action);
        delayed.heap.pop();
    }
}

/// Outputs of entities with wires become actions.
pub(crate) fn follow_wires(
    clock: Res<LogicClock>,
    mut outputs: MessageReader<Output>,
    wires: Query<&Wires>,
    mut delayed: ResMut<DelayedActions>,
    mut actions: MessageWriter<Action>,
) {
    let mut sent = 0;
    'outputs: for output in outputs.read() {
        let Ok(wires) = wires.get(output.source) else {
            continue;
        };
        for wire in wires.0.iter().filter(|wire| wire.on == output.name) {
            if sent == MOST_SENT {
                warn_once!(
                    "wires send more than {MOST_SENT} actions in a step, as if they led back to where they begin; \
                     the rest is left out"
                );
                break 'outputs;
            }
            sent += 1;
            let action = Action {
                target: wire.target,
                source: output.source,
                verb: wire.verb,
                parameter: match wire.parameter {
                    Value::None => output.parameter,
                    own => own,
                },
            };
            match clock.steps(wire.delay) {
                Some(steps) => delayed.send(clock.step + u64::from(steps), action),
                None => {
                    actions.write(action);
                }
            }
        }
    }
    // Nothing is caught up on in the next step.
    outputs.clear();
}
