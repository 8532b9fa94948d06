//! Layouts and pipeline of the pass; made when there is something to ask.

use std::num::NonZero;

use bevy::prelude::*;
use bevy::render::render_resource::binding_types::{
    storage_buffer_read_only_sized, storage_buffer_sized, uniform_buffer_sized,
};
use bevy::render::render_resource::{
    BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedComputePipelineId,
    ComputePipelineDescriptor, PipelineCache, ShaderStages,
};

use crate::detail::layout::DetailParams;
use crate::detail::probe::{ANSWER_PASS, Asked};

/// Layouts and pipeline.
pub(super) struct AnswerPipeline {
    /// What the passes of the level of detail share, without the lists of cells that they work through:
    /// with all of it there would be more than eight storage buffers.
    pub shared: BindGroupLayoutDescriptor,
    /// Corners of the roots, vertices; the question; the answers.
    pub own: BindGroupLayoutDescriptor,
    pub id: CachedComputePipelineId,
}

impl AnswerPipeline {
    /// Queues it.
    pub(super) fn new(shader: &Handle<Shader>, cache: &PipelineCache) -> Self {
        let compute = ShaderStages::COMPUTE;
        let uniform = |size| uniform_buffer_sized(false, NonZero::new(size as u64));
        let read = || storage_buffer_read_only_sized(false, None);
        let write = || storage_buffer_sized(false, None);
        let shared = BindGroupLayoutDescriptor::new(
            "answer_shared",
            &BindGroupLayoutEntries::with_indices(
                compute,
                (
                    (0, uniform(size_of::<DetailParams>())),
                    (2, write()),
                    (3, write()),
                    (4, write()),
                    (5, write()),
                ),
            ),
        );
        let own = BindGroupLayoutDescriptor::new(
            "answer_own",
            &BindGroupLayoutEntries::sequential(
                compute,
                (read(), read(), uniform(size_of::<Asked>()), read(), write()),
            ),
        );
        let (_, entry) = ANSWER_PASS;
        let id = cache.queue_compute_pipeline(ComputePipelineDescriptor {
            label: Some("height_queries".into()),
            layout: vec![shared.clone(), own.clone()],
            shader: shader.clone(),
            entry_point: Some(entry.into()),
            ..default()
        });
        Self { shared, own, id }
    }
}
