//! Straight into the picture of a camera that has no G-buffer: no light pass reads it back.

use bevy::camera::MainPassResolutionOverride;
use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::prelude::*;
use bevy::render::camera::ExtractedCamera;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::{PipelineCache, RenderPassDescriptor, StoreOp};
use bevy::render::renderer::{RenderContext, ViewQuery};
use bevy::render::view::{ViewDepthTexture, ViewTarget};

use super::extract::ExtractedGeometryCamera;
use super::pass::{draw_calls, ready, viewport};
use super::pipeline::{DrawKey, DrawStep};
use super::producer::Producers;

type DirectView<'a> = (
    Entity,
    &'a ExtractedCamera,
    Option<&'a MainPassResolutionOverride>,
    &'a ViewTarget,
    &'a ViewDepthTexture,
    &'a Msaa,
    Option<&'a ViewPrepassTextures>,
);

/// The primitives of every producer into picture and depth buffer, before Bevy's own opaque things.
pub fn draw(
    view: ViewQuery<DirectView, With<ExtractedGeometryCamera>>,
    producers: Res<Producers>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
    mut told: Local<bool>,
) {
    let (entity, camera, resolution, target, depth, msaa, prepass) = view.into_inner();
    if prepass.is_some_and(|prepass| prepass.deferred.is_some()) {
        return;
    }
    let key = |lines| DrawKey::new(prepass, target, lines);
    let calls = ready(&producers, entity, &cache, key, DrawStep::Whole);
    if calls.is_empty() {
        return;
    }
    if msaa.samples() > 1 {
        if !std::mem::replace(&mut *told, true) {
            error!("a camera with a GeometryCamera draws one sample a pixel: give it Msaa::Off");
        }
        return;
    }
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("geometry_direct"),
        color_attachments: &[Some(target.get_color_attachment())],
        depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = recorder.pass_span(&mut pass, "geometry_direct");
    draw_calls(&mut pass, viewport(camera, resolution).as_ref(), &calls);
    span.end(&mut pass);
}
