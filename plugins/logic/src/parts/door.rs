//! Doors, and what slides.

use crate::action::{Action, Output};
use crate::clock::LogicClock;
use crate::names::Key;
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::math::Vec3;
use bevy::reflect::prelude::*;
use bevy::transform::components::Transform;

/// Where a door is on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum DoorState {
    /// Wholly closed.
    #[default]
    Closed,
    /// On its way to open.
    Opening,
    /// Wholly open.
    Open,
    /// On its way to closed.
    Closing,
}

/// A door. Actions: [`Key::OPEN`], [`Key::CLOSE`], [`Key::TOGGLE`], [`Key::LOCK`], [`Key::UNLOCK`], and [`Key::BLOCK`]
/// when something is in its way, which opens it again. Outputs: [`Key::OPENED`], [`Key::CLOSED`].
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Logic)]
pub struct Door {
    /// Where it is on its way.
    pub state: DoorState,
    /// How far it is open, 0 to 1.
    pub open: f32,
    /// Seconds from closed to open; what is not above 0 is at once.
    pub time: f32,
    /// Seconds after which it closes by itself; `None`: never.
    pub hold: Option<f32>,
    /// Whether it does not open.
    pub locked: bool,
    /// Seconds that it has been open.
    pub waited: f32,
}

impl Default for Door {
    /// Closed; a second from closed to open; stays open.
    fn default() -> Self {
        Self {
            state: DoorState::Closed,
            open: 0.0,
            time: 1.0,
            hold: None,
            locked: false,
            waited: 0.0,
        }
    }
}

impl Door {
    /// Opens, unless it is locked.
    pub fn open(&mut self) {
        if self.locked {
            return;
        }
        match self.state {
            DoorState::Closed | DoorState::Closing => self.state = DoorState::Opening,
            // Who opens it again keeps it open.
            DoorState::Open => self.waited = 0.0,
            DoorState::Opening => (),
        }
    }

    /// Closes.
    pub fn close(&mut self) {
        if matches!(self.state, DoorState::Open | DoorState::Opening) {
            self.state = DoorState::Closing;
        }
    }

    /// One step on; gives [`Key::OPENED`] or [`Key::CLOSED`] when it is there.
    pub fn advance(&mut self, seconds: f32) -> Option<Key> {
        let part = if self.time > 0.0 {
            seconds / self.time
        } else {
            1.0
        };
        match self.state {
            DoorState::Opening => {
                self.open = (self.open + part).min(1.0);
                if self.open >= 1.0 {
                    self.state = DoorState::Open;
                    self.waited = 0.0;
                    return Some(Key::OPENED);
                }
            }
            DoorState::Closing => {
                self.open = (self.open - part).max(0.0);
                if self.open <= 0.0 {
                    self.state = DoorState::Closed;
                    return Some(Key::CLOSED);
                }
            }
            DoorState::Open => {
                self.waited += seconds;
                if self.hold.is_some_and(|hold| self.waited >= hold) {
                    self.state = DoorState::Closing;
                }
            }
            DoorState::Closed => (),
        }
        None
    }
}

/// Moves the entity between two places as its [`Door`] opens.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Transform, Door)]
pub struct Slide {
    /// Where it is closed.
    pub closed: Vec3,
    /// Where it is open.
    pub open: Vec3,
}

pub(super) fn run(
    clock: Res<LogicClock>,
    mut actions: MessageReader<Action>,
    mut doors: Query<(Entity, &mut Door, Option<(&Slide, &mut Transform)>)>,
    mut outputs: MessageWriter<Output>,
) {
    for action in actions.read() {
        let Ok((_, mut door, _)) = doors.get_mut(action.target) else {
            continue;
        };
        match action.verb {
            Key::OPEN => door.open(),
            Key::CLOSE => door.close(),
            Key::TOGGLE => match door.state {
                DoorState::Open | DoorState::Opening => door.close(),
                DoorState::Closed | DoorState::Closing => door.open(),
            },
            Key::BLOCK if door.state == DoorState::Closing => {
                // A lock does not hold what is in the way.
                door.state = DoorState::Opening;
            }
            Key::LOCK => door.locked = true,
            Key::UNLOCK => door.locked = false,
            _ => (),
        }
    }
    for (entity, mut door, slide) in &mut doors {
        let rests = door.state == DoorState::Closed
            || (door.state == DoorState::Open && door.hold.is_none());
        if !rests && let Some(name) = door.advance(clock.delta) {
            outputs.write(Output::new(entity, name, ()));
        }
        // One that rests is where it says too: one that is new, or that was put there.
        if let Some((slide, mut transform)) = slide {
            let place = slide.closed.lerp(slide.open, door.open);
            if place.is_finite() && transform.translation != place {
                transform.translation = place;
            }
        }
    }
}
