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

use crate::blocks::layout::{self, BlockNumbers};
use crate::detail::Choice;
use crate::detail::layout::DetailParams;
use crate::detail::probe::{ANSWER_PASS, Asked};

/// Layouts and pipeline.
pub(super) struct AnswerPipeline {
    /// What the passes of a choice share. Of one of cells without the lists that they work through: with all of it there
    /// would be more than eight storage buffers.
    pub shared: BindGroupLayoutDescriptor,
    /// Of a choice of cells, corners of the roots and vertices; the question; the answers.
    pub own: BindGroupLayoutDescriptor,
    pub id: CachedComputePipelineId,
}

impl AnswerPipeline {
    /// File and entry of the pass that answers from a choice.
    pub(super) const fn pass(choice: Choice) -> (&'static str, &'static str) {
        match choice {
            Choice::Blocks => layout::ANSWER_PASS,
            Choice::Cells => ANSWER_PASS,
        }
    }

    /// Queues it.
    pub(super) fn new(choice: Choice, shader: &Handle<Shader>, cache: &PipelineCache) -> Self {
        let compute = ShaderStages::COMPUTE;
        let uniform = |size| uniform_buffer_sized(false, NonZero::new(size as u64));
        let read = || storage_buffer_read_only_sized(false, None);
        let write = || storage_buffer_sized(false, None);
        let (params, asked) = (
            uniform(size_of::<DetailParams>()),
            uniform(size_of::<Asked>()),
        );
        let (shared, own) = match choice {
            Choice::Blocks => (
                BindGroupLayoutEntries::sequential(
                    compute,
                    (
                        params,
                        uniform(size_of::<BlockNumbers>()),
                        write(),
                        write(),
                        write(),
                        write(),
                        write(),
                    ),
                )
                .to_vec(),
                BindGroupLayoutEntries::with_indices(
                    compute,
                    ((2, asked), (3, read()), (4, write())),
                )
                .to_vec(),
            ),
            Choice::Cells => (
                BindGroupLayoutEntries::with_indices(
                    compute,
                    (
                        (0, params),
                        (2, write()),
                        (3, write()),
                        (4, write()),
                        (5, write()),
                    ),
                )
                .to_vec(),
                BindGroupLayoutEntries::sequential(
                    compute,
                    (read(), read(), asked, read(), write()),
                )
                .to_vec(),
            ),
        };
        let shared = BindGroupLayoutDescriptor::new("answer_shared", &shared);
        let own = BindGroupLayoutDescriptor::new("answer_own", &own);
        let (_, entry) = Self::pass(choice);
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
