//! Buffers, uniforms and bind groups of the terrain and of each view, and the decision whether a
//! view has anything to do.

use std::collections::HashMap;
use std::sync::Arc;

use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::math::{DMat4, DVec2};
use bevy::pbr::{ShadowView, ViewLightEntities};
use bevy::prelude::*;
use bevy::render::camera::TemporalJitter;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_resource::{
    AddressMode, BindGroup, BindGroupEntries, Buffer, BufferBinding, BufferDescriptor,
    BufferInitDescriptor, BufferUsages, CachedRenderPipelineId, FilterMode, MipmapFilterMode,
    PipelineCache, SamplerDescriptor,
};
use bevy::render::renderer::{RenderAdapterInfo, RenderDevice, RenderQueue};
use bevy::render::texture::{FallbackImage, GpuImage};
use bevy::render::view::ExtractedView;

use super::extract::{ExtractedTerrain, ExtractedTerrainView};
use super::layout::{DRAW_SLOT, DrawParams, FILL, LINES};
use super::params::{Camera, draw_params, from_anchor, view_params};
use super::pipeline::{DrawKey, Pipelines, Shaders};
use super::readback::Counters;
use crate::cover::Cover;
use crate::layout::{PlanResult, ViewParams};
use crate::settings::TerrainView;

/// Views that cast this terrain's shadows at most; more are not drawn into.
const SHADOW_SLOTS: u64 = 16;

/// The height function on the GPU.
#[derive(Resource, Default)]
pub struct TerrainBuffers {
    version: u64,
    layers: Option<Buffer>,
    data: Option<Buffer>,
    uniform: Option<Buffer>,
    /// Bind group 1 of the compute passes.
    pub group: Option<BindGroup>,
    /// Bind group 1 of the draws, and the images that it was made of.
    pub material: Option<BindGroup>,
    material_images: Vec<AssetId<Image>>,
}

impl TerrainBuffers {
    /// Buffers that exist.
    pub fn count(&self) -> usize {
        [&self.layers, &self.data, &self.uniform]
            .into_iter()
            .flatten()
            .count()
    }
}

/// Buffers of one view: three of records, uniform, vertices, indices, result, draws, counters.
pub const VIEW_BUFFERS: usize = 9;

/// State of every view that tessellates, by render-world entity.
#[derive(Resource, Default)]
pub struct TerrainViews(pub HashMap<Entity, ViewState>);

/// Buffers and decisions of one view.
pub struct ViewState {
    cover: Arc<Cover>,
    terrain_version: u64,
    params: ViewParams,
    previous_clip_from_world: Option<DMat4>,
    /// False when this frame has to dispatch.
    pub settled: bool,
    /// Whether the buffers hold a finished tessellation.
    pub filled: bool,
    /// Threads of the levels pass, workgroups of the emit pass.
    pub counts: [u32; 2],
    pub lines: bool,
    pub visible: bool,
    pub pipeline: Option<CachedRenderPipelineId>,
    /// Shadow views to draw into, and the slot of each.
    pub shadows: Vec<(Entity, u32)>,
    pub indices: Buffer,
    pub result: Buffer,
    pub counters: Counters<PlanResult>,
    pub groups: Option<ViewGroups>,
    records: [Buffer; 3],
    uniform: Buffer,
    vertices: Buffer,
    draw: Buffer,
}

/// Bind groups of one view.
pub struct ViewGroups {
    pub levels: BindGroup,
    pub plan: BindGroup,
    pub emit: BindGroup,
    pub draw: BindGroup,
    pub lines: BindGroup,
}

/// Uploads the height function when it changed.
pub fn terrain(
    extracted: Res<ExtractedTerrain>,
    mut buffers: ResMut<TerrainBuffers>,
    pipelines: Option<Res<Pipelines>>,
    device: Res<RenderDevice>,
) {
    let (Some(terrain), Some(_)) = (&extracted.current, pipelines) else {
        if extracted.current.is_none() && buffers.version != 0 {
            *buffers = TerrainBuffers::default();
        }
        return;
    };
    if buffers.version == extracted.version {
        return;
    }
    let storage = |label, contents: &[u8]| {
        device.create_buffer_with_data(&BufferInitDescriptor {
            label: Some(label),
            contents,
            usage: BufferUsages::STORAGE,
        })
    };
    buffers.version = extracted.version;
    buffers.layers = Some(storage(
        "terrain_layers",
        bytemuck::cast_slice(&terrain.gpu.layers),
    ));
    buffers.data = Some(storage(
        "terrain_data",
        bytemuck::cast_slice(&terrain.gpu.data),
    ));
    buffers.uniform = Some(device.create_buffer_with_data(&BufferInitDescriptor {
        label: Some("terrain_uniform"),
        contents: bytemuck::bytes_of(&terrain.gpu.uniform),
        usage: BufferUsages::UNIFORM,
    }));
    buffers.group = None;
}

type ViewItem<'a> = (
    Entity,
    &'a ExtractedView,
    &'a ExtractedTerrainView,
    Option<&'a ViewLightEntities>,
    Option<&'a TemporalJitter>,
    Option<&'a ViewPrepassTextures>,
);

/// Writes each view's uniforms, and unsettles the views whose key changed.
#[expect(
    clippy::too_many_arguments,
    reason = "a system's arguments are what it reads"
)]
pub fn views(
    extracted: Res<ExtractedTerrain>,
    mut states: ResMut<TerrainViews>,
    views: Query<ViewItem>,
    shadow_views: Query<&ExtractedView, With<ShadowView>>,
    pipelines: Option<ResMut<Pipelines>>,
    shaders: Res<Shaders>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    let (Some(terrain), Some(mut pipelines)) = (&extracted.current, pipelines) else {
        states.0.clear();
        return;
    };
    states.0.retain(|entity, _| views.contains(*entity));
    for (entity, view, settings, lights, jitter, prepass) in &views {
        let TerrainView { fill, lines, .. } = settings.settings;
        if settings.cover.patches.is_empty() {
            states.0.remove(&entity);
            continue;
        }
        let camera = Camera::new(view, jitter);
        let params = view_params(view, &camera, settings, terrain, extracted.sun);
        let state = states
            .0
            .entry(entity)
            .or_insert_with(|| ViewState::new(&device, &settings.settings, &settings.cover));
        state.update(&device, &queue, settings, &params, extracted.version);
        state.visible = fill || lines;
        state.lines = lines;
        state.pipeline = prepass.map(|prepass| {
            let key = DrawKey {
                lines,
                normals: prepass.normal.is_some(),
                motion: prepass.motion_vectors.is_some(),
            };
            pipelines.draw(&cache, &shaders, key)
        });
        let anchor = DVec2::new(f64::from(params.anchor[0]), f64::from(params.anchor[1]));
        let mut main = draw_params(terrain, &camera, anchor, view, extracted.time);
        main.flags = u32::from(fill) * FILL + u32::from(lines) * LINES;
        let before = state
            .previous_clip_from_world
            .unwrap_or(camera.clip_from_world);
        main.previous_clip_from_anchor = from_anchor(before, anchor);
        state.previous_clip_from_world = Some(camera.clip_from_world);
        queue.write_buffer(&state.draw, 0, bytemuck::bytes_of(&main));
        state.shadows.clear();
        for light in lights
            .into_iter()
            .flat_map(|lights| lights.lights.iter().copied())
        {
            let slot = state.shadows.len() as u64 + 1;
            let Ok(shadow) = shadow_views.get(light) else {
                continue;
            };
            if slot > SHADOW_SLOTS {
                break;
            }
            let clip = Camera::new(shadow, None).clip_from_world;
            let params = DrawParams {
                clip_from_anchor: from_anchor(clip, anchor),
                ..main
            };
            queue.write_buffer(&state.draw, slot * DRAW_SLOT, bytemuck::bytes_of(&params));
            state.shadows.push((light, (slot * DRAW_SLOT) as u32));
        }
    }
}

impl ViewState {
    fn new(device: &RenderDevice, settings: &TerrainView, cover: &Arc<Cover>) -> Self {
        let buffer = |label, size: u64, usage| {
            device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let storage = BufferUsages::STORAGE;
        Self {
            cover: cover.clone(),
            terrain_version: 0,
            params: bytemuck::Zeroable::zeroed(),
            previous_clip_from_world: None,
            settled: false,
            filled: false,
            counts: [0; 2],
            lines: false,
            visible: true,
            pipeline: None,
            shadows: Vec::new(),
            vertices: buffer(
                "terrain_vertices",
                u64::from(settings.max_vertices) * 16,
                storage | BufferUsages::COPY_SRC,
            ),
            indices: buffer(
                "terrain_indices",
                u64::from(settings.max_triangles) * 12,
                storage | BufferUsages::INDEX | BufferUsages::COPY_SRC,
            ),
            result: buffer(
                "terrain_plan_result",
                size_of::<PlanResult>() as u64,
                storage | BufferUsages::INDIRECT | BufferUsages::COPY_SRC,
            ),
            counters: Counters::new(device),
            groups: None,
            records: records(device, cover),
            uniform: buffer(
                "terrain_view",
                size_of::<ViewParams>() as u64,
                BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            ),
            draw: buffer(
                "terrain_draw",
                DRAW_SLOT * (SHADOW_SLOTS + 1),
                BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            ),
        }
    }

    /// Takes over this frame's inputs; unsettles the view if any of them changed.
    fn update(
        &mut self,
        device: &RenderDevice,
        queue: &RenderQueue,
        settings: &ExtractedTerrainView,
        params: &ViewParams,
        terrain_version: u64,
    ) {
        let pools = [
            settings.settings.max_vertices,
            settings.settings.max_triangles,
        ];
        if pools != [self.params.max_vertices, self.params.max_triangles]
            && self.params.max_vertices != 0
        {
            *self = Self::new(device, &settings.settings, &settings.cover);
        }
        let same_cover = Arc::ptr_eq(&self.cover, &settings.cover);
        if !same_cover {
            let counts =
                |cover: &Cover| [cover.corners.len(), cover.edges.len(), cover.patches.len()];
            if self.fits(counts(&settings.cover)) {
                queue.write_buffer(
                    &self.records[0],
                    0,
                    bytemuck::cast_slice(&settings.cover.corners),
                );
                queue.write_buffer(
                    &self.records[1],
                    0,
                    bytemuck::cast_slice(&settings.cover.edges),
                );
                queue.write_buffer(
                    &self.records[2],
                    0,
                    bytemuck::cast_slice(&settings.cover.patches),
                );
            } else {
                self.records = records(device, &settings.cover);
                self.groups = None;
            }
            self.cover = settings.cover.clone();
        }
        let unchanged =
            same_cover && self.params == *params && self.terrain_version == terrain_version;
        if !unchanged {
            self.settled = false;
            self.params = *params;
            self.terrain_version = terrain_version;
            queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(params));
            let [corners, edges, patches] =
                [params.corner_count, params.edge_count, params.patch_count];
            self.counts = [edges.max(patches), patches + edges + corners.div_ceil(64)];
        }
    }

    fn fits(&self, [corners, edges, patches]: [usize; 3]) -> bool {
        let room = |buffer: &Buffer, size: usize| buffer.size() >= size as u64;
        room(
            &self.records[0],
            corners * size_of::<crate::layout::Corner>(),
        ) && room(&self.records[1], edges * size_of::<crate::layout::Edge>())
            && room(
                &self.records[2],
                patches * size_of::<crate::layout::Patch>(),
            )
    }
}

/// Buffers for corners, edges and patches with a quarter to spare, so that a moving camera seldom
/// needs new ones.
fn records(device: &RenderDevice, cover: &Cover) -> [Buffer; 3] {
    let make = |label, contents: &[u8]| {
        let size = (contents.len() as u64 * 5 / 4)
            .next_multiple_of(256)
            .max(256);
        let buffer = device.create_buffer(&BufferDescriptor {
            label: Some(label),
            size,
            usage: BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
            mapped_at_creation: true,
        });
        buffer
            .slice(..)
            .get_mapped_range_mut()
            .slice(..contents.len())
            .copy_from_slice(contents);
        buffer.unmap();
        buffer
    };
    [
        make("terrain_corners", bytemuck::cast_slice(&cover.corners)),
        make("terrain_edges", bytemuck::cast_slice(&cover.edges)),
        make("terrain_patches", bytemuck::cast_slice(&cover.patches)),
    ]
}

/// Makes the bind groups that are missing.
pub fn bind_groups(
    extracted: Res<ExtractedTerrain>,
    pipelines: Option<Res<Pipelines>>,
    mut terrain: ResMut<TerrainBuffers>,
    mut states: ResMut<TerrainViews>,
    images: Res<RenderAssets<GpuImage>>,
    fallback: Res<FallbackImage>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    adapter: Res<RenderAdapterInfo>,
) {
    let (Some(data), Some(pipelines)) = (&extracted.current, pipelines) else {
        return;
    };
    let terrain = &mut *terrain;
    if let (None, Some(layers), Some(values), Some(uniform)) = (
        &terrain.group,
        &terrain.layers,
        &terrain.data,
        &terrain.uniform,
    ) {
        terrain.group = Some(device.create_bind_group(
            "terrain_heights",
            &cache.get_bind_group_layout(&pipelines.terrain_layout),
            &BindGroupEntries::sequential((
                layers.as_entire_binding(),
                values.as_entire_binding(),
                uniform.as_entire_binding(),
            )),
        ));
    }
    let relief = data
        .relief
        .as_ref()
        .and_then(|relief| images.get(&relief.image));
    let albedo = images.get(&data.material.albedo_height);
    let normal = images.get(&data.material.normal_roughness);
    let is_array = |image: &&GpuImage| image.texture_descriptor.size.depth_or_array_layers > 1;
    match (albedo.filter(is_array), normal.filter(is_array)) {
        (Some(albedo), Some(normal)) => {
            let mut ids = vec![
                data.material.albedo_height.id(),
                data.material.normal_roughness.id(),
            ];
            ids.extend(
                relief
                    .and(data.relief.as_ref())
                    .map(|relief| relief.image.id()),
            );
            if terrain.material.is_none() || terrain.material_images != ids {
                let relief = relief.unwrap_or(&fallback.d2);
                // A processor that draws pays for every tap in full.
                let software = adapter.device_type == wgpu::DeviceType::Cpu;
                let textures = device.create_sampler(&SamplerDescriptor {
                    label: Some("terrain_textures"),
                    address_mode_u: AddressMode::Repeat,
                    address_mode_v: AddressMode::Repeat,
                    mag_filter: FilterMode::Linear,
                    min_filter: FilterMode::Linear,
                    mipmap_filter: MipmapFilterMode::Linear,
                    anisotropy_clamp: if software { 1 } else { 8 },
                    ..default()
                });
                terrain.material = Some(device.create_bind_group(
                    "terrain_material",
                    &cache.get_bind_group_layout(&pipelines.material_layout),
                    &BindGroupEntries::sequential((
                        &albedo.texture_view,
                        &normal.texture_view,
                        &textures,
                        &relief.texture_view,
                        &relief.sampler,
                    )),
                ));
                terrain.material_images = ids;
            }
        }
        _ => terrain.material = None,
    }
    for state in states.0.values_mut().filter(|state| state.groups.is_none()) {
        let [corners, edges, patches] = &state.records;
        let group = |name, layout, entries: &[_]| {
            device.create_bind_group(name, &cache.get_bind_group_layout(layout), entries)
        };
        let draw = || {
            bevy::render::render_resource::BindingResource::Buffer(BufferBinding {
                buffer: &state.draw,
                offset: 0,
                size: (size_of::<DrawParams>() as u64).try_into().ok(),
            })
        };
        let view = || state.uniform.as_entire_binding();
        state.groups = Some(ViewGroups {
            levels: group(
                "terrain_levels",
                &pipelines.levels_layout,
                &BindGroupEntries::sequential((
                    view(),
                    corners.as_entire_binding(),
                    edges.as_entire_binding(),
                    patches.as_entire_binding(),
                )),
            ),
            plan: group(
                "terrain_plan",
                &pipelines.plan_layout,
                &BindGroupEntries::sequential((
                    view(),
                    corners.as_entire_binding(),
                    edges.as_entire_binding(),
                    patches.as_entire_binding(),
                    state.result.as_entire_binding(),
                )),
            ),
            emit: group(
                "terrain_emit",
                &pipelines.emit_layout,
                &BindGroupEntries::sequential((
                    view(),
                    corners.as_entire_binding(),
                    edges.as_entire_binding(),
                    patches.as_entire_binding(),
                    state.vertices.as_entire_binding(),
                    state.indices.as_entire_binding(),
                )),
            ),
            draw: group(
                "terrain_draw",
                &pipelines.draw_layout,
                &BindGroupEntries::sequential((draw(), state.vertices.as_entire_binding())),
            ),
            lines: group(
                "terrain_lines",
                &pipelines.line_layout,
                &BindGroupEntries::sequential((
                    draw(),
                    state.vertices.as_entire_binding(),
                    state.indices.as_entire_binding(),
                )),
            ),
        });
    }
}
