//! Where a camera stands and looks.
//!
//! Position in f64. Yaw 0 looks north (−z) and grows to the left, pitch grows upwards.

use bevy::math::{DVec2, DVec3, EulerRot, Quat, Vec2, ops};
use dolomite::terrain::Ground;

/// Furthest that the view tips up or down, radians: 89 degrees, so that "up" stays defined.
pub const PITCH_LIMIT: f32 = 89.0 * std::f32::consts::PI / 180.0;

/// Least height of the camera above ground and sea, metres.
pub const CLEARANCE: f64 = 1.0;

/// Where [`Pose::behind`] stands: metres back, metres above the ground under the figure, and the
/// pitch, radians. A figure of 1.8 m then fills a fifth of the height of the default view, at its
/// lower edge, and leaves the rest to the mountain.
const BEHIND: f64 = 9.0;
const OVER: f64 = 2.4;
const LOOKING_UP: f32 = 9.0 * std::f32::consts::PI / 180.0;

/// Where a camera stands and looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// World position, metres.
    pub position: DVec3,
    /// Turn about +y, radians; 0 looks to −z, a quarter turn to −x.
    pub yaw: f32,
    /// Tip upwards, radians, −[`PITCH_LIMIT`] to [`PITCH_LIMIT`].
    pub pitch: f32,
}

impl Pose {
    /// The rotation of the camera.
    pub fn rotation(&self) -> Quat {
        Quat::from_euler(EulerRot::YXZ, self.yaw, self.pitch, 0.0)
    }

    /// A pose at `position` that looks at `target`.
    pub fn looking_at(position: DVec3, target: DVec3) -> Self {
        let to = (target - position).as_vec3();
        let level = Vec2::new(to.x, to.z).length();
        Self {
            position,
            yaw: ops::atan2(-to.x, -to.z),
            pitch: ops::atan2(to.y, level).clamp(-PITCH_LIMIT, PITCH_LIMIT),
        }
    }

    /// A pose behind someone who stands at `place` (x, z) and looks along `yaw` (radians), so that
    /// they and what lies ahead of them are in the picture.
    pub fn behind(place: DVec2, yaw: f32, ground: &impl Ground) -> Self {
        let (sin, cos) = ops::sin_cos(yaw);
        let back = DVec2::new(f64::from(sin), f64::from(cos)) * BEHIND;
        let at = place + back;
        Self {
            position: DVec3::new(at.x, ground.height(place) + OVER, at.y),
            yaw,
            pitch: LOOKING_UP,
        }
    }

    /// The same pose, lifted where it must be so that it is [`CLEARANCE`] above ground and sea.
    pub fn above(mut self, ground: &impl Ground, sea: Option<f32>) -> Self {
        let floor = ground
            .height(DVec2::new(self.position.x, self.position.z))
            .max(sea.map_or(f64::NEG_INFINITY, f64::from));
        self.position.y = self.position.y.max(floor + CLEARANCE);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::Vec3;

    #[test]
    fn from_behind_the_figure_is_ahead_and_below_the_middle() {
        struct Flat;
        impl Ground for Flat {
            fn sample(&self, _: DVec2) -> dolomite::terrain::GroundSample {
                dolomite::terrain::GroundSample {
                    height: 7.0,
                    ..Default::default()
                }
            }
        }
        let place = DVec2::new(100.0, -50.0);
        for yaw in [0.0, 1.0, 3.0, 5.0] {
            let pose = Pose::behind(place, yaw, &Flat);
            let middle = DVec3::new(place.x, 7.0 + 0.9, place.y);
            let seen = pose.rotation().inverse() * (middle - pose.position).as_vec3();
            assert!(seen.x.abs() < 1e-4 && seen.z < -8.0, "{seen}");
            // Below the middle, and within the lower half of the default view of 55 degrees.
            let down = -seen.y / -seen.z;
            assert!(down > 0.0 && down < 0.52, "{seen}");
        }
    }

    #[test]
    fn looking_at_a_point_points_there() {
        let from = DVec3::new(10.0, 20.0, 30.0);
        for to in [
            DVec3::new(-50.0, 0.0, 10.0),
            DVec3::new(60.0, 90.0, 31.0),
            DVec3::new(10.0, 20.0, 200.0),
        ] {
            let pose = Pose::looking_at(from, to);
            let ahead = pose.rotation() * Vec3::NEG_Z;
            let wanted = (to - from).as_vec3().normalize();
            // Two f32 rotations and two arc tangents: a few units in the last place.
            assert!(ahead.distance(wanted) < 1e-5, "{ahead} {wanted}");
        }
    }
}
