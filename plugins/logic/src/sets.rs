//! The order of a step.

use bevy::ecs::prelude::*;

/// Systems of logic, in `FixedUpdate`, in this order.
///
/// What an action asks for is done in the step after the one in which it was sent, except where it was sent before
/// [`LogicSystems::Act`]. Outputs become actions at the end of the step.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LogicSystems {
    /// The clock counts the step, actions whose time has come are sent, and who has to be is woken.
    Begin,
    /// What actions ask for: buttons, doors, lifts, timers, health. Before movers of `dolomite_collision` move.
    Act,
    /// Systems that were added by `add_update`.
    Update,
    /// Who sees and hears whom.
    Sense,
    /// Behaviours.
    Think,
    /// Walkers and patrols.
    Move,
    /// Zones and shots: after all that moves.
    Touch,
    /// Objectives and missions.
    Rules,
    /// Outputs become actions.
    Wire,
}
