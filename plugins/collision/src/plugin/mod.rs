//! Movers, bodies, blockers and triggers in a Bevy app, with or without a renderer.
//!
//! | component | who writes it | what it is |
//! |---|---|---|
//! | [`Collider`] | you | triangles that movers meet |
//! | [`Blocker`] | you | a box that movers slide along |
//! | [`CharacterBody`] | you | the radii of a mover, and how it moves |
//! | [`MoveWish`] | you | the way of the next step; taken by it |
//! | [`MoveState`] | the plugin | where the mover is in f64, what it stands on and touched |
//! | [`Trigger`] | you | a box that reports who comes, stays and goes, by [`TriggerMessage`] |
//!
//! Steps are taken in `FixedUpdate`. Places are those of `Transform` and not of its parents: what takes part in
//! collision has none. Scale is not used: it belongs into the mesh.

mod bodies;
mod diagnostics;
mod movers;
mod triggers;

pub use bodies::{Blocker, Collider};
pub use diagnostics::CollisionCounters;
pub use movers::{CharacterBody, MoveState, MoveWish};
pub use triggers::{Trigger, TriggerKind, TriggerMessage};

use bevy::app::{App, FixedUpdate, Plugin};
use bevy::ecs::prelude::*;

/// Systems of collision, in `FixedUpdate`, in this order.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CollisionSystems {
    /// Trees of blockers, and where bodies were and are. Whoever moves a body does it before.
    Gather,
    /// Movers go where they wish. Whoever writes a [`MoveWish`] does it before.
    Move,
    /// Triggers report.
    Trigger,
}

/// Moves every [`CharacterBody`]. Runs under `MinimalPlugins`.
///
/// May be added before or after Bevy's plugins, and more than once. Without a component of its own in the world none
/// of its systems runs.
#[derive(Clone, Copy, Debug, Default)]
pub struct CollisionPlugin;

impl Plugin for CollisionPlugin {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<CollisionCounters>() {
            return;
        }
        diagnostics::build(app);
        app.init_resource::<bodies::Bodies>()
            .init_resource::<triggers::Inside>()
            .add_message::<TriggerMessage>()
            .register_type::<Blocker>()
            .register_type::<CharacterBody>()
            .register_type::<CollisionCounters>()
            .register_type::<MoveWish>()
            .register_type::<Trigger>()
            .configure_sets(
                FixedUpdate,
                (
                    CollisionSystems::Gather,
                    CollisionSystems::Move,
                    CollisionSystems::Trigger,
                )
                    .chain(),
            )
            .add_systems(
                FixedUpdate,
                (
                    (bodies::build_blockers, bodies::gather)
                        .chain()
                        .in_set(CollisionSystems::Gather)
                        .run_if(any_with_component::<CharacterBody>),
                    (movers::go, diagnostics::count)
                        .chain()
                        .in_set(CollisionSystems::Move)
                        .run_if(any_with_component::<CharacterBody>),
                    triggers::report
                        .in_set(CollisionSystems::Trigger)
                        .run_if(any_with_component::<Trigger>),
                ),
            );
    }

    fn is_unique(&self) -> bool {
        false
    }
}
