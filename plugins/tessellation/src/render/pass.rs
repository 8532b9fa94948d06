//! What is recorded for each view: the compute passes of the kinds that changed.

use bevy::prelude::*;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::{
    BindGroup, BindGroupEntry, BindGroupLayoutDescriptor, Buffer, ComputePassDescriptor,
    PipelineCache,
};
use bevy::render::renderer::{RenderContext, RenderDevice, ViewQuery};
use dolomite_geometry::render::{ExtractedGeometryCamera, GeometryShared, GeometryView, Producers};

use super::pipeline::{KindPipelines, given_layout};
use super::prepare::{Kind, KindBuffers, StageKinds};
use super::record::{StageBound, clear_work, record_shadow_ranges, record_stage};
use super::view::{StageGroups, StageViewState};

/// Pipelines and bind groups that are missing.
pub fn bind_groups(
    mut kinds: ResMut<StageKinds>,
    mut producers: ResMut<Producers>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
) {
    for kind in kinds.0.values_mut() {
        let Some(producer) = producers.get_mut(kind.key) else {
            continue;
        };
        let (Some(layout), Some(_), Some(_)) =
            (&producer.data_layout, &producer.data, &kind.buffers)
        else {
            continue;
        };
        if kind.pipelines.is_none() {
            let (shaders, traits) = (&kind.shaders, &kind.traits);
            let pipelines = KindPipelines::new(kind.name, shaders, traits, layout, &cache);
            kind.pipelines = Some(pipelines);
        }
        let Kind {
            pipelines: Some(pipelines),
            buffers: Some(buffers),
            views,
            ..
        } = kind
        else {
            continue;
        };
        producer.pipelines = pipelines.count();
        producer.fault = pipelines.fault(&cache);
        for (entity, own) in views.iter_mut() {
            if let Some(state) = producer.views.get_mut(entity) {
                bind(own, state, buffers, pipelines, &cache, &device);
            }
        }
    }
}

fn bind(
    own: &mut StageViewState,
    state: &mut GeometryView,
    buffers: &KindBuffers,
    pipelines: &KindPipelines,
    cache: &PipelineCache,
    device: &RenderDevice,
) {
    let given = [&own.uniform, &buffers.tables, &buffers.data];
    let mut emit = given.to_vec();
    emit.extend([&state.work, &state.vertices, &state.indices]);
    emit.extend(&state.previous);
    let shadows = state.ranges.as_ref();
    let shadows = shadows.map(|ranges| [&ranges.arguments, &ranges.views]);
    let all = emit.iter().copied().chain(shadows.into_iter().flatten());
    let bound: Vec<_> = all.map(|buffer| buffer.id()).collect();
    if own.groups.is_some() && state.inputs.is_some() && own.bound == bound {
        return;
    }
    let group = |label, layout: &BindGroupLayoutDescriptor, buffers: &[&Buffer]| -> BindGroup {
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        device.create_bind_group(label, &cache.get_bind_group_layout(layout), &entries)
    };
    let inputs = group("stage_given", &given_layout(), &given);
    let groups = StageGroups {
        work: group("stage_work", &pipelines.work_layout, &emit[..4]),
        emit: group("stage_emit", &pipelines.emit_layout, &emit),
        ranges: shadows
            .zip(pipelines.ranges.as_ref())
            .map(|(shadows, (layout, _))| {
                let bound = [&emit[..4], &shadows].concat();
                group("stage_shadow_ranges", layout, &bound)
            }),
    };
    own.groups = Some(groups);
    own.bound = bound;
    state.inputs = Some(inputs);
}

/// control → measure → plan → place → vertices → grid → strips, for each kind whose inputs changed.
pub fn tessellate(
    view: ViewQuery<Entity, With<ExtractedGeometryCamera>>,
    kinds: Res<StageKinds>,
    mut producers: ResMut<Producers>,
    cache: Res<PipelineCache>,
    shared: Res<GeometryShared>,
    mut ctx: RenderContext,
) {
    let entity = view.into_inner();
    for kind in kinds.0.values() {
        let Some(producer) = producers.get_mut(kind.key) else {
            continue;
        };
        let (Some(pipelines), Some(data), Some(own), Some(state)) = (
            &kind.pipelines,
            &producer.data,
            kind.views.get(&entity),
            producer.views.get_mut(&entity),
        ) else {
            continue;
        };
        let Some(groups) = &own.groups else {
            continue;
        };
        if !state.settled
            && let Some(ready) = pipelines.ready(&cache)
        {
            let recorder = ctx.diagnostic_recorder();
            let recorder = recorder.as_deref();
            let encoder = ctx.command_encoder();
            clear_work(encoder, &state.work, &own.params);
            let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
                label: Some("stage"),
                ..default()
            });
            let span = recorder.pass_span(&mut pass, "stage");
            let ready: Vec<_> = ready.into_iter().map(|pipeline| &**pipeline).collect();
            let bound = StageBound {
                work: &groups.work,
                emit: &groups.emit,
                data: Some(data),
                buffer: &state.work,
            };
            let dispatches =
                record_stage(&mut pass, &ready, &bound, &own.params, kind.layout.domain);
            span.end(&mut pass);
            drop(pass);
            shared.count_dispatches(dispatches);
            state.settled = true;
            state.filled = true;
            state.counters.want();
            if let Some(ranges) = &mut state.ranges {
                ranges.due = true;
            }
        }
        if let Some(ranges) = &mut state.ranges
            && ranges.due
            && ranges.count() > 0
            && state.filled
            && let Some(group) = &groups.ranges
            && let Some((_, id)) = pipelines.ranges
            && let Some(pipeline) = cache.get_compute_pipeline(id)
        {
            let mut pass = ctx
                .command_encoder()
                .begin_compute_pass(&ComputePassDescriptor {
                    label: Some("stage_shadow_ranges"),
                    ..default()
                });
            let groups = (&**group, Some(&**data));
            record_shadow_ranges(&mut pass, pipeline, groups, ranges.count());
            drop(pass);
            shared.count_dispatches(1);
            ranges.due = false;
        }
    }
}
