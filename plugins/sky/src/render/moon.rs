//! The disc of the moon: a sphere of triangle patches behind the ground, with seas and craters made
//! by its material. Full, and opposite to the sun; by day there is none.

use bevy::math::{Vec4, ops};
use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, ShaderType};
use dolomite_tessellation::render::{PatchKind, PatchPool, PatchShader};
use dolomite_tessellation::{PatchLayout, PatchMesh, shapes};

use super::dome::DOME;
use super::dress::DrawnSky;
use super::night::{Hung, NightKind};
use crate::seen::SeenSky;

/// Its true radius in the sky, radians: a quarter of a degree.
const RADIUS: f32 = 0.004_363_5;

/// Luminance of its bright highlands outside the air, cd/m².
const LUMINANCE: f32 = 5_000.0;

/// Greatest luminance in the picture, exposed. The true one would be four thousand times white at
/// night: eyes and films that see the ground see nothing in it. This leaves it white, and its seas
/// grey.
const SHOWN: f32 = 3.0;

/// The kind of patches that the moon is.
#[derive(Resource, AsBindGroup, Clone, Default, PartialEq)]
pub struct Moon {
    #[uniform(0)]
    light: MoonLight,
    #[texture(1, dimension = "cube")]
    #[sampler(2)]
    sky: Option<Handle<Image>>,
}

/// Laid out as `MoonLight` in `moon.wgsl`.
#[derive(ShaderType, Clone, Copy, Default, PartialEq)]
struct MoonLight {
    /// Exposed luminance of the highlands; w: exposed luminance of 1 in the map of the sky.
    shine: Vec4,
}

impl PatchKind for Moon {
    const LAYOUT: PatchLayout = PatchLayout::TRIANGLE;
    const CUSTOM_MATERIAL: bool = true;
    const SHADOWS: bool = false;
    const UV_RANGE: f32 = 2.0;

    fn shader() -> PatchShader {
        PatchShader::Library("dolomite::sky::moon")
    }

    fn pool(&self) -> PatchPool {
        PatchPool::bytes(1 << 20)
    }
}

impl NightKind for Moon {
    const NAME: &'static str = "the moon";

    fn of(seen: &SeenSky, drawn: &DrawnSky) -> Option<Self> {
        seen.heavens
            .towards_moon()
            .filter(|_| seen.sky.moon_size > 0.0)?;
        let shine = shown(seen.heavens.through_air_to_moon(), drawn.exposure);
        Some(Self {
            light: MoonLight {
                shine: shine.extend(drawn.exposure * drawn.scale),
            },
            sky: Some(drawn.map.clone()),
        })
    }

    fn hung(seen: &SeenSky) -> Hung {
        // It stands opposite to the sun.
        let towards = -seen.heavens.towards_sun;
        Hung {
            offset: towards * DOME,
            // Its front, +z, looks back; its north is up.
            rotation: Transform::default().looking_to(towards, Vec3::Y).rotation,
            scale: DOME * (RADIUS * seen.sky.moon_size),
        }
    }

    fn mesh() -> Option<PatchMesh> {
        Some(shapes::octahedron(2))
    }
}

/// Exposed luminance of the highlands through air that passes so much: what it is while that is
/// little, and never more than [`SHOWN`].
fn shown(passed: Vec3, exposure: f32) -> Vec3 {
    let true_one = passed * (LUMINANCE * exposure);
    let most = true_one.max_element().max(1e-9);
    true_one * (SHOWN * (1.0 - ops::exp(-most / SHOWN)) / most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::twilight::{self, DAY_EV100, NIGHT_EV100};

    #[test]
    fn it_is_pale_at_sunset_and_white_at_night_and_red_near_the_horizon() {
        let exposed =
            |elevation| twilight::exposure(twilight::ev100(elevation, DAY_EV100, NIGHT_EV100));
        let clear = Vec3::new(0.9, 0.85, 0.7);
        let night = shown(clear, exposed(-30.0));
        assert!(
            night.max_element() <= SHOWN && night.y > 0.9 * SHOWN * 0.85,
            "{night}"
        );
        let dusk = shown(clear * 0.1, exposed(-1.0));
        assert!((0.05..1.0).contains(&dusk.y), "{dusk}");
        let low = shown(Vec3::new(0.3, 0.1, 0.02), exposed(-30.0));
        assert!(low.x > 2.9 * low.y, "{low}");
    }
}
