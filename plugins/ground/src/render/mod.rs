//! The ground on the GPU: producers of triangles that are kept up to date with the terrains, their materials and
//! the views.
//!
//! Nothing exists on the GPU until the world has a visible terrain with its material, its textures have
//! arrived, and a camera has a [`TerrainView`].

pub mod blocks;
mod builtin;
pub mod detail;
mod drawn;
mod edits;
pub mod inspect;
mod kind;
mod look;
mod noise;
mod pools;
pub mod relief;
mod room;
mod terrain;
pub mod texture;
mod tiles;
mod told;

use std::sync::Arc;

use bevy::camera::visibility::RenderLayers;
use bevy::prelude::*;
use bevy::render::{Render, RenderApp, RenderSystems};

use detail::DetailKind;
pub use detail::probe::{AnswerCensus, DrawnProbeStats, answer_census};
pub use drawn::{DrawnGround, GroundProgress};
#[doc(hidden)]
pub use edits::words_of_edits;
#[doc(hidden)]
pub use kind::{GroundKind, HeightUniform};
#[doc(hidden)]
pub use look::{GroundLook, LookBand, LookCanopy, LookLayer, LookLimit};
pub use relief::TerrainRelief;
pub use texture::GroundTextures;

use crate::cover::{PatchDetail, TerrainCover, TerrainCoverSystems, TerrainView};
use crate::detail::work::GroundWork;
use crate::sets::GroundSystems;
use crate::streaming::{any_map_by_tiles, follow_maps};
use dolomite_geometry::GeometryPlugin;
use dolomite_tessellation::render::PatchPlugin;
use dolomite_tessellation::{PatchMeshError, Patches};
use texture::ReadyArrays;
use told::is_news;

/// Adds the main world's side of the GPU half.
pub(crate) fn build(app: &mut App, relief_side: u32) {
    app.register_type::<GroundTextures>()
        .register_type::<TerrainRelief>()
        .insert_resource(relief::ReliefSide(relief_side))
        .add_plugins((GeometryPlugin, PatchPlugin(GroundKind::<0>::default())))
        .add_systems(
            PostUpdate,
            follow_maps
                .after(TerrainCoverSystems)
                .run_if(any_map_by_tiles),
        );
}

/// Adds the rest to an app that renders, when all plugins have been built; does nothing to one that does not.
pub(crate) fn finish(app: &mut App) {
    if app.get_sub_app(RenderApp).is_none() || app.world().contains_resource::<ReadyArrays>() {
        return;
    }
    let progress = GroundProgress::default();
    app.insert_resource(progress.clone());
    let work = app.world().get_resource::<GroundWork>().cloned();
    if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
        render_app
            .insert_resource(work.unwrap_or_default())
            .insert_resource(progress)
            .add_systems(
                Render,
                drawn::end
                    .in_set(RenderSystems::Cleanup)
                    .after(drawn::Telling),
            );
    }
    app.init_resource::<ReadyArrays>()
        .add_systems(
            Update,
            (
                texture::make_built_in,
                texture::make_arrays,
                relief::forget,
                relief::start,
                relief::finish,
            )
                .chain()
                .in_set(GroundSystems::Make),
        )
        .add_systems(PostUpdate, place_patches.in_set(GroundSystems::Place));
    // As many as MOST_TERRAINS.
    add_slot::<0>(app);
    add_slot::<1>(app);
    add_slot::<2>(app);
    add_slot::<3>(app);
    detail::probe::build(app);
}

fn add_slot<const SLOT: usize>(app: &mut App) {
    const { assert!(SLOT < crate::MOST_TERRAINS) };
    app.init_resource::<GroundKind<SLOT>>().add_systems(
        PostUpdate,
        terrain::follow::<SLOT>.in_set(GroundSystems::Follow),
    );
    edits::build::<SLOT>(app);
    add_kind::<GroundKind<SLOT>>(app);
}

/// Adds the systems of a kind of ground to an app that renders, from `Plugin::finish` on; does nothing where they are.
/// The app needs [`GeometryPlugin`].
pub fn add_kind<K: DetailKind>(app: &mut App) {
    if detail::build::<K>(app) {
        blocks::build::<K>(app);
        inspect::build::<K>(app);
    }
}

/// The patches of a camera; on the entity that draws them.
#[derive(Component)]
struct GroundOf(Entity);

/// Gives every view whose ground is of patches those of its cover, as an entity that it alone sees, where it sees one
/// of the terrain's layers.
fn place_patches(
    mut commands: Commands,
    kind: Res<GroundKind<0>>,
    covers: Query<(Entity, Ref<TerrainCover>), (With<TerrainView>, With<PatchDetail>)>,
    mut grounds: Query<(
        Entity,
        &GroundOf,
        &mut Patches<GroundKind<0>>,
        &mut Transform,
        &mut GlobalTransform,
        &mut RenderLayers,
    )>,
    mut told: Local<Vec<PatchMeshError>>,
) {
    for (entity, of, ..) in &grounds {
        if !kind.shown || !covers.contains(of.0) {
            commands.entity(entity).despawn();
        }
    }
    if !kind.shown {
        return;
    }
    for (camera, cover) in &covers {
        if let Some(fault) = &cover.fault
            && is_news(&mut told, fault)
        {
            error!("the ground cannot be covered with patches: {fault}");
        }
        let mut found = grounds.iter_mut().find(|(_, of, ..)| of.0 == camera);
        if let Some((.., layers)) = &mut found {
            layers.set_if_neq(kind.seen_on.clone());
        }
        let mesh = &cover.patches.mesh;
        let other = |patches: &Patches<GroundKind<0>>| !Arc::ptr_eq(&patches.mesh, mesh);
        if found
            .as_ref()
            .is_some_and(|(_, _, patches, ..)| !other(patches))
        {
            continue;
        }
        // The newest patches cannot be had: what is drawn stays.
        if cover.fault.is_some() {
            continue;
        }
        let mut patches = Patches::new(mesh.clone());
        patches.params[0].x = kind.heights_apart;
        patches.camera = Some(camera);
        let origin = cover.patches.origin.as_vec2();
        let place = Transform::from_xyz(origin.x, 0.0, origin.y);
        // Transforms have been propagated by now.
        let world = GlobalTransform::from(place);
        match found {
            Some((_, _, mut old, mut transform, mut global, _)) => {
                *old = patches;
                *transform = place;
                *global = world;
            }
            None => {
                let layers = kind.seen_on.clone();
                commands.spawn((GroundOf(camera), patches, place, world, layers));
            }
        }
    }
}
