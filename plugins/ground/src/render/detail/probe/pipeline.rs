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

use crate::blocks::layout::{ANSWER_PASS, BlockNumbers};
use crate::detail::layout::DetailParams;
use crate::detail::probe::Asked;

/// Layouts and pipeline.
pub(super) struct AnswerPipeline {
    /// The question, the places, the answers.
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
        // What the passes of a choice share.
        let shared = BindGroupLayoutDescriptor::new(
            "answer_shared",
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
        let own = BindGroupLayoutDescriptor::new(
            "answer_own",
            &BindGroupLayoutEntries::with_indices(
                compute,
                ((2, uniform(size_of::<Asked>())), (3, read()), (4, write())),
            ),
        );
        let (_, entry) = ANSWER_PASS;
        let id = cache.queue_compute_pipeline(ComputePipelineDescriptor {
            label: Some("height_queries".into()),
            layout: vec![shared, own.clone()],
            shader: shader.clone(),
            entry_point: Some(entry.into()),
            ..default()
        });
        Self { own, id }
    }
}
