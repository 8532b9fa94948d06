//! Root motion: how far a clip itself carries its figure.

use crate::clip::{Clip, Sampler};
use crate::pose::Pose;
use bevy::math::{Quat, Vec3, ops};

/// A step over the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RootDelta {
    /// Metres, in the frame that the figure had before the step; y is 0.
    pub translation: Vec3,
    /// Radians about +y.
    pub yaw: f32,
}

impl RootDelta {
    /// Both, one after the other.
    #[must_use]
    pub fn then(self, next: Self) -> Self {
        Self {
            translation: self.translation + turned(self.yaw) * next.translation,
            yaw: self.yaw + next.yaw,
        }
    }
}

/// The rotation by `yaw` about +y.
pub(crate) fn turned(yaw: f32) -> Quat {
    let (sin, cos) = ops::sin_cos(0.5 * yaw);
    Quat::from_xyzw(0.0, sin, 0.0, cos)
}

/// The turn about +y that is in a rotation (its twist), radians.
pub(crate) fn yaw_of(rotation: Quat) -> f32 {
    let yaw = 2.0 * ops::atan2(rotation.y, rotation.w);
    wrapped(yaw)
}

/// The same angle in (−π, π].
pub(crate) fn wrapped(angle: f32) -> f32 {
    use std::f32::consts::{PI, TAU};
    let angle = angle.rem_euclid(TAU);
    if angle > PI { angle - TAU } else { angle }
}

/// How joint `root`, which has to be a root, moves over the ground while `clip` plays from `from` to
/// `to` seconds (which may lie many turns apart, or backwards, if it repeats). For a `root` that the clip
/// does not have, nothing.
#[must_use]
pub fn root_delta(
    clip: &Clip,
    root: usize,
    from: f32,
    to: f32,
    repeats: bool,
    sampler: &mut Sampler,
    scratch: &mut Pose,
) -> RootDelta {
    if root >= clip.joints() || !from.is_finite() || !to.is_finite() {
        return RootDelta::default();
    }
    let mut at = |time: f32| {
        sampler.sample(clip, time, scratch);
        let joint = scratch.get(root);
        (joint.translation, yaw_of(joint.rotation))
    };
    let mut between = |a: f32, b: f32| {
        let ((from, yaw), (to, to_yaw)) = (at(a), at(b));
        let way = turned(-yaw) * (to - from);
        RootDelta {
            translation: Vec3::new(way.x, 0.0, way.z),
            yaw: wrapped(to_yaw - yaw),
        }
    };
    let length = clip.duration();
    if !repeats || length <= 0.0 {
        return between(from, to);
    }
    let turns = (to / length).floor() - (from / length).floor();
    let (a, b) = (clip.looped(from), clip.looped(to));
    if turns == 0.0 {
        return between(a, b);
    }
    let (mut step, whole) = if turns > 0.0 {
        (between(a, length), between(0.0, length))
    } else {
        (between(a, 0.0), between(length, 0.0))
    };
    // A frame is short: more than a few turns come from a jump of time, and their sum means nothing.
    for _ in 1..(turns.abs() as u32).min(16) {
        step = step.then(whole);
    }
    step.then(if turns > 0.0 {
        between(0.0, b)
    } else {
        between(length, b)
    })
}
