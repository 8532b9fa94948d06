//! What a camera with a sky gets: exposure, sky box, light of the sky, haze.

use bevy::camera::Exposure;
use bevy::light::{AmbientLight, EnvironmentMapLight, Skybox};
use bevy::pbr::{DistanceFog, FogFalloff};
use bevy::prelude::*;

use super::store::MapStore;
use crate::components::Sky;
use crate::haze::Haze;
use crate::seen::SeenSky;
use crate::twilight;

/// How fast the glow of the haze falls off about the sun.
const GLOW_EXPONENT: f32 = 12.0;

/// The sky of a camera as it is drawn, for what is drawn before it.
#[derive(Component, Clone, Debug, PartialEq)]
pub struct DrawnSky {
    /// The cube map that is seen. Left-handed, as Bevy's: −z is north's.
    pub map: Handle<Image>,
    /// Luminance of 1 in it, cd/m².
    pub scale: f32,
    /// Factor from cd/m² to what the picture holds.
    pub exposure: f32,
}

/// Brings the cameras up to date whose sky, or whose own exposure, changed; the maps when they are
/// there.
pub(super) fn dress(
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    mut store: ResMut<MapStore>,
    cameras: Query<(Entity, Ref<SeenSky>, Option<&Exposure>, Option<&DrawnSky>), With<Camera3d>>,
) {
    store.receive(&mut images);
    for (camera, seen, own, drawn) in &cameras {
        let sky = &seen.sky;
        let ev100 = match own {
            Some(own) if !sky.expose && own.ev100.is_finite() => own.ev100,
            _ => seen.ev100,
        };
        let step = if seen.is_changed() { sky.map_step } else { 0.0 };
        let maps = store.find(&seen, ev100, step, &mut images);
        let exposure = twilight::exposure(ev100);
        let other_map = drawn.is_none_or(|drawn| drawn.map != maps.seen);
        let other_exposure = drawn.is_none_or(|drawn| drawn.exposure != exposure);
        if !(seen.is_changed() || other_map || other_exposure) {
            continue;
        }
        let mut camera = commands.entity(camera);
        if sky.expose {
            camera.insert(Exposure { ev100 });
        }
        if other_map {
            camera.insert((
                Skybox {
                    image: Some(maps.seen.clone()),
                    brightness: maps.scale,
                    ..default()
                },
                AmbientLight {
                    color: Color::BLACK,
                    brightness: 0.0,
                    ..default()
                },
            ));
        }
        if sky.light {
            camera.insert(EnvironmentMapLight {
                diffuse_map: maps.diffuse.clone(),
                specular_map: maps.specular.clone(),
                intensity: maps.scale,
                ..default()
            });
        } else {
            camera.remove::<EnvironmentMapLight>();
        }
        if sky.haze > 0.0 {
            camera.insert(fog(&Haze::new(&seen.heavens, sky.haze, sky.dust), exposure));
        } else {
            camera.remove::<DistanceFog>();
        }
        camera.insert(DrawnSky {
            map: maps.seen.clone(),
            scale: maps.scale,
            exposure,
        });
    }
    store.drop_unused();
}

/// Bevy's fog mixes exposed colours.
fn fog(haze: &Haze, exposure: f32) -> DistanceFog {
    let colour = haze.colour * exposure;
    let glow = haze.exposed_glow(exposure);
    DistanceFog {
        color: Color::linear_rgb(colour.x, colour.y, colour.z),
        directional_light_color: Color::linear_rgb(glow.x, glow.y, glow.z),
        directional_light_exponent: GLOW_EXPONENT,
        falloff: FogFalloff::Atmospheric {
            extinction: haze.extinction,
            inscattering: haze.extinction,
        },
    }
}

/// Takes away what the sky has brought.
pub(super) fn undress(removed: On<Remove, Sky>, mut commands: Commands) {
    if let Ok(mut camera) = commands.get_entity(removed.entity) {
        camera.try_remove::<(
            DrawnSky,
            Skybox,
            EnvironmentMapLight,
            AmbientLight,
            DistanceFog,
        )>();
    }
}
