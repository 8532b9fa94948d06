//! What is recorded for each view: the compute passes of the kinds that changed, then the draws.

use bevy::camera::CompositingSpace;
use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::pbr::ShadowView;
use bevy::prelude::*;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_phase::TrackedRenderPass;
use bevy::render::render_resource::{
    BindGroupEntries, BindingResource, BufferBinding, ComputePass, ComputePassDescriptor,
    ComputePipeline, IndexFormat, PipelineCache, PreparedBindGroup, RenderPassDescriptor,
    RenderPipeline, StoreOp,
};
use bevy::render::renderer::{RenderContext, RenderDevice, ViewQuery};
use bevy::render::view::{ViewDepthTexture, ViewTarget};

use super::StageShared;
use super::extract::ExtractedStageCamera;
use super::pipeline::{DrawKey, KindPipelines, KindView, Picture, fetches};
use super::prepare::{Kind, KindTraits, StageKinds, ViewGroups, ViewKind};
use crate::layout::{
    AMPLIFIED_ARGUMENTS, DRAW_SLOT, GRID_DISPATCH_ARGUMENTS, OTHERS_ARGUMENTS, PLAIN_ARGUMENTS,
    StageDraw, VERTEX_DISPATCH_ARGUMENTS,
};

/// Columns of a dispatch's grid, as in `work.wgsl`.
const COLUMNS: u32 = 32_768;

/// Pipelines and bind groups that are missing.
pub fn bind_groups(
    mut kinds: ResMut<StageKinds>,
    views: Query<(Option<&ViewPrepassTextures>, &ViewTarget)>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    shared: Res<StageShared>,
) {
    for kind in kinds.0.values_mut() {
        let (Some(layout), Some(_), Some(_)) = (&kind.data_layout, &kind.data, &kind.buffers)
        else {
            continue;
        };
        if kind.pipelines.is_none() {
            kind.pipelines = Some(KindPipelines::new(kind, layout, &cache));
        }
        let Kind {
            pipelines: Some(pipelines),
            buffers: Some(buffers),
            views: states,
            shaders,
            traits,
            name,
            ..
        } = kind
        else {
            continue;
        };
        if let Some(fault) = pipelines.fault(&cache) {
            if !pipelines.told {
                pipelines.told = true;
                error!("{name}: its shader is not used until it is corrected: {fault}");
                shared.report(name, fault);
            }
        } else if pipelines.told {
            pipelines.told = false;
            shared.clear(name);
        }
        for (entity, state) in states.iter_mut() {
            if let Ok((prepass, target)) = views.get(*entity) {
                let of = KindView {
                    name,
                    shaders,
                    traits,
                };
                pipelines.draw(&of, &cache, draw_key(prepass, target, state));
            }
            if let (Some(ranges), Some((layout, _))) = (&mut state.ranges, &pipelines.ranges) {
                ranges.bind(
                    &device,
                    &cache,
                    layout,
                    buffers,
                    [&state.uniform, &state.work],
                );
            }
            let fetched = fetches(traits, state.shown[1]);
            if state
                .groups
                .as_ref()
                .is_some_and(|groups| groups.fetch.is_some() || !fetched)
            {
                continue;
            }
            let given = (
                state.uniform.as_entire_binding(),
                buffers.tables.as_entire_binding(),
                buffers.data.as_entire_binding(),
            );
            let work = state.work.as_entire_binding();
            let slot = BindingResource::Buffer(BufferBinding {
                buffer: &state.draw,
                offset: 0,
                size: (size_of::<StageDraw>() as u64).try_into().ok(),
            });
            let mut emit = vec![
                given.0.clone(),
                given.1.clone(),
                given.2.clone(),
                work.clone(),
                state.vertices.as_entire_binding(),
                state.indices.as_entire_binding(),
            ];
            emit.extend(
                state
                    .previous
                    .as_ref()
                    .map(|previous| previous.as_entire_binding()),
            );
            let draw = vec![slot, buffers.materials.as_entire_binding()];
            let mut fetch = draw.clone();
            fetch.push(state.vertices.as_entire_binding());
            fetch.push(state.indices.as_entire_binding());
            fetch.extend(
                state
                    .previous
                    .as_ref()
                    .map(|previous| previous.as_entire_binding()),
            );
            let group =
                |name, layout, resources: Vec<BindingResource>| {
                    let entries: Vec<_> =
                        (0_u32..)
                            .zip(resources)
                            .map(|(binding, resource)| {
                                bevy::render::render_resource::BindGroupEntry { binding, resource }
                            })
                            .collect();
                    device.create_bind_group(name, &cache.get_bind_group_layout(layout), &entries)
                };
            state.groups = Some(ViewGroups {
                work: device.create_bind_group(
                    "stage_work",
                    &cache.get_bind_group_layout(&pipelines.work_layout),
                    &BindGroupEntries::sequential((
                        given.0.clone(),
                        given.1.clone(),
                        given.2.clone(),
                        work,
                    )),
                ),
                emit: group("stage_emit", &pipelines.emit_layout, emit),
                given: device.create_bind_group(
                    "stage_given",
                    &cache.get_bind_group_layout(&pipelines.given_layout),
                    &BindGroupEntries::sequential(given),
                ),
                draw: group("stage_draw", &pipelines.draw_layout, draw),
                fetch: fetched.then(|| group("stage_fetch", &pipelines.fetch_layout, fetch)),
            });
        }
    }
}

/// Where the view's draw goes: into its G-buffer, or into its picture if it has none.
pub fn draw_key(
    prepass: Option<&ViewPrepassTextures>,
    target: &ViewTarget,
    state: &ViewKind,
) -> DrawKey {
    let deferred = prepass.filter(|prepass| prepass.deferred.is_some());
    DrawKey {
        lines: state.shown[1],
        normals: deferred.is_some_and(|prepass| prepass.normal.is_some()),
        motion: deferred.is_some_and(|prepass| prepass.motion_vectors.is_some()),
        direct: deferred.is_none().then(|| Picture {
            format: target.main_texture_format(),
            encoded: target.compositing_space == Some(CompositingSpace::Srgb),
        }),
    }
}

/// control → measure → plan → place → vertices → grid → strips, for each kind whose inputs changed.
pub fn tessellate(
    view: ViewQuery<Entity, With<ExtractedStageCamera>>,
    mut kinds: ResMut<StageKinds>,
    cache: Res<PipelineCache>,
    shared: Res<StageShared>,
    mut ctx: RenderContext,
) {
    let entity = view.into_inner();
    for kind in kinds.0.values_mut() {
        let (Some(pipelines), Some(data), Some(state)) =
            (&kind.pipelines, &kind.data, kind.views.get_mut(&entity))
        else {
            continue;
        };
        if !state.settled
            && !kind.given
            && let Some(groups) = &state.groups
        {
            let found = pipelines.compute.map(|id| cache.get_compute_pipeline(id));
            let [
                Some(control),
                Some(measure),
                Some(plan),
                Some(place),
                Some(vertices),
                Some(grid),
            ] = found
            else {
                continue;
            };
            let strips = pipelines.strips.map(|id| cache.get_compute_pipeline(id));
            if matches!(strips, Some(None)) {
                continue;
            }
            let recorder = ctx.diagnostic_recorder();
            let recorder = recorder.as_deref();
            let encoder = ctx.command_encoder();
            encoder.clear_buffer(&state.work, 0, Some(state.cleared));
            let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
                label: Some("stage"),
                ..default()
            });
            let span = recorder.pass_span(&mut pass, "stage");
            let [patches, items, sides] = state.groups_of;
            pass.set_bind_group(0, &groups.work, &[]);
            pass.set_bind_group(1, &data.bind_group, &[]);
            dispatch(&mut pass, control, patches);
            dispatch(&mut pass, measure, items);
            dispatch(&mut pass, plan, 1);
            dispatch(&mut pass, place, items);
            pass.set_bind_group(0, &groups.emit, &[]);
            pass.set_pipeline(vertices);
            pass.dispatch_workgroups_indirect(&state.work, VERTEX_DISPATCH_ARGUMENTS);
            pass.set_pipeline(grid);
            pass.dispatch_workgroups_indirect(&state.work, GRID_DISPATCH_ARGUMENTS);
            if let Some(strips) = strips.flatten() {
                dispatch(&mut pass, strips, sides);
            }
            span.end(&mut pass);
            drop(pass);
            shared.count_dispatches(pipelines.dispatches());
            state.settled = true;
            state.filled = true;
            state.counters.want();
            if let Some(ranges) = &mut state.ranges {
                ranges.due = true;
            }
        }
        if let Some(ranges) = &mut state.ranges
            && ranges.due
            && ranges.count > 0
            && state.filled
            && let Some(group) = &ranges.group
            && let Some((_, id)) = pipelines.ranges
            && let Some(pipeline) = cache.get_compute_pipeline(id)
        {
            let mut pass = ctx
                .command_encoder()
                .begin_compute_pass(&ComputePassDescriptor {
                    label: Some("stage_shadow_ranges"),
                    ..default()
                });
            pass.set_bind_group(0, group, &[]);
            pass.set_bind_group(1, &data.bind_group, &[]);
            dispatch(&mut pass, pipeline, ranges.count);
            drop(pass);
            shared.count_dispatches(1);
            ranges.due = false;
        }
        if state.counters.is_waiting() {
            state.counters.copy(ctx.command_encoder(), &state.work);
        }
    }
}

/// So many groups, in rows of [`COLUMNS`].
fn dispatch(pass: &mut ComputePass, pipeline: &ComputePipeline, groups: u32) {
    pass.set_pipeline(pipeline);
    pass.dispatch_workgroups(groups.min(COLUMNS), groups.div_ceil(COLUMNS), 1);
}

/// A kind that can be drawn in a view.
pub struct Ready<'a> {
    pipeline: &'a RenderPipeline,
    groups: &'a ViewGroups,
    data: &'a PreparedBindGroup,
    state: &'a ViewKind,
    traits: &'a KindTraits,
}

impl<'a> Ready<'a> {
    /// Records the draw.
    pub fn draw(&self, pass: &mut TrackedRenderPass<'a>) {
        pass.set_render_pipeline(self.pipeline);
        pass.set_bind_group(0, &self.groups.given, &[]);
        pass.set_bind_group(1, &self.data.bind_group, &[]);
        let lines = self.state.shown[1];
        draw(pass, self.state, self.groups, self.traits, lines, 0);
    }
}

/// The kinds that have something to show in a view, and whose pipelines are there.
pub fn ready<'a>(
    kinds: &'a mut StageKinds,
    view: Entity,
    cache: &'a PipelineCache,
    key: impl Fn(&ViewKind) -> DrawKey,
) -> Vec<Ready<'a>> {
    let mut drawn = Vec::new();
    for kind in kinds.0.values_mut() {
        let Kind {
            pipelines: Some(pipelines),
            shaders,
            traits,
            name,
            data: Some(data),
            views,
            ..
        } = kind
        else {
            continue;
        };
        let of = KindView {
            name,
            shaders,
            traits,
        };
        let shown = |state: &&ViewKind| state.filled && state.shown != [false; 2];
        let Some(state) = views.get(&view).filter(shown) else {
            continue;
        };
        let id = pipelines.draw(&of, cache, key(state));
        if let (Some(pipeline), Some(groups)) = (cache.get_render_pipeline(id), &state.groups) {
            drawn.push(Ready {
                pipeline,
                groups,
                data,
                state,
                traits,
            });
        }
    }
    drawn
}

/// The primitives of every kind into the G-buffer and the depth buffer.
pub fn draw_gbuffer(
    view: ViewQuery<
        (Entity, &ViewPrepassTextures, &ViewTarget, &ViewDepthTexture),
        With<ExtractedStageCamera>,
    >,
    mut kinds: ResMut<StageKinds>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let (entity, prepass, target, depth) = view.into_inner();
    let (Some(deferred), Some(pass_id)) = (&prepass.deferred, &prepass.deferred_lighting_pass_id)
    else {
        return;
    };
    let drawn = ready(&mut kinds, entity, &cache, |state| {
        draw_key(Some(prepass), target, state)
    });
    if drawn.is_empty() {
        return;
    }
    let attachments = [
        prepass
            .normal
            .as_ref()
            .map(|texture| texture.get_attachment()),
        prepass
            .motion_vectors
            .as_ref()
            .map(|texture| texture.get_attachment()),
        Some(deferred.get_attachment()),
        Some(pass_id.get_attachment()),
    ];
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("stage_gbuffer"),
        color_attachments: &attachments,
        depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = recorder.pass_span(&mut pass, "stage_gbuffer");
    for kind in &drawn {
        kind.draw(&mut pass);
    }
    span.end(&mut pass);
}

fn draw<'a>(
    pass: &mut TrackedRenderPass<'a>,
    state: &'a ViewKind,
    groups: &'a ViewGroups,
    traits: &KindTraits,
    lines: bool,
    slot: u32,
) {
    if fetches(traits, lines) {
        let Some(fetch) = &groups.fetch else { return };
        pass.set_bind_group(2, fetch, &[slot]);
        if traits.amplified > 0 {
            pass.draw_indirect(&state.work, AMPLIFIED_ARGUMENTS);
        } else {
            pass.draw_indirect(&state.work, PLAIN_ARGUMENTS);
        }
        return;
    }
    pass.set_bind_group(2, &groups.draw, &[slot]);
    set_buffers(pass, state);
    pass.draw_indexed_indirect(&state.work, 0);
}

fn set_buffers<'a>(pass: &mut TrackedRenderPass<'a>, state: &'a ViewKind) {
    pass.set_vertex_buffer(0, state.vertices.slice(..));
    if let Some(previous) = &state.previous {
        pass.set_vertex_buffer(1, previous.slice(..));
    }
    pass.set_index_buffer(state.indices.slice(..), IndexFormat::Uint32);
}

/// The same primitives into the shadow maps of the view's lights.
pub fn draw_shadows(
    view: ViewQuery<Entity, With<ExtractedStageCamera>>,
    kinds: Res<StageKinds>,
    shadow_views: Query<&ShadowView>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let entity = view.into_inner();
    // All kinds of a light in one pass: a list of the lights, in the order of the slots.
    let states = || {
        kinds.0.values().filter_map(|kind| {
            let shown = |state: &&ViewKind| state.filled && state.shown != [false; 2];
            let state = kind.views.get(&entity).filter(shown)?;
            Some((kind, state, state.groups.as_ref()?))
        })
    };
    let lights: Vec<(Entity, u32)> = states()
        .map(|(_, state, _)| &state.shadows)
        .max_by_key(|shadows| shadows.len())
        .cloned()
        .unwrap_or_default();
    for (light, offset) in lights {
        let Ok(shadow) = shadow_views.get(light) else {
            continue;
        };
        let recorder = ctx.diagnostic_recorder();
        let recorder = recorder.as_deref();
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("stage_shadow"),
            color_attachments: &[],
            depth_stencil_attachment: Some(shadow.depth_attachment.get_attachment(StoreOp::Store)),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        let span = recorder.pass_span(&mut pass, "stage_shadow");
        for (kind, state, groups) in states().filter(|(kind, ..)| kind.traits.shadows) {
            let Some((pipeline, data)) = kind
                .pipelines
                .as_ref()
                .and_then(|pipelines| cache.get_render_pipeline(pipelines.shadow))
                .zip(kind.data.as_ref())
            else {
                continue;
            };
            pass.set_render_pipeline(pipeline);
            pass.set_bind_group(0, &groups.given, &[]);
            pass.set_bind_group(1, &data.bind_group, &[]);
            match &state.ranges {
                Some(ranges) => {
                    pass.set_bind_group(2, &groups.draw, &[offset]);
                    set_buffers(&mut pass, state);
                    let shadow_view = offset / DRAW_SLOT as u32 - 1;
                    for at in ranges.draws(shadow_view, state.patches()) {
                        pass.draw_indexed_indirect(&ranges.arguments, at);
                    }
                }
                None => {
                    draw(&mut pass, state, groups, &kind.traits, false, offset);
                    if kind.given {
                        // What faces away from the camera, or lies beside its picture.
                        pass.draw_indexed_indirect(&state.work, OTHERS_ARGUMENTS);
                    }
                }
            }
        }
        span.end(&mut pass);
    }
}
