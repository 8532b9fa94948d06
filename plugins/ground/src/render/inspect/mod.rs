//! Numbers of the drawn ground in each pixel of the cameras that have a [`GroundInspection`]: what their pools hold is
//! drawn once more, into a texture of its own.
//!
//! While no camera has one, each system here is a run condition, and one looks for cameras.

mod pass;
mod pipeline;
mod prepare;

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::prelude::*;
use bevy::render::render_resource::{BindGroup, Buffer, CachedRenderPipelineId};
use bevy::render::sync_world::RenderEntity;
use bevy::render::texture::CachedTexture;
use bevy::render::{Extract, ExtractSchedule, Render, RenderApp, RenderSystems};
use dolomite_geometry::render::{GeometrySystems, ModuleShaders, shader_asset};

use super::blocks;
use super::detail::DetailKind;
use crate::inspection::GroundInspection;
pub use pipeline::inspection_variants;

/// The shader's file.
const FILE: &str = "ground/inspect.wgsl";

/// What was found of a view's ground. On the view's entity in the render world.
#[derive(Component, Clone)]
pub struct ViewInspection {
    /// What it is.
    pub what: GroundInspection,
    /// As large as the target: two floats a pixel, or with [`GroundInspection::Overdraw`] two halves of that size.
    pub found: CachedTexture,
    pub(super) depth: CachedTexture,
}

/// How many passes of inspections were recorded, over all views: 0 as long as no camera had one. The same in both worlds.
#[derive(Resource, Clone, Debug, Default)]
pub struct InspectionPasses(Arc<AtomicU64>);

impl InspectionPasses {
    /// The count.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }

    fn add(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
}

#[derive(Resource)]
struct InspectionShader {
    handle: Handle<Shader>,
    _modules: ModuleShaders,
}

/// What is inspected in this frame; there while anything is.
#[derive(Resource, Default)]
struct Inspected {
    views: Vec<(Entity, GroundInspection)>,
    draws: Vec<Draw>,
}

/// The ground of a kind in a view.
struct Draw {
    view: Entity,
    pipeline: CachedRenderPipelineId,
    groups: Vec<BindGroup>,
    /// Pixels.
    tolerance: f32,
    /// Begins with the arguments.
    work: Buffer,
}

/// What all kinds share, to an app that renders; once.
fn build_all(app: &mut App) {
    let is_there = |app: &App| app.world().contains_resource::<InspectionPasses>();
    let Some(modules) = ModuleShaders::load(app).filter(|_| !is_there(app)) else {
        return;
    };
    let Some(mut assets) = app.world_mut().get_resource_mut::<Assets<Shader>>() else {
        return;
    };
    let source = dolomite_shaders::find(FILE).source;
    let shader = InspectionShader {
        handle: assets.add(shader_asset(source, FILE)),
        _modules: modules,
    };
    let passes = InspectionPasses::default();
    app.insert_resource(passes.clone());
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .insert_resource(shader)
        .insert_resource(passes)
        .init_resource::<pipeline::Pipelines>()
        .add_systems(ExtractSchedule, extract)
        .add_systems(
            Render,
            (
                prepare::textures.run_if(resource_exists::<Inspected>),
                prepare::clear.run_if(resource_removed::<Inspected>),
            )
                .in_set(RenderSystems::PrepareResources),
        )
        .add_systems(
            Core3d,
            pass::draw
                .run_if(resource_exists::<Inspected>)
                .in_set(Core3dSystems::MainPass)
                .after(GeometrySystems::Make),
        );
}

/// Adds the systems of a kind to an app that renders, beside those that choose it.
pub(super) fn build<K: DetailKind>(app: &mut App) {
    build_all(app);
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app.add_systems(
        Render,
        prepare::draws::<K>
            .run_if(resource_exists::<Inspected>)
            .in_set(GeometrySystems::Bind)
            .after(blocks::prepare::prepare::<K>),
    );
}

fn extract(
    mut commands: Commands,
    cameras: Extract<Query<(RenderEntity, &Camera, &GroundInspection)>>,
    known: Option<Res<Inspected>>,
) {
    let active = cameras.iter().filter(|(_, camera, _)| camera.is_active);
    let views: Vec<_> = active.map(|(entity, _, what)| (entity, *what)).collect();
    if !views.is_empty() {
        let draws = Vec::new();
        commands.insert_resource(Inspected { views, draws });
    } else if known.is_some() {
        commands.remove_resource::<Inspected>();
    }
}
