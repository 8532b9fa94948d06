//! Leaning: into acceleration, into turns, against slopes.

use super::locomotion::Motion;
use super::spring::Spring;
use super::travel::turned;
use crate::pose::Pose;
use crate::skeleton::Skeleton;
use bevy::math::{Affine3A, Quat, Vec2, Vec3, ops};

/// How much a figure leans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeanSettings {
    /// Of the angle at which a rigid body would balance while it speeds up or slows down.
    pub acceleration: f32,
    /// Of the angle at which it would balance in a turn.
    pub turning: f32,
    /// Of the angle of the ground, forwards uphill.
    pub slope: f32,
    /// At most, radians.
    pub most: f32,
    /// Seconds that the lean lags behind.
    pub lag: f32,
}

impl Default for LeanSettings {
    fn default() -> Self {
        Self {
            acceleration: 0.35,
            turning: 0.5,
            slope: 0.35,
            most: 0.35,
            lag: 0.35,
        }
    }
}

/// A lean under way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lean {
    pitch: Spring,
    roll: Spring,
}

/// m/s².
const GRAVITY: f32 = 9.81;

impl Lean {
    /// Goes on by `dt` seconds; `acceleration` is along the way the figure looks, m/s².
    pub fn advance(
        &mut self,
        settings: &LeanSettings,
        motion: &Motion,
        acceleration: f32,
        dt: f32,
    ) {
        let balance = |a: f32| ops::atan2(a, GRAVITY);
        let centripetal = motion.speed * motion.turn_rate;
        let uphill = ops::atan2(motion.slope.y, 1.0);
        let most = |angle: f32| angle.clamp(-settings.most, settings.most);
        let pitch = settings.acceleration * balance(acceleration) + settings.slope * uphill;
        let roll = settings.turning * balance(centripetal);
        self.pitch.follow(most(pitch), settings.lag, dt);
        self.roll.follow(most(roll), settings.lag, dt);
    }

    /// Radians: forwards, and to the left.
    #[must_use]
    pub const fn angles(&self) -> Vec2 {
        Vec2::new(self.pitch.value, self.roll.value)
    }

    /// Bends the joints of `spine`, each by an equal part, about the model's axes. `model` are the matrices
    /// of `pose` and are not brought up to date.
    pub fn apply(&self, skeleton: &Skeleton, spine: &[usize], model: &[Affine3A], pose: &mut Pose) {
        let Vec2 { x: pitch, y: roll } = self.angles();
        if spine.is_empty() || pitch.abs() + roll.abs() < 1e-5 {
            return;
        }
        let share = 1.0 / spine.len() as f32;
        let bend = about(Vec3::X, pitch * share) * about(Vec3::NEG_Z, roll * share);
        for joint in spine {
            let above = skeleton
                .parent(*joint)
                .map_or(Quat::IDENTITY, |parent| rotation_of(&model[parent]));
            let local = pose.get(*joint).rotation;
            pose.set_rotation(*joint, (above.inverse() * bend * above * local).normalize());
        }
    }
}

/// The rotation in a matrix without shear.
pub(crate) fn rotation_of(matrix: &Affine3A) -> Quat {
    let unit = |axis: bevy::math::Vec3A| Vec3::from(axis).normalize_or(Vec3::ZERO);
    let [x, y, z] = [
        matrix.matrix3.x_axis,
        matrix.matrix3.y_axis,
        matrix.matrix3.z_axis,
    ]
    .map(unit);
    let rotation = Quat::from_mat3(&bevy::math::Mat3::from_cols(x, y, z));
    if rotation.is_finite() {
        rotation.normalize()
    } else {
        Quat::IDENTITY
    }
}

/// The rotation by `angle` about an axis of the model.
pub(crate) fn about(axis: Vec3, angle: f32) -> Quat {
    let about_y = turned(angle);
    Quat::from_xyzw(
        axis.x * about_y.y,
        axis.y * about_y.y,
        axis.z * about_y.y,
        about_y.w,
    )
}
