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
//! | [`BetweenSteps`] | you | what steps move is drawn between them |
//! | `GroundTiles`, [`MeetsMovers`] | you | ground that movers meet: the module `ground`, with the feature `terrain` |
//!
//! Steps are taken in `FixedUpdate`. Places are those of `Transform` and not of its parents: what takes part in
//! collision has none. Scale is not used: it belongs into the mesh.

mod between;
mod bodies;
mod diagnostics;
mod forget;
mod movers;
mod triggers;

pub use between::BetweenSteps;
pub use bodies::{Blocker, Collider, MeetsMovers};
#[cfg(feature = "terrain")]
pub(crate) use bodies::{Bodies, Placed, gather};
pub use diagnostics::CollisionCounters;
#[cfg(feature = "terrain")]
pub(crate) use movers::go;
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
/// May be added before or after Bevy's plugins, and more than once. Without a [`CharacterBody`], [`Trigger`] or
/// [`BetweenSteps`] in the world none of its systems runs.
#[derive(Clone, Copy, Debug, Default)]
pub struct CollisionPlugin;

impl Plugin for CollisionPlugin {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<CollisionCounters>() {
            return;
        }
        diagnostics::build(app);
        between::build(app);
        app.init_resource::<bodies::Bodies>()
            .init_resource::<triggers::Inside>()
            .add_message::<TriggerMessage>()
            .register_type::<Blocker>()
            .register_type::<CharacterBody>()
            .register_type::<CollisionCounters>()
            .register_type::<MeetsMovers>()
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
                    forget::forget.in_set(CollisionSystems::Gather).run_if(
                        not(any_with_component::<CharacterBody>).and_then(bodies::remembered),
                    ),
                    (movers::go, diagnostics::count)
                        .chain()
                        .in_set(CollisionSystems::Move)
                        .run_if(any_with_component::<CharacterBody>),
                    triggers::report
                        .in_set(CollisionSystems::Trigger)
                        .run_if(any_with_component::<Trigger>.or_else(triggers::occupied)),
                ),
            );
        #[cfg(feature = "terrain")]
        crate::ground::build(app);
    }

    fn is_unique(&self) -> bool {
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::MinimalPlugins;
    use bevy::ecs::change_detection::Tick;

    /// When the resources that the systems write were written last. Each system writes one in every run.
    fn written(app: &App) -> [Tick; 3] {
        let world = app.world();
        [
            world.resource_ref::<bodies::Bodies>().last_changed(),
            world.resource_ref::<CollisionCounters>().last_changed(),
            world.resource_ref::<triggers::Inside>().last_changed(),
        ]
    }

    #[test]
    fn no_system_runs_without_a_mover_or_a_trigger() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, CollisionPlugin));
        let begun = written(&app);
        let step = |app: &mut App| {
            app.world_mut().run_schedule(FixedUpdate);
            written(app)
        };
        for _ in 0..3 {
            assert_eq!(step(&mut app), begun);
        }
        // What movers meet is nobody's business without one.
        app.world_mut().spawn(Blocker::default());
        assert_eq!(step(&mut app), begun);
        // The counterpart: each of them is seen.
        app.world_mut().spawn(Trigger::default());
        let [bodies, counters, inside] = step(&mut app);
        assert!((bodies, counters) == (begun[0], begun[1]) && inside != begun[2]);
        app.world_mut().spawn(CharacterBody::default());
        let moved = step(&mut app);
        assert!(moved[0] != bodies && moved[1] != counters && moved[2] != inside);
    }
}
