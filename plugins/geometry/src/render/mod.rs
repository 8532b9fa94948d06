//! Pools, draws and counters of all that producers make.
//!
//! A frame, in order: `extract` copies cameras, time and sun. Producers say in which views they want to
//! draw ([`Producer::wanted`]); `prepare` makes the pools and writes what the draws of each view are told.
//! Producers then prepare what their own passes need, and record them in `Core3d` before Bevy's prepass;
//! `pass` draws what is [filled](GeometryView::filled) into the G-buffer and the shadow maps, `direct` into
//! the picture of cameras that have no G-buffer. After the submit the counters are fetched.
//!
//! Where these steps stand among Bevy's systems is said by [`GeometrySystems`].

mod camera;
mod direct;
mod extract;
mod material;
mod once;
mod pass;
mod pipeline;
mod prepare;
mod producer;
mod ranges;
mod readback;
mod record;
mod shader;
mod shared;
mod space;
mod stats;
mod traits;
mod variants;
mod view;

use bevy::core_pipeline::core_3d::main_opaque_pass_3d;
use bevy::core_pipeline::prepass::node::early_prepass;
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::pbr::{EARLY_SHADOW_PASS, per_view_shadow_pass};
use bevy::prelude::*;
use bevy::render::{ExtractSchedule, Render, RenderApp, RenderSystems};

pub use camera::Matrices;
pub use extract::{ExtractedGeometryCamera, GeometryScene, camera_number};
pub use material::GeometryMaterial;
#[doc(hidden)]
pub use pipeline::pipeline_fault;
pub use producer::{Producer, ProducerKey, Producers, ViewNumbers};
pub use ranges::ShadowRanges;
#[doc(hidden)]
pub use ranges::{PLANES, RANGE_ARGUMENTS, RANGES, half_spaces};
pub use readback::{Counters, Mapped};
pub use record::{DrawCall, DrawSource, Pools, record_draw};
pub use shader::{ModuleShaders, shader_asset};
pub use shared::{GeometryFault, GeometryShared, GeometryStats, PoolStats};
pub use space::{ViewFrame, Viewpoint};
pub use traits::{DrawShader, DrawTraits, GeometryPool};
#[doc(hidden)]
pub use variants::{DRAW_FILE, ShaderVariant, draw_variants};
pub use view::{GeometryView, ShadowSlot};

use crate::GeometryCamera;

/// Where the steps of a frame stand, for producers' own systems.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GeometrySystems {
    /// Schedule `Render`, in `RenderSystems::PrepareResources`: producers say where they want to draw.
    Want,
    /// Behind it: pools are made, views are told.
    Views,
    /// Behind it: producers write what their passes need, and unsettle the views whose inputs changed.
    Prepare,
    /// Schedule `Render`, in `RenderSystems::PrepareBindGroups`: bind groups and pipelines.
    Bind,
    /// Schedule `Core3d`, before Bevy's prepass and shadow passes: producers record their passes.
    Make,
    /// Behind it: the draws into G-buffer and shadow maps.
    Draw,
}

/// Draws what producers make; producers bring it along, so that few apps add it themselves.
///
/// May be added any number of times, before or after Bevy's plugins. Does nothing in an app that does not
/// render.
#[derive(Clone, Copy, Debug, Default)]
pub struct GeometryPlugin;

impl Plugin for GeometryPlugin {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<GeometryStats>() {
            return;
        }
        app.init_resource::<GeometryStats>()
            .init_resource::<GeometryShared>()
            .register_type::<GeometryCamera>()
            .register_type::<GeometryStats>()
            .add_systems(PreUpdate, stats::publish.run_if(stats::are_counted));
        stats::register(app);
    }

    fn finish(&self, app: &mut App) {
        build_render(app);
    }

    fn is_unique(&self) -> bool {
        false
    }
}

/// The render half, once: from `Plugin::finish` on, when all plugins have been built.
pub fn build_render(app: &mut App) {
    let shared = app.world().get_resource::<GeometryShared>().cloned();
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    if render_app.world().contains_resource::<Producers>() {
        return;
    }
    render_app
        .insert_resource(shared.unwrap_or_default())
        .init_resource::<Producers>()
        .init_resource::<GeometryScene>()
        .init_resource::<once::Surfaces>()
        .configure_sets(
            Render,
            (
                (
                    GeometrySystems::Want,
                    GeometrySystems::Views,
                    GeometrySystems::Prepare,
                )
                    .chain()
                    .in_set(RenderSystems::PrepareResources),
                GeometrySystems::Bind.in_set(RenderSystems::PrepareBindGroups),
            ),
        )
        .configure_sets(
            Core3d,
            (
                GeometrySystems::Make
                    .in_set(Core3dSystems::Prepass)
                    .before(early_prepass)
                    .before(per_view_shadow_pass::<EARLY_SHADOW_PASS>),
                GeometrySystems::Draw.after(GeometrySystems::Make),
            ),
        )
        .add_systems(ExtractSchedule, (extract::scene, extract::cameras))
        .add_systems(
            Render,
            (
                prepare::views.in_set(GeometrySystems::Views),
                (once::keep, pass::bind).in_set(GeometrySystems::Bind),
                stats::collect.in_set(RenderSystems::Cleanup),
            ),
        )
        .add_systems(
            Core3d,
            (
                pass::read_counters
                    .in_set(Core3dSystems::Prepass)
                    .after(GeometrySystems::Make),
                pass::draw_gbuffer
                    .in_set(GeometrySystems::Draw)
                    .in_set(Core3dSystems::Prepass)
                    .before(early_prepass),
                direct::draw
                    .in_set(Core3dSystems::MainPass)
                    .before(main_opaque_pass_3d),
                pass::draw_shadows
                    .in_set(GeometrySystems::Draw)
                    .before(per_view_shadow_pass::<EARLY_SHADOW_PASS>),
            ),
        );
}

/// What producers hold on the GPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GeometryCensus {
    /// Pipelines queued: of draws, and those that producers report ([`Producer::pipelines`]).
    pub pipelines: usize,
    /// Producers that have a view.
    pub kinds: usize,
    /// Views of producers that hold pools.
    pub views: usize,
    /// Bytes of all buffers of these views.
    pub bytes: u64,
}

/// Counts what producers hold in a render world: all 0 as long as no camera has a [`GeometryCamera`] or no
/// producer wants to draw.
#[must_use]
pub fn census(render_world: &World) -> GeometryCensus {
    let mut census = GeometryCensus::default();
    let Some(producers) = render_world.get_resource::<Producers>() else {
        return census;
    };
    for producer in producers.iter() {
        census.pipelines += producer.pipelines + producer.draw_pipelines();
        census.kinds += usize::from(!producer.views.is_empty());
        census.views += producer.views.len();
        census.bytes += producer
            .views
            .values()
            .map(GeometryView::bytes)
            .sum::<u64>();
    }
    census
}
