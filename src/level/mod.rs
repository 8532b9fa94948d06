//! Levels: what turns a scene into a game that is won or lost. Needs no renderer.
//!
//! | file | concern |
//! |---|---|
//! | [`mod@file`], [`quarter`], [`load`], [`mod@error`] | a level in its file; against its ground; what is wrong with it |
//! | [`ground`], [`town`] | the ground that logic knows; houses, roofs and walls on it |
//! | [`words`] | what is said of a level |
//! | [`parts`], [`begin`] | entities and resources; how they begin |
//! | `player`, `day`, `soldier`, `walk`, `arms`, `verdict` | what happens in a step |
//! | [`lifts`], [`gate`] | the ways up to roofs; the way out |
//! | [`menu`] | the menu, without its looks |
//! | [`sealed`], [`save`] | files that are whole or refused; saved games |
//!
//! A level runs at 60 steps a second in `FixedUpdate`, on parts of `dolomite_logic`: health, weapons, zones,
//! objectives, senses, behaviours. The player is the [`Figure`](crate::play::figure::Figure), moved by
//! [`PlayerInput`](crate::input::PlayerInput) alone.

pub mod arms;
pub mod begin;
pub mod day;
pub mod error;
pub mod file;
pub mod gate;
pub mod ground;
pub mod lifts;
pub mod load;
pub mod menu;
pub mod parts;
mod player;
pub mod quarter;
pub mod save;
pub mod sealed;
mod soldier;
pub mod town;
mod verdict;
mod walk;
pub mod words;

use bevy::prelude::*;
use dolomite::logic::{BehaviourAppExt, LogicSystems};

pub use error::LevelError;
pub use parts::{Level, LevelState, Verdict};
pub use walk::yaw_of;

use crate::play::figure::FigureSystems;
use parts::{Cast, Soldier};

/// Steps a second of a level.
pub const STEPS: f64 = 60.0;

/// When a level begins (schedule `Startup`).
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LevelSystems {
    /// Its entities are made.
    Begin,
}

/// Plays the resource [`Level`]. Add after the simulation and `LogicPlugin`.
pub struct LevelPlugin;

impl Plugin for LevelPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(Time::<Fixed>::from_hz(STEPS))
            .add_leaf("walk_on", soldier::walk_on)
            .add_leaf("look_about", soldier::look_about)
            .add_leaf("stare", soldier::stare)
            .add_leaf("go_there", soldier::go_there)
            .add_leaf("fight", soldier::fight)
            .add_systems(Startup, begin_level.in_set(LevelSystems::Begin))
            .add_systems(
                FixedUpdate,
                (
                    player::follow
                        .after(FigureSystems)
                        .before(LogicSystems::Begin),
                    (player::mend, day::shine, player::kindle)
                        .chain()
                        .in_set(LogicSystems::Update),
                    (lifts::carry, lifts::press)
                        .chain()
                        .run_if(any_with_component::<lifts::Panel>)
                        .after(player::kindle)
                        .in_set(LogicSystems::Update),
                    (arms::suffer, arms::shoot)
                        .chain()
                        .run_if(has_weapon)
                        .after(lifts::press)
                        .in_set(LogicSystems::Update),
                    gate::unbar
                        .run_if(any_with_component::<gate::Beyond>)
                        .after(LogicSystems::Rules)
                        .before(LogicSystems::Wire),
                    soldier::notice
                        .after(LogicSystems::Sense)
                        .before(LogicSystems::Think),
                    walk::walk
                        .run_if(any_with_component::<Soldier>)
                        .in_set(LogicSystems::Move),
                    verdict::judge.after(LogicSystems::Wire),
                )
                    .run_if(resource_exists::<Cast>),
            );
    }
}

/// Whether the player of this level has a weapon.
fn has_weapon(level: Res<Level>) -> bool {
    level.file.weapon.is_some()
}

fn begin_level(world: &mut World) {
    if let Err(error) = begin::begin(world) {
        error!("the level cannot begin: {error}");
        world.write_message(AppExit::error());
    }
}
