//! The plugin.

use crate::action::{self, Action, Output, Wires};
use crate::behaviour;
use crate::clock::{self, LogicClock};
use crate::diagnostics;
use crate::names::Names;
use crate::need::{self, AttentionSettings};
use crate::sets::LogicSystems;
use crate::values::Logic;
use crate::{movement, parts, senses};
use bevy::app::{App, FixedUpdate, Plugin};
use bevy::ecs::prelude::*;

/// Values, actions, ready-made parts, behaviours, senses and movement, in `FixedUpdate`. Runs under `MinimalPlugins`.
///
/// May be added before or after Bevy's plugins, and more than once. Without a component of its own in the world none
/// of its systems runs.
#[derive(Clone, Copy, Debug, Default)]
pub struct LogicPlugin;

impl Plugin for LogicPlugin {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<LogicClock>() {
            return;
        }
        app.init_resource::<LogicClock>()
            .init_resource::<Names>()
            .init_resource::<AttentionSettings>()
            .init_resource::<action::DelayedActions>()
            .register_type::<AttentionSettings>()
            .register_type::<need::Asleep>()
            .register_type::<need::Focus>()
            .register_type::<Logic>()
            .register_type::<LogicClock>()
            .add_message::<Action>()
            .add_message::<Output>()
            .configure_sets(
                FixedUpdate,
                (
                    LogicSystems::Begin,
                    LogicSystems::Act,
                    LogicSystems::Update,
                    LogicSystems::Sense,
                    LogicSystems::Think,
                    LogicSystems::Move,
                    LogicSystems::Touch,
                    LogicSystems::Rules,
                    LogicSystems::Wire,
                )
                    .chain(),
            )
            .add_systems(
                FixedUpdate,
                (
                    clock::advance.run_if(any_with_component::<Logic>),
                    action::send_delayed.run_if(action::any_delayed),
                    need::wake.run_if(any_with_component::<Logic>),
                    need::pay.run_if(any_with_component::<need::Attention>.and_then(need::looks)),
                )
                    .chain()
                    .in_set(LogicSystems::Begin),
            )
            .add_systems(
                FixedUpdate,
                (
                    action::follow_wires.run_if(any_with_component::<Wires>),
                    diagnostics::count.run_if(any_with_component::<Logic>),
                )
                    .chain()
                    .in_set(LogicSystems::Wire),
            );
        diagnostics::build(app);
        parts::build(app);
        behaviour::build(app);
        senses::build(app);
        movement::build(app);
        #[cfg(feature = "collision")]
        crate::collision::build(app);
    }

    fn is_unique(&self) -> bool {
        false
    }
}
