//! What hides and what stops shots: a trait that ground, blocks and meshes answer.

use bevy::ecs::prelude::*;
use bevy::math::Vec3;
use std::sync::Arc;

/// Where a straight way is stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// When, as a part of the way.
    pub time: f32,
    /// By what: a number that means something to who answered.
    pub blocker: u64,
}

/// Answers whether something is in the way. The same question has the same answer in any order and from any thread.
pub trait Rays: Send + Sync + 'static {
    /// What stops a way from one place to another first. Places that are not finite are stopped by nothing.
    fn cast(&self, from: Vec3, to: Vec3) -> Option<Stop>;

    /// Whether a blocker of an earlier answer stops this way too. `false` may also mean that it is not known; `true`
    /// has to be true.
    fn still_blocks(&self, blocker: u64, from: Vec3, to: Vec3) -> bool;

    /// What is in the way from one place to each of several others: anything, not what is first. Places of which
    /// something is known already are left out. Of many ways from one place some find what is near once for all.
    fn hide(&self, from: Vec3, to: &[Vec3], blockers: &mut [Option<u64>]) {
        for (to, blocker) in to.iter().zip(blockers) {
            if blocker.is_none() {
                *blocker = self.cast(from, *to).map(|stop| stop.blocker);
            }
        }
    }
}

/// What stops sight and shots in this world; without it nothing does.
#[derive(Resource, Clone)]
pub struct RayWorld(pub Arc<dyn Rays>);
