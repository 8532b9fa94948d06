//! The player shoots, soldiers are hit and fall.

use bevy::math::ops;
use bevy::prelude::*;
use dolomite::logic::senses::{Ear, Memory, Noise, Sight};
use dolomite::logic::{Action, Health, Hitbox, Key, LogicClock, Mind, Output, Weapon};

use super::parts::{Cast, Fallen, Level, LevelState, Player, Soldier};
use crate::input::PlayerInput;
use crate::play::camera::FreeCamera;

/// A soldier who is no farther than this from where the player looks is aimed at, radians: with a stick nobody aims
/// better, and a camera behind the shoulder looks past what it is turned to.
const AIMS: f32 = 0.1;

/// Where shots begin, above the middle of a figure, metres: at the shoulder.
pub const SHOULDER: Vec3 = Vec3::new(0.0, 0.5, 0.0);

/// Chest of a figure above its middle, metres.
const CHEST: Vec3 = Vec3::new(0.0, 0.2, 0.0);

/// m/s².
const GRAVITY: f32 = 9.81;

/// How sure of where the player is who was hit by them, 0 to 1.
const HIT: f32 = 0.95;

/// Along which way a bolt of so many metres a second hits somebody `far` away who moves, with the middle of a figure at
/// `middle`: where they will be, above by what the bolt falls on its way.
pub fn lead(from: Vec3, middle: Vec3, far: f32, velocity: Vec2, bolt: f32) -> Vec3 {
    let time = far / bolt;
    let moved = Vec3::new(velocity.x, 0.0, velocity.y) * time;
    let drop = Vec3::Y * (0.5 * GRAVITY * time * time);
    middle + CHEST + moved + drop - from
}

/// A shot of the player, at the soldier that they look at or where they look.
pub(super) fn shoot(
    level: Res<Level>,
    cast: Res<Cast>,
    clock: Res<LogicClock>,
    input: Res<PlayerInput>,
    cameras: Query<&FreeCamera>,
    players: Query<(&Transform, &Health, &Weapon), With<Player>>,
    soldiers: Query<(Entity, &Soldier, &Transform), (Without<Fallen>, Without<Player>)>,
    mut actions: MessageWriter<Action>,
    mut noises: MessageWriter<Noise>,
) {
    let (true, Ok((at, health, weapon)), Some(camera), Some(file)) = (
        input.fire,
        players.get(cast.player),
        cameras.iter().next(),
        level.file.weapon,
    ) else {
        return;
    };
    let ready = clock.step >= weapon.ready && weapon.rounds != Some(0);
    if !ready || !health.is_alive() {
        return;
    }
    let from = at.translation + SHOULDER;
    let yaw = camera.pose.yaw;
    let (sin, cos) = ops::sin_cos(yaw);
    let ahead = Vec2::new(-sin, -cos);
    let aimed = soldiers
        .iter()
        .filter_map(|(entity, soldier, at)| {
            let way = at.translation - from;
            let flat = Vec2::new(way.x, way.z);
            let off = ops::atan2(ahead.perp_dot(flat), ahead.dot(flat)).abs();
            let far = way.length();
            let near = off <= AIMS && far <= file.range;
            let aim = || lead(from, at.translation, far, soldier.velocity, file.bolt);
            near.then(|| (off, entity, aim()))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let toward = match aimed {
        Some((.., toward)) => toward,
        None => camera.pose.rotation() * Vec3::NEG_Z,
    };
    actions.write(Action::new(cast.player, Key::FIRE, toward));
    noises.write(Noise {
        place: at.translation,
        range: file.noise,
        source: Some(cast.player),
    });
}

/// Who is hit knows from where; who has no health left falls.
pub(super) fn suffer(
    mut commands: Commands,
    cast: Res<Cast>,
    mut outputs: MessageReader<Output>,
    mut state: ResMut<LevelState>,
    players: Query<&Transform, With<Player>>,
    mut soldiers: Query<(&mut Soldier, &mut Memory), Without<Fallen>>,
) {
    let Ok(player) = players.get(cast.player) else {
        outputs.clear();
        return;
    };
    for output in outputs.read() {
        let Ok((mut soldier, mut memory)) = soldiers.get_mut(output.source) else {
            continue;
        };
        if output.name == Key::HURT {
            memory.note(Some(cast.player), player.translation, HIT);
            soldier.notice = 1.0;
            soldier.alarmed = true;
        }
        if output.name == Key::DIED {
            soldier.alarmed = false;
            soldier.velocity = Vec2::ZERO;
            state.fallen += 1;
            fall(&mut commands.entity(output.source));
        }
    }
}

/// A soldier falls: nothing of it is worked on any more. One that a new game ended in the same moment does not fall.
pub fn fall(soldier: &mut EntityCommands) {
    soldier
        .try_insert(Fallen)
        .try_remove::<(Mind, Sight, Ear, Memory, Weapon, Hitbox)>();
}
