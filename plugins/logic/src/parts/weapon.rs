//! Weapons, and shots that sweep.
//!
//! A shot is a point that flies in a straight line within a step; gravity turns it between steps. Its way of a step is
//! cast against what the world says (`RayWorld`), and against capsules, which move in the same time. What is met first
//! stops it. So nothing is too fast to hit, and nothing is hit through a wall.

use crate::action::{Action, Output};
use crate::bodies::BodyIndex;
use crate::clock::LogicClock;
use crate::names::Key;
use crate::rays::RayWorld;
use crate::value::Value;
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::math::{DVec3, Vec3};
use bevy::reflect::prelude::*;
use bevy::transform::components::Transform;

use super::health::Team;

/// A weapon in somebody's hand. Actions: [`Key::FIRE`] along a direction or at an entity, [`Key::RELOAD`],
/// [`Key::RESET`]. Outputs: [`Key::FIRED`], [`Key::EMPTY`].
///
/// A number in it that is not finite or has no meaning means: no shot.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Logic, Transform)]
pub struct Weapon {
    /// Taken from the health of who is hit.
    pub damage: f32,
    /// Metres a second; infinite for one that hits in the same step.
    pub speed: f32,
    /// Metres that a shot flies.
    pub range: f32,
    /// Downwards, m/s²; 0 of one that hits in the same step.
    pub gravity: f32,
    /// Seconds between shots.
    pub interval: f32,
    /// Seconds until a [`Key::RELOAD`] is done.
    pub reload: f32,
    /// Rounds left; `None`: as many as one wants.
    pub rounds: Option<u32>,
    /// Rounds after a reload.
    pub most: u32,
    /// Where shots begin, from the entity's place, metres, in world axes.
    pub muzzle: Vec3,
    /// Whether shots fly through the [`Team`] of who shoots.
    pub spares_own: bool,
    /// The first step in which it shoots again.
    pub ready: u64,
}

impl Default for Weapon {
    /// A rifle: 25 of health at 400 m/s up to 300 m, 30 rounds.
    fn default() -> Self {
        Self {
            damage: 25.0,
            speed: 400.0,
            range: 300.0,
            gravity: 9.81,
            interval: 0.2,
            reload: 2.0,
            rounds: Some(30),
            most: 30,
            muzzle: Vec3::ZERO,
            spares_own: true,
            ready: 0,
        }
    }
}

impl Weapon {
    fn can_shoot(&self) -> bool {
        self.speed > 0.0
            && self.range > 0.0
            && self.range.is_finite()
            && self.gravity.is_finite()
            && self.damage.is_finite()
            && self.muzzle.is_finite()
            && self.interval.is_finite()
            && self.reload.is_finite()
    }
}

/// A shot that flies.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Clone, PartialEq)]
pub struct Shot {
    /// Who shot.
    pub shooter: Entity,
    /// Where it is.
    pub place: DVec3,
    /// Metres a second; of length 1 where `at_once`.
    pub velocity: DVec3,
    /// Whether it flies all of its range within a step.
    pub at_once: bool,
    /// Metres that it still flies.
    pub left: f64,
    /// Downwards, m/s².
    pub gravity: f64,
    /// Taken from who is hit.
    pub damage: f32,
    /// Whom it flies through.
    pub spares: Option<Team>,
}

/// Where a shot ended.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct ShotMessage {
    /// Who shot.
    pub shooter: Entity,
    /// Who was hit; `None` where something that is no body was.
    pub hit: Option<Entity>,
    /// Where.
    pub place: DVec3,
    /// When, as a part of the step.
    pub time: f64,
}

/// All shots that fly.
#[derive(Resource, Reflect, Clone, Debug, Default)]
#[reflect(Resource, Default, Clone)]
pub struct Shots(pub Vec<Shot>);

/// Whether one flies, or a weapon could shoot: a run condition.
pub(super) fn any_shot(shots: Res<Shots>) -> bool {
    !shots.0.is_empty()
}

pub(super) fn fire(
    clock: Res<LogicClock>,
    mut actions: MessageReader<Action>,
    mut weapons: Query<(&mut Weapon, &Transform, Option<&Team>)>,
    places: Query<&Transform>,
    mut shots: ResMut<Shots>,
    mut outputs: MessageWriter<Output>,
) {
    for action in actions.read() {
        let Ok((mut weapon, transform, team)) = weapons.get_mut(action.target) else {
            continue;
        };
        match action.verb {
            Key::RESET => {
                weapon.rounds = weapon.rounds.map(|_| weapon.most);
                weapon.ready = 0;
            }
            Key::RELOAD => {
                weapon.rounds = weapon.rounds.map(|_| weapon.most);
                let steps = clock.steps(weapon.reload).map_or(0, u64::from);
                weapon.ready = weapon.ready.max(clock.step + steps);
            }
            Key::FIRE if clock.step >= weapon.ready && weapon.can_shoot() => {
                let from = transform.translation + weapon.muzzle;
                let toward = match action.parameter {
                    Value::Vec3(direction) => Some(direction),
                    // A target that is gone is not shot at.
                    Value::Entity(target) => {
                        places.get(target).ok().map(|at| at.translation - from)
                    }
                    _ => None,
                };
                let Some(toward) = toward.and_then(Vec3::try_normalize) else {
                    continue;
                };
                if !from.is_finite() {
                    continue;
                }
                match &mut weapon.rounds {
                    Some(0) => {
                        outputs.write(Output::new(action.target, Key::EMPTY, ()));
                        continue;
                    }
                    Some(rounds) => *rounds -= 1,
                    None => (),
                }
                let steps = clock.steps(weapon.interval).map_or(0, u64::from);
                weapon.ready = clock.step + steps;
                let at_once = weapon.speed.is_infinite();
                let speed = if at_once { 1.0 } else { weapon.speed };
                shots.0.push(Shot {
                    shooter: action.target,
                    place: from.as_dvec3(),
                    velocity: toward.as_dvec3() * f64::from(speed),
                    at_once,
                    left: f64::from(weapon.range),
                    gravity: f64::from(weapon.gravity),
                    damage: weapon.damage,
                    spares: team.copied().filter(|_| weapon.spares_own),
                });
                outputs.write(Output::new(action.target, Key::FIRED, toward));
            }
            _ => (),
        }
    }
}

/// One step of every shot.
pub(super) fn fly(
    clock: Res<LogicClock>,
    world: Option<Res<RayWorld>>,
    bodies: Res<BodyIndex>,
    teams: Query<&Team>,
    mut shots: ResMut<Shots>,
    mut messages: MessageWriter<ShotMessage>,
    mut actions: MessageWriter<Action>,
) {
    let seconds = f64::from(clock.delta);
    let mut hits = Vec::new();
    shots.0.retain_mut(|shot| {
        let way = if shot.at_once {
            shot.velocity * shot.left
        } else {
            shot.velocity * seconds
        };
        let length = way.length();
        // The last step ends where the range does.
        let part = (shot.left / length).min(1.0);
        let way = way * part;
        if !(way.is_finite() && shot.place.is_finite()) {
            return false;
        }
        if length == 0.0 {
            // At the top of its way it stands for a step; what nothing moves is no shot.
            shot.velocity.y -= shot.gravity * seconds;
            return shot.gravity != 0.0 && !shot.at_once;
        }
        let end = shot.place + way;
        let stop = world
            .as_ref()
            .and_then(|world| world.0.cast(shot.place.as_vec3(), end.as_vec3()));
        let spared = |entity: Entity| {
            let team = teams.get(entity).ok();
            shot.spares.is_some_and(|own| team == Some(&own))
        };
        let body = bodies.cast(shot.place, way, !shot.at_once, |capsule| {
            capsule.entity == shot.shooter || spared(capsule.entity)
        });
        let wall = stop.map(|stop| f64::from(stop.time));
        let hit = match (wall, body) {
            // Where both are at once, the wall stops it.
            (Some(wall), Some((time, capsule))) if time < wall => {
                Some((time, Some(capsule.entity)))
            }
            (Some(wall), _) => Some((wall, None)),
            (None, Some((time, capsule))) => Some((time, Some(capsule.entity))),
            (None, None) => None,
        };
        if let Some((time, entity)) = hit {
            hits.push((
                ShotMessage {
                    shooter: shot.shooter,
                    hit: entity,
                    place: shot.place + way * time,
                    time: time * part,
                },
                shot.damage,
            ));
            return false;
        }
        shot.place = end;
        shot.left -= length * part;
        shot.velocity.y -= shot.gravity * seconds;
        shot.left > 0.0 && !shot.at_once
    });
    // Who is hit by two in a step is hit by the earlier one first.
    hits.sort_by(|a, b| a.0.time.total_cmp(&b.0.time));
    for (message, damage) in hits {
        if let Some(hit) = message.hit {
            actions.write(Action {
                target: hit,
                source: message.shooter,
                verb: Key::DAMAGE,
                parameter: Value::Float(damage),
            });
        }
        messages.write(message);
    }
}
