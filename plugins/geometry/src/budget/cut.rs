//! When a camera's view is another one than a frame ago.

use bevy::prelude::*;

/// A camera that moved farther than this in one frame was put elsewhere, metres: an aircraft at the
/// speed of sound makes 12 m in a frame of a slow display (30 Hz).
const CUT_METRES: f32 = 25.0;
/// Cosine of the turn in one frame that counts as a cut: 40 degrees, 1200 degrees a second at 30 Hz.
const CUT_TURN: f32 = 0.766;

/// Whether a camera was put elsewhere between two frames. Poses that are not finite are no cut.
pub(super) fn is_cut(before: &GlobalTransform, now: &GlobalTransform) -> bool {
    let moved = before.translation().distance(now.translation());
    let turned = before.forward().dot(*now.forward());
    moved > CUT_METRES || turned < CUT_TURN
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_that_is_put_elsewhere_is_cut() {
        let at = |x: f32, yaw: f32| {
            GlobalTransform::from(
                Transform::from_xyz(x, 0.0, 0.0).with_rotation(Quat::from_rotation_y(yaw)),
            )
        };
        assert!(!is_cut(&at(0.0, 0.0), &at(12.0, 0.3)));
        assert!(is_cut(&at(0.0, 0.0), &at(500.0, 0.0)));
        assert!(is_cut(&at(0.0, 0.0), &at(0.0, 1.5)));
        assert!(!is_cut(&at(f32::NAN, 0.0), &at(0.0, 0.0)));
    }
}
