//! Layouts and pipelines; made when a view first has something that grows.

use std::num::NonZero;

use bevy::core_pipeline::core_3d::CORE_3D_DEPTH_FORMAT;
use bevy::core_pipeline::deferred::{DEFERRED_LIGHTING_PASS_ID_FORMAT, DEFERRED_PREPASS_FORMAT};
use bevy::core_pipeline::prepass::{
    MOTION_VECTOR_PREPASS_FORMAT, NORMAL_PREPASS_FORMAT, ViewPrepassTextures,
};
use bevy::prelude::*;
use bevy::render::render_resource::binding_types::{
    storage_buffer_read_only_sized, storage_buffer_sized, uniform_buffer_sized,
};
use bevy::render::render_resource::{
    BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedComputePipelineId,
    CachedRenderPipelineId, ColorTargetState, ColorWrites, CompareFunction, ComputePipeline,
    ComputePipelineDescriptor, DepthStencilState, FragmentState, PipelineCache, PrimitiveState,
    RenderPipeline, RenderPipelineDescriptor, ShaderStages, TextureFormat, VertexState,
};
use bevy::shader::{Shader, ShaderDefVal};
use dolomite_geometry::render::{ModuleShaders, pipeline_fault, shader_asset};

use super::layout::{BladeView, GrowParams, LISTS};
use super::lists::{BLADES, LIST, SHADOW_DEFS, draw_defs, rank_defs};
use super::record::{PASSES, Second};

/// The shaders, as assets.
#[derive(Resource, Clone)]
pub struct VegetationShaders {
    passes: Vec<Handle<Shader>>,
    draws: [Handle<Shader>; LISTS],
    _modules: ModuleShaders,
}

impl VegetationShaders {
    /// Of an app that has shaders.
    pub fn load(app: &mut App) -> Option<Self> {
        let modules = ModuleShaders::load(app)?;
        let mut assets = app.world_mut().get_resource_mut::<Assets<Shader>>()?;
        let mut add =
            |file: &str| assets.add(shader_asset(dolomite_shaders::find(file).source, file));
        Some(Self {
            passes: PASSES.iter().map(|(file, ..)| add(file)).collect(),
            draws: LIST.map(|list| add(list.file)),
            _modules: modules,
        })
    }
}

/// What the pipelines of a view's draws depend on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DrawKey {
    normals: bool,
    motion: bool,
}

impl DrawKey {
    /// Of a view with a G-buffer.
    pub fn new(prepass: &ViewPrepassTextures) -> Option<Self> {
        prepass.deferred.as_ref()?;
        Some(Self {
            normals: prepass.normal.is_some(),
            motion: prepass.motion_vectors.is_some(),
        })
    }
}

/// Layouts and pipelines.
pub struct VegetationPipelines {
    /// Group 0 of the passes.
    pub shared: BindGroupLayoutDescriptor,
    /// Group 1 of passes, by [`Second`].
    pub arguments: BindGroupLayoutDescriptor,
    /// See [`Second::Records`].
    pub records: BindGroupLayoutDescriptor,
    /// Group 0 of the draws.
    pub draw: BindGroupLayoutDescriptor,
    /// Group 1 of the draws into shadow maps.
    pub shadow_view: BindGroupLayoutDescriptor,
    passes: Vec<CachedComputePipelineId>,
    shadow: Option<CachedRenderPipelineId>,
    draws: Vec<(DrawKey, [Option<CachedRenderPipelineId>; LISTS])>,
    shaders: [Handle<Shader>; LISTS],
}

impl VegetationPipelines {
    /// Queues the passes.
    pub fn new(shaders: &VegetationShaders, cache: &PipelineCache) -> Self {
        let compute = ShaderStages::COMPUTE;
        let uniform = |size: usize| uniform_buffer_sized(false, NonZero::new(size as u64));
        let read = || storage_buffer_read_only_sized(false, None);
        let write = || storage_buffer_sized(false, None);
        let shared = BindGroupLayoutDescriptor::new(
            "vegetation_shared",
            &BindGroupLayoutEntries::sequential(
                compute,
                (
                    uniform(size_of::<GrowParams>()),
                    read(),
                    read(),
                    read(),
                    write(),
                    write(),
                ),
            ),
        );
        let single = |name| {
            BindGroupLayoutDescriptor::new(name, &BindGroupLayoutEntries::single(compute, write()))
        };
        let arguments = single("vegetation_arguments");
        let records = single("vegetation_records");
        let draw = BindGroupLayoutDescriptor::new(
            "vegetation_draw",
            &BindGroupLayoutEntries::sequential(
                ShaderStages::VERTEX_FRAGMENT,
                (uniform(size_of::<BladeView>()), read()),
            ),
        );
        let shadow_view = BindGroupLayoutDescriptor::new(
            "vegetation_shadow_view",
            &BindGroupLayoutEntries::single(
                ShaderStages::VERTEX,
                uniform_buffer_sized(true, NonZero::new(64)),
            ),
        );
        let passes = PASSES
            .iter()
            .zip(&shaders.passes)
            .map(|((_, entry, second), shader)| {
                let second = match second {
                    Second::Nothing => None,
                    Second::Arguments => Some(&arguments),
                    Second::Records => Some(&records),
                };
                cache.queue_compute_pipeline(ComputePipelineDescriptor {
                    label: Some(format!("vegetation_{entry}").into()),
                    layout: [&shared].into_iter().chain(second).cloned().collect(),
                    shader: shader.clone(),
                    entry_point: Some((*entry).into()),
                    ..default()
                })
            })
            .collect();
        Self {
            shared,
            arguments,
            records,
            draw,
            shadow_view,
            shadow: None,
            passes,
            draws: Vec::new(),
            shaders: shaders.draws.clone(),
        }
    }

    /// Queues the draws of the lists that are used in such views, the first time.
    pub fn want_draws(&mut self, key: DrawKey, used: [bool; LISTS], cache: &PipelineCache) {
        let known = self.draws.iter().position(|(known, _)| *known == key);
        let mut ids = known.map_or([None; LISTS], |place| self.draws[place].1);
        for list in 0..LISTS {
            if used[list] && ids[list].is_none() {
                ids[list] = Some(cache.queue_render_pipeline(self.descriptor(list, key)));
            }
        }
        match known {
            Some(place) => self.draws[place].1 = ids,
            None => self.draws.push((key, ids)),
        }
    }

    /// Queues the draws into shadow maps, the first time.
    pub fn want_shadows(&mut self, cache: &PipelineCache) {
        if self.shadow.is_some() {
            return;
        }
        let nearest = self.descriptor(BLADES, DrawKey::default());
        let defs = SHADOW_DEFS.map(ShaderDefVal::from).to_vec();
        self.shadow = Some(cache.queue_render_pipeline(RenderPipelineDescriptor {
            label: Some("vegetation_shadows".into()),
            layout: vec![self.draw.clone(), self.shadow_view.clone()],
            vertex: VertexState {
                shader_defs: defs,
                ..nearest.vertex
            },
            fragment: None,
            ..nearest
        }));
    }

    /// The draws into shadow maps, once they are there.
    pub fn shadows<'a>(&self, cache: &'a PipelineCache) -> Option<&'a RenderPipeline> {
        cache.get_render_pipeline(self.shadow?)
    }

    /// What draws a list for its ranks into a texture of this format, behind the view's depths; `kinds` is its group 1.
    pub fn ranks(
        &self,
        list: usize,
        kinds: &BindGroupLayoutDescriptor,
        format: TextureFormat,
    ) -> RenderPipelineDescriptor {
        let mut descriptor = self.descriptor(list, DrawKey::default());
        let defs: Vec<ShaderDefVal> = rank_defs(list).into_iter().map(Into::into).collect();
        descriptor.label = Some("vegetation_ranks".into());
        descriptor.layout.push(kinds.clone());
        descriptor.vertex.shader_defs.clone_from(&defs);
        if let Some(fragment) = &mut descriptor.fragment {
            fragment.shader_defs = defs;
            fragment.targets = vec![Some(ColorTargetState {
                format,
                blend: None,
                write_mask: ColorWrites::ALL,
            })];
        }
        if let Some(depth) = &mut descriptor.depth_stencil {
            // What was drawn is drawn again, by another pipeline, which may round otherwise.
            depth.depth_write_enabled = Some(false);
            depth.bias.constant = 64;
        }
        descriptor
    }

    fn descriptor(&self, list: usize, key: DrawKey) -> RenderPipelineDescriptor {
        let target = |format: TextureFormat| {
            Some(ColorTargetState {
                format,
                blend: None,
                write_mask: ColorWrites::ALL,
            })
        };
        let defs: Vec<ShaderDefVal> = draw_defs(list, key.normals, key.motion)
            .into_iter()
            .map(ShaderDefVal::from)
            .collect();
        RenderPipelineDescriptor {
            label: Some(LIST[list].label.into()),
            layout: vec![self.draw.clone()],
            vertex: VertexState {
                shader: self.shaders[list].clone(),
                shader_defs: defs.clone(),
                entry_point: Some("vertex".into()),
                buffers: Vec::new(),
            },
            fragment: Some(FragmentState {
                shader: self.shaders[list].clone(),
                shader_defs: defs,
                entry_point: Some("fragment".into()),
                targets: vec![
                    key.normals.then(|| target(NORMAL_PREPASS_FORMAT)).flatten(),
                    key.motion
                        .then(|| target(MOTION_VECTOR_PREPASS_FORMAT))
                        .flatten(),
                    target(DEFERRED_PREPASS_FORMAT),
                    target(DEFERRED_LIGHTING_PASS_ID_FORMAT),
                ],
            }),
            primitive: PrimitiveState {
                // Without indices: a strip ends with its instance.
                topology: LIST[list].topology,
                cull_mode: None,
                ..default()
            },
            depth_stencil: Some(DepthStencilState {
                format: CORE_3D_DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(CompareFunction::GreaterEqual),
                stencil: default(),
                bias: default(),
            }),
            ..default()
        }
    }

    /// The passes, once all are there.
    pub fn passes<'a>(
        &self,
        cache: &'a PipelineCache,
    ) -> Option<[&'a ComputePipeline; PASSES.len()]> {
        let ready = self.passes.iter().map(|id| cache.get_compute_pipeline(*id));
        ready.collect::<Option<Vec<_>>>()?.try_into().ok()
    }

    /// The draws of such a view, once all that were wanted are there.
    pub fn draws<'a>(
        &self,
        key: DrawKey,
        cache: &'a PipelineCache,
    ) -> Option<[Option<&'a RenderPipeline>; LISTS]> {
        let (_, ids) = self.draws.iter().find(|(known, _)| *known == key)?;
        let mut ready = [None; LISTS];
        for (slot, id) in ready.iter_mut().zip(ids) {
            if let Some(id) = id {
                *slot = Some(cache.get_render_pipeline(*id)?);
            }
        }
        Some(ready)
    }

    /// Number of pipelines queued.
    pub fn count(&self) -> usize {
        let draws = self.draws.iter().flat_map(|(_, ids)| ids).flatten().count();
        self.passes.len() + draws + usize::from(self.shadow.is_some())
    }

    /// Why a pipeline could not be made, if one could not.
    pub fn fault(&self, cache: &PipelineCache) -> Option<String> {
        let passes = self
            .passes
            .iter()
            .map(|id| cache.get_compute_pipeline_state(*id));
        let draws = self
            .draws
            .iter()
            .flat_map(|(_, ids)| ids)
            .flatten()
            .chain(&self.shadow);
        let draws = draws.map(|id| cache.get_render_pipeline_state(*id));
        passes.chain(draws).find_map(pipeline_fault)
    }
}
