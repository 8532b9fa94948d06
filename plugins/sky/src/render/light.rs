//! The light that casts shadows: the sun's by day, the moon's by night.

use bevy::light::DirectionalLight;
use bevy::prelude::*;

use crate::components::{Sky, Sun};
use crate::heavens::Heavens;
use crate::seen::SeenSky;

/// Direction, colour and illuminance of each sun's light, by its place and by the dust of the sky.
pub(super) fn light(
    mut suns: Query<(Ref<Sun>, &mut Transform, &mut DirectionalLight)>,
    skies: Query<(Entity, Ref<SeenSky>)>,
) {
    let first = skies.iter().min_by_key(|(camera, _)| camera.index_u32());
    let sky_changed = first.as_ref().is_some_and(|(_, seen)| seen.is_changed());
    let sky = first.map_or_else(Sky::default, |(_, seen)| seen.sky);
    for (sun, mut place, mut light) in &mut suns {
        if !(sky_changed || sun.is_changed()) {
            continue;
        }
        let Some(towards) = sun.towards() else {
            continue;
        };
        let key = Heavens::new(towards, &sky).key();
        let brightest = key.illuminance.max_element().max(1e-6);
        let colour = key.illuminance / brightest;
        place.rotation = Transform::default()
            .looking_to(-key.towards, Vec3::Y)
            .rotation;
        light.illuminance = brightest;
        light.color = Color::linear_rgb(colour.x, colour.y, colour.z);
    }
}
