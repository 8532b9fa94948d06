//! The level of detail of the ground on the GPU: what [`crate::detail`] does, in compute passes that write
//! the vertices and triangles which the stage then draws.
//!
//! A [`DetailKind`] whose triangles are given is drawn so; a camera's [`Detail`] says how fine. What it
//! takes is made when the first such camera looks; a view that did not change dispatches nothing.

mod host;
mod pass;
mod pipeline;
mod prepare;
pub(crate) mod probe;
mod view;

use std::marker::PhantomData;

use bevy::core_pipeline::prepass::node::early_prepass;
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::pbr::{EARLY_SHADOW_PASS, per_view_shadow_pass};
use bevy::prelude::*;
use bevy::render::sync_world::RenderEntity;
use bevy::render::{Extract, ExtractSchedule, Render, RenderApp, RenderSystems};
use dolomite_terrain::Terrain;

use crate::detail::Detail;
use dolomite_tessellation::render::PatchKind;
use dolomite_tessellation::render::library::{ModuleShaders, shader};
use dolomite_tessellation::render::pass as stage_pass;

/// A kind of the stage whose triangles the level of detail makes, as long as [`PatchKind::given`] says so.
/// Its data begin with what `terrain_height` reads: layers at binding 0, their data at 1, the uniform at 2.
pub trait DetailKind: PatchKind {
    /// The ground.
    fn ground(&self) -> Option<&Terrain>;

    /// From the lowest to the highest ground, metres.
    fn relief(&self) -> f32;

    /// Whether the CPU chooses and places, and uploads what it made.
    fn on_host(&self) -> bool {
        false
    }
}

/// How a camera sees the ground, in the render world.
#[derive(Component, Clone, Copy)]
struct ExtractedDetail(Detail);

/// The ground of a kind, in the render world.
#[derive(Resource)]
struct ExtractedGround<K> {
    terrain: Option<Terrain>,
    /// From the lowest to the highest ground, metres.
    relief: f32,
    on_host: bool,
    kind: PhantomData<fn() -> K>,
}

impl<K> Default for ExtractedGround<K> {
    fn default() -> Self {
        Self {
            terrain: None,
            relief: 0.0,
            on_host: false,
            kind: PhantomData,
        }
    }
}

/// Entry shaders of the passes, in the order of `DEPTH_PASSES` and then `LAST_PASSES`.
#[derive(Resource, Clone)]
struct DetailShaders {
    entries: Vec<Handle<Shader>>,
    _modules: ModuleShaders,
}

/// Adds the systems of a kind to an app that renders.
pub fn build<K: DetailKind>(app: &mut App) {
    let Some(render_app) = app.get_sub_app(RenderApp) else {
        return;
    };
    if !render_app.world().contains_resource::<DetailShaders>() {
        build_shared(app);
    }
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .init_resource::<ExtractedGround<K>>()
        .init_resource::<prepare::DetailViews<K>>()
        .add_systems(ExtractSchedule, extract_ground::<K>)
        .add_systems(
            Render,
            prepare::prepare::<K>
                .in_set(RenderSystems::PrepareBindGroups)
                .before(stage_pass::bind_groups),
        )
        .add_systems(
            Core3d,
            pass::choose::<K>
                .in_set(Core3dSystems::Prepass)
                .before(stage_pass::tessellate)
                .before(early_prepass)
                .before(per_view_shadow_pass::<EARLY_SHADOW_PASS>),
        );
}

/// What all kinds share, once.
fn build_shared(app: &mut App) {
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
        .add_systems(ExtractSchedule, extract_cameras);
}

fn extract_ground<K: DetailKind>(
    mut ground: ResMut<ExtractedGround<K>>,
    kind: Extract<Option<Res<K>>>,
) {
    let Some(kind) = kind.as_ref() else {
        return;
    };
    let same = match (&ground.terrain, kind.ground()) {
        (Some(known), Some(terrain)) => known.same(terrain),
        (known, terrain) => known.is_none() && terrain.is_none(),
    };
    if !same {
        ground.terrain = kind.ground().cloned();
    }
    ground.relief = kind.relief();
    ground.on_host = kind.on_host();
}

fn extract_cameras(
    mut commands: Commands,
    cameras: Extract<Query<(RenderEntity, &Detail)>>,
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
