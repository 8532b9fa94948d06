//! A view without its lighting, to measure what that costs.

use bevy::pbr::deferred::SkipDeferredLighting;
use bevy::prelude::*;
use bevy::render::sync_world::RenderEntity;
use bevy::render::{Extract, ExtractSchedule, RenderApp};
use dolomite::deferred::DeferredLighting;

/// On a camera whose G-buffer is not lit: its picture is the sky alone.
#[derive(Component, Clone, Copy, Debug)]
pub struct Unlit;

/// Lets [`Unlit`] be heard.
pub fn add(app: &mut App) {
    if let Some(render) = app.get_sub_app_mut(RenderApp) {
        render.add_systems(ExtractSchedule, extract);
    }
}

fn extract(
    mut commands: Commands,
    // Dolomite's lighting has Bevy's left out by itself.
    cameras: Extract<
        Query<(RenderEntity, Has<Unlit>), (With<Camera3d>, Without<DeferredLighting>)>,
    >,
    known: Query<(), With<SkipDeferredLighting>>,
) {
    for (camera, unlit) in &cameras {
        if unlit == known.contains(camera) {
            continue;
        }
        let mut camera = commands.entity(camera);
        if unlit {
            camera.insert(SkipDeferredLighting);
        } else {
            camera.remove::<SkipDeferredLighting>();
        }
    }
}
