//! The order of a step.

use bevy::ecs::prelude::*;

/// Systems of logic, in `FixedUpdate`, in this order.
///
/// What an action asks for is done in the set that answers it, which is [`LogicSystems::Act`], and for objectives and
/// missions [`LogicSystems::Rules`]: in the same step where it was sent before that set, else in the next one. Outputs
/// become actions at the end of the step.
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
    /// Objectives and missions, and what actions ask of them.
    Rules,
    /// Outputs become actions.
    Wire,
}
