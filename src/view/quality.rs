//! Gives cameras and sun what the chosen quality says, and nothing that is off.

use bevy::anti_alias::fxaa::Fxaa;
use bevy::anti_alias::smaa::Smaa;
use bevy::light::{CascadeShadowConfig, CascadeShadowConfigBuilder, DirectionalLightShadowMap};
use bevy::post_process::bloom::Bloom;
use bevy::prelude::*;
use dolomite::deferred::{AmbientOcclusion, OcclusionResolution};
use dolomite::ground::{GroundShading, TerrainView};
use dolomite::sky::Sun;

use crate::input::PlayerInput;
use crate::settings::Settings;
use crate::settings::quality::{AntiAliasing, DeviceKind, Occlusion, Quality, stepped};

/// How far from the camera things cast shadows, metres: across a valley.
const SHADOW_DISTANCE: f32 = 5_000.0;

/// What is farther away blocks no light from everywhere, metres: bushes, feet, doors, the gap below a bench. Over more of
/// them what the picture does not show weighs too much (docs/measured/light.md).
const OCCLUSION_RADIUS: f32 = 1.0;

/// The kind of device that draws; none where a picture shall be the same on each.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DrawnBy(pub Option<DeviceKind>);

/// Keeps [`Quality`] and what it is about up to date with the settings.
pub struct QualityPlugin;

impl Plugin for QualityPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<DrawnBy>()
            .init_resource::<Quality>()
            .register_type::<Quality>()
            .add_systems(PreStartup, choose)
            .add_systems(
                Update,
                (
                    step.run_if(|input: Res<PlayerInput>| input.resolution_steps != 0),
                    choose.run_if(resource_changed::<Settings>),
                    dress,
                    shade,
                    light.run_if(resource_changed::<Quality>),
                )
                    .chain(),
            );
    }
}

fn choose(settings: Res<Settings>, device: Res<DrawnBy>, mut quality: ResMut<Quality>) {
    quality.set_if_neq(Quality::chosen(&settings, device.0));
}

fn step(input: Res<PlayerInput>, quality: Res<Quality>, mut settings: ResMut<Settings>) {
    let next = stepped(quality.resolution, input.resolution_steps);
    if settings.resolution != Some(next) {
        settings.resolution = Some(next);
    }
}

/// What a camera was dressed with.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
struct Dressed(Quality);

/// Cameras that see the ground: once they do, and when the quality changes. What was taken from a camera or put on it
/// otherwise stays so until then.
fn dress(
    mut commands: Commands,
    quality: Res<Quality>,
    cameras: Query<(Entity, Option<&Dressed>), With<TerrainView>>,
) {
    for (camera, dressed) in &cameras {
        if dressed.is_some_and(|dressed| dressed.0 == *quality) {
            continue;
        }
        let mut camera = commands.entity(camera);
        camera.insert(Dressed(*quality));
        effects(&mut camera, &quality);
    }
}

/// Puts on a camera what is on, and takes away what is off.
pub fn effects(camera: &mut EntityCommands, quality: &Quality) {
    if quality.bloom {
        camera.insert(Bloom::NATURAL);
    } else {
        camera.remove::<Bloom>();
    }
    match quality.anti_aliasing {
        AntiAliasing::Off => camera.remove::<(Fxaa, Smaa)>(),
        AntiAliasing::Fxaa => camera.remove::<Smaa>().insert(Fxaa::default()),
        AntiAliasing::Smaa => camera.remove::<Fxaa>().insert(Smaa::default()),
    };
    let resolution = match quality.occlusion {
        Occlusion::Off => {
            camera.remove::<AmbientOcclusion>();
            return;
        }
        Occlusion::Half => OcclusionResolution::Half,
        Occlusion::Full => OcclusionResolution::Full,
    };
    camera.insert(AmbientOcclusion {
        radius: OCCLUSION_RADIUS,
        resolution,
        ..default()
    });
}

/// The pixels of every ground, new ones too.
fn shade(quality: Res<Quality>, mut grounds: Query<&mut GroundShading>) {
    for mut shading in &mut grounds {
        shading.set_if_neq(quality.shading);
    }
}

fn light(
    quality: Res<Quality>,
    mut maps: Option<ResMut<DirectionalLightShadowMap>>,
    mut suns: Query<(&mut DirectionalLight, &mut CascadeShadowConfig), With<Sun>>,
) {
    if let Some(maps) = &mut maps
        && maps.size != quality.shadow_map as usize
    {
        maps.size = quality.shadow_map as usize;
    }
    for (mut light, mut config) in &mut suns {
        light.shadow_maps_enabled = quality.shadow_cascades > 0;
        *config = cascades(&quality);
    }
}

/// Whether the torch casts shadows.
pub const fn torch_casts(quality: &Quality) -> bool {
    quality.shadow_cascades > 0
}

/// The cascades of the sun's shadow; those of none are never drawn.
pub fn cascades(quality: &Quality) -> CascadeShadowConfig {
    CascadeShadowConfigBuilder {
        num_cascades: quality.shadow_cascades.max(1) as usize,
        minimum_distance: 0.2,
        // Fewer cascades share the distance: the nearest reaches farther, so that none is much coarser than the last.
        first_cascade_far_bound: match quality.shadow_cascades {
            0..=2 => 300.0,
            3 => 120.0,
            _ => 60.0,
        },
        maximum_distance: SHADOW_DISTANCE,
        ..default()
    }
    .build()
}
