//! Motion measured from where an entity is put.

use super::CharacterMotion;
use crate::gait::{wrapped, yaw_of};
use bevy::ecs::prelude::*;
use bevy::math::Vec3;
use bevy::reflect::prelude::*;
use bevy::time::Time;
use bevy::transform::components::Transform;

/// Fills the speed and the turning of a figure's [`CharacterMotion`] from the changes of its `Transform`:
/// for figures whom something else moves. Whether it is in the air stays for gameplay to say.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[require(CharacterMotion)]
pub struct MotionFromTransform {
    last: Option<(Vec3, f32)>,
}

/// Faster than this it was not moved but put there, m/s.
const PUT: f32 = 60.0;

pub(super) fn measure(
    time: Res<Time>,
    mut figures: Query<(&Transform, &mut MotionFromTransform, &mut CharacterMotion)>,
) {
    let dt = time.delta_secs();
    if dt <= 0.0 {
        return;
    }
    for (transform, mut from, mut motion) in &mut figures {
        let (place, yaw) = (transform.translation, yaw_of(transform.rotation));
        let (last, last_yaw) = from.last.unwrap_or((place, yaw));
        from.last = Some((place, yaw));
        let way = (place - last) / dt;
        let ahead = transform.rotation * Vec3::Z;
        let ahead = Vec3::new(ahead.x, 0.0, ahead.z).normalize_or(Vec3::Z);
        let put = way.length() > PUT || !way.is_finite();
        let next = CharacterMotion(crate::gait::Motion {
            speed: if put { 0.0 } else { way.dot(ahead) },
            turn_rate: if put {
                0.0
            } else {
                wrapped(yaw - last_yaw) / dt
            },
            climb: if put { 0.0 } else { way.y },
            ..motion.0
        });
        motion.set_if_neq(next);
    }
}
