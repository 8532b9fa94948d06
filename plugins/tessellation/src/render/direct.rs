//! Patches straight into the picture of a camera that has no G-buffer: no light pass reads them back.

use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::prelude::*;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::{PipelineCache, RenderPassDescriptor, StoreOp};
use bevy::render::renderer::{RenderContext, ViewQuery};
use bevy::render::view::{ViewDepthTexture, ViewTarget};

use super::extract::ExtractedStageCamera;
use super::pass::{draw_key, ready};
use super::prepare::StageKinds;

type DirectView<'a> = (
    Entity,
    &'a ViewTarget,
    &'a ViewDepthTexture,
    &'a Msaa,
    Option<&'a ViewPrepassTextures>,
);

/// The primitives of every kind into picture and depth buffer, before Bevy's own opaque things.
pub fn draw(
    view: ViewQuery<DirectView, With<ExtractedStageCamera>>,
    mut kinds: ResMut<StageKinds>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
    mut told: Local<bool>,
) {
    let (entity, target, depth, msaa, prepass) = view.into_inner();
    if prepass.is_some_and(|prepass| prepass.deferred.is_some()) {
        return;
    }
    if msaa.samples() > 1 {
        if !std::mem::replace(&mut *told, true) {
            error!("patches are drawn with one sample a pixel: give the camera Msaa::Off");
        }
        return;
    }
    let drawn = ready(&mut kinds, entity, &cache, |state| {
        draw_key(prepass, target, state)
    });
    if drawn.is_empty() {
        return;
    }
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("stage_direct"),
        color_attachments: &[Some(target.get_color_attachment())],
        depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = recorder.pass_span(&mut pass, "stage_direct");
    for kind in &drawn {
        kind.draw(&mut pass);
    }
    span.end(&mut pass);
}
