//! What is recorded in a frame that asks.

use bevy::prelude::*;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::{ComputePassDescriptor, PipelineCache};
use bevy::render::renderer::{RenderContext, ViewQuery};

use super::GroundAnswers;
use super::prepare::drawn;
use crate::render::GroundKind;
use crate::render::blocks::prepare::BlockViews;
use crate::render::blocks::record::record_answers;
use crate::render::detail::prepare::DetailViews;
use dolomite_geometry::render::{ExtractedGeometryCamera, Producers};

/// Answers what was asked, if the view is the one that answers and its triangles are there.
pub(super) fn answer(
    view: ViewQuery<Entity, With<ExtractedGeometryCamera>>,
    mut answers: ResMut<GroundAnswers>,
    producers: Res<Producers>,
    (details, blocks): (
        Res<DetailViews<GroundKind<0>>>,
        Res<BlockViews<GroundKind<0>>>,
    ),
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let entity = view.into_inner();
    let answers = &mut *answers;
    if answers.view != Some(entity) {
        return;
    }
    let Some((drawn, state)) = drawn(&producers, &details, &blocks, entity) else {
        return;
    };
    if !state.settled || !state.filled {
        return;
    }
    let pipeline = answers
        .pipeline(drawn.choice())
        .and_then(|pipeline| cache.get_compute_pipeline(pipeline.id));
    let (Some(pipeline), Some(buffers), Some((staging, bytes, ticket))) =
        (pipeline, &answers.buffers, answers.ring.begun())
    else {
        return;
    };
    let Some([shared, own]) = &buffers.groups else {
        return;
    };
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let encoder = ctx.command_encoder();
    let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
        label: Some("height_queries"),
        ..default()
    });
    let span = recorder.pass_span(&mut pass, "height_queries");
    record_answers(&mut pass, pipeline, [shared, own], ticket.count);
    span.end(&mut pass);
    drop(pass);
    encoder.copy_buffer_to_buffer(&buffers.answers, 0, staging.buffer(), 0, Some(bytes));
    answers.ring.copied();
    answers.dispatches += 1;
}
