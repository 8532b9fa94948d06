//! The programmable tessellation stage: control and evaluate functions in WGSL, any patches, drawn
//! by [`dolomite_geometry`] into Bevy's G-buffer and shadow maps.
//!
//! A frame, in order: `extract` copies what changed; `prepare` uploads it and decides which kinds of
//! which views have to be tessellated anew; `pass` records, in `Core3d` before Bevy's own prepass,
//! control → measure → plan → place → emit (only after a change). What comes out is drawn by
//! [`dolomite_geometry::render`], and counted there.
//!
//! Each view tessellates for itself: levels depend on it. Shadow views draw what their camera
//! tessellated. Nothing exists on the GPU until a [`GeometryCamera`](dolomite_geometry::GeometryCamera) and
//! [`Patches`](crate::Patches) of a kind are in the world.

mod extract;
mod host;
mod kind;
mod pass;
mod pipeline;
mod prepare;
mod ranges;
pub mod record;
mod variants;
mod view;

use std::any::TypeId;
use std::marker::PhantomData;

use bevy::asset::LoadState;
use bevy::prelude::*;
use bevy::render::{Extract, ExtractSchedule, Render, RenderApp};
use dolomite_geometry::GeometryPlugin;
use dolomite_geometry::render::{
    DrawTraits, GeometryShared, GeometrySystems, Producer, ProducerKey, Producers, build_render,
};

pub use dolomite_geometry::render::{
    GeometryCensus, GeometryFault, GeometryMaterial, GeometryStats, Viewpoint, census,
};
pub use kind::{PatchKind, PatchPlugin, PatchPool, PatchShader};

#[doc(hidden)]
pub use variants::{KindVariants, StageVariant, stage_variants};

use crate::{Domain, Drawing};

/// Brings what draws along, once.
fn add_geometry(app: &mut App) {
    app.add_plugins(GeometryPlugin);
}

/// How the triangles and segments of a kind are drawn.
fn draw_traits<K: PatchKind>() -> DrawTraits {
    use bevy::mesh::PrimitiveTopology::{LineList, TriangleList};
    DrawTraits {
        topology: match K::LAYOUT.domain {
            Domain::Isolines => LineList,
            _ => TriangleList,
        },
        evaluated: evaluated::<K>(),
        moves: K::MOVES && !evaluated::<K>(),
        vertex_shaded: K::VERTEX_SHADED,
        amplified: K::AMPLIFIED,
        double_sided: K::DOUBLE_SIDED,
        shadows: K::SHADOWS,
        others: false,
        bounded: K::BOUNDED && K::SHADOWS && K::AMPLIFIED == 0,
        uv_range: K::UV_RANGE,
    }
}

/// Adds a kind to an app that renders, when all plugins have been built; does nothing to one that does not,
/// or that has the kind already.
fn add_kind<K: PatchKind>(app: &mut App, _: PhantomData<K>) {
    build_render(app);
    let key = ProducerKey::of::<K>();
    let known = |app: &App| {
        let producers = app
            .get_sub_app(RenderApp)?
            .world()
            .get_resource::<Producers>()?;
        Some(producers.get(key).is_some())
    };
    if known(app) != Some(false) {
        return;
    }
    let name = core::any::type_name::<K>();
    let Some(shaders) = pipeline::KindShaders::new::<K>(app, name) else {
        return;
    };
    if let Some(file) = shaders.user.clone() {
        let watch =
            move |server: Res<AssetServer>, shared: Res<GeometryShared>, mut told: Local<bool>| {
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
    build_stage(render_app);
    let traits = draw_traits::<K>();
    let producer = Producer::new(name, traits, shaders.draw.clone(), pipeline::given_layout());
    let kind = prepare::Kind {
        name,
        key,
        layout: K::LAYOUT,
        tessellator: variants::tessellator::<K>(),
        animated: K::ANIMATED,
        traits,
        shaders,
        pool: PatchPool::default(),
        host: None,
        instances: Vec::new(),
        instances_changed: false,
        other_layout: 0,
        version: 0,
        data_due: true,
        pipelines: None,
        buffers: None,
        views: Default::default(),
    };
    let world = render_app.world_mut();
    world.resource_mut::<Producers>().insert(key, producer);
    world
        .resource_mut::<prepare::StageKinds>()
        .0
        .insert(TypeId::of::<K>(), kind);
    render_app
        .add_systems(ExtractSchedule, (extract::kind::<K>, extract_settings::<K>))
        .add_systems(
            Render,
            prepare::data::<K>
                .in_set(GeometrySystems::Want)
                .before(prepare::buffers),
        );
}

/// Whether the draws evaluate the kind's vertices.
const fn evaluated<K: PatchKind>() -> bool {
    matches!(K::DRAWING, Drawing::Evaluated) && K::AMPLIFIED == 0
}

/// The user's resource, when it changed.
fn extract_settings<K: PatchKind>(mut commands: Commands, settings: Extract<Option<Res<K>>>) {
    if let Some(settings) = settings.as_ref().filter(|settings| settings.is_changed()) {
        commands.insert_resource(prepare::ExtractedKind((**settings).clone()));
    }
}

/// What all kinds share, once.
fn build_stage(render_app: &mut SubApp) {
    if render_app
        .world()
        .contains_resource::<prepare::StageKinds>()
    {
        return;
    }
    use bevy::core_pipeline::Core3d;
    render_app
        .init_resource::<prepare::StageKinds>()
        .add_systems(
            Render,
            (
                prepare::buffers.in_set(GeometrySystems::Want),
                (prepare::views, host::tessellate)
                    .chain()
                    .in_set(GeometrySystems::Prepare),
                pass::bind_groups.in_set(GeometrySystems::Bind),
            ),
        )
        .add_systems(Core3d, pass::tessellate.in_set(GeometrySystems::Make));
}
