//! What is recorded for a view.

use bevy::camera::MainPassResolutionOverride;
use bevy::camera::Viewport;
use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::pbr::ShadowView;
use bevy::prelude::*;
use bevy::render::camera::ExtractedCamera;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::{
    ComputePassDescriptor, PipelineCache, RenderPassDescriptor, StoreOp,
};
use bevy::render::renderer::{RenderContext, RenderDevice, ViewQuery};
use bevy::render::view::ViewDepthTexture;
use dolomite_geometry::render::{ExtractedGeometryCamera, Producers};

use super::extract::ExtractedVegetationView;
use super::layout::SHADOW_SLOT;
use super::pipeline::DrawKey;
use super::prepare::{VegetationGrounds, VegetationViews};
use super::record::{DISPATCHES, GrowBound, record_draws, record_passes, record_shadows};
use super::stats::VegetationStats;

/// Records of the view's roots, if its ground or anything else that they depend on has changed.
pub fn grow(
    view: ViewQuery<Entity, (With<ExtractedVegetationView>, With<ExtractedGeometryCamera>)>,
    mut vegetation: ResMut<VegetationViews>,
    (producers, grounds): (Res<Producers>, Res<VegetationGrounds>),
    (cache, device, stats): (Res<PipelineCache>, Res<RenderDevice>, Res<VegetationStats>),
    mut ctx: RenderContext,
) {
    let entity = view.into_inner();
    let VegetationViews {
        pipelines: Some(pipelines),
        views,
        ..
    } = &mut *vegetation
    else {
        return;
    };
    let Some(passes) = pipelines.passes(&cache) else {
        return;
    };
    for (place, key) in grounds.0.iter().enumerate() {
        let Some(state) = views.get_mut(&(entity, place)) else {
            continue;
        };
        let ground = producers.get(*key).and_then(|of| of.views.get(&entity));
        let Some(ground) = ground.filter(|ground| ground.filled) else {
            continue;
        };
        if state.counters.is_wanted() {
            let counts = state.buffers.counts.clone();
            state.counters.copy(&device, ctx.command_encoder(), &counts);
        }
        let Some(groups) = state.groups.as_ref().filter(|_| state.due) else {
            continue;
        };
        let bound = GrowBound {
            shared: &groups.shared,
            arguments: &groups.arguments,
            records: &groups.records,
            indirect: &state.buffers.arguments,
        };
        let recorder = ctx.diagnostic_recorder();
        let recorder = recorder.as_deref();
        let encoder = ctx.command_encoder();
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
            label: Some("vegetation_grow"),
            ..default()
        });
        let span = recorder.pass_span(&mut pass, "vegetation_grow");
        record_passes(&mut pass, passes.map(|pipeline| &**pipeline), &bound);
        span.end(&mut pass);
        drop(pass);
        stats.change(|count| count.dispatches += u64::from(DISPATCHES));
        state.counters.want();
        state.counters.copy(&device, encoder, &state.buffers.counts);
        state.due = !ground.settled;
        state.grown = true;
    }
}

type DrawnView<'a> = (
    Entity,
    &'a ExtractedCamera,
    Option<&'a MainPassResolutionOverride>,
    &'a ViewPrepassTextures,
    &'a ViewDepthTexture,
);

/// What grows in a view into its G-buffer.
pub fn draw(
    view: ViewQuery<DrawnView, (With<ExtractedVegetationView>, With<ExtractedGeometryCamera>)>,
    vegetation: Res<VegetationViews>,
    grounds: Res<VegetationGrounds>,
    (cache, stats): (Res<PipelineCache>, Res<VegetationStats>),
    mut ctx: RenderContext,
) {
    let (entity, camera, resolution, prepass, depth) = view.into_inner();
    let (Some(deferred), Some(pass_id), Some(key)) = (
        &prepass.deferred,
        &prepass.deferred_lighting_pass_id,
        DrawKey::new(prepass),
    ) else {
        return;
    };
    let ready = vegetation.pipelines.as_ref();
    let Some(pipelines) = ready.and_then(|known| known.draws(key, &cache)) else {
        return;
    };
    let states = (0..grounds.0.len())
        .filter_map(|place| vegetation.views.get(&(entity, place)))
        .filter(|state| state.grown);
    let mut states = states
        .filter_map(|state| Some((state, state.groups.as_ref()?)))
        .peekable();
    if states.peek().is_none() {
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
        label: Some("vegetation_gbuffer"),
        color_attachments: &attachments,
        depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = recorder.pass_span(&mut pass, "vegetation_gbuffer");
    let viewport = Viewport::from_viewport_and_override(camera.viewport.as_ref(), resolution);
    if let Some(viewport) = &viewport {
        pass.set_camera_viewport(viewport);
    }
    for (state, groups) in states {
        let draws = groups.draws.each_ref().map(|group| &**group);
        record_draws(
            pass.wgpu_pass(),
            pipelines.map(|pipeline| pipeline.map(|pipeline| &**pipeline)),
            draws,
            &state.buffers.arguments,
        );
    }
    span.end(&mut pass);
    stats.change(|count| count.draws += 1);
}

/// The nearest blades into the shadow maps of the view's sun.
pub fn draw_shadows(
    view: ViewQuery<Entity, (With<ExtractedVegetationView>, With<ExtractedGeometryCamera>)>,
    vegetation: Res<VegetationViews>,
    grounds: Res<VegetationGrounds>,
    lights: Query<&ShadowView>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let entity = view.into_inner();
    let known = vegetation.pipelines.as_ref();
    let Some(pipeline) = known.and_then(|known| known.shadows(&cache)) else {
        return;
    };
    let states = (0..grounds.0.len())
        .filter_map(|place| vegetation.views.get(&(entity, place)))
        .filter(|state| state.grown);
    for state in states {
        let Some(groups) = &state.groups else {
            continue;
        };
        for (number, light) in (0..).zip(&state.shadows) {
            let Ok(shadow) = lights.get(*light) else {
                continue;
            };
            let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
                label: Some("vegetation_shadows"),
                color_attachments: &[],
                depth_stencil_attachment: Some(
                    shadow.depth_attachment.get_attachment(StoreOp::Store),
                ),
                timestamp_writes: None,
                occlusion_query_set: None,
                multiview_mask: None,
            });
            record_shadows(
                pass.wgpu_pass(),
                pipeline,
                groups.draws.each_ref().map(|group| &**group),
                (&groups.shadows, number * SHADOW_SLOT as u32),
                &state.buffers.arguments,
            );
        }
    }
}
