//! The GPU half: what is extracted, prepared and recorded for each view.
//!
//! A frame, in order: `extract` copies settings, patches and the terrain; `prepare` writes this
//! frame's uniforms and decides whether anything changed; in `Core3d`, before Bevy's own prepass,
//! `pass` records levels → plan → emit (only after a change) and the G-buffer draw, then the
//! shadow draws; after the submit `readback` fetches the counters.
//!
//! Nothing here exists until a camera has a [`TerrainView`](crate::TerrainView) and the world a
//! terrain: pipelines and buffers are made on first use, and the passes skip views without it.

mod extract;
mod layout;
mod params;
mod pass;
mod pipeline;
mod prepare;
mod readback;
pub mod relief;
pub mod stage;
pub mod texture;

use bevy::core_pipeline::prepass::node::early_prepass;
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::pbr::{EARLY_SHADOW_PASS, per_view_shadow_pass};
use bevy::prelude::*;
use bevy::render::{ExtractSchedule, Render, RenderApp, RenderSystems};

pub use layout::DrawParams;
pub use prepare::TerrainViews;
pub use relief::TerrainRelief;

/// Adds the GPU half to an app that renders; does nothing to one that does not.
pub(crate) fn build(app: &mut App) {
    if app.get_sub_app(RenderApp).is_none() {
        return;
    }
    let shared = readback::SharedStats::default();
    app.insert_resource(shared.clone())
        .add_systems(PreUpdate, readback::publish)
        .add_systems(
            Update,
            (texture::make_arrays, relief::start, relief::finish).chain(),
        );
    readback::register(app);
    let shaders = pipeline::load_shaders(app);
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .insert_resource(shaders)
        .insert_resource(shared)
        .init_resource::<extract::ExtractedTerrain>()
        .init_resource::<prepare::TerrainViews>()
        .init_resource::<prepare::TerrainBuffers>()
        .add_systems(ExtractSchedule, (extract::terrain, extract::views))
        .add_systems(
            Render,
            (
                (
                    pipeline::create.run_if(not(resource_exists::<pipeline::Pipelines>)),
                    prepare::terrain,
                    prepare::views,
                )
                    .chain()
                    .in_set(RenderSystems::PrepareResources),
                prepare::bind_groups.in_set(RenderSystems::PrepareBindGroups),
                readback::collect.in_set(RenderSystems::Cleanup),
            ),
        )
        .add_systems(
            Core3d,
            (
                (pass::tessellate, pass::draw_gbuffer)
                    .chain()
                    .in_set(Core3dSystems::Prepass)
                    .before(early_prepass),
                pass::draw_shadows
                    .after(pass::tessellate)
                    .before(per_view_shadow_pass::<EARLY_SHADOW_PASS>),
            ),
        );
}

/// What the plugin holds on the GPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Census {
    /// Pipelines queued.
    pub pipelines: usize,
    /// Buffers of the terrain and of all views.
    pub buffers: usize,
    /// Views that record passes.
    pub views: usize,
}

/// Counts what the plugin holds in a render world: all 0 as long as no camera has a
/// [`TerrainView`](crate::TerrainView) or the world no terrain.
pub fn census(render_world: &World) -> Census {
    let views = render_world
        .get_resource::<TerrainViews>()
        .map_or(0, |views| views.0.len());
    let terrain = render_world.get_resource::<prepare::TerrainBuffers>();
    Census {
        pipelines: render_world
            .get_resource::<pipeline::Pipelines>()
            .map_or(0, |found| found.count()),
        buffers: terrain.map_or(0, prepare::TerrainBuffers::count) + views * prepare::VIEW_BUFFERS,
        views,
    }
}
