//! The pipelines: Bevy's own for its lighting pass, with our shaders and one bind group more.

use std::collections::HashMap;

use bevy::mesh::VertexBufferLayout;
use bevy::pbr::deferred::DeferredLightingLayout;
use bevy::pbr::{MeshPipelineKey, ViewKeyCache};
use bevy::prelude::*;
use bevy::render::render_resource::binding_types::{
    storage_buffer_read_only_sized, storage_buffer_sized, texture_2d, texture_depth_2d,
    uniform_buffer, uniform_buffer_sized,
};
use bevy::render::render_resource::{
    BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindGroupLayoutEntryBuilder, BlendComponent,
    BlendFactor, BlendOperation, BlendState, CachedComputePipelineId, CachedRenderPipelineId,
    ColorTargetState, ColorWrites, CompareFunction, ComputePipelineDescriptor, DepthStencilState,
    Face, PipelineCache, PrimitiveState, RenderPipelineDescriptor, ShaderStages,
    SpecializedRenderPipeline, TextureFormat, TextureSampleType, VertexFormat, VertexStepMode,
};
use bevy::render::view::{ExtractedView, ViewUniform};
use bevy::shader::ShaderDefVal;

use super::prepare::{ViewLighting, ViewPipelines};
use super::shaders::Shaders;
use crate::choice::Chosen;

/// Every pipeline that a view has asked for.
#[derive(Resource, Default)]
pub struct Pipelines {
    light: HashMap<(MeshPipelineKey, Chosen), CachedRenderPipelineId>,
    volumes: HashMap<(MeshPipelineKey, bool), CachedRenderPipelineId>,
    tiles: HashMap<u32, CachedComputePipelineId>,
}

type Entry = (u32, BindGroupLayoutEntryBuilder);

fn layout(
    label: &'static str,
    stages: ShaderStages,
    entries: &[Entry],
) -> BindGroupLayoutDescriptor {
    let entries: Vec<BindGroupLayoutEntry> = entries
        .iter()
        .map(|(binding, entry)| entry.clone().build(*binding, stages))
        .collect();
    BindGroupLayoutDescriptor::new(label, &entries)
}

/// The layout of our group in the full-screen pass; `None` for the hulls.
pub fn light_layout(chosen: Option<Chosen>) -> BindGroupLayoutDescriptor {
    let read = || storage_buffer_read_only_sized(false, None);
    let mut entries: Vec<Entry> = vec![
        (0, uniform_buffer_sized(false, None)),
        (3, texture_2d(TextureSampleType::Uint)),
    ];
    if chosen != Some(Chosen::Nothing) {
        entries.extend([(1, read()), (2, read())]);
    }
    match chosen {
        Some(Chosen::Tiled) => entries.push((4, read())),
        Some(Chosen::Volumes) => {
            entries.push((
                4,
                texture_2d(TextureSampleType::Float { filterable: false }),
            ));
        }
        _ => {}
    }
    layout(
        "dolomite_deferred_light",
        ShaderStages::VERTEX_FRAGMENT,
        &entries,
    )
}

/// The layout of the pass that lists the lights of tiles.
pub fn tiles_layout() -> BindGroupLayoutDescriptor {
    let entries = [
        (0, uniform_buffer::<ViewUniform>(true)),
        (1, uniform_buffer_sized(false, None)),
        (2, storage_buffer_read_only_sized(false, None)),
        (3, storage_buffer_read_only_sized(false, None)),
        (4, texture_depth_2d()),
        (5, storage_buffer_sized(false, None)),
        (6, storage_buffer_sized(false, None)),
    ];
    layout("dolomite_deferred_tiles", ShaderStages::COMPUTE, &entries)
}

/// Gives views the pipelines of their way.
pub fn prepare(
    mut views: Query<(&ExtractedView, &mut ViewLighting)>,
    keys: Res<ViewKeyCache>,
    bevys: Option<Res<DeferredLightingLayout>>,
    cache: Res<PipelineCache>,
    shaders: Res<Shaders>,
    mut pipelines: ResMut<Pipelines>,
) {
    for (view, mut lighting) in &mut views {
        lighting.pipelines = ViewPipelines::default();
        let (Some(chosen), Some(key)) = (lighting.chosen, keys.get(&view.retained_view_entity))
        else {
            continue;
        };
        let Some(bevys) = &bevys else {
            bevy::log::warn_once!(
                "DeferredLighting needs Bevy's deferred lighting plugin (PbrPlugin::add_default_deferred_lighting_plugin), which was left out"
            );
            continue;
        };
        let light = pipelines
            .light
            .entry((*key, chosen))
            .or_insert_with(|| cache.queue_render_pipeline(light(bevys, *key, chosen, &shaders)));
        lighting.pipelines.light = Some(*light);
        if chosen == Chosen::Volumes {
            let both = [false, true].map(|spots| {
                let known = pipelines.volumes.entry((*key, spots));
                *known.or_insert_with(|| {
                    cache.queue_render_pipeline(volumes(bevys, *key, spots, &shaders))
                })
            });
            lighting.pipelines.volumes = Some(both);
        }
        if chosen == Chosen::Tiled {
            let words = lighting.mask_words();
            let known = pipelines.tiles.entry(words);
            let id = known.or_insert_with(|| cache.queue_compute_pipeline(tiles(words, &shaders)));
            lighting.pipelines.tiles = Some(*id);
        }
    }
}

/// Bevy's descriptor with our group, so that definitions and layouts of its views stay Bevy's.
fn bevys_with(
    bevys: &DeferredLightingLayout,
    key: MeshPipelineKey,
    group: BindGroupLayoutDescriptor,
    defs: &[&str],
) -> RenderPipelineDescriptor {
    let mut descriptor = bevys.specialize(key);
    descriptor.layout.truncate(2);
    descriptor.layout.push(group);
    let mut defs: Vec<ShaderDefVal> = defs.iter().map(|def| (*def).into()).collect();
    if key.intersects(MeshPipelineKey::ENVIRONMENT_MAP | MeshPipelineKey::IRRADIANCE_VOLUME) {
        defs.push("NEEDS_PROBES".into());
    }
    descriptor.vertex.shader_defs.extend(defs.iter().cloned());
    descriptor.vertex.entry_point = Some("vertex".into());
    if let Some(fragment) = &mut descriptor.fragment {
        fragment.shader_defs.extend(defs);
        fragment.entry_point = Some("fragment".into());
    }
    descriptor
}

fn light(
    bevys: &DeferredLightingLayout,
    key: MeshPipelineKey,
    chosen: Chosen,
    shaders: &Shaders,
) -> RenderPipelineDescriptor {
    let way: &[&str] = match chosen {
        Chosen::Nothing => &[],
        Chosen::BruteForce => &["BRUTE_FORCE"],
        Chosen::Tiled => &["TILED"],
        Chosen::Volumes => &["VOLUMES"],
    };
    let mut descriptor = bevys_with(bevys, key, light_layout(Some(chosen)), way);
    descriptor.label = Some("dolomite_deferred_light".into());
    descriptor.vertex.shader = shaders.light.clone();
    if let Some(fragment) = &mut descriptor.fragment {
        fragment.shader = shaders.light.clone();
    }
    if let Some(depth) = &mut descriptor.depth_stencil {
        // Against 0, the id of what is not lit.
        depth.depth_compare = Some(CompareFunction::NotEqual);
    }
    descriptor
}

fn volumes(
    bevys: &DeferredLightingLayout,
    key: MeshPipelineKey,
    spots: bool,
    shaders: &Shaders,
) -> RenderPipelineDescriptor {
    let kind: &[&str] = if spots { &["SPOTS"] } else { &[] };
    let mut descriptor = bevys_with(bevys, key, light_layout(None), kind);
    descriptor.label = Some("dolomite_deferred_volumes".into());
    descriptor.vertex.shader = shaders.volume.clone();
    descriptor.vertex.buffers = vec![VertexBufferLayout::from_vertex_formats(
        VertexStepMode::Vertex,
        [VertexFormat::Float32x3],
    )];
    if let Some(fragment) = &mut descriptor.fragment {
        fragment.shader = shaders.volume.clone();
        let sum = BlendComponent {
            src_factor: BlendFactor::One,
            dst_factor: BlendFactor::One,
            operation: BlendOperation::Add,
        };
        fragment.targets = vec![Some(ColorTargetState {
            format: TextureFormat::Rgba32Float,
            blend: Some(BlendState {
                color: sum,
                alpha: sum,
            }),
            write_mask: ColorWrites::ALL,
        })];
    }
    descriptor.primitive = PrimitiveState {
        cull_mode: Some(Face::Front),
        ..default()
    };
    // Behind the surface: depth is reversed.
    descriptor.depth_stencil = Some(DepthStencilState {
        format: TextureFormat::Depth32Float,
        depth_write_enabled: Some(false),
        depth_compare: Some(CompareFunction::LessEqual),
        stencil: default(),
        bias: default(),
    });
    descriptor
}

fn tiles(words: u32, shaders: &Shaders) -> ComputePipelineDescriptor {
    ComputePipelineDescriptor {
        label: Some("dolomite_deferred_tiles".into()),
        layout: vec![tiles_layout()],
        shader: shaders.tiles.clone(),
        shader_defs: vec![ShaderDefVal::UInt("MASK_WORDS".into(), words)],
        entry_point: Some("list".into()),
        ..default()
    }
}
