//! The pass of a view that is inspected.

use bevy::prelude::*;
use bevy::render::camera::ExtractedCamera;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::{
    LoadOp, Operations, PipelineCache, RenderPassColorAttachment, RenderPassDepthStencilAttachment,
    RenderPassDescriptor, StoreOp,
};
use bevy::render::renderer::{RenderContext, ViewQuery};
use dolomite_geometry::layout::PLAIN_ARGUMENTS;
use dolomite_geometry::render::{GeometryView, Producers};

use super::{Inspected, InspectionPasses, ViewInspection};
use crate::inspection::GroundInspection;

/// Where no ground is: no level, no error, but the tolerance; and nothing drawn yet.
const fn nothing(what: GroundInspection, tolerance: f32) -> LinearRgba {
    match what {
        GroundInspection::Level => LinearRgba::new(-1.0, 0.0, 0.0, 0.0),
        GroundInspection::Error => LinearRgba::new(-1.0, tolerance, 0.0, 0.0),
        GroundInspection::Overdraw => LinearRgba::NONE,
    }
}

/// Draws what the pools of the view hold.
pub(super) fn draw(
    view: ViewQuery<(Entity, &ExtractedCamera, &ViewInspection)>,
    inspected: Res<Inspected>,
    producers: Res<Producers>,
    cache: Res<PipelineCache>,
    passes: Res<InspectionPasses>,
    mut ctx: RenderContext,
) {
    let (entity, camera, own) = view.into_inner();
    // Pools that hold nothing have no arguments yet.
    let is_shown = |work: &bevy::render::render_resource::Buffer| {
        let mut states = producers.iter().filter_map(|of| of.views.get(&entity));
        states.any(|state: &GeometryView| state.work.id() == work.id() && state.is_shown())
    };
    let draws = || inspected.draws.iter().filter(|draw| draw.view == entity);
    let tolerance = draws().next().map_or(1.0, |draw| draw.tolerance);
    passes.add();
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("ground_inspection"),
        color_attachments: &[Some(RenderPassColorAttachment {
            view: &own.found.default_view,
            depth_slice: None,
            resolve_target: None,
            ops: Operations {
                load: LoadOp::Clear(nothing(own.what, tolerance).into()),
                store: StoreOp::Store,
            },
        })],
        depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
            view: &own.depth.default_view,
            depth_ops: Some(Operations {
                load: LoadOp::Clear(0.0),
                store: StoreOp::Discard,
            }),
            stencil_ops: None,
        }),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = recorder.pass_span(&mut pass, "ground_inspection");
    if let Some(viewport) = &camera.viewport {
        pass.set_camera_viewport(viewport);
    }
    for draw in draws() {
        let Some(pipeline) = cache.get_render_pipeline(draw.pipeline) else {
            continue;
        };
        if !is_shown(&draw.work) {
            continue;
        }
        pass.set_render_pipeline(pipeline);
        for (at, group) in draw.groups.iter().enumerate() {
            pass.set_bind_group(at, group, &[]);
        }
        pass.draw_indirect(&draw.work, PLAIN_ARGUMENTS);
    }
    span.end(&mut pass);
}
