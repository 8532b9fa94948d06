//! Shadow maps of point lights that are drawn again only where something moved.
//!
//! Bevy draws the six faces of each point light that casts shadows in every frame, and each face runs the whole schedule of
//! a 3D view. A light with [`StillShadows`](crate::StillShadows) keeps what its map holds: [`watch`] finds in the main world which faces see a
//! caster that came, went or moved; [`skip`] gives the others a schedule without systems for this frame, so that their part
//! of the map stays as it is. The map is Bevy's own, and so is what is drawn into it.

mod faces;
mod skip;
mod stats;
mod watch;

pub use skip::is_kept_face;
pub use stats::StillStats;

use bevy::light::SimulationLightSystems;
use bevy::pbr::prepare_lights;
use bevy::prelude::*;
use bevy::render::{ExtractSchedule, Render, RenderApp, RenderSystems};

/// In the main world.
pub fn build(app: &mut App) {
    app.init_resource::<StillStats>()
        .init_resource::<watch::Watched>()
        .add_systems(
            PostUpdate,
            watch::watch
                .after(SimulationLightSystems::CheckLightVisibility)
                .run_if(watch::wanted),
        );
}

/// In the render world.
pub fn finish(app: &mut App) {
    let stats = app.world().resource::<StillStats>().clone();
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    if render_app.world().contains_resource::<StillStats>() {
        return;
    }
    render_app
        .insert_resource(stats)
        .init_resource::<skip::Kept>()
        .add_schedule(Schedule::new(skip::StillFace))
        .add_systems(ExtractSchedule, skip::extract)
        .add_systems(
            Render,
            skip::skip
                .after(prepare_lights)
                .in_set(RenderSystems::PrepareResources)
                .run_if(skip::wanted),
        );
}
