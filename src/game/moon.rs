//! The disc of the moon: a sphere of triangle patches behind the ground, with seas and craters made
//! by its material. Full, and opposite to the sun; by day there is none.

use std::sync::Arc;

use bevy::math::{Vec4, ops};
use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, ShaderType};
use dolomite::tessellation::render::{PatchKind, PatchPlugin, PatchPool, PatchShader};
use dolomite::tessellation::{PatchLayout, Patches, shapes};

use super::camera::FreeCamera;
use super::sky::{SeenSky, SkySystems};
use super::stars::{DOME, Dome, dome};

/// Its radius in the sky, radians: half a degree, twice what it is, as paintings have it. At its
/// own half degree it would fill six pixels of 720.
const RADIUS: f32 = 0.008_727;

/// Luminance of its bright highlands outside the air, cd/m².
const LUMINANCE: f32 = 5_000.0;

/// Greatest luminance in the picture, exposed. The true one would be four thousand times white at
/// night: eyes and films that see the ground see nothing in it. This leaves it white, and its seas
/// grey.
const SHOWN: f32 = 3.0;

/// The kind of patches that the moon is.
#[derive(Resource, AsBindGroup, Clone, Default)]
pub struct Moon {
    #[uniform(0)]
    light: MoonLight,
    #[texture(1, dimension = "cube")]
    #[sampler(2)]
    sky: Option<Handle<Image>>,
}

/// Laid out as `MoonLight` in `moon.wgsl`.
#[derive(ShaderType, Clone, Copy, Default)]
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
        PatchShader::File("shaders/moon.wgsl")
    }

    fn pool(&self) -> PatchPool {
        PatchPool::bytes(1 << 20)
    }
}

/// The moon where and while it is up.
pub struct MoonPlugin;

impl Plugin for MoonPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(PatchPlugin(Moon::default())).add_systems(
            Update,
            rise.run_if(resource_exists_and_changed::<SeenSky>)
                .after(SkySystems),
        );
    }
}

/// Spawns, moves or removes the moon, and gives it its light.
fn rise(
    mut commands: Commands,
    sky: Res<SeenSky>,
    mut kind: ResMut<Moon>,
    moons: Query<Entity, With<Patches<Moon>>>,
    cameras: Query<&Transform, (With<FreeCamera>, Without<Dome>)>,
) {
    for entity in &moons {
        commands.entity(entity).despawn();
    }
    let Some(towards) = sky.heavens.towards_moon() else {
        return;
    };
    let seen = shown(sky.heavens.through_air_to_moon(), sky.exposure);
    *kind = Moon {
        light: MoonLight {
            shine: seen.extend(sky.exposure * sky.scale),
        },
        sky: Some(sky.map.clone()),
    };
    let patches = Patches::<Moon>::new(Arc::new(shapes::octahedron(2)));
    // Its front, +z, looks back; its north is up.
    let turned = Transform::default().looking_to(towards, Vec3::Y).rotation;
    let (offset, radius) = (towards * DOME, DOME * RADIUS);
    commands.spawn(dome(&cameras, offset, radius, turned, patches));
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
    use crate::game::twilight;

    #[test]
    fn it_is_pale_at_sunset_and_white_at_night_and_red_near_the_horizon() {
        let exposed = |elevation| twilight::exposure(twilight::ev100(elevation));
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
