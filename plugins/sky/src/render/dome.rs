//! What hangs in the sky of a camera: patches on a dome about it that goes with it.

use bevy::prelude::*;
use bevy::transform::helper::TransformHelper;

use super::dress::DrawnSky;
use crate::seen::SeenSky;

/// Radius of the dome, metres: behind all ground. Patches are not cut off at the camera's far plane.
pub(super) const DOME: f32 = 90_000.0;

/// On patches that one camera sees, and that go with it.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Dome {
    /// The camera.
    pub camera: Entity,
    /// Place seen from there, metres, in the axes of the world.
    pub offset: Vec3,
}

/// Moves domes with their cameras; a camera that rests changes nothing.
///
/// Places are f32: 10 000 km from the origin they are 1 m apart, on the dome a hundred-thousandth of a
/// radian, a hundredth of a pixel.
pub(super) fn follow(
    mut places: ParamSet<(TransformHelper, Query<(&Dome, &mut Transform)>)>,
    cameras: Query<Entity, (With<SeenSky>, With<DrawnSky>)>,
    mut eyes: Local<Vec<(Entity, Vec3)>>,
) {
    let helper = places.p0();
    eyes.clear();
    eyes.extend(cameras.iter().filter_map(|camera| {
        let eye = helper.compute_global_transform(camera).ok()?.translation();
        eye.is_finite().then_some((camera, eye))
    }));
    for (dome, mut place) in &mut places.p1() {
        let Some((_, eye)) = eyes.iter().find(|(camera, _)| *camera == dome.camera) else {
            continue;
        };
        let translation = eye + dome.offset;
        if place.translation != translation {
            place.translation = translation;
        }
    }
}
