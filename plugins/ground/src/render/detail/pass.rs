//! What is recorded for a view whose ground changed.

use bevy::prelude::*;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::{ComputePassDescriptor, PipelineCache};
use bevy::render::renderer::{RenderContext, RenderDevice, ViewQuery};
use dolomite_geometry::render::{ExtractedGeometryCamera, GeometryShared, Producers};

use super::prepare::DetailViews;
use super::record::{DetailBound, record_step, steps};
use super::{DetailKind, detail_key};

/// Chooses the view's ground anew, if anything that the choice depends on has changed.
pub fn choose<K: DetailKind>(
    view: ViewQuery<Entity, With<ExtractedGeometryCamera>>,
    mut producers: ResMut<Producers>,
    mut details: ResMut<DetailViews<K>>,
    cache: Res<PipelineCache>,
    shared: Res<GeometryShared>,
    device: Res<RenderDevice>,
    mut ctx: RenderContext,
) {
    let entity = view.into_inner();
    let Some(producer) = producers.get_mut(detail_key::<K>()) else {
        return;
    };
    let details = &mut *details;
    let (Some(data), Some(state), Some(own)) = (
        &producer.data,
        producer.views.get_mut(&entity),
        details.views.get_mut(&entity),
    ) else {
        return;
    };
    if state.settled || details.data_due {
        return;
    }
    let ready = details
        .pipelines
        .as_ref()
        .and_then(|pipelines| pipelines.ready(&cache));
    let (Some(ready), Some(groups)) = (ready, &own.groups) else {
        return;
    };
    let [even, odd] = &groups.arguments;
    let bound = DetailBound {
        shared: &groups.shared,
        ground: data,
        arguments: [even, odd],
        vertices: &groups.vertices,
        triangles: &groups.triangles,
        head: &groups.head,
        capacity: own.capacity,
        indirect: [&own.arguments[0], &own.arguments[1]],
        closing: &own.closing,
    };
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let encoder = ctx.command_encoder();
    let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
        label: Some("detail"),
        ..default()
    });
    let span = recorder.pass_span(&mut pass, "detail");
    let mut dispatches = 0;
    for step in steps(own.depth, own.extras) {
        record_step(&mut pass, ready[step.pipeline], &bound, &step);
        dispatches += 1;
    }
    span.end(&mut pass);
    drop(pass);
    let (always, metric) = (own.always(), own.detail.metric);
    if let Some(counted) = &mut own.counted {
        counted.copy(&device, ctx.command_encoder(), &own.kept[3], metric, always);
    }
    shared.count_dispatches(dispatches);
    if let Some(store) = details.stores.get_mut(&own.detail.finest.to_bits()) {
        store.fresh = false;
    }
    state.settled = true;
    state.filled = true;
    state.counters.want();
}
