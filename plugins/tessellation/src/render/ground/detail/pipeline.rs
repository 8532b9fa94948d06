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

use super::DetailShaders;
use crate::detail::layout::{DEPTH_PASSES, DetailParams, DetailPass, LAST_PASSES};

/// The files of the passes, in their order.
pub(super) fn files() -> impl Iterator<Item = &'static str> {
    let depth = DEPTH_PASSES.iter().map(|(file, _)| *file);
    depth.chain(LAST_PASSES.iter().map(|(file, ..)| *file))
}

/// Layouts and pipelines.
pub(super) struct DetailPipelines {
    /// What all passes share.
    pub shared: BindGroupLayoutDescriptor,
    /// The corners of the roots, and what is written.
    pub emit: BindGroupLayoutDescriptor,
    ids: Vec<CachedComputePipelineId>,
}

impl DetailPipelines {
    /// Queues all; `ground` is the layout of the ground's data.
    pub(super) fn new(
        shaders: &DetailShaders,
        ground: &BindGroupLayoutDescriptor,
        cache: &PipelineCache,
    ) -> Self {
        let compute = ShaderStages::COMPUTE;
        let uniform = |dynamic, size| uniform_buffer_sized(dynamic, NonZero::new(size as u64));
        let write = || storage_buffer_sized(false, None);
        let shared = BindGroupLayoutDescriptor::new(
            "detail_shared",
            &BindGroupLayoutEntries::sequential(
                compute,
                (
                    uniform(false, size_of::<DetailParams>()),
                    uniform(true, size_of::<DetailPass>()),
                    write(),
                    write(),
                    write(),
                    write(),
                    write(),
                ),
            ),
        );
        let emit = BindGroupLayoutDescriptor::new(
            "detail_emit",
            &BindGroupLayoutEntries::sequential(
                compute,
                (storage_buffer_read_only_sized(false, None), write()),
            ),
        );
        let entries = DEPTH_PASSES.iter().map(|(_, entry)| *entry);
        let entries = entries.chain(LAST_PASSES.iter().map(|(_, entry, _)| *entry));
        let ids = entries
            .zip(&shaders.entries)
            .map(|(entry, shader)| {
                let second = match entry {
                    "make_cells" => Some(ground.clone()),
                    "look_at_cells" | "keep_cells" | "find_middles" | "fit" => None,
                    _ => Some(emit.clone()),
                };
                cache.queue_compute_pipeline(ComputePipelineDescriptor {
                    label: Some(format!("detail_{entry}").into()),
                    layout: [shared.clone()].into_iter().chain(second).collect(),
                    shader: shader.clone(),
                    entry_point: Some(entry.into()),
                    ..default()
                })
            })
            .collect();
        Self { shared, emit, ids }
    }

    /// All pipelines in the order of the passes, once all are there.
    pub(super) fn ready<'a>(&self, cache: &'a PipelineCache) -> Option<Vec<&'a ComputePipeline>> {
        let ids = self.ids.iter();
        ids.map(|id| cache.get_compute_pipeline(*id)).collect()
    }
}
