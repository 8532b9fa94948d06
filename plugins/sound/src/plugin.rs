//! The plugin.

use bevy::app::{App, Plugin, PostUpdate};
use bevy::ecs::message::MessageWriter;
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::schedule::common_conditions::resource_exists;
use bevy::ecs::schedule::{IntoScheduleConfigs, SystemSet};
use bevy::ecs::system::{Commands, Query, Res, ResMut};
use bevy::transform::TransformSystems;

use crate::error::SoundFault;
use crate::output::SoundOutput;
use crate::parts::{PlaySound, SoundEmitter, SoundListener};
use crate::settings::{SoundCounters, SoundSettings, SoundTarget};
use crate::sounds::Sounds;
use crate::voices::{Voices, tick};

/// What is heard. Runs under `MinimalPlugins`; places are `GlobalTransform`s, which Bevy's `TransformPlugin` computes.
///
/// May be added before or after Bevy's plugins, and more than once. Without a [`SoundListener`], and while
/// [`SoundSettings::on`] is off, no output is open, no thread runs, and of the systems only conditions are asked.
#[derive(Clone, Copy, Debug, Default)]
pub struct SoundPlugin;

/// When sound takes over the frame (schedule `PostUpdate`, after transforms are propagated).
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SoundSystems;

/// What could not be opened: it is not tried in each frame.
#[derive(Resource, Default)]
struct Given(Option<SoundTarget>);

impl Plugin for SoundPlugin {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<Voices>() {
            return;
        }
        app.init_resource::<SoundSettings>()
            .init_resource::<SoundCounters>()
            .init_resource::<Sounds>()
            .init_resource::<Voices>()
            .init_resource::<Given>()
            .register_type::<SoundSettings>()
            .register_type::<SoundCounters>()
            .register_type::<SoundListener>()
            .register_type::<SoundEmitter>()
            .add_message::<PlaySound>()
            .add_message::<SoundFault>()
            .add_systems(
                PostUpdate,
                (
                    close.run_if(has_to_close),
                    open.run_if(has_to_open),
                    tick.run_if(resource_exists::<SoundOutput>),
                )
                    .chain()
                    .in_set(SoundSystems)
                    .after(TransformSystems::Propagate),
            );
    }

    fn is_unique(&self) -> bool {
        false
    }
}

fn has_to_open(
    settings: Res<SoundSettings>,
    output: Option<Res<SoundOutput>>,
    given: Res<Given>,
    listeners: Query<(), With<SoundListener>>,
) -> bool {
    settings.on && output.is_none() && given.0 != Some(settings.target) && !listeners.is_empty()
}

fn has_to_close(
    settings: Res<SoundSettings>,
    output: Option<Res<SoundOutput>>,
    given: Res<Given>,
    listeners: Query<(), With<SoundListener>>,
) -> bool {
    match output {
        Some(output) => !settings.on || listeners.is_empty() || output.target() != settings.target,
        // Whoever switches it off and on again wants another try.
        None => !settings.on && given.0.is_some(),
    }
}

fn open(
    settings: Res<SoundSettings>,
    mut sounds: ResMut<Sounds>,
    mut given: ResMut<Given>,
    mut voices: ResMut<Voices>,
    mut counters: ResMut<SoundCounters>,
    mut faults: MessageWriter<SoundFault>,
    mut commands: Commands,
) {
    let opened = sounds
        .unpack()
        .and_then(|()| SoundOutput::open(settings.target));
    match opened {
        Ok(output) => {
            counters.opened += 1;
            commands.insert_resource(output);
        }
        Err(error) => {
            given.0 = Some(settings.target);
            voices.refuse(error, &mut faults);
        }
    }
}

fn close(
    mut given: ResMut<Given>,
    mut voices: ResMut<Voices>,
    mut commands: Commands,
    mut counters: ResMut<SoundCounters>,
) {
    given.0 = None;
    voices.clear();
    voices.forgive();
    counters.voices = 0;
    commands.remove_resource::<SoundOutput>();
}
