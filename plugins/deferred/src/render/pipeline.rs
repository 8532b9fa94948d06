//! The pipelines: Bevy's own for its lighting pass, with our shaders and one bind group more.

use std::collections::HashMap;

use bevy::ecs::system::SystemParam;
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

use super::occlusion;
use super::shaders::Shaders;
use crate::choice::{Chosen, Suns, Variation};

/// Every pipeline that a view has asked for.
#[derive(Resource, Default)]
pub struct Pipelines {
    light: HashMap<(MeshPipelineKey, Variation, u8), CachedRenderPipelineId>,
    volumes: HashMap<(MeshPipelineKey, bool, bool), CachedRenderPipelineId>,
    tiles: HashMap<(u32, bool), CachedComputePipelineId>,
    pyramid: Option<[CachedComputePipelineId; 3]>,
    occlusion: Option<[CachedComputePipelineId; 2]>,
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

/// The layout of our group in the full-screen pass, which reads ambient occlusion where it is `occluded`; `None` for the
/// hulls.
pub fn light_layout(chosen: Option<Chosen>, occluded: bool) -> BindGroupLayoutDescriptor {
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
    if occluded {
        entries.push((
            5,
            texture_2d(TextureSampleType::Float { filterable: false }),
        ));
    }
    layout(
        "dolomite_deferred_light",
        ShaderStages::VERTEX_FRAGMENT,
        &entries,
    )
}

/// The layout of the pass that lists the lights of tiles; `culled` by the depth pyramid.
pub fn tiles_layout(culled: bool) -> BindGroupLayoutDescriptor {
    let mut entries: Vec<Entry> = vec![
        (0, uniform_buffer::<ViewUniform>(true)),
        (1, uniform_buffer_sized(false, None)),
        (2, storage_buffer_read_only_sized(false, None)),
        (3, storage_buffer_read_only_sized(false, None)),
        (4, texture_depth_2d()),
        (5, storage_buffer_sized(false, None)),
        (6, storage_buffer_sized(false, None)),
    ];
    if culled {
        entries.push((7, storage_buffer_read_only_sized(false, None)));
    }
    layout("dolomite_deferred_tiles", ShaderStages::COMPUTE, &entries)
}

/// The layout of the passes that make the levels of the depth pyramid.
pub fn build_layout(from_depth: bool) -> BindGroupLayoutDescriptor {
    let mut entries: Vec<Entry> = vec![
        (0, uniform_buffer_sized(false, None)),
        (1, storage_buffer_sized(false, None)),
    ];
    if from_depth {
        entries.push((2, texture_depth_2d()));
    }
    layout("dolomite_deferred_pyramid", ShaderStages::COMPUTE, &entries)
}

/// The layout of the pass that tests lights against the pyramid.
pub fn look_layout() -> BindGroupLayoutDescriptor {
    let entries = [
        (0, uniform_buffer::<ViewUniform>(true)),
        (1, uniform_buffer_sized(false, None)),
        (2, storage_buffer_read_only_sized(false, None)),
        (3, storage_buffer_read_only_sized(false, None)),
        (4, storage_buffer_read_only_sized(false, None)),
        (5, storage_buffer_sized(false, None)),
    ];
    layout("dolomite_deferred_shown", ShaderStages::COMPUTE, &entries)
}

/// The pipelines of a view.
#[derive(Clone, Debug, Default)]
pub struct ViewPipelines {
    /// The full-screen pass, one a shading model.
    pub light: Vec<CachedRenderPipelineId>,
    /// Hulls of points, and of spots, that cast no shadows.
    pub volumes: Option<[CachedRenderPipelineId; 2]>,
    /// Of those that do.
    pub casting: Option<[CachedRenderPipelineId; 2]>,
    /// Lists of tiles.
    pub tiles: Option<CachedComputePipelineId>,
    /// The depth pyramid: its first levels, those above, and the test of lights.
    pub pyramid: Option<[CachedComputePipelineId; 3]>,
    /// Ambient occlusion: the pass that looks around, and the one that takes the mean.
    pub occlusion: Option<[CachedComputePipelineId; 2]>,
}

/// Makes pipelines when they are first asked for.
#[derive(SystemParam)]
pub struct Maker<'w> {
    keys: Res<'w, ViewKeyCache>,
    bevys: Option<Res<'w, DeferredLightingLayout>>,
    cache: Res<'w, PipelineCache>,
    shaders: Res<'w, Shaders>,
    pipelines: ResMut<'w, Pipelines>,
}

impl Maker<'_> {
    /// Of a view, for a variation and so many words of the tiles' memory; `None` before Bevy knows the view.
    pub fn make(
        &mut self,
        view: &ExtractedView,
        variation: Variation,
        words: u32,
    ) -> Option<ViewPipelines> {
        let key = *self.keys.get(&view.retained_view_entity)?;
        let Some(bevys) = &self.bevys else {
            bevy::log::warn_once!(
                "DeferredLighting needs Bevy's deferred lighting plugin (PbrPlugin::add_default_deferred_lighting_plugin), which was left out"
            );
            return None;
        };
        let (cache, shaders) = (&self.cache, &self.shaders);
        let mut made = ViewPipelines::default();
        let chosen = variation.chosen;
        // Hulls have their shadows already.
        let of_light = Variation {
            casters: variation.casters && matches!(chosen, Chosen::Tiled | Chosen::BruteForce),
            culled: false,
            ..variation
        };
        for model in &shaders.models {
            let known = self.pipelines.light.entry((key, of_light, *model));
            let id = known.or_insert_with(|| {
                cache.queue_render_pipeline(light(bevys, key, of_light, *model, shaders))
            });
            made.light.push(*id);
        }
        if chosen == Chosen::Volumes {
            let mut both = |casting: bool| {
                [false, true].map(|spots| {
                    let known = self.pipelines.volumes.entry((key, spots, casting));
                    *known.or_insert_with(|| {
                        cache.queue_render_pipeline(volumes(bevys, key, spots, casting, shaders))
                    })
                })
            };
            made.volumes = Some(both(false));
            made.casting = variation.casters.then(|| both(true));
        }
        if chosen == Chosen::Tiled {
            let known = self.pipelines.tiles.entry((words, variation.culled));
            let id = known.or_insert_with(|| {
                cache.queue_compute_pipeline(tiles(words, variation.culled, shaders))
            });
            made.tiles = Some(*id);
            if variation.culled {
                let known = &mut self.pipelines.pyramid;
                let all = known.get_or_insert_with(|| {
                    pyramid(shaders).map(|descriptor| cache.queue_compute_pipeline(descriptor))
                });
                made.pyramid = Some(*all);
            }
        }
        if variation.occluded {
            let known = &mut self.pipelines.occlusion;
            let all = known.get_or_insert_with(|| {
                occlusion::pipelines(shaders)
                    .map(|descriptor| cache.queue_compute_pipeline(descriptor))
            });
            made.occlusion = Some(*all);
        }
        Some(made)
    }

    /// Whether all of them are compiled.
    pub fn ready(&self, made: &ViewPipelines) -> bool {
        let hulls = [made.volumes, made.casting].into_iter().flatten().flatten();
        let mut drawn = made.light.iter().copied().chain(hulls);
        let mut computed = made
            .tiles
            .into_iter()
            .chain(made.pyramid.into_iter().flatten())
            .chain(made.occlusion.into_iter().flatten());
        drawn.all(|id| self.cache.get_render_pipeline(id).is_some())
            && computed.all(|id| self.cache.get_compute_pipeline(id).is_some())
    }
}

/// Bevy's descriptor with our group, so that definitions and layouts of its views stay Bevy's.
fn bevys_with(
    bevys: &DeferredLightingLayout,
    key: MeshPipelineKey,
    group: BindGroupLayoutDescriptor,
    mut defs: Vec<ShaderDefVal>,
) -> RenderPipelineDescriptor {
    let mut descriptor = bevys.specialize(key);
    descriptor.layout.truncate(2);
    descriptor.layout.push(group);
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
    variation: Variation,
    model: u8,
    shaders: &Shaders,
) -> RenderPipelineDescriptor {
    let mut defs: Vec<ShaderDefVal> = match variation.chosen {
        Chosen::Nothing => vec![],
        Chosen::BruteForce => vec!["LISTS".into()],
        Chosen::Tiled => vec!["LISTS".into(), "TILED".into()],
        Chosen::Volumes => vec!["VOLUMES".into()],
    };
    match variation.suns {
        Suns::None => {}
        Suns::Open => defs.push("SUNS".into()),
        Suns::Shadowed => defs.extend(["SUNS".into(), "SUN_SHADOWS".into()]),
    }
    if variation.casters {
        defs.push("CASTERS".into());
    }
    if variation.occluded {
        defs.push("AMBIENT_OCCLUSION".into());
    }
    if variation.occluded || key.contains(MeshPipelineKey::SCREEN_SPACE_AMBIENT_OCCLUSION) {
        defs.push("OCCLUDED".into());
    }
    defs.push("ONE_MODEL".into());
    defs.push(format!("MODEL_{model}").as_str().into());
    defs.push(ShaderDefVal::UInt("MODEL".into(), model.into()));
    let mut descriptor = bevys_with(
        bevys,
        key,
        light_layout(Some(variation.chosen), variation.occluded),
        defs,
    );
    descriptor.label = Some("dolomite_deferred_light".into());
    descriptor.vertex.shader = shaders.light.clone();
    if let Some(fragment) = &mut descriptor.fragment {
        fragment.shader = shaders.light.clone();
    }
    descriptor
}

fn volumes(
    bevys: &DeferredLightingLayout,
    key: MeshPipelineKey,
    spots: bool,
    casting: bool,
    shaders: &Shaders,
) -> RenderPipelineDescriptor {
    let kinds = [(spots, "SPOTS"), (casting, "CASTERS")];
    let kinds = kinds.into_iter().filter(|(is, _)| *is);
    let defs = kinds.map(|(_, def)| def.into()).collect();
    let mut descriptor = bevys_with(bevys, key, light_layout(None, false), defs);
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

fn tiles(words: u32, culled: bool, shaders: &Shaders) -> ComputePipelineDescriptor {
    let mut shader_defs = vec![ShaderDefVal::UInt("MASK_WORDS".into(), words)];
    if culled {
        shader_defs.push("CULLED".into());
    }
    ComputePipelineDescriptor {
        label: Some("dolomite_deferred_tiles".into()),
        layout: vec![tiles_layout(culled)],
        shader: shaders.tiles.clone(),
        shader_defs,
        entry_point: Some("list".into()),
        ..default()
    }
}

fn pyramid(shaders: &Shaders) -> [ComputePipelineDescriptor; 3] {
    let build = |from_depth: bool| ComputePipelineDescriptor {
        label: Some("dolomite_deferred_pyramid".into()),
        layout: vec![build_layout(from_depth)],
        shader: shaders.pyramid_build.clone(),
        shader_defs: if from_depth {
            vec!["FROM_DEPTH".into()]
        } else {
            vec![]
        },
        entry_point: Some("halve".into()),
        ..default()
    };
    let look = ComputePipelineDescriptor {
        label: Some("dolomite_deferred_shown".into()),
        layout: vec![look_layout()],
        shader: shaders.pyramid_lights.clone(),
        entry_point: Some("look".into()),
        ..default()
    };
    [build(true), build(false), look]
}
