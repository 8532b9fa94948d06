//! What grows, in the picture: blades of grass, flowers, kelp.
//!
//! **Roots stand on the triangles that are drawn.** After a view's ground has been chosen, `divide` goes through its
//! triangles — those that the camera sees, and those that are kept for shadows — and makes pieces of work: a triangle
//! and a tile of at most 8 × 8 squares of the lattice. `grow` looks at the candidate of each square: if the triangle
//! holds it (exactly, by edge functions in integers: `edges`), stands it on the plane of the triangle, and writes a record of
//! 16 bytes if it may be seen. It works for whatever writes triangles into pools ([`dolomite_geometry`]), needs no map
//! of heights, and finds the ground where geomorphs and levels put it.
//!
//! Ground that is in neither list grows nothing: what lies beyond the borders of the picture or behind nearer ground,
//! in views without shadows (in those with shadows it is kept).
//!
//! **Squares become larger with distance** (`rings`): about the eye lie rings, and in each only candidates of ranks that
//! may be drawn there are looked at, one a square of 2^level cells a side. The work is that of what is drawn, whatever
//! the area.
//!
//! **At rest nothing is dispatched.** Records are made anew when the view, the ground or a setting has changed. Wind
//! moves vertices in the draws, and previous places of motion vectors are those of the wind of the last frame.
//!
//! **Shapes** have lists of records of their own (`lists`), one a level of detail, and an indirect draw each. What no kind
//! uses has no pipeline.
//!
//! **Ranks** (`ranks`) are found in each pixel of cameras that ask for it, for a picture of them.
//!
//! **Where blades end** the ground shows their far field (`far`), fitted to them by a task.
//!
//! Nothing exists until there are a `Vegetation` with kinds that are drawn, and a camera with a `VegetationView`.

pub mod edges;
mod extract;
mod far;
mod layers;
pub mod layout;
pub mod lists;
pub mod meshes;
mod pass;
mod pipeline;
mod prepare;
mod published;
pub mod ranks;
pub mod record;
pub mod rings;
mod state;
mod stats;

use bevy::core_pipeline::prepass::node::early_prepass;
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::pbr::{EARLY_SHADOW_PASS, per_view_shadow_pass};
use bevy::prelude::*;
use bevy::render::{ExtractSchedule, Render, RenderApp, RenderSystems};
use dolomite_geometry::GeometryPlugin;
use dolomite_geometry::render::{GeometrySystems, build_render};

pub use extract::VegetationCulling;
pub use prepare::VegetationGrounds;
pub use state::VegetationPool;
pub use stats::{VegetationCount, VegetationStats};

/// Adds the main world's side.
pub(crate) fn build(app: &mut App) {
    app.init_resource::<VegetationPool>()
        .init_resource::<VegetationCulling>()
        .init_resource::<VegetationStats>()
        .add_plugins(GeometryPlugin);
    meshes::build(app);
    far::build(app);
    published::build(app);
}

/// Adds the rest to an app that renders, when all plugins have been built; does nothing to one that does not.
pub(crate) fn finish(app: &mut App) {
    let known = app.get_sub_app(RenderApp).map(SubApp::world);
    if known.is_none_or(|world| world.contains_resource::<prepare::VegetationViews>()) {
        return;
    }
    build_render(app);
    let stats = app.world().get_resource::<VegetationStats>().cloned();
    let Some(shaders) = pipeline::VegetationShaders::load(app) else {
        return;
    };
    ranks::build(app);
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .insert_resource(stats.unwrap_or_default())
        .insert_resource(shaders)
        .init_resource::<extract::ExtractedVegetation>()
        .init_resource::<VegetationGrounds>()
        .init_resource::<prepare::VegetationViews>()
        .add_systems(ExtractSchedule, (extract::vegetation, extract::views))
        .add_systems(
            Render,
            (
                prepare::prepare
                    .in_set(RenderSystems::PrepareBindGroups)
                    .after(GeometrySystems::Bind),
                prepare::collect.in_set(RenderSystems::Cleanup),
            ),
        )
        .add_systems(
            Core3d,
            pass::draw_shadows
                .after(pass::grow)
                .after(GeometrySystems::Draw)
                .before(per_view_shadow_pass::<EARLY_SHADOW_PASS>),
        )
        .add_systems(
            Core3d,
            (
                pass::grow.after(GeometrySystems::Make),
                pass::draw.after(GeometrySystems::Draw),
            )
                .chain()
                .in_set(Core3dSystems::Prepass)
                .before(early_prepass),
        );
}
