//! Who goes where a field leads: components, settings, and what is told of a step (`walk`).

use super::flow::FlowField;
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::math::Vec2;
use bevy::reflect::prelude::*;
use std::sync::Arc;

/// One of a crowd. Its entity's `Transform`, if it has one, follows it, at the height of the ground.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Clone, PartialEq)]
#[require(Logic, Rank)]
pub struct Walker {
    /// Where it is: x and z.
    pub place: Vec2,
    /// Metres a second.
    pub velocity: Vec2,
    /// Metres.
    pub radius: f32,
    /// The speed that it wants, m/s; what is not above 0 or not finite stands.
    pub speed: f32,
    /// The field that it follows, by its number in [`FlowFields`]; one that is not there leads nowhere.
    pub field: u16,
    /// Whether nobody hindered it when it decided last: it decides half as often then.
    pub calm: bool,
}

impl Walker {
    /// A figure at a place that follows a field.
    #[must_use]
    pub const fn new(place: Vec2, field: u16) -> Self {
        Self {
            place,
            velocity: Vec2::ZERO,
            radius: 0.3,
            speed: 1.4,
            field,
            calm: false,
        }
    }

    /// Words for a hash of the state.
    pub(crate) fn bits(&self) -> [u32; 5] {
        [
            self.place.x.to_bits(),
            self.place.y.to_bits(),
            self.velocity.x.to_bits(),
            self.velocity.y.to_bits(),
            u32::from(self.field) | u32::from(self.calm) << 16,
        ]
    }
}

/// The fields of this world, by number.
#[derive(Resource, Clone, Debug, Default)]
pub struct FlowFields(pub Vec<Arc<FlowField>>);

/// How walkers avoid each other.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct WalkSettings {
    /// Steps from one decision of a walker to the next; twice as many of one whom nobody hindered.
    pub every: u32,
    /// Seconds within which two are not to meet.
    pub horizon: f32,
    /// Farthest neighbour, metres.
    pub reach: f32,
    /// Most others that are looked at for the nearest: a crowd in one place costs no more.
    pub looks: u32,
}

impl Default for WalkSettings {
    /// Every second step; 1 s; 2 m; 48.
    fn default() -> Self {
        Self {
            every: 2,
            horizon: 1.0,
            reach: 2.0,
            looks: 48,
        }
    }
}

/// What the last step of walkers did.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct WalkCounters {
    /// Walkers.
    pub walkers: u32,
    /// Walkers that decided anew.
    pub steered: u32,
    /// Bytes of arrays beside the world's.
    pub bytes: u64,
}

/// What the stages of the last step took, milliseconds.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct WalkTimes {
    /// From the world.
    pub gather: f32,
    /// The grid.
    pub sort: f32,
    /// Wishes.
    pub flow: f32,
    /// Avoidance.
    pub avoid: f32,
    /// Places, and back into the world.
    pub go: f32,
}

/// Where a walker stands in the arrays of a step.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Rank(pub(super) u32);
