//! How soldiers go where they want: on ways over the grid, around each other, turning as people do.

use bevy::math::ops;
use bevy::prelude::*;
use dolomite::logic::LogicClock;
use dolomite::logic::movement::{PathScratch, find_path};

use super::parts::{Fallen, Level, MIDDLE, Soldier, ground_of};

/// A turn of a way is passed at this distance, metres.
const PASSED: f32 = 0.7;

/// A goal that has moved by less is the same, metres; and seconds until another way is thought of.
const MOVED: f32 = 1.5;
const PATIENCE: f32 = 0.5;

/// Two soldiers are not nearer than this, metres, and give way at this speed, metres a second.
const APART: f32 = 1.2;
const GIVES_WAY: f32 = 1.0;

/// Radians a second.
const TURNS: f32 = 3.5;

/// One step of every soldier.
pub(super) fn walk(
    level: Res<Level>,
    clock: Res<LogicClock>,
    mut soldiers: Query<(&mut Soldier, &mut Transform), Without<Fallen>>,
    mut scratch: Local<PathScratch>,
    mut places: Local<Vec<Vec2>>,
) {
    let grid = &*level.grid;
    let seconds = clock.delta;
    places.clear();
    places.extend(soldiers.iter().map(|(_, at)| ground_of(at)));
    for (number, (mut soldier, mut at)) in soldiers.iter_mut().enumerate() {
        let place = places[number];
        let mut velocity = Vec2::ZERO;
        soldier.patience = (soldier.patience - seconds).max(0.0);
        match soldier
            .wish
            .goal
            .and_then(|goal| grid.nearest_open(goal, 12))
        {
            Some(goal) => {
                let known = soldier
                    .leads
                    .is_some_and(|leads| leads.distance(goal) < MOVED);
                if !known && soldier.patience == 0.0 {
                    let way = find_path(grid, place, goal, &mut scratch).unwrap_or_default();
                    // The first is where it stands.
                    soldier.way = way.into_iter().skip(1).rev().collect();
                    soldier.leads = Some(goal);
                    soldier.patience = PATIENCE;
                }
                while soldier
                    .way
                    .last()
                    .is_some_and(|turn| turn.distance(place) < PASSED)
                {
                    soldier.way.pop();
                }
                if let Some(turn) = soldier.way.last() {
                    velocity = (*turn - place).normalize_or_zero() * soldier.wish.speed;
                }
            }
            None => {
                soldier.way.clear();
                soldier.leads = None;
            }
        }
        for (other, &there) in places.iter().enumerate() {
            let away = place - there;
            if other != number && away.length_squared() < APART * APART {
                // Of two in one place each goes its own way.
                let away = away.try_normalize().unwrap_or_else(|| direction_of(number));
                velocity += away * GIVES_WAY;
            }
        }
        // Going up or down a slope s covers 1/sqrt(1 + s²) of the way on the plane.
        let ahead = velocity.normalize_or_zero();
        let slope = grid.height(place + ahead) - grid.height(place);
        let step = velocity * (seconds / (1.0 + slope * slope).sqrt());
        let next = grid.step(place, place + step);
        soldier.velocity = (next - place) / seconds;
        if velocity != Vec2::ZERO && next == place {
            // A wall: another way, soon.
            soldier.leads = None;
        }
        let height = grid.height(next) + MIDDLE;
        let goal = match soldier.wish.face {
            Some(face) => face - next,
            None => soldier.velocity,
        };
        at.translation = Vec3::new(next.x, height, next.y);
        if goal.length_squared() > 1e-4 {
            let yaw = yaw_of(&at);
            let turn = ops::atan2(-goal.x, -goal.y) - yaw;
            let turn = (turn + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU)
                - std::f32::consts::PI;
            let turn = turn.clamp(-TURNS * seconds, TURNS * seconds);
            at.rotation = Quat::from_rotation_y(yaw + turn);
        }
    }
}

/// A direction of its own for each number, by turns of the golden angle.
fn direction_of(number: usize) -> Vec2 {
    let (sin, cos) = ops::sin_cos(number as f32 * 2.399_963);
    Vec2::new(cos, sin)
}

/// The turn about +y of who stands upright, radians.
pub fn yaw_of(at: &Transform) -> f32 {
    let ahead = at.rotation * Vec3::NEG_Z;
    ops::atan2(-ahead.x, -ahead.z)
}
