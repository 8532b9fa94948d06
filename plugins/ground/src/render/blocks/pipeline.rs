//! Layouts and pipelines of the passes; made when a camera first looks.

use std::num::NonZero;

use bevy::prelude::*;
use bevy::render::render_resource::binding_types::{
    storage_buffer_read_only_sized, storage_buffer_sized, uniform_buffer_sized,
};
use bevy::render::render_resource::{
    BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedComputePipelineId, ComputePipeline,
    ComputePipelineDescriptor, PipelineCache, ShaderStages,
};
use dolomite_geometry::render::pipeline_fault;
use dolomite_terrain::GpuTerrainUniform;

use super::BlockShaders;
use crate::blocks::layout::{BlockNumbers, PASSES, Second};
use crate::detail::layout::DetailParams;

/// Layouts and pipelines.
pub(in crate::render) struct BlockPipelines {
    /// What all passes share.
    pub shared: BindGroupLayoutDescriptor,
    /// See [`Second`].
    pub looked: BindGroupLayoutDescriptor,
    pub arguments: BindGroupLayoutDescriptor,
    pub triangles: BindGroupLayoutDescriptor,
    pub ground: BindGroupLayoutDescriptor,
    pub head: BindGroupLayoutDescriptor,
    /// Definitions for what evaluates the ground.
    pub without: Vec<&'static str>,
    ids: Vec<CachedComputePipelineId>,
}

impl BlockPipelines {
    /// Queues all; `without` is what the ground has not.
    pub(super) fn new(
        shaders: &BlockShaders,
        without: Vec<&'static str>,
        cache: &PipelineCache,
    ) -> Self {
        let compute = ShaderStages::COMPUTE;
        let uniform = |size| uniform_buffer_sized(false, NonZero::new(size as u64));
        let write = || storage_buffer_sized(false, None);
        let read = || storage_buffer_read_only_sized(false, None);
        let shared = BindGroupLayoutDescriptor::new(
            "blocks_shared",
            &BindGroupLayoutEntries::sequential(
                compute,
                (
                    uniform(size_of::<DetailParams>()),
                    uniform(size_of::<BlockNumbers>()),
                    write(),
                    write(),
                    write(),
                    write(),
                    write(),
                ),
            ),
        );
        let looked = BindGroupLayoutDescriptor::new(
            "blocks_looked",
            &BindGroupLayoutEntries::single(compute, write()),
        );
        let arguments = BindGroupLayoutDescriptor::new(
            "blocks_arguments",
            &BindGroupLayoutEntries::sequential(compute, (write(), write(), write())),
        );
        let triangles = BindGroupLayoutDescriptor::new(
            "blocks_triangles",
            &BindGroupLayoutEntries::sequential(compute, (write(), write())),
        );
        let ground = BindGroupLayoutDescriptor::new(
            "blocks_ground",
            &BindGroupLayoutEntries::sequential(
                compute,
                (
                    read(),
                    read(),
                    uniform(size_of::<GpuTerrainUniform>()),
                    write(),
                ),
            ),
        );
        let head = BindGroupLayoutDescriptor::new(
            "blocks_head",
            &BindGroupLayoutEntries::with_indices(compute, ((0, write()), (2, write()))),
        );
        let ids = PASSES
            .iter()
            .zip(&shaders.entries)
            .map(|((_, entry, second, _), shader)| {
                let defs: &[&str] = match second {
                    Second::Ground => &without,
                    _ => &[],
                };
                let second = match second {
                    Second::Nothing => None,
                    Second::Looked => Some(&looked),
                    Second::Arguments => Some(&arguments),
                    Second::Triangles => Some(&triangles),
                    Second::Ground => Some(&ground),
                    Second::Head => Some(&head),
                };
                cache.queue_compute_pipeline(ComputePipelineDescriptor {
                    label: Some(format!("blocks_{entry}").into()),
                    layout: [&shared].into_iter().chain(second).cloned().collect(),
                    shader: shader.clone(),
                    shader_defs: defs.iter().map(|def| (*def).into()).collect(),
                    entry_point: Some((*entry).into()),
                    // Counts of a workgroup begin with 0.
                    zero_initialize_workgroup_memory: true,
                    ..default()
                })
            })
            .collect();
        Self {
            shared,
            looked,
            arguments,
            triangles,
            ground,
            head,
            without,
            ids,
        }
    }

    /// Number of pipelines queued.
    pub(super) const fn count(&self) -> usize {
        self.ids.len()
    }

    /// Why a pipeline could not be made, if one could not.
    pub(super) fn fault(&self, cache: &PipelineCache) -> Option<String> {
        let ids = self.ids.iter();
        ids.map(|id| cache.get_compute_pipeline_state(*id))
            .find_map(pipeline_fault)
    }

    /// All pipelines in the order of the passes, once all are there.
    pub(super) fn ready<'a>(&self, cache: &'a PipelineCache) -> Option<Vec<&'a ComputePipeline>> {
        let ids = self.ids.iter();
        ids.map(|id| cache.get_compute_pipeline(*id)).collect()
    }
}
