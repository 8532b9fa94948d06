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

use super::DetailShaders;
use crate::detail::layout::{
    DEPTH_PASSES, DetailParams, DetailPass, LAST_PASSES, Pass, SWEEP_PASS, Second,
};

/// The files of the passes, in their order.
pub(super) fn files() -> impl Iterator<Item = &'static str> {
    passes().map(|(file, ..)| *file)
}

/// All of them.
fn passes() -> impl Iterator<Item = &'static Pass> {
    DEPTH_PASSES.iter().chain(&LAST_PASSES).chain([&SWEEP_PASS])
}

/// Layouts and pipelines.
pub(super) struct DetailPipelines {
    /// What all passes share.
    pub shared: BindGroupLayoutDescriptor,
    /// See [`Second`].
    pub arguments: BindGroupLayoutDescriptor,
    pub vertices: BindGroupLayoutDescriptor,
    pub triangles: BindGroupLayoutDescriptor,
    pub head: BindGroupLayoutDescriptor,
    /// Definitions for what evaluates the ground.
    pub without: Vec<&'static str>,
    ids: Vec<CachedComputePipelineId>,
}

impl DetailPipelines {
    /// Queues all; `ground` is the layout of the ground's data, `without` what it has not.
    pub(super) fn new(
        shaders: &DetailShaders,
        ground: &BindGroupLayoutDescriptor,
        without: Vec<&'static str>,
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
        let read = || storage_buffer_read_only_sized(false, None);
        let arguments = BindGroupLayoutDescriptor::new(
            "detail_arguments",
            &BindGroupLayoutEntries::sequential(compute, (write(), write(), write())),
        );
        let vertices = BindGroupLayoutDescriptor::new(
            "detail_vertices",
            &BindGroupLayoutEntries::sequential(compute, (read(), write(), write())),
        );
        let triangles = BindGroupLayoutDescriptor::new(
            "detail_triangles",
            &BindGroupLayoutEntries::sequential(compute, (read(), write())),
        );
        let head = BindGroupLayoutDescriptor::new(
            "detail_head",
            &BindGroupLayoutEntries::sequential(compute, (write(), write(), write())),
        );
        let ids = passes()
            .zip(&shaders.entries)
            .map(|((_, entry, second, _), shader)| {
                let defs: &[&str] = match second {
                    Second::Ground => &without,
                    _ => &[],
                };
                let second = match second {
                    Second::Nothing => None,
                    Second::Ground => Some(ground),
                    Second::Arguments => Some(&arguments),
                    Second::Vertices => Some(&vertices),
                    Second::Triangles => Some(&triangles),
                    Second::Head => Some(&head),
                };
                cache.queue_compute_pipeline(ComputePipelineDescriptor {
                    label: Some(format!("detail_{entry}").into()),
                    layout: [&shared].into_iter().chain(second).cloned().collect(),
                    shader: shader.clone(),
                    shader_defs: defs.iter().map(|def| (*def).into()).collect(),
                    entry_point: Some((*entry).into()),
                    ..default()
                })
            })
            .collect();
        Self {
            shared,
            arguments,
            vertices,
            triangles,
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
