//! What goes with the last mover.

use super::bodies::Bodies;
use super::diagnostics::CollisionCounters;
use bevy::ecs::prelude::*;

/// Forgets what was known of bodies: the next mover is not pushed by what moved while there was none.
pub(super) fn forget(mut bodies: ResMut<Bodies>, mut counters: ResMut<CollisionCounters>) {
    *bodies = Bodies::default();
    *counters = CollisionCounters::default();
}
