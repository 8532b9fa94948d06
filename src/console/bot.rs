//! A hand at the figure's keys, for the command `bot`.

use bevy::prelude::*;
use dolomite::inspector::InspectorSystems;

use crate::input::PlayerInput;
use crate::input::devices::DeviceSystems;

/// What the figure is to do, and for how long.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct Bot {
    /// As in [`PlayerInput::walk`].
    pub walk: Vec2,
    /// As in [`PlayerInput::fast`].
    pub fast: bool,
    /// It leaps at once.
    pub jump: bool,
    /// Virtual seconds that are left.
    pub seconds: f32,
}

/// Moves the figure while there is a [`Bot`].
pub struct BotPlugin;

impl Plugin for BotPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            PreUpdate,
            steer
                .run_if(resource_exists::<Bot>)
                .after(DeviceSystems)
                .after(InspectorSystems),
        );
    }
}

fn steer(
    mut commands: Commands,
    time: Res<Time>,
    mut input: ResMut<PlayerInput>,
    bot: Option<ResMut<Bot>>,
) {
    let Some(mut bot) = bot else { return };
    if bot.seconds <= 0.0 {
        // Without devices nobody else would let go of the keys.
        *input = PlayerInput::default();
        commands.remove_resource::<Bot>();
        return;
    }
    *input = PlayerInput {
        walk: bot.walk,
        fast: bot.fast,
        jump: bot.jump,
        ..default()
    };
    bot.jump = false;
    bot.seconds -= time.delta_secs();
}
