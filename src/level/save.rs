//! Saved games: what of a level cannot be made anew from its file.

mod check;

use std::f32::consts::TAU;
use std::path::{Path, PathBuf};

use bevy::math::DVec2;
use bevy::prelude::*;
use dolomite::logic::parts::{Lift, LogicTimer};
use dolomite::logic::senses::Memory;
use dolomite::logic::{
    Action, BehaviourError, DayClock, Health, Key, Lamp, Objective, PickUp, Weapon,
};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::arms::fall;
use super::begin::{begin, put_figure};
use super::lifts::RoofLift;
use super::parts::{Bandage, Beacon, Cast, Level, LevelState, MIDDLE, Numbered, Player, Soldier};
use super::sealed::{self, Kind, SealedError};
use super::town::PLATE;
use super::walk::yaw_of;
use crate::play::figure::Figure;
use check::check;

/// Saved games.
pub const SAVE: Kind = Kind {
    letters: b"SAVE",
    name: "saved game",
    version: 2,
};

/// Who stands on a plate has their feet no farther from it than this, metres: a step of the fastest lift, twice over.
const RIDES: f64 = 0.1;

/// A saved game that is not gone on with.
#[derive(Debug, Error)]
pub enum SaveError {
    /// Its file.
    #[error(transparent)]
    File(#[from] SealedError),
    /// Another level, or another edition of it.
    #[error("the saved game is of level `{saved}` with {has}; this is `{level}` with {needs}")]
    Other {
        /// Of what it is.
        saved: String,
        /// What is in it.
        has: String,
        /// What is played.
        level: String,
        /// What is in that.
        needs: String,
    },
    /// A number in it is not finite, or nobody can stand there.
    #[error("the saved game says that {0}")]
    Value(String),
    /// What soldiers do was refused.
    #[error(transparent)]
    Behaviour(#[from] BehaviourError),
    /// There is nothing to save.
    #[error("no level is being played")]
    NoLevel,
    /// There is no folder to save in.
    #[error("there is no folder for saved games: neither XDG_DATA_HOME nor HOME is set")]
    NoFolder,
}

/// A level in the middle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Saved {
    /// Which level.
    pub level: String,
    /// Its seed.
    pub seed: u64,
    /// Seconds since it began.
    pub passed: f32,
    /// The hour.
    pub hour: f32,
    /// The figure: x, z, metres, and where it looks, radians.
    pub figure: (f64, f64, f32),
    /// How high its feet are above the ground, metres: on a roof, on a lift.
    pub above: f64,
    /// Of the player.
    pub health: f32,
    /// Shots that are left, where there is a weapon.
    pub rounds: Option<u32>,
    /// Which beacons burn.
    pub beacons: Vec<bool>,
    /// Which bandages are still there.
    pub bandages: Vec<bool>,
    /// At which floor each lift is, or where it goes.
    pub lifts: Vec<usize>,
    /// Everybody on patrol.
    pub soldiers: Vec<SavedSoldier>,
}

/// A soldier.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedSoldier {
    /// x, z, metres, and where it looks, radians.
    pub place: (f32, f32, f32),
    /// The next place of its round.
    pub next: usize,
    /// How sure it is, 0 to 1.
    pub notice: f32,
    /// It is after the player.
    pub alarmed: bool,
    /// What is left of its health, a part of 1; of who fell nothing.
    pub health: f32,
}

/// What is worth saving; nothing of a level that has ended, nor of one whose player has fallen, which ends a step later.
pub fn take(world: &mut World) -> Option<Saved> {
    let cast = *world.get_resource::<Cast>()?;
    let alive = world.get::<Health>(cast.player)?.is_alive();
    if !alive || world.resource::<LevelState>().verdict.is_some() {
        return None;
    }
    let level = world.resource::<Level>().clone();
    let figure = world.query::<&Figure>().iter(world).next()?.now;
    let lifts = in_order::<RoofLift, Lift>(world);
    // Who rides is where the lift goes.
    let place = figure.place.as_vec2();
    let rides = level
        .built
        .roofs
        .iter()
        .flatten()
        .zip(&lifts)
        .find(|(roof, (_, lift))| {
            let feet = f64::from(level.grid.height(place)) + figure.jump.lift();
            let plate = f64::from(lift.height() + PLATE.y);
            roof.on_plate(place) && (feet - plate).abs() < RIDES
        });
    let above = match rides {
        Some((roof, (_, lift))) => {
            f64::from(roof.floors[lift.floor().min(1)] - level.grid.height(place))
        }
        None => figure.jump.lift(),
    };
    Some(Saved {
        level: level.name.to_owned(),
        seed: level.seed,
        passed: world.get::<LogicTimer>(cast.timer)?.passed,
        hour: world.get::<DayClock>(cast.clock)?.hour,
        // Who turns about often enough has turned farther than a saved game may say.
        figure: (figure.place.x, figure.place.y, figure.yaw.rem_euclid(TAU)),
        above,
        health: world.get::<Health>(cast.player)?.now,
        rounds: world
            .get::<Weapon>(cast.player)
            .and_then(|weapon| weapon.rounds),
        beacons: in_order::<Beacon, Lamp>(world)
            .iter()
            .map(|(_, lamp)| lamp.lit)
            .collect(),
        bandages: in_order::<Bandage, PickUp>(world)
            .iter()
            .map(|(_, one)| one.there)
            .collect(),
        lifts: lifts.iter().map(|(_, lift)| lift.floor()).collect(),
        soldiers: in_order::<Soldier, Transform>(world)
            .iter()
            .filter_map(|(entity, at)| {
                let soldier = world.get::<Soldier>(*entity)?;
                Some(SavedSoldier {
                    place: (at.translation.x, at.translation.z, yaw_of(at)),
                    next: soldier.next,
                    notice: soldier.notice,
                    alarmed: soldier.alarmed,
                    health: world.get::<Health>(*entity).map_or(1.0, Health::part),
                })
            })
            .collect(),
    })
}

/// A component of all entities that have another, in the order in which they stand in the level's file. Numbers of
/// entities are no order: those of who is gone are given out again.
fn in_order<A: Component, B: Component + Clone>(world: &mut World) -> Vec<(Entity, B)> {
    let mut query = world.query_filtered::<(&Numbered, Entity, &B), With<A>>();
    let all = query.iter(world).map(|(n, e, b)| (*n, e, b.clone()));
    let mut all: Vec<_> = all.collect();
    all.sort_by_key(|(number, ..)| *number);
    all.into_iter().map(|(_, e, b)| (e, b)).collect()
}

/// Goes on with a saved game.
///
/// # Errors
/// [`SaveError`]; what is being played stays as it is then.
pub fn put(world: &mut World, saved: &Saved) -> Result<(), SaveError> {
    let level = world
        .get_resource::<Level>()
        .ok_or(SaveError::NoLevel)?
        .clone();
    check(saved, &level)?;
    let old = level.seed;
    world.resource_mut::<Level>().seed = saved.seed;
    if let Err(error) = begin(world) {
        world.resource_mut::<Level>().seed = old;
        return Err(error.into());
    }
    let cast = *world.resource::<Cast>();
    if let Some(mut timer) = world.get_mut::<LogicTimer>(cast.timer) {
        timer.passed = saved.passed;
    }
    if let Some(mut clock) = world.get_mut::<DayClock>(cast.clock) {
        clock.hour = saved.hour;
    }
    if let Some(mut health) = world.get_mut::<Health>(cast.player) {
        health.now = saved.health;
    }
    let mut lit = 0_u32;
    for ((beacon, _), &burns) in in_order::<Beacon, Lamp>(world).iter().zip(&saved.beacons) {
        if let Some(mut lamp) = world.get_mut::<Lamp>(*beacon) {
            lamp.lit = burns;
            lit += u32::from(burns);
        }
    }
    if let Some(mut objective) = world.get_mut::<Objective>(cast.objective) {
        objective.have = lit as i32;
        // What is done is said once more: the gate opens.
        let done = objective.have >= objective.need;
        if done {
            world.write_message(Action::new(cast.objective, Key::PROGRESS, 0));
        }
    }
    if let Some(mut weapon) = world.get_mut::<Weapon>(cast.player)
        && saved.rounds.is_some()
    {
        weapon.rounds = saved.rounds;
    }
    for ((entity, lift), &floor) in in_order::<RoofLift, Lift>(world).iter().zip(&saved.lifts) {
        // Checked above.
        if let Ok(lift) = lift.clone().at_floor(floor) {
            let mut entity = world.entity_mut(*entity);
            if let Some(mut at) = entity.get_mut::<Transform>() {
                at.translation.y = lift.height();
            }
            entity.insert(lift);
        }
    }
    for ((bandage, _), &there) in in_order::<Bandage, PickUp>(world)
        .iter()
        .zip(&saved.bandages)
    {
        if let Some(mut bandage) = world.get_mut::<PickUp>(*bandage) {
            bandage.there = there;
        }
    }
    let (x, z, yaw) = saved.figure;
    // A finger's breadth higher than it was, so that it lands on what it stood on.
    let above = match saved.above > 0.0 {
        true => saved.above + 0.02,
        false => 0.0,
    };
    put_figure(world, DVec2::new(x, z), yaw, above);
    let there = Vec2::new(x as f32, z as f32);
    let height = level.grid.height(there) + above as f32 + MIDDLE;
    let player = Vec3::new(there.x, height, there.y);
    if let Some(mut at) = world.get_mut::<Transform>(cast.player) {
        at.translation = player;
    }
    let soldiers = in_order::<Soldier, Transform>(world);
    let mut fallen = 0;
    for (&(id, _), saved) in soldiers.iter().zip(&saved.soldiers) {
        let (x, z, yaw) = saved.place;
        let place = Vec2::new(x, z);
        let place = level.grid.nearest_open(place, 4).unwrap_or(place);
        let height = level.grid.height(place) + MIDDLE;
        let at =
            Transform::from_xyz(place.x, height, place.y).with_rotation(Quat::from_rotation_y(yaw));
        let mut entity = world.entity_mut(id);
        entity.insert(at);
        if let Some(mut soldier) = entity.get_mut::<Soldier>() {
            soldier.next = saved.next;
            soldier.notice = saved.notice;
            soldier.alarmed = saved.alarmed;
        }
        if saved.alarmed
            && let Some(mut memory) = entity.get_mut::<Memory>()
        {
            memory.note(Some(cast.player), player, 1.0);
        }
        let Some(mut health) = entity.get_mut::<Health>() else {
            continue;
        };
        health.now = saved.health * health.most;
        if !health.is_alive() {
            fallen += 1;
            fall(&mut world.commands().entity(id));
        }
    }
    world.flush();
    let mut state = world.resource_mut::<LevelState>();
    (state.fallen, state.lit) = (fallen, lit);
    if let Some(mut player) = world.get_mut::<Player>(cast.player) {
        *player = Player::default();
    }
    Ok(())
}

/// Where the saved game of a level lies.
///
/// # Errors
/// [`SaveError::NoFolder`].
pub fn path(level: &str) -> Result<PathBuf, SaveError> {
    let data = std::env::var_os("XDG_DATA_HOME")
        .filter(|value| !value.is_empty())
        .map(PathBuf::from)
        .or_else(|| std::env::var_os("HOME").map(|home| PathBuf::from(home).join(".local/share")))
        .ok_or(SaveError::NoFolder)?;
    Ok(data.join("dolomite/saves").join(format!("{level}.save")))
}

/// Writes a saved game.
///
/// # Errors
/// [`SaveError::File`]; the last whole one stands.
pub fn write(path: &Path, saved: &Saved) -> Result<(), SaveError> {
    let text = serde_json::to_vec(saved).map_err(|error| content(path, &error))?;
    Ok(sealed::write(SAVE, path, &text)?)
}

/// Reads a saved game; where it is damaged the one before it, and what is wrong with the newer one.
///
/// # Errors
/// [`SaveError::File`] where neither is whole.
pub fn read(path: &Path) -> Result<(Saved, Option<SealedError>), SaveError> {
    let (bytes, error) = sealed::read_last(SAVE, path)?;
    let saved = serde_json::from_slice(&bytes).map_err(|error| content(path, &error))?;
    Ok((saved, error))
}

fn content(path: &Path, error: &serde_json::Error) -> SealedError {
    SealedError::Content {
        path: path.to_owned(),
        reason: error.to_string(),
    }
}
