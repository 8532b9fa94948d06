//! Sky, sun and haze: Bevy's atmosphere, lit by one sun of physical brightness.

use bevy::light::atmosphere::ScatteringMedium;
use bevy::light::{
    Atmosphere, AtmosphereEnvironmentMapLight, CascadeShadowConfigBuilder,
    DirectionalLightShadowMap, SunDisk, light_consts::lux,
};
use bevy::math::ops;
use bevy::pbr::AtmosphereSettings;
use bevy::prelude::*;

use super::scene_file::SunFile;
use super::scenes::CurrentScene;
use super::settings::Settings;

/// Distance that the aerial view table covers, metres: from a summit to the far side of the
/// largest scene. Haze beyond it stays as it is at its end.
const HAZE_DISTANCE: f32 = 40_000.0;

/// Side of the sky's cube map for ambient light, pixels. The sky is smooth: 64 pixels a face show
/// no difference on rough ground, and filtering costs a sixty-fourth of the default's 512.
const AMBIENT_SIDE: u32 = 64;

/// How far from the camera the figure casts a shadow, metres.
const SHADOW_DISTANCE: f32 = 250.0;

/// Sun and atmosphere.
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

/// The components of a camera that sees the sky.
pub fn sky_view() -> impl Bundle {
    (
        AtmosphereSettings {
            aerial_view_lut_max_distance: HAZE_DISTANCE,
            ..default()
        },
        AtmosphereEnvironmentMapLight {
            size: UVec2::splat(AMBIENT_SIDE),
            ..default()
        },
    )
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

fn spawn(mut commands: Commands, mut media: ResMut<bevy::asset::Assets<ScatteringMedium>>) {
    // 256 steps each, as Bevy's own default: the density halves every few kilometres.
    commands.spawn(Atmosphere::earth(
        media.add(ScatteringMedium::earth(256, 256)),
    ));
    commands.spawn((
        DirectionalLight {
            // Before the atmosphere takes its part: the atmosphere computes what arrives.
            illuminance: lux::RAW_SUNLIGHT,
            shadow_maps_enabled: true,
            ..default()
        },
        SunDisk::EARTH,
        CascadeShadowConfigBuilder {
            num_cascades: 2,
            minimum_distance: 0.2,
            first_cascade_far_bound: 30.0,
            maximum_distance: SHADOW_DISTANCE,
            ..default()
        }
        .build(),
    ));
}

fn turn_sun(
    scene: Res<CurrentScene>,
    settings: Res<Settings>,
    mut suns: Query<&mut Transform, With<SunDisk>>,
) {
    let sun = settings.sun.map_or(scene.sun, |(azimuth, elevation)| SunFile {
        azimuth,
        elevation,
    });
    let turned = Transform::default().looking_to(-towards_sun(sun), Vec3::Y);
    for mut transform in &mut suns {
        transform.set_if_neq(turned);
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
