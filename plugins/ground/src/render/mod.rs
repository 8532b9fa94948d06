//! The ground on the GPU: a kind of the tessellation stage that is kept up to date with the terrain,
//! its material and the views.
//!
//! Nothing exists on the GPU until the world has a terrain with its material, its textures have
//! arrived, and a camera has a [`TerrainView`].

pub mod detail;
mod kind;
pub mod relief;
pub mod texture;

use std::sync::Arc;

use bevy::asset::RenderAssetUsages;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::storage::ShaderBuffer;
use dolomite_terrain::{GpuTerrainUniform, Terrain};

pub use detail::probe::{AnswerCensus, DrawnProbeStats, answer_census};
pub use kind::{GroundKind, GroundLook, HeightUniform};
pub use relief::TerrainRelief;

use crate::cover::lattice::clamped;
use crate::cover::{
    GROUND_LAYOUT, TerrainCover, TerrainCoverSystems, TerrainMaterial, TerrainView,
};
use crate::detail::Detail;
use dolomite_geometry::GeometryPlugin;
use dolomite_tessellation::Patches;
use dolomite_tessellation::render::{PatchPlugin, PatchPool};
use relief::RELIEF_SIDE;
use texture::ReadyArrays;

/// Adds the main world's side of the GPU half.
pub(crate) fn build(app: &mut App) {
    app.add_plugins((GeometryPlugin, PatchPlugin(GroundKind::default())));
}

/// Adds the rest to an app that renders, when all plugins have been built; does nothing to one that does not.
pub(crate) fn finish(app: &mut App) {
    if app.get_sub_app(RenderApp).is_none() || app.world().contains_resource::<ReadyArrays>() {
        return;
    }
    detail::build::<GroundKind>(app);
    detail::probe::build(app);
    app.init_resource::<ReadyArrays>()
        .add_systems(
            Update,
            (texture::make_arrays, relief::start, relief::finish).chain(),
        )
        .add_systems(
            PostUpdate,
            (update_kind, place_patches)
                .chain()
                .after(TerrainCoverSystems),
        );
}

/// The patches of a camera; on the entity that draws them.
#[derive(Component)]
struct GroundOf(Entity);

type GroundQuery<'a> = (
    Ref<'a, Terrain>,
    Ref<'a, TerrainMaterial>,
    Option<Ref<'a, TerrainRelief>>,
);

/// What has to be taken over when a view next looks.
#[derive(Default)]
struct Due {
    terrain: bool,
    look: bool,
    /// Whether there was a relief map.
    relief: bool,
}

/// Takes over the terrain and its look where they changed.
fn update_kind(
    mut kind: ResMut<GroundKind>,
    mut buffers: ResMut<Assets<ShaderBuffer>>,
    terrains: Query<GroundQuery>,
    views: Query<&TerrainView>,
    ready: Res<ReadyArrays>,
    mut due: Local<Due>,
) {
    let Some((terrain, material, relief)) = terrains.iter().next() else {
        if kind.shown {
            kind.shown = false;
        }
        return;
    };
    let relief_changed =
        relief.is_some() != due.relief || relief.as_ref().is_some_and(|relief| relief.is_changed());
    due.relief = relief.is_some();
    due.terrain |= terrain.is_changed();
    due.look |= terrain.is_changed() || material.is_changed() || relief_changed;
    if views.is_empty() {
        return;
    }
    let shown = ready.has(&material);
    if kind.shown != shown {
        kind.shown = shown;
    }
    let pool = views
        .iter()
        .map(clamped)
        .fold([1; 2], |[vertices, primitives], view| {
            [
                vertices.max(view.max_vertices),
                primitives.max(view.max_triangles),
            ]
        });
    let pool = PatchPool {
        vertices: pool[0],
        primitives: pool[1],
    };
    if kind.pool != pool {
        kind.pool = pool;
    }
    if std::mem::take(&mut due.terrain) {
        let gpu = terrain.gpu();
        let mut buffer =
            |bytes: &[u8]| buffers.add(ShaderBuffer::new(bytes, RenderAssetUsages::RENDER_WORLD));
        kind.layers = buffer(bytemuck::cast_slice(&gpu.layers));
        kind.data = buffer(bytemuck::cast_slice(&gpu.data));
        kind.heights = gpu.uniform.into();
        let bounds = terrain.bounds(&terrain.extent());
        kind.heights_apart = (bounds.max - bounds.min).max(0.0);
        kind.extent_min = terrain.extent().min;
        kind.terrain = Some((*terrain).clone());
    }
    if std::mem::take(&mut due.look) {
        kind.albedo_height = material.albedo_height.clone();
        kind.normal_roughness = material.normal_roughness.clone();
        kind.relief = relief.as_ref().map(|relief| relief.image.clone());
        kind.look = look(&terrain, &material, relief.as_deref());
    }
}

fn look(
    terrain: &Terrain,
    material: &TerrainMaterial,
    relief: Option<&TerrainRelief>,
) -> GroundLook {
    let bands = material.bands;
    GroundLook {
        sea_level: terrain.sea_level().unwrap_or(GpuTerrainUniform::NO_SEA),
        tile: material.tile.clamp(0.01, 10_000.0),
        sand_top: bands.sand_top,
        tree_line: bands.tree_line,
        snow_line: bands.snow_line,
        blend: bands.blend.max(0.01),
        rock_slope: bands.rock_slope,
        snow_slope: bands.snow_slope,
        relief_texel: relief.map_or(0.0, |relief| relief.texel),
        relief_scale: relief.map_or(0.0, |relief| 1.0 / (relief.texel * RELIEF_SIDE as f32)),
        pad_a: 0.0,
        pad_b: 0.0,
    }
}

/// Gives every view the patches of its cover, as an entity that it alone sees.
fn place_patches(
    mut commands: Commands,
    terrains: Query<&TerrainMaterial, With<Terrain>>,
    kind: Res<GroundKind>,
    ready: Res<ReadyArrays>,
    // The level of detail draws for the others.
    covers: Query<(Entity, Ref<TerrainCover>), (With<TerrainView>, Without<Detail>)>,
    mut grounds: Query<(
        Entity,
        &GroundOf,
        &mut Patches<GroundKind>,
        &mut Transform,
        &mut GlobalTransform,
    )>,
) {
    let drawn = terrains
        .iter()
        .next()
        .is_some_and(|material| ready.has(material));
    for (entity, of, ..) in &grounds {
        if !drawn || !covers.contains(of.0) {
            commands.entity(entity).despawn();
        }
    }
    if !drawn {
        return;
    }
    for (camera, cover) in &covers {
        let found = grounds.iter_mut().find(|(_, of, ..)| of.0 == camera);
        let mesh = &cover.patches.mesh;
        let other = |patches: &Patches<GroundKind>| !Arc::ptr_eq(&patches.mesh, mesh);
        if found
            .as_ref()
            .is_some_and(|(_, _, patches, ..)| !other(patches))
        {
            continue;
        }
        if let Some(fault) = &cover.fault {
            error!("the ground cannot be covered with patches: {fault}");
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
            Some((.., mut old, mut transform, mut global)) => {
                *old = patches;
                *transform = place;
                *global = world;
            }
            None => {
                commands.spawn((GroundOf(camera), patches, place, world));
            }
        }
    }
}
