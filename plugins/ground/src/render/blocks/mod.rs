//! The level of detail on the GPU: what [`crate::blocks`] does, in compute passes that write the vertices and triangles which
//! [`dolomite_geometry`] then draws.
//!
//! A view draws what there is at once and makes what is missing, a few blocks a frame (`pace`); until a choice
//! comes back that had nothing to make. Then it rests, and a view that rests dispatches nothing.

mod head;
mod host;
mod pace;
pub mod parts;
mod pass;
mod pipeline;
pub(super) mod prepare;
pub mod record;
pub(super) mod state;
mod store;
mod told;

use bevy::core_pipeline::Core3d;
use bevy::prelude::*;
use bevy::render::{Render, RenderApp, RenderSystems};
use dolomite_geometry::render::{GeometrySystems, ModuleShaders, shader_asset};

use super::detail::DetailKind;
use super::drawn::Telling;
use crate::blocks::layout::PASSES;

/// Entry shaders of the passes, in the order of [`PASSES`].
#[derive(Resource, Clone)]
pub(super) struct BlockShaders {
    entries: Vec<Handle<Shader>>,
    _modules: ModuleShaders,
}

/// Adds the systems of a kind to an app that renders, beside those of [`detail`](super::detail).
pub(super) fn build<K: DetailKind>(app: &mut App) {
    let Some(shaders) = shaders(app) else { return };
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .insert_resource(shaders)
        .init_resource::<prepare::BlockViews<K>>()
        .add_systems(
            Render,
            (
                prepare::prepare::<K>.in_set(GeometrySystems::Bind),
                told::hand_in::<K>.in_set(RenderSystems::Cleanup),
                told::report::<K>
                    .in_set(RenderSystems::Cleanup)
                    .in_set(Telling),
            ),
        )
        .add_systems(Core3d, pass::choose::<K>.in_set(GeometrySystems::Make));
}

/// What all kinds share.
fn shaders(app: &mut App) -> Option<BlockShaders> {
    let known = app.get_sub_app(RenderApp)?.world();
    if let Some(known) = known.get_resource::<BlockShaders>() {
        return Some(known.clone());
    }
    let modules = ModuleShaders::load(app)?;
    let mut assets = app.world_mut().get_resource_mut::<Assets<Shader>>()?;
    let entries = PASSES
        .iter()
        .map(|(file, ..)| assets.add(shader_asset(dolomite_shaders::find(file).source, file)))
        .collect();
    Some(BlockShaders {
        entries,
        _modules: modules,
    })
}
