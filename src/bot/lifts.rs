//! How the bot rides lifts: onto the plate, up, over the bridge, and down again once nobody looks for it.

use bevy::prelude::*;

use super::pilot::{Does, Pilot};
use super::seen::{Sees, Town};
use crate::level::Level;
use crate::level::town::{PLATE, Roof};

/// Steps between two presses of a button: a press is a key that goes down.
const PRESS: u64 = 24;

/// It waits on a roof no longer than this while somebody is after it, steps.
const WAITS: u32 = 60 * 60;

/// It has come to a place that is nearer than this, metres.
const THERE: f32 = 0.3;

/// A plate stands at a floor that is no farther from it than this, metres.
pub(super) const AT_FLOOR: f32 = 0.05;

impl Pilot {
    pub(super) fn presses(&self) -> bool {
        self.step % PRESS < 2
    }

    /// To a place near by, and stops there.
    pub(super) fn step_to(place: Vec2, goal: Vec2) -> Vec2 {
        let way = goal - place;
        if way.length() < THERE {
            return Vec2::ZERO;
        }
        // Slower on the last metre: who runs needs that to stop.
        way.normalize_or_zero() * (way.length() / 1.2).clamp(0.15, 0.7)
    }

    /// On the plate of a lift.
    pub(super) fn ride(
        &mut self,
        number: usize,
        roof: &Roof,
        sees: &Sees,
        level: &Level,
        town: &Town,
    ) -> Does {
        let (top, moves) = town.lifts[number].unwrap_or((roof.floors[0], false));
        let below = top < (roof.floors[0] + roof.floors[1]) / 2.0;
        let dark = town.dark.iter().any(|(dark, _)| *dark == number);
        let wanted = Self::step_to(sees.place, roof.shaft);
        if moves {
            return Does {
                wanted,
                ..default()
            };
        }
        if below && !self.wants(number, sees, level, town) {
            return self.on_street(sees, level, town);
        }
        if !below && dark {
            return self.on_roof(number, roof, sees, level, town);
        }
        Does {
            wanted,
            act: wanted == Vec2::ZERO && self.presses(),
            ..default()
        }
    }

    /// On a roof, or on the bridge to it.
    pub(super) fn on_roof(
        &mut self,
        number: usize,
        roof: &Roof,
        sees: &Sees,
        level: &Level,
        town: &Town,
    ) -> Does {
        let dark = town.dark.iter().find(|(dark, _)| *dark == number);
        if let Some(&(_, beacon)) = dark {
            let far = beacon.distance(sees.place);
            let reach = level.file.reach;
            return Does {
                wanted: match far < reach * 0.7 {
                    true => Vec2::ZERO,
                    false => Self::along_bridge(beacon, roof, sees.place),
                },
                act: far < reach - 0.2,
                ..default()
            };
        }
        self.town.waited += 1;
        let hunted = !sees.hunters.is_empty() || self.flees;
        if hunted && self.town.waited < WAITS {
            // In the middle nobody on the street sees it.
            let middle = roof.middle();
            let wanted = match middle.distance(sees.place) < 1.0 {
                true => Vec2::ZERO,
                false => Self::along_bridge(middle, roof, sees.place),
            };
            return Does {
                wanted,
                ..default()
            };
        }
        let up = town.lifts[number]
            .is_some_and(|(top, moves)| !moves && (top - roof.floors[1]).abs() < AT_FLOOR);
        let before = roof.shaft - roof.out * (PLATE.x + 0.6);
        if up {
            return Does {
                wanted: Self::along_bridge(roof.shaft, roof, sees.place),
                ..default()
            };
        }
        let near = before.distance(sees.place) < THERE * 2.0;
        Does {
            wanted: match near {
                true => Vec2::ZERO,
                false => Self::along_bridge(before, roof, sees.place),
            },
            act: near && self.presses(),
            ..default()
        }
    }

    /// Between the roof and the plate: on the line of the bridge first.
    fn along_bridge(goal: Vec2, roof: &Roof, place: Vec2) -> Vec2 {
        let across = (place - roof.shaft).dot(roof.along());
        let on_house = (roof.house[0].x..=roof.house[1].x).contains(&place.x)
            && (roof.house[0].z..=roof.house[1].z).contains(&place.y);
        let crosses = (goal - roof.middle()).dot(roof.out) > 2.0;
        if across.abs() > 0.4 && on_house && crosses {
            return -roof.along() * across.signum() * 0.5;
        }
        let way = goal - place - roof.along() * (across * 0.5);
        way.normalize_or_zero() * (goal.distance(place) / 1.2).clamp(0.15, 0.6)
    }

    /// Whether it goes up to this roof now.
    pub(super) fn wants(&self, number: usize, sees: &Sees, level: &Level, town: &Town) -> bool {
        let next = Self::next(sees, level, town);
        next.is_some_and(|(next, _)| next == Some(number))
            && !(self.flees && sees.bandage.is_some())
    }
}
