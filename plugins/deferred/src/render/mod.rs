//! The passes that light, behind a component on the camera.
//!
//! A frame, in order: `extract` copies [`DeferredLighting`] and takes Bevy's lighting pass off the view; `gather`
//! writes the rows of all lights; `prepare` lists what each view sees, chooses its way and makes what that needs, its
//! pipelines by `pipeline`, which asks Bevy for the layout and the definitions of its own lighting pass and puts our
//! shaders in their place; `pass` records; `difference` compares with the reference. Without a camera that has the
//! component there is no buffer, pipeline or pass of ours.

mod blinn_phong;
mod difference;
mod dither;
mod extract;
mod gather;
mod hull;
mod lights;
mod occlusion;
mod pass;
mod pipeline;
mod prepare;
mod pyramid;
mod shaders;
mod stats;
mod still;
mod unlit;

use bevy::core_pipeline::core_3d::main_opaque_pass_3d;
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::prelude::*;
use bevy::render::extract_component::ExtractComponentPlugin;
use bevy::render::{Render, RenderApp, RenderSystems};

pub use blinn_phong::{BlinnPhongMaterial, BlinnPhongPlugin, Lobe};
pub use difference::ViewDifference;
pub use dither::DitheredGBufferPlugin;
pub use prepare::{LightingUniform, TILE, ViewLighting};
pub use stats::{DeferredStats, ViewStats};
pub use still::{StillStats, is_kept_face};

use crate::components::{DeferredLighting, LightingDifference, StillShadows, Way};
use crate::model::ShadingModels;
use crate::occlusion::{AmbientOcclusion, OcclusionQuality, OcclusionResolution};

/// Lights cameras that have [`DeferredLighting`]. Add after Bevy's plugins.
///
/// Does nothing in an app that does not render; added again it does nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct DeferredPlugin;

/// Says that the plugin was added.
#[derive(Resource)]
struct Added;

/// Says that Bevy's renderer was there when the plugin was added.
#[derive(Resource)]
struct Extracted;

impl Plugin for DeferredPlugin {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<Added>() {
            return;
        }
        app.insert_resource(Added)
            .init_resource::<ShadingModels>()
            .init_resource::<DeferredStats>()
            .register_type::<DeferredLighting>()
            .register_type::<Way>()
            .register_type::<StillShadows>()
            .register_type::<LightingDifference>()
            .register_type::<AmbientOcclusion>()
            .register_type::<OcclusionQuality>()
            .register_type::<OcclusionResolution>()
            .add_systems(PreUpdate, stats::publish)
            .add_systems(
                PostUpdate,
                unlit::tell.run_if(any_with_component::<DeferredLighting>),
            );
        // Its hook needs the renderer's resources.
        if app.get_sub_app(RenderApp).is_some() {
            still::build(app);
            app.insert_resource(Extracted);
            app.add_plugins((
                ExtractComponentPlugin::<DeferredLighting>::default(),
                ExtractComponentPlugin::<AmbientOcclusion>::default(),
                ExtractComponentPlugin::<LightingDifference>::default(),
            ));
        }
    }

    fn finish(&self, app: &mut App) {
        let stats = app.world().resource::<DeferredStats>().clone();
        if app.get_sub_app(RenderApp).is_none() {
            return;
        }
        if !app.world().contains_resource::<Extracted>() {
            warn!(
                "DeferredPlugin does nothing: it was added before Bevy's plugins; add it after DefaultPlugins"
            );
            return;
        }
        let Some(shaders) = shaders::load(app) else {
            return;
        };
        still::finish(app);
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        if render_app.world().contains_resource::<DeferredStats>() {
            return;
        }
        render_app
            .insert_resource(shaders)
            .insert_resource(stats)
            .init_resource::<lights::Lights>()
            .init_resource::<pipeline::Pipelines>()
            .init_resource::<difference::Comparison>()
            .add_systems(
                Render,
                (
                    gather::gather,
                    prepare::prepare,
                    difference::prepare.run_if(any_with_component::<LightingDifference>),
                )
                    .chain()
                    .in_set(RenderSystems::PrepareResources),
            )
            .add_systems(
                Core3d,
                (
                    difference::light.run_if(any_with_component::<ViewDifference>),
                    pass::light,
                    difference::compare.run_if(any_with_component::<ViewDifference>),
                )
                    .chain()
                    .in_set(Core3dSystems::MainPass)
                    .before(main_opaque_pass_3d),
            );
    }

    fn is_unique(&self) -> bool {
        false
    }
}
