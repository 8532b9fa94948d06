//! What the bot wants: it looks at what a player sees, and answers with what a player can do.
//!
//! It goes to the nearest beacon that does not burn, at a run, on a way that keeps out of the sight of soldiers where
//! there is one. Who is after it is led away and left behind, unless the beacon is near and it is well; it runs a little
//! to and fro meanwhile, which bolts miss. When nobody knows of it any more and it is well again, it goes on.
//!
//! How it plays in a city, among lifts and houses, is [`town`](super::town)'s concern.

use bevy::math::{Vec3Swizzles as _, ops};
use bevy::prelude::*;
use dolomite::logic::movement::{PathScratch, WalkGrid, find_path};
use dolomite::logic::random::Random;

use super::seen::{Sees, look};
use crate::input::PlayerInput;
use crate::level::Level;

/// It flees below the first part of its health, and comes back above the second.
pub(super) const FLEES: f32 = 0.5;
pub(super) const RETURNS: f32 = 0.9;

/// It presses on to a beacon that is nearer than this, metres, with at least this part of its health.
pub(super) const NEAR: f32 = 25.0;
pub(super) const PRESSES: f32 = 0.62;

/// It leads away who is after it and nearer than the first, metres, until they are farther than the second.
const LEADS: f32 = 45.0;
const LEFT: f32 = 60.0;

/// Who is after it and nearer than this, metres, may shoot.
const SHOT: f32 = 40.0;

/// How far it turns off its way when it runs to and fro, radians.
const DODGE: f32 = 0.45;

/// It keeps out of this part of how far soldiers see.
const KEEPS_OUT: f32 = 0.75;

/// It turns to the other side after so many steps, at least and at most.
const TURNS: (u32, u32) = (16, 34);

/// A turn of its way is passed at this distance, metres.
pub(super) const PASSED: f32 = 3.0;

/// Steps after which it thinks of its way again.
const THINKS: u64 = 90;

/// How far it turns the view in a step at most, radians.
pub(super) const LOOKS: f32 = 0.12;

/// The bot's mind.
pub struct Pilot {
    pub(super) random: Random,
    scratch: PathScratch,
    way: Vec<Vec2>,
    goal: Vec2,
    pub(super) flees: bool,
    leads: bool,
    /// Which side it runs to, and for how many steps still.
    pub(super) side: f32,
    turn: u32,
    pub(super) step: u64,
    pub(super) town: InTown,
}

/// What it keeps in mind in a city.
#[derive(Default)]
pub struct InTown {
    /// Where it runs to, and since which step.
    pub(super) hide: Option<(Vec2, u64)>,
    /// Steps that it has waited on this roof.
    pub(super) waited: u32,
    /// Where it was some steps ago.
    pub(super) was: Vec2,
    /// Steps for which it goes aside.
    pub(super) aside: u32,
}

/// What it does in a step.
#[derive(Default)]
pub(super) struct Does {
    pub(super) wanted: Vec2,
    pub(super) act: bool,
    /// Where it looks, in place of ahead.
    pub(super) face: Option<Vec2>,
}

impl Pilot {
    /// The same seed plays the same game.
    pub fn new(seed: u64) -> Self {
        Self {
            random: Random::new(seed ^ 0x0b07),
            scratch: PathScratch::default(),
            way: Vec::new(),
            goal: Vec2::NAN,
            flees: false,
            leads: false,
            side: 1.0,
            turn: 0,
            step: 0,
            town: InTown::default(),
        }
    }

    /// What it does in the next step.
    pub fn decide(&mut self, world: &mut World) -> PlayerInput {
        let Some(sees) = look(world) else {
            return PlayerInput::default();
        };
        let level = world.resource::<Level>().clone();
        self.step += 1;
        if self.turn == 0 {
            self.side = -self.side;
            self.turn = TURNS.0 + self.random.below(TURNS.1 - TURNS.0);
        }
        self.turn -= 1;
        if !level.built.hides.is_empty() {
            return self.decide_in_town(&sees, &level, world);
        }
        let distances = sees.hunters.iter().map(|at| at.distance(sees.place));
        let hunted = distances.fold(f32::INFINITY, f32::min);
        let far =
            |place: Option<Vec2>| place.map_or(f32::INFINITY, |place| place.distance(sees.place));
        self.flees = match self.flees {
            true => sees.health < RETURNS,
            false => sees.health < FLEES,
        };
        let presses = far(sees.beacon) < NEAR && sees.health > PRESSES;
        self.leads = match self.leads {
            true => hunted < LEFT,
            false => hunted < LEADS && !presses,
        };
        let mut wanted = Vec2::ZERO;
        let mut act = false;
        let waits = !sees.hunters.is_empty() && !presses || self.flees && sees.bandage.is_none();
        if self.leads {
            wanted = self.away(&sees, &level);
        } else if let Some(goal) = sees.bandage.filter(|_| self.flees).or(sees.beacon)
            && !waits
        {
            act = !self.flees && far(Some(goal)) < level.file.reach - 0.2;
            if !(act && far(Some(goal)) < 1.2) {
                let reach = sees.sight * KEEPS_OUT;
                wanted = self.toward(goal, &sees, &level, (reach, PASSED));
            }
        }
        if act && hunted < SHOT {
            // Around the beacon, within reach.
            let out = sees.place - sees.beacon.unwrap_or(sees.place);
            wanted = out.perp().normalize_or(Vec2::X) * self.side - out * 0.4;
        } else if hunted < SHOT && wanted != Vec2::ZERO {
            let (sin, cos) = ops::sin_cos(self.side * DODGE);
            wanted = Vec2::new(
                wanted.x * cos - wanted.y * sin,
                wanted.x * sin + wanted.y * cos,
            );
        }
        command(wanted.clamp_length_max(1.0), sees.yaw, act)
    }

    fn away(&mut self, sees: &Sees, level: &Level) -> Vec2 {
        let mut away = Vec2::ZERO;
        for soldier in sees.hunters.iter().chain(&sees.others) {
            let from = sees.place - soldier;
            away += from / from.length_squared().max(1.0);
        }
        // The far sides of the area are no way out of it.
        let middle = Vec2::from(level.file.area.middle);
        let out = (sees.place - middle) / (level.file.area.side / 2.0);
        let far = out.length_squared();
        (away.normalize_or(Vec2::X) - out * (far * far)).normalize_or(Vec2::X)
    }

    /// Along a way to a goal, which keeps as far as `reach` from soldiers where it can; turns are passed at a distance
    /// of `passed`. Metres.
    pub(super) fn toward(
        &mut self,
        goal: Vec2,
        sees: &Sees,
        level: &Level,
        (reach, passed): (f32, f32),
    ) -> Vec2 {
        let grid = &level.grid;
        if self.goal != goal || self.step.is_multiple_of(THINKS) {
            self.goal = goal;
            let open = |place| grid.nearest_open(place, 16);
            let way = open(sees.place).zip(open(goal)).and_then(|(from, to)| {
                // Around whoever could see it, and straight where there is no way around.
                let mut hidden = WalkGrid::clone(grid);
                for soldier in &sees.others {
                    // Where it is, and where it goes to, nobody is kept out of.
                    let room = soldier.distance(from).min(soldier.distance(to)) * 0.7;
                    let half = Vec2::splat(reach.min(room) * 0.8);
                    let (low, high) = (*soldier - half, *soldier + half);
                    hidden.block(low.extend(0.0).xzy(), high.extend(0.0).xzy(), 0.0);
                }
                find_path(&hidden, from, to, &mut self.scratch)
                    .or_else(|| find_path(grid, from, to, &mut self.scratch))
            });
            self.way = way.unwrap_or_default().into_iter().skip(1).rev().collect();
        }
        while let Some(turn) = self.way.last()
            && turn.distance(sees.place) < passed
        {
            self.way.pop();
        }
        let next = self.way.last().copied().unwrap_or(goal);
        (next - sees.place).normalize_or_zero()
    }
}

/// From where the view looks to a direction (x, z), radians, −π to π.
pub(super) fn turn_to(direction: Vec2, yaw: f32) -> f32 {
    let turn = ops::atan2(-direction.x, -direction.y) - yaw;
    (turn + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU) - std::f32::consts::PI
}

/// Keys for a way (x, z) of length 0 to 1: the view turns there, and the figure runs as the view is now.
pub(super) fn command(wanted: Vec2, yaw: f32, act: bool) -> PlayerInput {
    if wanted == Vec2::ZERO {
        return PlayerInput { act, ..default() };
    }
    let (sin, cos) = ops::sin_cos(yaw);
    let turn = turn_to(wanted, yaw);
    PlayerInput {
        walk: Vec2::new(
            wanted.dot(Vec2::new(cos, -sin)),
            wanted.dot(Vec2::new(-sin, -cos)),
        ),
        look: Vec2::new(-turn.clamp(-LOOKS, LOOKS), 0.0),
        fast: true,
        act,
        ..default()
    }
}
