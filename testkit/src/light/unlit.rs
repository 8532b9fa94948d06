//! Frames that nobody lights, to measure what lighting costs.

use bevy::pbr::deferred::SkipDeferredLighting;
use bevy::prelude::*;
use bevy::render::camera::ExtractedCamera;
use bevy::render::extract_resource::{ExtractResource, ExtractResourcePlugin};
use bevy::render::{Render, RenderApp, RenderSystems};
use dolomite_deferred::DeferredLighting;

/// Whether Bevy's lighting pass is left out; the plugin's own component is for the app to remove.
#[derive(Resource, ExtractResource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unlit(pub bool);

/// Obeys [`Unlit`].
pub struct UnlitPlugin;

impl Plugin for UnlitPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Unlit>()
            .add_plugins(ExtractResourcePlugin::<Unlit>::default());
        if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
            render_app.add_systems(Render, skip.in_set(RenderSystems::CreateViews));
        }
    }
}

fn skip(
    mut commands: Commands,
    unlit: Option<Res<Unlit>>,
    views: Query<(Entity, Has<DeferredLighting>), With<ExtractedCamera>>,
) {
    let unlit = unlit.is_some_and(|unlit| unlit.0);
    for (view, ours) in &views {
        if unlit {
            commands.entity(view).insert(SkipDeferredLighting);
        } else if !ours {
            commands.entity(view).remove::<SkipDeferredLighting>();
        }
    }
}
