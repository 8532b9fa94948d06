//! The programmable tessellation stage: control and evaluate functions in WGSL, any patches, drawn
//! into Bevy's G-buffer and shadow maps.
//!
//! A frame, in order: `extract` copies what changed; `prepare` uploads it and decides which kinds of
//! which views have to be tessellated anew; `pass` records, in `Core3d` before Bevy's own prepass,
//! control → measure → plan → place → emit (only after a change), the G-buffer draw and the shadow
//! draws; after the submit the counters are fetched.
//!
//! A camera without `DeferredPrepass` draws patches straight into its picture instead, in the base
//! colour that their material gives and without light: for kinds that need none, or whose material
//! function computes it. (`StageCamera` requires the prepasses; remove them from the entity.)
//!
//! Each view tessellates for itself: levels depend on it. Shadow views draw what their camera
//! tessellated. Nothing exists on the GPU until a [`StageCamera`](crate::StageCamera) and
//! [`Patches`](crate::Patches) of a kind are in the world.

pub mod camera;
mod direct;
pub mod extract;
mod host;
pub mod kind;
pub mod library;
pub mod pass;
pub mod pipeline;
pub mod prepare;
pub mod ranges;
pub mod readback;
pub mod stats;
mod variants;
pub mod view;
pub mod view_buffers;

use std::any::TypeId;
use std::marker::PhantomData;

use bevy::asset::LoadState;
use bevy::core_pipeline::core_3d::main_opaque_pass_3d;
use bevy::core_pipeline::prepass::node::early_prepass;
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::pbr::{EARLY_SHADOW_PASS, per_view_shadow_pass};
use bevy::prelude::*;
use bevy::render::{Extract, ExtractSchedule, Render, RenderApp, RenderSystems};

pub use kind::{PatchKind, PatchMaterial, PatchPlugin, PatchPool, PatchShader};
pub use prepare::StageKinds;
use stats::StageShared;

use crate::Drawing;
pub use stats::{StageFault, StageStats};
#[doc(hidden)]
pub use variants::{KindVariants, StageVariant, stage_variants};
pub use view::Viewpoint;

/// Adds a kind to an app that renders; does nothing to one that does not.
fn add_kind<K: PatchKind>(app: &mut App, _: PhantomData<K>) {
    if app.get_sub_app(RenderApp).is_none() {
        return;
    }
    build(app);
    let name = core::any::type_name::<K>();
    let shaders = pipeline::KindShaders::new::<K>(app, name);
    if let Some(file) = shaders.user.clone() {
        let watch =
            move |server: Res<AssetServer>, shared: Res<StageShared>, mut told: Local<bool>| {
                let Some(LoadState::Failed(fault)) = server.get_load_state(&file) else {
                    *told = false;
                    return;
                };
                if !*told {
                    *told = true;
                    error!("{name}: its shader cannot be loaded: {fault}");
                    shared.report(name, fault.to_string());
                }
            };
        app.add_systems(PreUpdate, watch);
    }
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    let kind = prepare::Kind {
        name,
        traits: prepare::KindTraits::of::<K>(),
        shaders,
        pool: PatchPool::default(),
        host: None,
        still: false,
        given: false,
        materials: Vec::new(),
        materials_changed: true,
        instances: Vec::new(),
        instances_changed: false,
        other_layout: 0,
        version: 0,
        data_layout: None,
        data: None,
        data_due: true,
        numbers: None,
        pipelines: None,
        buffers: None,
        views: Default::default(),
    };
    render_app
        .world_mut()
        .resource_mut::<StageKinds>()
        .0
        .insert(TypeId::of::<K>(), kind);
    render_app
        .add_systems(ExtractSchedule, (extract::kind::<K>, extract_settings::<K>))
        .add_systems(
            Render,
            prepare::data::<K>
                .in_set(RenderSystems::PrepareResources)
                .before(prepare::buffers),
        );
}

/// Whether the draws evaluate the kind's vertices.
fn evaluated<K: PatchKind>() -> bool {
    K::DRAWING == Drawing::Evaluated && K::AMPLIFIED == 0
}

/// The user's resource, when it changed.
fn extract_settings<K: PatchKind>(mut commands: Commands, settings: Extract<Option<Res<K>>>) {
    if let Some(settings) = settings.as_ref().filter(|settings| settings.is_changed()) {
        commands.insert_resource(prepare::ExtractedKind((**settings).clone()));
    }
}

/// What all kinds share, once.
fn build(app: &mut App) {
    if app.world().contains_resource::<StageStats>() {
        return;
    }
    let shared = StageShared::default();
    app.init_resource::<StageStats>()
        .insert_resource(shared.clone())
        .add_systems(PreUpdate, stats::publish);
    stats::register(app);
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .insert_resource(shared)
        .init_resource::<StageKinds>()
        .init_resource::<extract::StageScene>()
        .add_systems(ExtractSchedule, (extract::scene, extract::cameras))
        .add_systems(
            Render,
            (
                (prepare::buffers, prepare::views, host::tessellate)
                    .chain()
                    .in_set(RenderSystems::PrepareResources),
                pass::bind_groups.in_set(RenderSystems::PrepareBindGroups),
                stats::collect.in_set(RenderSystems::Cleanup),
            ),
        )
        .add_systems(
            Core3d,
            (
                (pass::tessellate, pass::draw_gbuffer)
                    .chain()
                    .in_set(Core3dSystems::Prepass)
                    .before(early_prepass),
                direct::draw
                    .in_set(Core3dSystems::MainPass)
                    .before(main_opaque_pass_3d),
                pass::draw_shadows
                    .after(pass::tessellate)
                    .before(per_view_shadow_pass::<EARLY_SHADOW_PASS>),
            ),
        );
}

/// What the stage holds on the GPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StageCensus {
    /// Pipelines queued, of all kinds.
    pub pipelines: usize,
    /// Kinds that hold buffers.
    pub kinds: usize,
    /// Views of kinds that hold buffers.
    pub views: usize,
}

/// Counts what the stage holds in a render world: all 0 as long as no camera has a
/// [`StageCamera`](crate::StageCamera) or no patches are in the world.
pub fn census(render_world: &World) -> StageCensus {
    let mut census = StageCensus::default();
    for kind in render_world
        .get_resource::<StageKinds>()
        .into_iter()
        .flat_map(|kinds| kinds.0.values())
    {
        census.pipelines += kind
            .pipelines
            .as_ref()
            .map_or(0, pipeline::KindPipelines::count);
        census.kinds += usize::from(kind.buffers.is_some());
        census.views += kind.views.len();
    }
    census
}
