//! Masks: a weight for every joint.

use crate::pose::{LANES, Lane};
use crate::skeleton::Skeleton;

/// A weight for every joint, at least 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mask {
    joints: usize,
    lanes: Vec<Lane>,
}

impl Mask {
    /// The same weight for all joints.
    #[must_use]
    pub fn uniform(joints: usize, weight: f32) -> Self {
        Self {
            joints,
            lanes: vec![[valid(weight); LANES]; joints.div_ceil(LANES)],
        }
    }

    /// 1 for `top` and all joints that hang from it, 0 for the others: a branch, such as the upper body.
    ///
    /// # Panics
    /// If there is no such joint.
    #[must_use]
    pub fn branch(skeleton: &Skeleton, top: usize) -> Self {
        let mut mask = Self::uniform(skeleton.len(), 0.0);
        for joint in 0..skeleton.len() {
            if skeleton.is_below(joint, top) {
                mask.set(joint, 1.0);
            }
        }
        mask
    }

    /// 1 − weight for every joint: what a full layer under this one keeps.
    #[must_use]
    pub fn inverted(&self) -> Self {
        let inverted = |lane: &Lane| lane.map(|weight| (1.0 - weight).max(0.0));
        Self {
            joints: self.joints,
            lanes: self.lanes.iter().map(inverted).collect(),
        }
    }

    /// Sets the weight of one joint; what is negative or no number becomes 0.
    ///
    /// # Panics
    /// If there is no such joint.
    pub fn set(&mut self, joint: usize, weight: f32) {
        assert!(joint < self.joints, "joint {joint} of {}", self.joints);
        self.lanes[joint / LANES][joint % LANES] = valid(weight);
    }

    /// The weight of one joint.
    ///
    /// # Panics
    /// If there is no such joint.
    #[must_use]
    pub fn get(&self, joint: usize) -> f32 {
        assert!(joint < self.joints, "joint {joint} of {}", self.joints);
        self.lanes[joint / LANES][joint % LANES]
    }

    /// Number of joints.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.joints
    }

    /// Whether there are no joints.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.joints == 0
    }

    pub(crate) fn lanes(&self) -> &[Lane] {
        &self.lanes
    }
}

fn valid(weight: f32) -> f32 {
    if weight.is_finite() {
        weight.max(0.0)
    } else {
        0.0
    }
}
