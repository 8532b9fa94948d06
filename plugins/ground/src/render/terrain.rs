//! From the components of a terrain to what its slot draws.

use std::sync::Arc;

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::RenderLayers;
use bevy::prelude::*;
use bevy::render::render_resource::ShaderType;
use bevy::render::renderer::RenderDevice;
use bevy::render::storage::ShaderBuffer;
use dolomite_terrain::Terrain;
use dolomite_tessellation::render::PatchPool;

use super::kind::{GroundKind, HeightUniform};
use super::look::{GroundLook, LookLimit};
use super::relief::{TerrainRelief, drawn};
use super::texture::{GroundTextures, ReadyArrays, textured};
use super::told::is_news;
use crate::blocks::gate::stands_on;
use crate::blocks::kept::lattice_of;
use crate::cover::{PatchDetail, TerrainView};
use crate::detail::TerrainLod;
use crate::material::{GroundCanopy, GroundMaterial, GroundShading, Sea};
use crate::shown::ShownTerrains;

type GroundQuery<'a> = (
    Ref<'a, Terrain>,
    Ref<'a, GroundMaterial>,
    Ref<'a, GroundTextures>,
    Ref<'a, GroundShading>,
    Option<Ref<'a, Sea>>,
    Option<Ref<'a, TerrainRelief>>,
    Option<Ref<'a, GroundCanopy>>,
    Option<&'a RenderLayers>,
);

/// What has to be taken over.
#[derive(Default)]
pub(super) struct Due {
    /// Of which terrain.
    of: Option<Entity>,
    terrain: bool,
    look: bool,
    /// Whether there was a relief map, a sea, and something that grows.
    had: [bool; 3],
}

/// Whether the device can bind the height maps of a terrain; says once where it cannot. Such a terrain is not drawn.
fn fits(device: Option<&RenderDevice>, terrain: &Terrain, told: &mut Option<u64>) -> bool {
    let bytes = terrain.gpu_map_bytes();
    let most = device.map_or(u64::MAX, |device| {
        let limits = device.limits();
        limits
            .max_storage_buffer_binding_size
            .min(limits.max_buffer_size)
    });
    if bytes <= most {
        *told = None;
        return true;
    }
    if told.replace(bytes) != Some(bytes) {
        error!(
            "the ground is not drawn: its height maps take {bytes} bytes on the GPU, which binds {most}; \
             take fewer samples (`--every 2`, or in a scene file `every: 2`)"
        );
    }
    false
}

/// Whether all that see a terrain can draw its map that is read by tiles, if it has one; says once where they cannot.
fn by_tiles(
    terrain: &Terrain,
    views: &Query<Option<&PatchDetail>, With<TerrainView>>,
    told: &mut bool,
) -> bool {
    let Some(map) = terrain.streamed() else {
        *told = false;
        return true;
    };
    let lattice = lattice_of(terrain, TerrainLod::default().finest);
    let fault = if !stands_on(&lattice, terrain, map) {
        "its `extent` is not that of the map; leave it out"
    } else if views.iter().any(|patches| patches.is_some()) {
        "a camera sees it in patches; take its `PatchDetail` away"
    } else {
        *told = false;
        return true;
    };
    if !std::mem::replace(told, true) {
        error!("the ground is not drawn: it has a map that is read by tiles, but {fault}");
    }
    false
}

/// Takes over the terrain of a slot and its look where they changed.
pub(super) fn follow<const SLOT: usize>(
    mut kind: ResMut<GroundKind<SLOT>>,
    mut buffers: ResMut<Assets<ShaderBuffer>>,
    shown: Res<ShownTerrains>,
    terrains: Query<GroundQuery>,
    views: Query<Option<&PatchDetail>, With<TerrainView>>,
    images: Res<Assets<Image>>,
    ready: Res<ReadyArrays>,
    mut due: Local<Due>,
    mut told: Local<Vec<LookLimit>>,
    device: Option<Res<RenderDevice>>,
    (mut too_large, mut no_tiles): (Local<Option<u64>>, Local<bool>),
) {
    // Without a view nothing is kept on the GPU.
    let entity = shown.slot(SLOT).filter(|_| !views.is_empty());
    let found = entity.and_then(|entity| terrains.get(entity).ok());
    let found = found.filter(|(terrain, ..)| fits(device.as_deref(), terrain, &mut too_large));
    let found = found.filter(|(terrain, ..)| by_tiles(terrain, &views, &mut no_tiles));
    let Some((terrain, material, textures, shading, sea, relief, canopy, layers)) = found else {
        if kind.terrain.is_some() {
            *kind = GroundKind::default();
        }
        *due = Due::default();
        return;
    };
    let other = due.of != entity;
    due.of = entity;
    let sea = sea.filter(|_| terrain.sea_level().is_some());
    let has = [relief.is_some(), sea.is_some(), canopy.is_some()];
    let [had_relief, had_sea, had_canopy] = std::mem::replace(&mut due.had, has);
    let changed = |had: bool, now: Option<bool>| had != now.is_some() || now == Some(true);
    let relief_changed = changed(had_relief, relief.as_ref().map(Ref::is_changed));
    let sea_changed = changed(had_sea, sea.as_ref().map(Ref::is_changed));
    let canopy_changed = changed(had_canopy, canopy.as_ref().map(Ref::is_changed));
    due.terrain |= other || terrain.is_changed() || had_sea != sea.is_some();
    let remade = due.terrain
        && !kind
            .terrain
            .as_ref()
            .is_some_and(|known| known.same_base(&drawn(&terrain, sea.is_some())));
    due.look |= remade
        || material.is_changed()
        || textures.is_changed()
        || shading.is_changed()
        || relief_changed
        || sea_changed
        || canopy_changed;
    let is_shown = ready.has(&material, &textures);
    if kind.shown != is_shown {
        kind.shown = is_shown;
    }
    let layers = layers.cloned().unwrap_or_default();
    if kind.seen_on != layers {
        kind.seen_on = layers;
    }
    let pool = pool(&views);
    if kind.pool != pool {
        kind.pool = pool;
    }
    if std::mem::take(&mut due.terrain) {
        let terrain = drawn(&terrain, sea.is_some());
        if !kind.takes_edits(&terrain) {
            lay_out(&mut kind, &mut buffers, terrain);
        }
    }
    if std::mem::take(&mut due.look) {
        let textured = textured(&material);
        let array = |handle: &Handle<Image>| textured.then(|| handle.clone());
        kind.albedo_height = array(&textures.albedo_height);
        kind.normal_roughness = array(&textures.normal_roughness);
        kind.relief = relief.as_ref().map(|relief| relief.image.clone());
        let sea = terrain.sea_level().zip(sea.as_deref().copied());
        let (look, limits) = GroundLook::new(&material, sea, relief.as_deref());
        kind.look = look.shaded(*shading).below(canopy.as_deref());
        kind.full = *shading == GroundShading::Full;
        for limit in limits {
            if is_news(&mut told, &limit) {
                warn!("{limit}");
            }
        }
    }
    let elsewhere = |handle: &Handle<Image>| {
        let lower = (0..SLOT).filter_map(|slot| shown.slot(slot));
        terrains
            .iter_many(lower)
            .any(|(_, material, textures, ..)| textured(&material) && textures.names(handle))
    };
    let arrays = [&kind.albedo_height, &kind.normal_roughness];
    let arrays = arrays
        .into_iter()
        .flatten()
        .filter(|array| !elsewhere(array));
    let bytes: u64 = arrays
        .chain(&kind.relief)
        .filter_map(|handle| images.get(handle))
        .map(image_bytes)
        .sum();
    if kind.texture_bytes != bytes {
        kind.texture_bytes = bytes;
    }
}

/// The data of a terrain into new buffers.
fn lay_out<const SLOT: usize>(
    kind: &mut GroundKind<SLOT>,
    buffers: &mut Assets<ShaderBuffer>,
    terrain: Terrain,
) {
    let gpu = terrain.gpu();
    let mut buffer =
        |bytes: &[u8]| buffers.add(ShaderBuffer::new(bytes, RenderAssetUsages::RENDER_WORLD));
    kind.layers = buffer(bytemuck::cast_slice(&gpu.layers));
    kind.data = buffer(bytemuck::cast_slice(&gpu.data));
    kind.heights = gpu.uniform.into();
    let uniforms = HeightUniform::min_size().get() + GroundLook::min_size().get();
    kind.buffer_bytes = (size_of_val(&*gpu.layers) + size_of_val(&*gpu.data)) as u64 + uniforms;
    let bounds = terrain.bounds(&terrain.extent());
    kind.heights_apart = (bounds.max - bounds.min).max(0.0);
    kind.extent_min = terrain.extent().min;
    kind.edits = gpu.edits.map(Arc::new);
    kind.terrain = Some(terrain);
}

/// Bytes of an image on the GPU, with its mip levels.
fn image_bytes(image: &Image) -> u64 {
    let descriptor = &image.texture_descriptor;
    let (width, height) = descriptor.format.block_dimensions();
    let block = descriptor.format.block_copy_size(None).unwrap_or(0);
    let level = |level: u32| {
        let size = descriptor.size.mip_level_size(level, descriptor.dimension);
        let sides = [
            size.width.div_ceil(width),
            size.height.div_ceil(height),
            size.depth_or_array_layers,
            block,
        ];
        sides.map(u64::from).iter().product::<u64>()
    };
    (0..descriptor.mip_level_count).map(level).sum()
}

/// Most that any view asks for whose ground is of patches.
fn pool(views: &Query<Option<&PatchDetail>, With<TerrainView>>) -> PatchPool {
    let details = views.iter().flatten().map(|detail| detail.clamped());
    let [vertices, primitives] = details.fold([1; 2], |[vertices, primitives], detail| {
        [
            vertices.max(detail.max_vertices),
            primitives.max(detail.max_triangles),
        ]
    });
    PatchPool {
        vertices,
        primitives,
    }
}
