//! Sky, sun, moon and haze: a clear day or night computed once for the place of the sun.
//!
//! The sky is a cube map (Bevy's skybox and environment map), the haze Bevy's distance fog with the
//! air's own extinction. Bevy's atmosphere would do all of this on the GPU for each frame; it
//! brings down the software Vulkan (Mesa 22.3) that tests and CI draw on.

use bevy::camera::Exposure;
use bevy::light::{
    CascadeShadowConfigBuilder, DirectionalLightShadowMap, EnvironmentMapLight, Skybox,
};
use bevy::math::ops;
use bevy::pbr::{DistanceFog, FogFalloff};
use bevy::prelude::*;
use bevy::render::view::ColorGrading;

use super::camera::FreeCamera;
use super::moon::MoonPlugin;
use super::night::Heavens;
use super::scattering::ground_extinction;
use super::scene_file::SunFile;
use super::scenes::CurrentScene;
use super::settings::Settings;
use super::sky_maps::SkyMaps;
use super::stars::StarPlugin;
use super::twilight;
use super::view::SATURATION;

/// How far from the camera things cast shadows, metres: across a valley.
const SHADOW_DISTANCE: f32 = 5_000.0;

/// Thickness of the haze against that of a very clear day.
const HAZE: f32 = 1.25;

/// Saturation of the picture by night: eyes see little colour then.
const NIGHT_SATURATION: f32 = 1.1;

/// The light of the scene that casts shadows: the sun, at night the moon.
#[derive(Component)]
struct Sun;

/// The sky of the camera, for what is drawn in it.
#[derive(Resource, Clone)]
pub struct SeenSky {
    /// What lights it.
    pub heavens: Heavens,
    /// Factor from cd/m² to what the picture holds.
    pub exposure: f32,
    /// The cube map that is seen, and the luminance of 1 in it, cd/m².
    pub map: Handle<Image>,
    /// See `map`.
    pub scale: f32,
}

/// Sun, moon, stars, sky and haze.
pub struct SkyPlugin;

impl Plugin for SkyPlugin {
    fn build(&self, app: &mut App) {
        // All light comes from sun and sky; a constant ambient would wash out the shadows.
        app.insert_resource(GlobalAmbientLight::NONE)
            .insert_resource(ClearColor(Color::BLACK))
            .insert_resource(DirectionalLightShadowMap { size: 2048 })
            .add_plugins((StarPlugin, MoonPlugin))
            .add_systems(Startup, spawn)
            .add_systems(Update, turn_sun.in_set(SkySystems));
    }
}

/// The set in which [`SeenSky`] is brought up to date (schedule `Update`).
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SkySystems;

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

/// Sets light, sky, haze and exposure anew whenever the place of the sun changes.
fn turn_sun(
    mut commands: Commands,
    scene: Res<CurrentScene>,
    settings: Res<Settings>,
    mut suns: Query<(&mut Transform, &mut DirectionalLight), With<Sun>>,
    mut cameras: Query<(Entity, &mut ColorGrading), (With<FreeCamera>, With<Camera3d>)>,
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
    let heavens = Heavens::new(towards_sun(sun), scene.terrain.sea_level().is_some());
    let ev100 = twilight::ev100(heavens.elevation);
    let exposure = twilight::exposure(ev100);
    let light = heavens.key();
    let brightest = light.illuminance.max_element().max(1e-6);
    for (mut transform, mut directional) in &mut suns {
        *transform = Transform::default().looking_to(-light.towards, Vec3::Y);
        directional.illuminance = brightest;
        let colour = light.illuminance / brightest;
        directional.color = Color::linear_rgb(colour.x, colour.y, colour.z);
    }
    let maps = SkyMaps::new(|direction| heavens.radiance(direction), ev100);
    let scale = maps.scale;
    let (seen, diffuse, specular) = (
        images.add(maps.seen),
        images.add(maps.diffuse),
        images.add(maps.specular),
    );
    for (camera, mut grading) in &mut cameras {
        grading.global.post_saturation =
            SATURATION + (NIGHT_SATURATION - SATURATION) * heavens.stars;
        commands.entity(camera).insert((
            Exposure { ev100 },
            Skybox {
                image: Some(seen.clone()),
                brightness: scale,
                ..default()
            },
            EnvironmentMapLight {
                diffuse_map: diffuse.clone(),
                specular_map: specular.clone(),
                intensity: scale,
                ..default()
            },
            haze(&heavens, exposure),
        ));
    }
    commands.insert_resource(SeenSky {
        heavens,
        exposure,
        map: seen,
        scale,
    });
}

/// The air between the camera and the ground: its extinction, and the colour of the sky just above
/// the horizon, to which everything far away tends. Bevy's fog mixes exposed colours.
fn haze(heavens: &Heavens, exposure: f32) -> DistanceFog {
    // Five degrees up, all round.
    let around = (0..16_u8).map(|i| {
        let (sin, cos) = ops::sin_cos(f32::from(i) * std::f32::consts::TAU / 16.0);
        heavens.radiance(Vec3::new(cos, 0.087, sin).normalize())
    });
    let horizon = if heavens.elevation < twilight::DUSK {
        twilight_haze(around.collect(), heavens.elevation)
    } else {
        around.sum::<Vec3>() / 16.0
    };
    let colour = horizon * exposure;
    let glow = heavens.key().illuminance * exposure * 0.03;
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

/// At dusk one side of the horizon is a hundred times as bright as the other, and haze of the mean
/// would glow before the dark one: the lower the sun, the more it tends to the geometric mean.
fn twilight_haze(around: Vec<Vec3>, elevation: f32) -> Vec3 {
    let count = around.len() as f32;
    let mean = around.iter().sum::<Vec3>() / count;
    let logs = around
        .iter()
        .map(|sky| Vec3::from_array(sky.to_array().map(|x| ops::ln(x.max(1e-9)))))
        .sum::<Vec3>()
        / count;
    let geometric = Vec3::from_array(logs.to_array().map(ops::exp));
    geometric.lerp(mean, twilight::smooth(-4.0, twilight::DUSK, elevation))
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
