//! When the sky's systems run.

use bevy::prelude::*;

/// What runs when, in the schedule `PostUpdate` before `TransformSystems::Propagate`, in this order.
/// Where there is neither a [`Sun`](crate::Sun) nor a [`Sky`](crate::Sky) nothing runs.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SkySystems {
    /// Writes [`SeenSky`](crate::SeenSky). Move [`Sun`](crate::Sun)s before.
    See,
    /// Brings lights and cameras up to date.
    Light,
    /// Spawns stars and moon or takes them away, and has them follow their cameras. Move cameras
    /// before.
    Night,
}
