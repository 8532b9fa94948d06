//! What a level consists of: entities and resources, plain data.

use std::sync::Arc;

use bevy::math::Vec2;
use bevy::prelude::*;
use dolomite::logic::random::Random;
use dolomite::logic::{Key, Names};

use super::file::LevelFile;
use super::town::Built;
use dolomite::logic::movement::WalkGrid;

/// From the feet of a figure to its middle, metres.
pub const MIDDLE: f32 = 0.9;

/// The level that is played.
#[derive(Resource, Clone)]
pub struct Level {
    /// The name that it is asked for by.
    pub name: &'static str,
    /// As it stands in its file.
    pub file: Arc<LevelFile>,
    /// What its soldiers do, RON.
    pub behaviour: Arc<str>,
    /// The ground of its logic; all that is open is joined.
    pub grid: Arc<WalkGrid>,
    /// What stands on it.
    pub built: Arc<Built>,
    /// What differs from game to game: where soldiers begin, and where their shots go.
    pub seed: u64,
}

/// Goes with the level.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct LevelPart;

/// Its place among those of its kind in the level's file.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Numbered(pub u32);

/// Who the player is, for logic; the figure is what they look like.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[require(LevelPart)]
pub struct Player {
    /// Seconds since the last hit.
    pub unhurt: f32,
    /// Metres walked since the last noise.
    pub stepped: f32,
    /// Metres a second downwards, while they fall.
    pub sinks: f32,
    /// They acted in the last step.
    pub acts: bool,
}

/// A beacon, or the switch of lamps: what is to be lit. Its `Lamp` says whether it burns.
#[derive(Component, Clone, Debug, PartialEq)]
#[require(LevelPart, Numbered)]
pub struct Beacon {
    /// What it is called.
    pub name: String,
    /// Seconds that a torch was held to it.
    pub kindled: f32,
}

/// What gives health back; its `PickUp` says whether it is there.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[require(LevelPart, Numbered)]
pub struct Bandage;

/// A soldier who fell: sees, hears and does nothing any more.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fallen;

/// A soldier.
#[derive(Component, Clone, Debug)]
#[require(LevelPart, Numbered)]
pub struct Soldier {
    /// The places that it walks through on patrol.
    pub round: Arc<[Vec2]>,
    /// The next of them.
    pub next: usize,
    /// How sure it is that somebody is there, 0 to 1; from 1 on it is alarmed.
    pub notice: f32,
    /// It knows that the player is there.
    pub alarmed: bool,
    /// Seconds until it calls again.
    pub calls: f32,
    /// What it wants in this step.
    pub wish: Wish,
    /// The way there: turns still to come, the last first.
    pub way: Vec<Vec2>,
    /// Where that way leads.
    pub leads: Option<Vec2>,
    /// Seconds until it thinks of another way.
    pub patience: f32,
    /// Metres a second, (x, z), of its last step.
    pub velocity: Vec2,
    /// Where shots go astray.
    pub random: Random,
}

/// What a soldier wants.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wish {
    /// To be there.
    pub goal: Option<Vec2>,
    /// Metres a second.
    pub speed: f32,
    /// To look there.
    pub face: Option<Vec2>,
}

/// The entities that rules are about.
#[derive(Resource, Clone, Copy, Debug)]
pub struct Cast {
    /// The player.
    pub player: Entity,
    /// What says whether it is won.
    pub mission: Entity,
    /// All beacons.
    pub objective: Entity,
    /// The time.
    pub timer: Entity,
    /// The hour.
    pub clock: Entity,
}

/// Names that the level looks up once.
#[derive(Resource, Clone, Copy, Debug)]
pub struct LevelKeys {
    /// An output of a beacon: it burns.
    pub kindled: Key,
    /// A value of a soldier.
    pub sees: Key,
    /// A value of a soldier.
    pub alarmed: Key,
    /// A value of the player: bandages that they took.
    pub bandages: Key,
}

impl LevelKeys {
    /// Looks them up.
    pub fn new(names: &mut Names) -> Self {
        Self {
            kindled: names.intern("kindled"),
            sees: names.intern("sees"),
            alarmed: names.intern("alarmed"),
            bandages: names.intern("bandages"),
        }
    }
}

/// Why a level ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// All beacons burn, and who had to leave has left.
    Won,
    /// The player fell.
    Fell,
    /// The time was over.
    Late,
}

/// What the level has come to.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct LevelState {
    /// Whether and why it ended.
    pub verdict: Option<Verdict>,
    /// Beacons that burn.
    pub lit: u32,
    /// Soldiers that are alarmed.
    pub alarmed: u32,
    /// The most that a soldier who is not alarmed is sure of, 0 to 1.
    pub noticed: f32,
    /// The beacon in reach that does not burn.
    pub near: Option<Entity>,
    /// The button in reach.
    pub button: Option<Entity>,
    /// The gate has been opened.
    pub open: bool,
    /// Soldiers who fell.
    pub fallen: u32,
    /// Steps since the level began.
    pub steps: u64,
    /// How much of the day's light there is, 0 to 1.
    pub light: f32,
    /// Calls of soldiers.
    pub calls: u32,
}

/// The place of a transform on the ground.
pub fn ground_of(transform: &Transform) -> Vec2 {
    Vec2::new(transform.translation.x, transform.translation.z)
}
