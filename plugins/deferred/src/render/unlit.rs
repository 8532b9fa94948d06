//! Lights that Bevy's pass has and ours has not: named once, never dropped in silence.

use bevy::light::{DirectionalLightTexture, PointLightTexture, RectLight, SpotLightTexture};
use bevy::log::warn_once;
use bevy::prelude::*;

type Textured = Or<(
    Added<PointLightTexture>,
    Added<SpotLightTexture>,
    Added<DirectionalLightTexture>,
)>;

/// Runs while a camera is lit by us.
pub fn tell(rects: Query<(), Added<RectLight>>, textured: Query<(), Textured>) {
    if !rects.is_empty() {
        warn_once!(
            "a RectLight is not drawn by cameras with DeferredLighting: use point or spot lights, or a camera without it"
        );
    }
    if !textured.is_empty() {
        warn_once!(
            "the texture of a light is left out by cameras with DeferredLighting: the light shines without it"
        );
    }
}
