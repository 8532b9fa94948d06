//! Shaders, layouts and pipelines of a kind's passes; made when a camera first sees one of its patches.

use std::num::NonZero;

use bevy::prelude::*;
use bevy::render::render_resource::binding_types::{
    storage_buffer_read_only_sized, storage_buffer_sized, uniform_buffer_sized,
};
use bevy::render::render_resource::{
    BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedComputePipelineId, ComputePipeline,
    ComputePipelineDescriptor, PipelineCache, ShaderStages,
};
use bevy::shader::{Shader, ShaderDefVal};
use dolomite_geometry::render::{
    DRAW_FILE, DrawShader, DrawTraits, ModuleShaders, pipeline_fault, shader_asset,
};

use super::kind::{PatchKind, PatchShader};
use super::variants::{draw_source, kind_defs, pass_defs, pass_source};
use crate::layout::StageParams;
use crate::passes::{PASSES, SHADOW_RANGES, StagePass, pass_count};

/// Entry shaders of a kind, the user's functions named in them.
#[derive(Clone)]
pub struct KindShaders {
    /// In the order of [`PASSES`].
    passes: Vec<Handle<Shader>>,
    pub draw: DrawShader,
    /// Of kinds with a bounds function.
    ranges: Option<Handle<Shader>>,
    /// The user's file, unless the functions stand in a library.
    pub user: Option<Handle<Shader>>,
    _modules: ModuleShaders,
    defs: Vec<ShaderDefVal>,
}

impl KindShaders {
    /// Puts the user's functions into the stage's shaders; `None` in an app without shaders.
    pub fn new<K: PatchKind>(app: &mut App, name: &str) -> Option<Self> {
        let modules = ModuleShaders::load(app)?;
        let user = match K::shader() {
            PatchShader::File(path) => Some(app.world().get_resource::<AssetServer>()?.load(path)),
            PatchShader::Library(_) => None,
        };
        let mut assets = app.world_mut().get_resource_mut::<Assets<Shader>>()?;
        let mut add =
            |file: &str, source| assets.add(shader_asset(source, &format!("{file}#{name}")));
        let mut entry = |pass: &StagePass| add(pass.file, pass_source::<K>(pass));
        let passes = PASSES[..pass_count(K::LAYOUT.domain)]
            .iter()
            .map(&mut entry)
            .collect();
        let ranges = K::BOUNDED.then(|| entry(&SHADOW_RANGES));
        let defs = kind_defs::<K>();
        Some(Self {
            passes,
            draw: DrawShader {
                handle: add(DRAW_FILE, draw_source::<K>()),
                defs: defs.clone(),
            },
            ranges,
            user,
            _modules: modules,
            defs,
        })
    }
}

fn params() -> bevy::render::render_resource::BindGroupLayoutEntryBuilder {
    uniform_buffer_sized(false, NonZero::new(size_of::<StageParams>() as u64))
}

/// What the user's functions read, for vertex shaders: parameters, tables, data.
pub fn given_layout() -> BindGroupLayoutDescriptor {
    let read = || storage_buffer_read_only_sized(false, None);
    BindGroupLayoutDescriptor::new(
        "stage_given",
        &BindGroupLayoutEntries::sequential(ShaderStages::VERTEX, (params(), read(), read())),
    )
}

/// Layouts and pipelines of a kind.
pub struct KindPipelines {
    pub work_layout: BindGroupLayoutDescriptor,
    pub emit_layout: BindGroupLayoutDescriptor,
    /// In the order of [`PASSES`].
    passes: Vec<CachedComputePipelineId>,
    /// Of kinds with a bounds function: what shadow views see.
    pub ranges: Option<(BindGroupLayoutDescriptor, CachedComputePipelineId)>,
}

impl KindPipelines {
    /// Queues what every view of the kind of this name needs.
    pub fn new(
        name: &str,
        shaders: &KindShaders,
        traits: &DrawTraits,
        data_layout: &BindGroupLayoutDescriptor,
        cache: &PipelineCache,
    ) -> Self {
        let compute = ShaderStages::COMPUTE;
        let read = || storage_buffer_read_only_sized(false, None);
        let write = || storage_buffer_sized(false, None);
        let work_layout = BindGroupLayoutDescriptor::new(
            "stage_work",
            &BindGroupLayoutEntries::sequential(compute, (params(), read(), read(), write())),
        );
        let emit_layout = if traits.moves {
            BindGroupLayoutDescriptor::new(
                "stage_emit",
                &BindGroupLayoutEntries::sequential(
                    compute,
                    (params(), read(), read(), read(), write(), write(), write()),
                ),
            )
        } else {
            BindGroupLayoutDescriptor::new(
                "stage_emit",
                &BindGroupLayoutEntries::sequential(
                    compute,
                    (params(), read(), read(), read(), write(), write()),
                ),
            )
        };
        let queue = |pass: &StagePass, shader: &Handle<Shader>, layout| {
            cache.queue_compute_pipeline(ComputePipelineDescriptor {
                label: Some(format!("stage_{} {name}", pass.entry).into()),
                layout: vec![layout, data_layout.clone()],
                shader: shader.clone(),
                shader_defs: pass_defs(&shaders.defs, pass),
                entry_point: Some(pass.entry.into()),
                ..default()
            })
        };
        let passes = PASSES
            .iter()
            .zip(&shaders.passes)
            .map(|(pass, shader)| {
                let layout = if pass.emits {
                    &emit_layout
                } else {
                    &work_layout
                };
                queue(pass, shader, layout.clone())
            })
            .collect();
        let ranges = shaders
            .ranges
            .as_ref()
            .filter(|_| traits.bounded)
            .map(|shader| {
                let layout = super::ranges::layout();
                let id = queue(&SHADOW_RANGES, shader, layout.clone());
                (layout, id)
            });
        Self {
            work_layout,
            emit_layout,
            passes,
            ranges,
        }
    }

    /// Number of pipelines queued.
    pub fn count(&self) -> usize {
        self.queued().count()
    }

    /// All pipelines of a tessellation, once all are there.
    pub fn ready<'a>(&self, cache: &'a PipelineCache) -> Option<Vec<&'a ComputePipeline>> {
        let ids = self.passes.iter();
        ids.map(|id| cache.get_compute_pipeline(*id)).collect()
    }

    fn queued(&self) -> impl Iterator<Item = &CachedComputePipelineId> {
        self.passes
            .iter()
            .chain(self.ranges.iter().map(|(_, id)| id))
    }

    /// Why a pipeline could not be made, if one could not.
    pub fn fault(&self, cache: &PipelineCache) -> Option<String> {
        self.queued()
            .map(|id| cache.get_compute_pipeline_state(*id))
            .find_map(pipeline_fault)
    }
}
