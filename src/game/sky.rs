//! Sky, sun and haze: a clear day computed once for the place of the sun.
//!
//! The sky is a cube map (Bevy's skybox and environment map), the haze Bevy's distance fog with the
//! air's own extinction. Bevy's atmosphere would do all of this on the GPU for each frame; it
//! brings down the software Vulkan (Mesa 22.3) that tests and CI draw on.

use bevy::light::{
    CascadeShadowConfigBuilder, DirectionalLightShadowMap, EnvironmentMapLight, Skybox,
};
use bevy::math::ops;
use bevy::pbr::{DistanceFog, FogFalloff};
use bevy::prelude::*;

use super::camera::FreeCamera;
use super::scattering::{ground_extinction, sky_radiance, sun_illuminance};
use super::scene_file::SunFile;
use super::scenes::CurrentScene;
use super::settings::Settings;
use super::sky_maps::{SCALE, SkyMaps};
use super::view::EV100;

/// How far from the camera things cast shadows, metres: across a valley.
const SHADOW_DISTANCE: f32 = 5_000.0;

/// Thickness of the haze against that of a very clear day.
const HAZE: f32 = 1.25;

/// The sun of the scene.
#[derive(Component)]
struct Sun;

/// Sun, sky and haze.
pub struct SkyPlugin;

impl Plugin for SkyPlugin {
    fn build(&self, app: &mut App) {
        // All light comes from sun and sky; a constant ambient would wash out the shadows.
        app.insert_resource(GlobalAmbientLight::NONE)
            .insert_resource(ClearColor(Color::BLACK))
            .insert_resource(DirectionalLightShadowMap { size: 2048 })
            .add_systems(Startup, spawn)
            .add_systems(Update, turn_sun);
    }
}

/// The unit vector towards the sun.
pub fn towards_sun(sun: SunFile) -> Vec3 {
    let (sin_azimuth, cos_azimuth) = ops::sin_cos(sun.azimuth.to_radians());
    let (sin_elevation, cos_elevation) = ops::sin_cos(sun.elevation.to_radians());
    Vec3::new(
        sin_azimuth * cos_elevation,
        sin_elevation,
        -cos_azimuth * cos_elevation,
    )
}

fn spawn(mut commands: Commands) {
    commands.spawn((
        Sun,
        DirectionalLight {
            shadow_maps_enabled: true,
            ..default()
        },
        CascadeShadowConfigBuilder {
            num_cascades: 4,
            minimum_distance: 0.2,
            first_cascade_far_bound: 60.0,
            maximum_distance: SHADOW_DISTANCE,
            ..default()
        }
        .build(),
    ));
}

/// Sets sun, sky and haze anew whenever the place of the sun changes.
fn turn_sun(
    mut commands: Commands,
    scene: Res<CurrentScene>,
    settings: Res<Settings>,
    mut suns: Query<(&mut Transform, &mut DirectionalLight), With<Sun>>,
    cameras: Query<Entity, (With<FreeCamera>, With<Camera3d>)>,
    mut images: ResMut<Assets<Image>>,
    mut last: Local<Option<SunFile>>,
) {
    let sun = settings
        .sun
        .map_or(scene.sun, |(azimuth, elevation)| SunFile {
            azimuth,
            elevation,
        });
    if *last == Some(sun) || cameras.is_empty() {
        return;
    }
    *last = Some(sun);
    let towards = towards_sun(sun);
    let light = sun_illuminance(towards);
    let brightest = light.max_element().max(1e-3);
    for (mut transform, mut directional) in &mut suns {
        *transform = Transform::default().looking_to(-towards, Vec3::Y);
        directional.illuminance = brightest;
        let colour = light / brightest;
        directional.color = Color::linear_rgb(colour.x, colour.y, colour.z);
    }
    let maps = SkyMaps::new(towards);
    let (seen, diffuse, specular) = (
        images.add(maps.seen),
        images.add(maps.diffuse),
        images.add(maps.specular),
    );
    for camera in &cameras {
        commands.entity(camera).insert((
            Skybox {
                image: Some(seen.clone()),
                brightness: SCALE,
                ..default()
            },
            EnvironmentMapLight {
                diffuse_map: diffuse.clone(),
                specular_map: specular.clone(),
                intensity: SCALE,
                ..default()
            },
            haze(towards),
        ));
    }
}

/// The air between the camera and the ground: its extinction, and the colour of the sky just above
/// the horizon, to which everything far away tends.
fn haze(towards_sun: Vec3) -> DistanceFog {
    // Bevy's fog mixes exposed colours; its exposure is 1 / (1.2 · 2^EV100).
    let exposure = 1.0 / (1.2 * ops::exp2(EV100));
    // Mean over the horizon, five degrees up.
    let horizon: Vec3 = (0..16_u8)
        .map(|i| {
            let (sin, cos) = ops::sin_cos(f32::from(i) * std::f32::consts::TAU / 16.0);
            sky_radiance(Vec3::new(cos, 0.087, sin).normalize(), towards_sun)
        })
        .sum::<Vec3>()
        / 16.0;
    let colour = horizon * exposure;
    let glow = sun_illuminance(towards_sun) * exposure * 0.03;
    let extinction = ground_extinction() * HAZE;
    DistanceFog {
        color: Color::linear_rgb(colour.x, colour.y, colour.z),
        directional_light_color: Color::linear_rgb(glow.x, glow.y, glow.z),
        directional_light_exponent: 12.0,
        falloff: FogFalloff::Atmospheric {
            extinction,
            inscattering: extinction,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuth_is_clockwise_from_north_and_elevation_up() {
        let at = |azimuth, elevation| towards_sun(SunFile { azimuth, elevation });
        // One rounding of sine or cosine of a right angle.
        let close = |a: Vec3, b: Vec3| a.distance(b) < 1e-6;
        assert!(close(at(0.0, 0.0), Vec3::NEG_Z), "north is -z");
        assert!(close(at(90.0, 0.0), Vec3::X), "east is +x");
        assert!(close(at(180.0, 0.0), Vec3::Z), "south is +z");
        assert!(close(at(45.0, 90.0), Vec3::Y), "the zenith is +y");
    }
}
