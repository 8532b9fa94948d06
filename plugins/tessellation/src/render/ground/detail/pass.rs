//! What is recorded for a view whose ground changed.

use std::any::TypeId;

use bevy::prelude::*;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::{
    ComputePass, ComputePassDescriptor, ComputePipeline, PipelineCache,
};
use bevy::render::renderer::{RenderContext, ViewQuery};

use super::DetailKind;
use super::prepare::{DetailViews, SLOT};
use crate::detail::layout::{DEPTH_PASSES, GROUPS, LAST_PASSES};
use crate::render::stage::extract::ExtractedStageCamera;
use crate::render::stage::prepare::StageKinds;
use crate::render::stage::stats::StageShared;

/// make, look, keep for each depth; then middles, fit, numbers, vertices, triangles, head.
pub fn choose<K: DetailKind>(
    view: ViewQuery<Entity, With<ExtractedStageCamera>>,
    mut kinds: ResMut<StageKinds>,
    mut details: ResMut<DetailViews<K>>,
    cache: Res<PipelineCache>,
    shared: Res<StageShared>,
    mut ctx: RenderContext,
) {
    let entity = view.into_inner();
    let Some(kind) = kinds
        .0
        .get_mut(&TypeId::of::<K>())
        .filter(|kind| kind.given)
    else {
        return;
    };
    let details = &mut *details;
    let (Some(data), Some(state), Some(own)) = (
        &kind.data,
        kind.views.get_mut(&entity),
        details.views.get_mut(&entity),
    ) else {
        return;
    };
    if state.settled {
        return;
    }
    let ready = details
        .pipelines
        .as_ref()
        .and_then(|pipelines| pipelines.ready(&cache));
    let (Some(ready), Some([bound, vertices, indices, head])) = (ready, &own.groups) else {
        return;
    };
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let encoder = ctx.command_encoder();
    let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
        label: Some("detail"),
        ..default()
    });
    let span = recorder.pass_span(&mut pass, "detail");
    let dispatch = |pass: &mut ComputePass, pipeline: &ComputePipeline, groups| {
        pass.set_pipeline(pipeline);
        pass.dispatch_workgroups(groups, 1, 1);
    };
    let (of_depth, last) = ready.split_at(DEPTH_PASSES.len());
    pass.set_bind_group(1, &data.bind_group, &[]);
    for depth in 0..=own.depth {
        pass.set_bind_group(0, bound, &[depth * SLOT as u32]);
        for pipeline in of_depth {
            dispatch(&mut pass, pipeline, GROUPS);
        }
    }
    for (pipeline, (_, entry, single)) in last.iter().zip(LAST_PASSES) {
        let target = match entry {
            "emit_triangles" => indices,
            "finish" => head,
            _ => vertices,
        };
        pass.set_bind_group(1, target, &[]);
        dispatch(&mut pass, pipeline, if single { 1 } else { GROUPS });
    }
    span.end(&mut pass);
    drop(pass);
    let dispatches = (own.depth + 1) * DEPTH_PASSES.len() as u32 + LAST_PASSES.len() as u32;
    shared.count_dispatches(dispatches);
    own.fresh = false;
    state.settled = true;
    state.filled = true;
    state.counters.want();
}
