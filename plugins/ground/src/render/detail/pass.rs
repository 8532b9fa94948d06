//! What is recorded for a view whose ground changed.

use std::any::TypeId;

use bevy::prelude::*;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::{ComputePassDescriptor, PipelineCache};
use bevy::render::renderer::{RenderContext, ViewQuery};

use super::DetailKind;
use super::prepare::{DetailViews, SLOT};
use crate::detail::layout::{DEPTH_PASSES, Groups, LAST_PASSES, Second, arguments_at};
use dolomite_tessellation::render::extract::ExtractedStageCamera;
use dolomite_tessellation::render::prepare::StageKinds;
use dolomite_tessellation::render::stats::StageShared;

/// make, look, keep for each depth; then middles, fit, numbers, vertices, heights, the horizon where it is
/// looked at, triangles, head. A dispatch has as many workgroups as those before it found work for.
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
    let (Some(ready), Some(groups)) = (ready, &own.groups) else {
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
    let (of_depth, last) = ready.split_at(DEPTH_PASSES.len());
    let depths = (0..=own.depth).flat_map(|depth| {
        let passes = of_depth.iter().zip(DEPTH_PASSES);
        passes.map(move |pass| (depth, pass))
    });
    let last = last.iter().zip(LAST_PASSES).map(|pass| (own.depth, pass));
    let mut dispatches = 0;
    for (depth, (pipeline, (_, _, second, count))) in depths.chain(last) {
        if count == Groups::Horizon && !own.occluded {
            continue;
        }
        let turn = (depth & 1) as usize;
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &groups.shared, &[depth * SLOT as u32]);
        match second {
            Second::Nothing => {}
            Second::Ground => pass.set_bind_group(1, &data.bind_group, &[]),
            Second::Arguments => pass.set_bind_group(1, &groups.arguments[turn], &[]),
            Second::Vertices => pass.set_bind_group(1, &groups.vertices, &[]),
            Second::Triangles => pass.set_bind_group(1, &groups.triangles, &[]),
            Second::Head => pass.set_bind_group(1, &groups.head, &[]),
        }
        match count {
            Groups::One => pass.dispatch_workgroups(1, 1, 1),
            Groups::Kept | Groups::Horizon => pass.dispatch_workgroups_indirect(&own.closing, 0),
            Groups::Make | Groups::Look => {
                let at = arguments_at(depth, count);
                pass.dispatch_workgroups_indirect(&own.arguments[turn], at);
            }
        }
        dispatches += 1;
    }
    span.end(&mut pass);
    drop(pass);
    shared.count_dispatches(dispatches);
    own.fresh = false;
    state.settled = true;
    state.filled = true;
    state.counters.want();
}
