//! The bridge to Rapier: ground under its bodies, and pushes between its bodies and movers.
//!
//! | component | who writes it | what it is |
//! |---|---|---|
//! | [`GroundTiles`] | you | ground that bodies meet, as height fields where bodies are awake |
//! | [`Pusher`] | you, on a mover | it pushes bodies, and bodies do not pass through it |
//! | [`MeetsMovers`] | you, on a body | movers meet it, stand on it and are pushed by it |
//!
//! [`RapierBridgePlugin`] adds Rapier in steps of `FixedUpdate`, one step of Rapier a step of Bevy; to set Rapier up
//! in another way, add its plugin before this one, in `FixedUpdate`, and leave its world empty until a step has begun:
//! the bridge then gives it a query dispatcher that knows ground. It takes no physics hooks: they are yours. Neither a
//! system of Rapier's runs nor is there a world of its before the first `RigidBody` or [`GroundTiles`] is there.

mod bodies;
mod cells;
mod contacts;
mod counters;
mod dispatch;
mod field;
mod meet;
mod push;
mod surface;
mod surfaces;
mod tiles;

pub use crate::ground::{Diagonals, GroundTiles, TileError};
pub use crate::plugin::MeetsMovers;
pub use counters::BridgeCounters;
pub use push::Pusher;

use crate::plugin::{CollisionPlugin, CollisionSystems};
use bevy::app::{App, FixedUpdate, Plugin, PostUpdate};
use bevy::ecs::prelude::*;
use bevy::time::{Fixed, Time};
use bevy::transform::StaticTransformOptimizations;
use bevy_rapier3d::plugin::systems::sync_removals;
use bevy_rapier3d::prelude::{
    DefaultRapierContext, NoUserData, PhysicsSet, RapierBevyComponentApply, RapierConfiguration,
    RapierContextInitialization, RapierContextSimulation, RapierPhysicsPlugin,
    RapierTransformPropagateSet, RigidBody, TimestepMode,
};

/// Systems of the bridge, in `FixedUpdate`, after [`CollisionSystems`] and before Rapier's own, in this order.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RapierBridgeSystems {
    /// Rapier's world, and what movers and bodies are to each other.
    Prepare,
    /// Movers push.
    Push,
    /// Tiles come and go.
    Tiles,
}

/// Adds Rapier, and everything of this module. Runs under `MinimalPlugins`.
#[derive(Clone, Copy, Debug, Default)]
pub struct RapierBridgePlugin;

impl Plugin for RapierBridgePlugin {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<BridgeCounters>() {
            return;
        }
        app.add_plugins(CollisionPlugin);
        // Rapier's plugin leaves this, whatever its type of hooks.
        if !app
            .world()
            .contains_resource::<RapierContextInitialization>()
        {
            add_rapier(app);
        }
        counters::build(app);
        app.register_type::<Pusher>()
            .init_resource::<tiles::Tiles>()
            .init_resource::<surfaces::Surfaces>()
            .configure_sets(
                FixedUpdate,
                (
                    CollisionSystems::Trigger,
                    RapierBridgeSystems::Prepare,
                    RapierBridgeSystems::Push,
                    RapierBridgeSystems::Tiles,
                    PhysicsSet::SyncBackend,
                )
                    .chain(),
            )
            .add_systems(
                FixedUpdate,
                (
                    (
                        make_world.run_if(needs_world),
                        surfaces::teach.run_if(any_with_component::<RapierContextSimulation>),
                        meet::shape.run_if(any_with_component::<MeetsMovers>),
                        meet::forget.run_if(any_with_component::<meet::Met>),
                        push::stand_in.run_if(
                            any_with_component::<Pusher>
                                .or_else(any_with_component::<push::StandIn>),
                        ),
                    )
                        .chain()
                        .in_set(RapierBridgeSystems::Prepare),
                    push::push
                        .in_set(RapierBridgeSystems::Push)
                        .run_if(any_with_component::<Pusher>),
                    (
                        surfaces::keep,
                        tiles::change,
                        tiles::lift,
                        tiles::keep,
                        counters::publish,
                    )
                        .chain()
                        .in_set(RapierBridgeSystems::Tiles)
                        .run_if(
                            any_with_component::<GroundTiles>
                                .or_else(any_with_component::<tiles::TileOf>)
                                .or_else(surfaces::any),
                        ),
                ),
            );
    }

    fn is_unique(&self) -> bool {
        false
    }
}

/// Rapier's plugin, but for its world and the schedule: its systems run where there is a world.
fn add_rapier(app: &mut App) {
    app.add_plugins(
        RapierPhysicsPlugin::<NoUserData>::default()
            .with_custom_initialization(RapierContextInitialization::NoAutomaticRapierContext)
            .with_default_system_setup(false),
    );
    let has_world = any_with_component::<RapierContextSimulation>;
    let sets = [
        PhysicsSet::SyncBackend,
        PhysicsSet::StepSimulation,
        PhysicsSet::Writeback,
    ];
    app.configure_sets(
        FixedUpdate,
        (sets[0].clone(), sets[1].clone(), sets[2].clone()).chain(),
    )
    .configure_sets(
        FixedUpdate,
        (RapierTransformPropagateSet, RapierBevyComponentApply).in_set(PhysicsSet::SyncBackend),
    );
    for set in sets {
        app.configure_sets(FixedUpdate, set.clone().run_if(has_world));
        app.add_systems(
            FixedUpdate,
            RapierPhysicsPlugin::<NoUserData>::get_systems(set),
        );
    }
    // What is removed is forgotten at the end of a frame, which may have no step.
    app.add_systems(PostUpdate, sync_removals.run_if(has_world))
        .init_resource::<TimestepMode>()
        // Rapier propagates transforms by Bevy's systems; this is theirs, and not there without `TransformPlugin`.
        .init_resource::<StaticTransformOptimizations>();
}

/// Whether something is there that Rapier is needed for, and Rapier's world is not.
fn needs_world(
    grounds: Query<(), With<GroundTiles>>,
    bodies: Query<(), With<RigidBody>>,
    worlds: Query<(), With<RapierContextSimulation>>,
) -> bool {
    worlds.is_empty() && !(grounds.is_empty() && bodies.is_empty())
}

/// One world, and one step of it in each step of Bevy.
fn make_world(mut commands: Commands, fixed: Res<Time<Fixed>>) {
    let mut simulation = RapierContextSimulation::default();
    simulation.integration_parameters.dt = fixed.timestep().as_secs_f32();
    // Contacts whose normals are within 5° of each other are else merged, and get the normal of the first: a ball in a
    // hollow would be pushed along one that is off by so much.
    simulation.integration_parameters.contact_clustering = false;
    commands.insert_resource(TimestepMode::Fixed {
        dt: fixed.timestep().as_secs_f32(),
        substeps: 1,
    });
    commands.spawn((
        simulation,
        RapierConfiguration::new(1.0),
        DefaultRapierContext,
    ));
}
