//! How the bot plays in a city: it rides lifts to roofs, waits there until nobody looks for it any more, turns corners
//! before who is after it, shoots at who sees it, and leaves by the gate. On lifts and roofs it is
//! [`lifts`](super::lifts)' concern.

use bevy::math::ops;
use bevy::prelude::*;

use super::lifts::AT_FLOOR;
use super::pilot::{Does, FLEES, LOOKS, NEAR, PRESSES, Pilot, RETURNS, command, turn_to};
use super::seen::{SHOOTS, Sees, Town, see};
use crate::input::PlayerInput;
use crate::level::Level;
use crate::level::town::Roof;

/// Higher than this above the ground, metres, it is on a roof or on a lift.
const UP: f32 = 1.5;

/// Who is after it and nearer than this, metres, it runs from.
const RUNS: f32 = 34.0;

/// It keeps so far out of the way of soldiers where it can, and passes turns of its way at this distance, metres.
const KEEPS: (f32, f32) = (20.0, 0.8);

/// Places to run to: in so many directions, so far away, metres; and steps after which it thinks again.
const DIRECTIONS: u32 = 24;
const DISTANCES: [f32; 2] = [28.0, 50.0];
const THINKS: u64 = 150;

/// It shoots when it looks at somebody as nearly as this, radians: half of what the level aims by itself.
const FIRES: f32 = 0.05;

/// Who has moved by less in so many steps, metres, is caught at a corner, and goes aside for some steps.
const CAUGHT: (f32, u64) = (0.4, 60);
const ASIDE: u32 = 20;

impl Pilot {
    /// What it does in the next step.
    pub(super) fn decide_in_town(
        &mut self,
        sees: &Sees,
        level: &Level,
        world: &mut World,
    ) -> PlayerInput {
        let town = see(world, sees, level);
        self.flees = match self.flees {
            true => sees.health < RETURNS,
            false => sees.health < FLEES,
        };
        let feet = level.grid.height(sees.place) + sees.above;
        let roofs = level.built.roofs.iter().enumerate();
        let roofs = roofs.filter_map(|(number, roof)| Some((number, roof.as_ref()?)));
        let by_distance = |a: &(usize, &Roof), b: &(usize, &Roof)| {
            let far = |roof: &Roof| roof.middle().distance(sees.place);
            far(a.1).total_cmp(&far(b.1))
        };
        let nearest = roofs.min_by(by_distance);
        let on_plate = nearest.filter(|(number, roof)| {
            let top = town.lifts[*number].map_or(f32::NAN, |(top, _)| top);
            roof.on_plate(sees.place) && (top - feet).abs() < 0.4
        });
        let mut does = match (on_plate, nearest) {
            (Some((number, roof)), _) => {
                self.town.waited = 0;
                self.ride(number, roof, sees, level, &town)
            }
            (None, Some((number, roof))) if sees.above > UP => {
                self.on_roof(number, roof, sees, level, &town)
            }
            _ => self.on_street(sees, level, &town),
        };
        self.free(sees, &mut does);
        if let Some(target) = town.target.filter(|_| town.loaded) {
            does.face = Some(target - sees.place);
        }
        let mut input = command(does.wanted.clamp_length_max(1.0), sees.yaw, does.act);
        if let Some(face) = does.face {
            let turn = turn_to(face, sees.yaw);
            input.look.x = -turn.clamp(-LOOKS, LOOKS);
            input.fire = turn.abs() < FIRES;
        }
        input
    }

    /// Who has not come on for a while goes aside.
    fn free(&mut self, sees: &Sees, does: &mut Does) {
        let (least, steps) = CAUGHT;
        if does.wanted == Vec2::ZERO {
            self.town.was = Vec2::INFINITY;
            self.town.aside = 0;
        } else if self.step.is_multiple_of(steps) {
            if self.town.was.distance(sees.place) < least {
                self.town.aside = ASIDE;
                self.town.hide = None;
            }
            self.town.was = sees.place;
        }
        // On a roof there is nothing to be caught at but rails, and an edge to fall from.
        if self.town.aside > 0 && sees.above < UP {
            self.town.aside -= 1;
            does.wanted = does.wanted.perp() * self.side - does.wanted * 0.3;
        }
    }

    /// Where it goes next: the number of a dark beacon and the place before it, or the way out.
    pub(super) fn next(sees: &Sees, level: &Level, town: &Town) -> Option<(Option<usize>, Vec2)> {
        if let Some(exit) = town.exit {
            return Some((None, exit));
        }
        let place_of = |&(number, at): &(usize, Vec2)| {
            let roof = level.built.roofs.get(number).and_then(Option::as_ref);
            (Some(number), roof.map_or(at, Roof::before))
        };
        let near = |a: &(Option<usize>, Vec2), b: &(Option<usize>, Vec2)| {
            a.1.distance(sees.place)
                .total_cmp(&b.1.distance(sees.place))
        };
        town.dark.iter().map(place_of).min_by(near)
    }

    /// On the street.
    pub(super) fn on_street(&mut self, sees: &Sees, level: &Level, town: &Town) -> Does {
        self.town.waited = 0;
        let distances = sees.hunters.iter().map(|at| at.distance(sees.place));
        let hunted = distances.fold(f32::INFINITY, f32::min);
        let next = Self::next(sees, level, town);
        let near = next.is_some_and(|(_, at)| at.distance(sees.place) < NEAR);
        let presses = near && sees.health > PRESSES;
        let hurt = self.flees.then_some(sees.bandage).flatten();
        if (hunted < RUNS && !presses) || (self.flees && hurt.is_none()) {
            let goal = self.hiding_place(sees, level);
            let way = match goal.distance(sees.place) < 2.0 && hunted > RUNS {
                true => Vec2::ZERO,
                false => self.toward(goal, sees, level, KEEPS),
            };
            return Does {
                wanted: self.dodge(way, hunted),
                ..default()
            };
        }
        self.town.hide = None;
        let (number, goal) = match (hurt, next) {
            (Some(bandage), _) => (None, bandage),
            (None, Some(next)) => next,
            (None, None) => return Does::default(),
        };
        let far = goal.distance(sees.place);
        let roof = number.and_then(|number| level.built.roofs.get(number)?.as_ref());
        if let (Some(number), Some(roof)) = (number, roof) {
            let down = town.lifts[number]
                .is_some_and(|(top, moves)| !moves && (top - roof.floors[0]).abs() < AT_FLOOR);
            // Once it is there it steps onto the plate, which no way leads over.
            if far < 2.5 && down {
                return Does {
                    wanted: Self::step_to(sees.place, roof.shaft),
                    ..default()
                };
            }
            if far < 1.0 {
                let wanted = Self::step_to(sees.place, goal);
                return Does {
                    wanted,
                    act: self.presses(),
                    ..default()
                };
            }
            let way = self.toward(goal, sees, level, KEEPS);
            return Does {
                wanted: self.dodge(way, hunted),
                ..default()
            };
        }
        let lights = number.is_some();
        let reach = level.file.reach;
        let wanted = match town.exit {
            // Through the gate no way of the soldiers' leads.
            Some(exit) if hurt.is_none() => self.leave(exit, sees, level),
            _ if lights && far < reach * 0.6 => Vec2::ZERO,
            _ if far < reach => Self::step_to(sees.place, goal),
            _ => {
                let way = self.toward(goal, sees, level, KEEPS);
                self.dodge(way, hunted)
            }
        };
        Does {
            wanted,
            act: lights && far < reach - 0.2,
            ..default()
        }
    }

    /// To the gate, through its middle, and out.
    fn leave(&mut self, exit: Vec2, sees: &Sees, level: &Level) -> Vec2 {
        let Some(gate) = level.built.gate else {
            return Vec2::ZERO;
        };
        let at = Vec2::new(gate.closed.x, gate.closed.z);
        let inside = at + (at - exit).normalize_or_zero() * 2.5;
        let line = (sees.place - at)
            .perp_dot((exit - at).normalize_or_zero())
            .abs();
        let near =
            sees.place.distance(inside) < 1.2 || (line < 1.5 && sees.place.distance(at) < 4.0);
        match near {
            true => (exit - sees.place).normalize_or_zero(),
            false => self.toward(inside, sees, level, KEEPS),
        }
    }

    /// A little to and fro where somebody may shoot.
    fn dodge(&self, wanted: Vec2, hunted: f32) -> Vec2 {
        if hunted > SHOOTS {
            return wanted;
        }
        let (sin, cos) = ops::sin_cos(self.side * 0.3);
        Vec2::new(
            wanted.x * cos - wanted.y * sin,
            wanted.x * sin + wanted.y * cos,
        )
    }

    /// Far from all soldiers and not past one who is after it.
    fn hiding_place(&mut self, sees: &Sees, level: &Level) -> Vec2 {
        if let Some((place, since)) = self.town.hide
            && self.step < since + THINKS
        {
            return place;
        }
        let soldiers = || sees.hunters.iter().chain(&sees.others);
        let grid = &level.grid;
        let mut best = (f32::NEG_INFINITY, sees.place);
        for number in 0..DIRECTIONS {
            let angle = number as f32 * (std::f32::consts::TAU / DIRECTIONS as f32);
            let (sin, cos) = ops::sin_cos(angle);
            for distance in DISTANCES {
                let wanted = sees.place + Vec2::new(cos, sin) * distance;
                let Some(place) = grid.nearest_open(wanted, 6) else {
                    continue;
                };
                let nearest = soldiers().map(|at| at.distance(place));
                let nearest = nearest.fold(80.0, f32::min);
                // Past whom it would come.
                let passed = sees.hunters.iter().map(|at| {
                    let way = place - sees.place;
                    let part = (*at - sees.place).dot(way) / way.length_squared().max(1.0);
                    let close = sees.place + way * part.clamp(0.0, 1.0);
                    (15.0 - close.distance(*at)).max(0.0)
                });
                let score = nearest - 3.0 * passed.sum::<f32>() - 0.2 * place.distance(sees.place);
                if score > best.0 {
                    best = (score, place);
                }
            }
        }
        self.town.hide = Some((best.1, self.step));
        best.1
    }
}
