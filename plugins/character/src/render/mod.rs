//! Crowds in Bevy's renderer: one mesh, one draw, 16 bytes a figure.
//!
//! A crowd draws by Bevy's own mesh passes (shadow maps, prepass, G-buffer, forward) with a vertex shader of
//! ours. Its meshes are instances that never move: each has a [`MeshTag`], the number of its figure, and the
//! shader reads that figure's 16 bytes from one buffer. What moves is the buffer; entities and Bevy's own
//! records of them stay as they are.

mod crowd;
mod material;
mod upload;

pub use crowd::{Crowd, CrowdLook, CrowdPart};
pub use material::{CrowdExtension, CrowdMaterial, CrowdUniform};
pub use upload::CrowdUploads;

use bevy::app::{App, Plugin, PostUpdate};
use bevy::asset::AssetServer;
use bevy::camera::visibility::VisibilitySystems;
use bevy::ecs::prelude::*;
use bevy::pbr::{MaterialPlugin, MeshMaterial3d, PbrPlugin};
use bevy::render::erased_render_asset::ErasedRenderAssetPlugin;
use bevy::render::{ExtractSchedule, Render, RenderApp, RenderSystems};

#[cfg(doc)]
use bevy::mesh::MeshTag;

/// Draws every [`Crowd`].
///
/// May be added before or after Bevy's plugins, and more than once. An app without Bevy's [`PbrPlugin`] is
/// told so in a warning, and draws no crowd.
#[derive(Clone, Copy, Debug, Default)]
pub struct CrowdPlugin;

/// Makes crowds have as many instances as figures (schedule `PostUpdate`): write [`Crowd`]s before it.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CrowdSystems;

/// The plugin has been added, or it has been said why not.
#[derive(Resource)]
struct Settled;

impl Plugin for CrowdPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Crowd>();
        if has_materials(app) && !app.world().contains_resource::<Settled>() {
            add(app);
        }
    }

    fn finish(&self, app: &mut App) {
        if app.world().contains_resource::<Settled>() {
            return;
        }
        if has_materials(app) {
            add(app);
            // A plugin that is added while others finish is not finished by the app.
            ErasedRenderAssetPlugin::<MeshMaterial3d<CrowdMaterial>>::default().finish(app);
        } else {
            app.insert_resource(Settled);
            bevy::log::warn!(
                "CrowdPlugin draws nothing: the app has no PbrPlugin (part of Bevy's DefaultPlugins)"
            );
        }
    }

    fn is_unique(&self) -> bool {
        false
    }
}

/// Whether Bevy's part is there.
fn has_materials(app: &App) -> bool {
    app.world().contains_resource::<AssetServer>() && app.is_plugin_added::<PbrPlugin>()
}

fn add(app: &mut App) {
    app.insert_resource(Settled);
    material::load_shaders(app);
    app.add_plugins(MaterialPlugin::<CrowdMaterial>::default())
        .add_systems(
            PostUpdate,
            (crowd::grow, crowd::show)
                .chain()
                .in_set(CrowdSystems)
                .before(VisibilitySystems::VisibilityPropagate)
                .run_if(any_with_component::<Crowd>),
        );
    if let Some(render) = app.get_sub_app_mut(RenderApp) {
        render
            .init_resource::<CrowdUploads>()
            .add_systems(ExtractSchedule, upload::extract)
            .add_systems(
                Render,
                upload::send
                    .in_set(RenderSystems::PrepareResources)
                    .run_if(upload::is_due),
            );
    }
}
