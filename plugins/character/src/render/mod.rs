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
use bevy::camera::visibility::VisibilitySystems;
use bevy::ecs::prelude::*;
use bevy::pbr::MaterialPlugin;
use bevy::render::{ExtractSchedule, Render, RenderApp, RenderSystems};

#[cfg(doc)]
use bevy::mesh::MeshTag;

/// Draws every [`Crowd`]. Needs Bevy's renderer and its standard material.
#[derive(Clone, Copy, Debug, Default)]
pub struct CrowdPlugin;

impl Plugin for CrowdPlugin {
    fn build(&self, app: &mut App) {
        material::load_shaders(app);
        app.add_plugins(MaterialPlugin::<CrowdMaterial>::default())
            .add_systems(
                PostUpdate,
                (crowd::grow, crowd::show)
                    .chain()
                    .before(VisibilitySystems::VisibilityPropagate)
                    .run_if(any_with_component::<Crowd>),
            );
        if let Some(render) = app.get_sub_app_mut(RenderApp) {
            render
                .init_resource::<CrowdUploads>()
                .add_systems(ExtractSchedule, upload::extract)
                .add_systems(Render, upload::send.in_set(RenderSystems::PrepareResources));
        }
    }
}
