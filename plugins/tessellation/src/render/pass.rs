//! What is recorded for each view: the compute passes after a change, then the draws.

use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::pbr::ShadowView;
use bevy::prelude::*;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::{
    ComputePassDescriptor, IndexFormat, PipelineCache, RenderPassDescriptor, StoreOp,
};
use bevy::render::renderer::{RenderContext, ViewQuery};
use bevy::render::view::ViewDepthTexture;

use super::extract::ExtractedTerrainView;
use super::pipeline::Pipelines;
use super::prepare::{TerrainBuffers, TerrainViews, ViewState};
use super::readback::SharedStats;

/// Byte offset in `PlanResult` of the arguments for `draw_indirect`.
const PLAIN_ARGUMENTS: u64 = 20;

/// Columns of the emit dispatch's grid, as in `emit.wgsl`.
const EMIT_COLUMNS: u32 = 32_768;

/// levels → plan → emit, when the view is not settled.
pub fn tessellate(
    view: ViewQuery<Entity, With<ExtractedTerrainView>>,
    mut states: ResMut<TerrainViews>,
    terrain: Res<TerrainBuffers>,
    pipelines: Option<Res<Pipelines>>,
    cache: Res<PipelineCache>,
    stats: Res<SharedStats>,
    mut ctx: RenderContext,
) {
    let Some(state) = states.0.get_mut(&view.into_inner()) else {
        return;
    };
    if state.settled {
        if state.counters.is_waiting() {
            state.counters.copy(ctx.command_encoder(), &state.result);
        }
        return;
    }
    let (Some(groups), Some(pipelines), Some(heights)) = (&state.groups, pipelines, &terrain.group)
    else {
        return;
    };
    let (Some(levels), Some(plan), Some(emit)) = (
        cache.get_compute_pipeline(pipelines.levels),
        cache.get_compute_pipeline(pipelines.plan),
        cache.get_compute_pipeline(pipelines.emit),
    ) else {
        return;
    };
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let encoder = ctx.command_encoder();
    let [items, workgroups] = state.counts;
    let columns = workgroups.min(EMIT_COLUMNS);
    for (name, pipeline, group, size) in [
        (
            "terrain_levels",
            levels,
            &groups.levels,
            [items.div_ceil(64), 1],
        ),
        ("terrain_plan", plan, &groups.plan, [1, 1]),
        (
            "terrain_emit",
            emit,
            &groups.emit,
            [columns, workgroups.div_ceil(EMIT_COLUMNS)],
        ),
    ] {
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
            label: Some(name),
            ..default()
        });
        let span = recorder.pass_span(&mut pass, name);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, group, &[]);
        if name != "terrain_plan" {
            pass.set_bind_group(1, heights, &[]);
        }
        pass.dispatch_workgroups(size[0], size[1], 1);
        span.end(&mut pass);
    }
    stats.count_dispatches(3);
    state.settled = true;
    state.filled = true;
    state.counters.want();
    if state.counters.is_waiting() {
        state.counters.copy(encoder, &state.result);
    }
}

/// The filled triangles, or their lines, into the G-buffer and the depth buffer.
pub fn draw_gbuffer(
    view: ViewQuery<(Entity, &ViewPrepassTextures, &ViewDepthTexture), With<ExtractedTerrainView>>,
    states: Res<TerrainViews>,
    terrain: Res<TerrainBuffers>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let (entity, prepass, depth) = view.into_inner();
    let Some((state, material)) = states.0.get(&entity).zip(terrain.material.as_ref()) else {
        return;
    };
    let Some(groups) = state
        .groups
        .as_ref()
        .filter(|_| state.filled && state.visible)
    else {
        return;
    };
    let Some(pipeline) = state.pipeline.and_then(|id| cache.get_render_pipeline(id)) else {
        return;
    };
    let (Some(deferred), Some(pass_id)) = (&prepass.deferred, &prepass.deferred_lighting_pass_id)
    else {
        return;
    };
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
        label: Some("terrain_gbuffer"),
        color_attachments: &attachments,
        depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = recorder.pass_span(&mut pass, "terrain_gbuffer");
    pass.set_render_pipeline(pipeline);
    pass.set_bind_group(1, material, &[]);
    if state.lines {
        pass.set_bind_group(0, &groups.lines, &[0]);
        pass.draw_indirect(&state.result, PLAIN_ARGUMENTS);
    } else {
        pass.set_bind_group(0, &groups.draw, &[0]);
        pass.set_index_buffer(state.indices.slice(..), IndexFormat::Uint32);
        pass.draw_indexed_indirect(&state.result, 0);
    }
    span.end(&mut pass);
}

/// The same triangles into the shadow maps of the view's directional lights.
pub fn draw_shadows(
    view: ViewQuery<Entity, With<ExtractedTerrainView>>,
    states: Res<TerrainViews>,
    shadow_views: Query<&ShadowView>,
    pipelines: Option<Res<Pipelines>>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let Some(state) = states.0.get(&view.into_inner()) else {
        return;
    };
    let drawn = |state: &&ViewState| state.filled && state.visible && !state.shadows.is_empty();
    let Some(groups) = Some(state)
        .filter(drawn)
        .and_then(|state| state.groups.as_ref())
    else {
        return;
    };
    let Some(pipeline) =
        pipelines.and_then(|pipelines| cache.get_render_pipeline(pipelines.shadow))
    else {
        return;
    };
    for (light, offset) in &state.shadows {
        let Ok(shadow) = shadow_views.get(*light) else {
            continue;
        };
        let recorder = ctx.diagnostic_recorder();
        let recorder = recorder.as_deref();
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("terrain_shadow"),
            color_attachments: &[],
            depth_stencil_attachment: Some(shadow.depth_attachment.get_attachment(StoreOp::Store)),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        let span = recorder.pass_span(&mut pass, "terrain_shadow");
        pass.set_render_pipeline(pipeline);
        pass.set_bind_group(0, &groups.draw, &[*offset]);
        pass.set_index_buffer(state.indices.slice(..), IndexFormat::Uint32);
        pass.draw_indexed_indirect(&state.result, 0);
        span.end(&mut pass);
    }
}
