//! Lifts that follow buttons.
//!
//! A lift goes on in its direction as long as somebody there called, then turns: SCAN, or the elevator algorithm
//! (D. Knuth, The Art of Computer Programming 1, 2.2.5). It stands, opens the door of the floor, waits, closes it,
//! and moves only when the door is closed.

use super::door::{Door, DoorState};
use crate::action::{Action, Output};
use crate::clock::LogicClock;
use crate::names::Key;
use crate::value::Value;
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::transform::components::Transform;
use thiserror::Error;

/// Most floors of a lift.
pub const FLOORS: usize = 64;

/// A lift that cannot be made, or a floor that it does not have.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum LiftError {
    /// No floor, or more than [`FLOORS`].
    #[error("a lift has 1 to {FLOORS} floors, not {0}")]
    Floors(usize),
    /// Heights have to rise.
    #[error("floor {0} is not above the one before, or not finite")]
    Order(usize),
    /// A speed or an acceleration.
    #[error("a lift needs a speed and an acceleration above 0, not {speed} and {acceleration}")]
    Speed {
        /// Metres a second.
        speed: f32,
        /// Metres a second squared.
        acceleration: f32,
    },
    /// No such floor.
    #[error("there is no floor {0}")]
    NoFloor(i32),
}

/// What a lift does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LiftState {
    /// Stands, and nobody calls.
    #[default]
    Idle,
    /// On its way.
    Moving,
    /// Stands at a floor until its door is open, and then for the waiting time.
    Waiting,
    /// The door closes.
    Closing,
}

/// A platform between floors. Its entity's `Transform` has the height. Actions: [`Key::CALL`] with the floor, from 0.
/// Output: [`Key::ARRIVED`] with the floor.
#[derive(Component, Clone, Debug, PartialEq)]
#[require(Logic, Transform)]
pub struct Lift {
    heights: Vec<f32>,
    /// The doors of the floors, each a [`Door`]; none where the list is shorter. A door that is gone counts as closed.
    pub doors: Vec<Option<Entity>>,
    speed: f32,
    acceleration: f32,
    /// Seconds that it stands at a floor with an open door.
    pub waiting: f32,
    height: f32,
    velocity: f32,
    calls: u64,
    rising: bool,
    state: LiftState,
    waited: f32,
    /// The floor that it goes to or stands at.
    floor: usize,
}

impl Lift {
    /// At its lowest floor, with 2 m/s, 1.5 m/s² and 3 s at each floor.
    ///
    /// # Errors
    /// [`LiftError`]: heights in metres have to rise from floor to floor.
    pub fn new(heights: Vec<f32>) -> Result<Self, LiftError> {
        if heights.is_empty() || heights.len() > FLOORS {
            return Err(LiftError::Floors(heights.len()));
        }
        for (floor, height) in heights.iter().enumerate() {
            let above = floor == 0 || *height > heights[floor - 1];
            if !height.is_finite() || !above {
                return Err(LiftError::Order(floor));
            }
        }
        Ok(Self {
            height: heights[0],
            heights,
            doors: Vec::new(),
            speed: 2.0,
            acceleration: 1.5,
            waiting: 3.0,
            velocity: 0.0,
            calls: 0,
            rising: true,
            state: LiftState::Idle,
            waited: 0.0,
            floor: 0,
        })
    }

    /// With this speed, m/s, and acceleration, m/s².
    ///
    /// # Errors
    /// [`LiftError::Speed`].
    pub fn with_speed(mut self, speed: f32, acceleration: f32) -> Result<Self, LiftError> {
        let whole = speed.is_finite() && acceleration.is_finite();
        if !(whole && speed > 0.0 && acceleration > 0.0) {
            return Err(LiftError::Speed {
                speed,
                acceleration,
            });
        }
        self.speed = speed;
        self.acceleration = acceleration;
        Ok(self)
    }

    /// Standing at a floor, called by nobody.
    ///
    /// # Errors
    /// [`LiftError::NoFloor`].
    pub fn at_floor(mut self, floor: usize) -> Result<Self, LiftError> {
        let number = i32::try_from(floor).unwrap_or(i32::MAX);
        self.height = *self.heights.get(floor).ok_or(LiftError::NoFloor(number))?;
        self.floor = floor;
        self.velocity = 0.0;
        self.calls = 0;
        self.state = LiftState::Idle;
        self.waited = 0.0;
        Ok(self)
    }

    /// Somebody wants it at a floor.
    ///
    /// # Errors
    /// [`LiftError::NoFloor`].
    pub fn call(&mut self, floor: i32) -> Result<(), LiftError> {
        let number = usize::try_from(floor).ok();
        let number = number.filter(|&number| number < self.heights.len());
        let number = number.ok_or(LiftError::NoFloor(floor))?;
        self.calls |= 1 << number;
        Ok(())
    }

    /// Where it is, metres.
    #[must_use]
    pub const fn height(&self) -> f32 {
        self.height
    }

    /// Upwards, m/s.
    #[must_use]
    pub const fn velocity(&self) -> f32 {
        self.velocity
    }

    /// The floor that it stands at or goes to.
    #[must_use]
    pub const fn floor(&self) -> usize {
        self.floor
    }

    /// What it does.
    #[must_use]
    pub const fn state(&self) -> LiftState {
        self.state
    }

    /// Whether somebody called it to a floor and it has not been there yet.
    #[must_use]
    pub fn is_called(&self, floor: usize) -> bool {
        floor < FLOORS && self.calls >> floor & 1 == 1
    }

    /// The next floor in its direction, or else in the other. A floor that it cannot stop at any more in this
    /// direction is none.
    fn next(&self) -> Option<(usize, bool)> {
        let stop = self.velocity * self.velocity / (2.0 * self.acceleration);
        let called = |floor: &usize| self.is_called(*floor);
        let up = || {
            let least = self.height + if self.velocity > 0.0 { stop } else { 0.0 };
            // A hundred-thousandth of the height for the rounding of many sums.
            let slack = least.abs().max(1.0) * 1e-5;
            (0..self.heights.len())
                .filter(called)
                .find(|&floor| self.heights[floor] >= least - slack)
        };
        let down = || {
            let most = self.height - if self.velocity < 0.0 { stop } else { 0.0 };
            let slack = most.abs().max(1.0) * 1e-5;
            (0..self.heights.len())
                .rev()
                .filter(called)
                .find(|&floor| self.heights[floor] <= most + slack)
        };
        if self.rising {
            up().map(|floor| (floor, true))
                .or_else(|| down().map(|floor| (floor, false)))
        } else {
            down()
                .map(|floor| (floor, false))
                .or_else(|| up().map(|floor| (floor, true)))
        }
    }

    /// One step of its way to the floor that it goes to; whether it is there.
    fn go(&mut self, seconds: f32) -> bool {
        let way = self.heights[self.floor] - self.height;
        let left = way.abs();
        let toward = way.signum();
        // The fastest from which it still stops there after this step: v² / 2a + v t = left.
        let slowed = self.acceleration * seconds;
        let stops = (slowed * slowed + 2.0 * self.acceleration * left).sqrt() - slowed;
        let along = self.velocity * toward;
        let next = (along + self.acceleration * seconds)
            .min(self.speed)
            .min(stops);
        let moved = next.max(0.0) * seconds;
        // A last step that would end within a tenth of a millimetre ends there.
        if moved >= left - 1e-4 {
            self.height = self.heights[self.floor];
            self.velocity = 0.0;
            return true;
        }
        self.height += toward * moved;
        self.velocity = toward * next;
        false
    }

    /// One step on. `door` says what became of the door of the floor that it stands at, or that there is none. Gives
    /// the floor at which it arrived, and what the door is asked for.
    pub fn advance(
        &mut self,
        seconds: f32,
        door: Option<DoorState>,
    ) -> (Option<usize>, Option<Key>) {
        match self.state {
            LiftState::Idle | LiftState::Moving => {
                // It stays where it is closed in: a door that somebody opened keeps it.
                if self.velocity == 0.0 && door.is_some_and(|door| door != DoorState::Closed) {
                    return (None, None);
                }
                let Some((floor, rising)) = self.next() else {
                    self.state = LiftState::Idle;
                    return (None, None);
                };
                self.floor = floor;
                self.rising = rising;
                self.state = LiftState::Moving;
                if self.go(seconds) {
                    self.calls &= !(1 << floor);
                    self.state = LiftState::Waiting;
                    self.waited = 0.0;
                    return (Some(floor), Some(Key::OPEN));
                }
                (None, None)
            }
            LiftState::Waiting => {
                // Who calls it to where it stands keeps it there.
                let again = self.is_called(self.floor);
                self.calls &= !(1 << self.floor);
                if again {
                    self.waited = 0.0;
                }
                if door.is_none_or(|door| door == DoorState::Open) {
                    self.waited += seconds;
                } else if door == Some(DoorState::Closed) {
                    // A locked door does not open: it is not waited for.
                    self.waited += seconds;
                }
                // Also ends a wait that is NaN.
                if self.waited < self.waiting {
                    return (None, None);
                }
                self.state = LiftState::Closing;
                (None, Some(Key::CLOSE))
            }
            LiftState::Closing => {
                if self.is_called(self.floor) {
                    self.calls &= !(1 << self.floor);
                    self.state = LiftState::Waiting;
                    self.waited = 0.0;
                    return (None, Some(Key::OPEN));
                }
                if door.is_none_or(|door| door == DoorState::Closed) {
                    self.state = LiftState::Idle;
                }
                (None, None)
            }
        }
    }
}

pub(super) fn run(
    clock: Res<LogicClock>,
    mut actions: MessageReader<Action>,
    mut lifts: Query<(Entity, &mut Lift, &mut Transform)>,
    mut doors: Query<&mut Door>,
    mut outputs: MessageWriter<Output>,
) {
    for action in actions.read() {
        if action.verb == Key::CALL
            && let Ok((_, mut lift, _)) = lifts.get_mut(action.target)
            && let Value::Int(floor) = action.parameter
        {
            // A floor that it does not have is nobody's.
            let _ = lift.call(floor);
        }
    }
    for (entity, mut lift, mut transform) in &mut lifts {
        if lift.state == LiftState::Idle && lift.calls == 0 {
            place(&lift, &mut transform);
            continue;
        }
        let door = lift.doors.get(lift.floor).copied().flatten();
        let state = door.and_then(|door| doors.get(door).ok().map(|door| door.state));
        let (arrived, ask) = lift.advance(clock.delta, state);
        if let Some(floor) = arrived {
            outputs.write(Output::new(entity, Key::ARRIVED, floor as i32));
        }
        // The door of the floor that it is at now.
        let door = lift.doors.get(lift.floor).copied().flatten();
        if let Some(mut door) = door.and_then(|door| doors.get_mut(door).ok()) {
            match ask {
                Some(Key::OPEN) => door.open(),
                Some(Key::CLOSE) => door.close(),
                _ => (),
            }
        }
        place(&lift, &mut transform);
    }
}

/// A lift that rests is where its height says too: one that is new, or that was put at a floor.
fn place(lift: &Lift, transform: &mut Mut<Transform>) {
    if transform.translation.y != lift.height {
        transform.translation.y = lift.height;
    }
}
