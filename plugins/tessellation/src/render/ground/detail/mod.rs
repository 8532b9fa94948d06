//! The level of detail of the ground on the GPU: what [`crate::detail`] does, in compute passes that write
//! the vertices and triangles which the stage then draws.
//!
//! A camera that has a [`Detail`] beside its `TerrainView` sees the ground so. What it takes is made when
//! the first such camera looks; a view that did not change dispatches nothing.

mod pass;
mod pipeline;
mod prepare;
pub(super) mod probe;

use bevy::core_pipeline::prepass::node::early_prepass;
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::pbr::{EARLY_SHADOW_PASS, per_view_shadow_pass};
use bevy::prelude::*;
use bevy::render::sync_world::RenderEntity;
use bevy::render::{Extract, ExtractSchedule, Render, RenderApp, RenderSystems};
use dolomite_terrain::Terrain;

use super::GroundKind;
use crate::detail::Detail;
use crate::ground::TerrainView;
use crate::render::stage::library::{ModuleShaders, shader};
use crate::render::stage::pass as stage_pass;

/// How a camera sees the ground, in the render world.
#[derive(Component, Clone, Copy)]
struct ExtractedDetail(Detail);

/// The ground, in the render world.
#[derive(Resource, Default)]
struct ExtractedGround {
    terrain: Option<Terrain>,
    /// From the lowest to the highest ground, metres.
    relief: f32,
}

/// Entry shaders of the passes, in the order of `DEPTH_PASSES` and then `LAST_PASSES`.
#[derive(Resource, Clone)]
struct DetailShaders {
    entries: Vec<Handle<Shader>>,
    _modules: ModuleShaders,
}

/// Adds the systems to an app that renders.
pub(super) fn build(app: &mut App) {
    let modules = ModuleShaders::load(app);
    let mut assets = app.world_mut().resource_mut::<Assets<Shader>>();
    let entries = pipeline::files()
        .map(|file| assets.add(shader(dolomite_shaders::find(file).source, file)))
        .collect();
    let shaders = DetailShaders {
        entries,
        _modules: modules,
    };
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .insert_resource(shaders)
        .init_resource::<ExtractedGround>()
        .init_resource::<prepare::DetailViews>()
        .add_systems(ExtractSchedule, (extract_ground, extract_cameras))
        .add_systems(
            Render,
            prepare::prepare
                .in_set(RenderSystems::PrepareBindGroups)
                .before(stage_pass::bind_groups),
        )
        .add_systems(
            Core3d,
            pass::choose
                .in_set(Core3dSystems::Prepass)
                .before(stage_pass::tessellate)
                .before(early_prepass)
                .before(per_view_shadow_pass::<EARLY_SHADOW_PASS>),
        );
    probe::build(app);
}

fn extract_ground(
    mut ground: ResMut<ExtractedGround>,
    terrains: Extract<Query<&Terrain>>,
    kind: Extract<Res<GroundKind>>,
) {
    let terrain = terrains.iter().next();
    let same = match (&ground.terrain, terrain) {
        (Some(known), Some(terrain)) => known.same(terrain),
        (known, terrain) => known.is_none() && terrain.is_none(),
    };
    if !same {
        ground.terrain = terrain.cloned();
    }
    ground.relief = kind.heights_apart;
}

fn extract_cameras(
    mut commands: Commands,
    cameras: Extract<Query<(RenderEntity, &Detail), With<TerrainView>>>,
    mut removed: Extract<RemovedComponents<Detail>>,
    entities: Extract<Query<RenderEntity>>,
) {
    for entity in removed
        .read()
        .filter_map(|entity| entities.get(entity).ok())
    {
        if let Ok(mut entity) = commands.get_entity(entity) {
            entity.remove::<ExtractedDetail>();
        }
    }
    for (entity, detail) in &cameras {
        commands
            .entity(entity)
            .insert(ExtractedDetail(detail.clamped()));
    }
}
