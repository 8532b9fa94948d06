//! What is heard of the game, by `dolomite_sound`. In a window alone: without its listener nothing of it runs.
//!
//! | file | concern |
//! |---|---|
//! | [`ground`] | which step belongs to what somebody stands on |
//! | [`steps`] | steps of the figure and of soldiers |
//! | [`air`] | wind and surf |
//! | [`level`] | shots, hits, calls; lifts, the gate, latches; fires |

pub mod air;
pub mod ground;
pub mod level;
pub mod steps;

use bevy::prelude::*;
use dolomite::sound::{SoundListener, SoundSettings};

use crate::play::camera::FreeCamera;
use crate::settings::Settings;
use air::AirPlugin;
use level::LevelSoundPlugin;
use steps::StepsPlugin;

/// When sounds of the game are asked for (schedule `Update`).
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct GameSoundSystems;

/// Lets the camera hear. Add after the plugins of the game.
pub struct GameSoundPlugin;

impl Plugin for GameSoundPlugin {
    fn build(&self, app: &mut App) {
        app.configure_sets(
            Update,
            GameSoundSystems.run_if(any_with_component::<SoundListener>),
        )
        .add_plugins((AirPlugin, LevelSoundPlugin, StepsPlugin))
        .add_systems(
            Update,
            (
                hear.run_if(any_without_ears),
                follow_settings.run_if(resource_changed::<Settings>),
            )
                .before(GameSoundSystems),
        );
    }
}

/// A camera that hears nothing while sound is on, or one that hears while it is off.
fn any_without_ears(
    settings: Res<Settings>,
    deaf: Query<(), (With<FreeCamera>, Without<SoundListener>)>,
    hearing: Query<(), With<SoundListener>>,
) -> bool {
    match settings.sound {
        true => !deaf.is_empty(),
        false => !hearing.is_empty(),
    }
}

fn hear(
    mut commands: Commands,
    settings: Res<Settings>,
    cameras: Query<Entity, With<FreeCamera>>,
    hearing: Query<Entity, With<SoundListener>>,
) {
    if settings.sound {
        for camera in &cameras {
            commands.entity(camera).insert(SoundListener);
        }
    } else {
        for camera in &hearing {
            commands.entity(camera).remove::<SoundListener>();
        }
    }
}

fn follow_settings(settings: Res<Settings>, mut sound: ResMut<SoundSettings>) {
    let next = SoundSettings {
        on: settings.sound,
        volume: settings.volume,
        ..*sound
    };
    sound.set_if_neq(next);
}
