//! Records the passes of a view.

use bevy::core_pipeline::deferred::copy_lighting_id::DeferredLightingIdDepthTexture;
use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::pbr::MeshViewBindGroup;
use bevy::prelude::*;
use bevy::render::camera::ExtractedCamera;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::{
    BindGroup, BindGroupEntry, Buffer, ComputePassDescriptor, IntoBinding, LoadOp, Operations,
    PipelineCache, RenderPassColorAttachment, RenderPassDepthStencilAttachment,
    RenderPassDescriptor, StoreOp, TextureView,
};
use bevy::render::renderer::{RenderContext, RenderDevice, ViewQuery};
use bevy::render::view::{ViewDepthTexture, ViewTarget, ViewUniformOffset, ViewUniforms};

use super::hull;
use super::lights::Lights;
use super::occlusion;
use super::pipeline::{light_layout, tiles_layout};
use super::prepare::ViewLighting;
use super::pyramid::{self, Recording, ViewPyramid};
use crate::choice::Chosen;

/// The hulls, made when the first view is lit by volumes.
#[derive(Default)]
pub struct Hulls(Option<[(Buffer, u32); 2]>);

/// What all passes of a view read.
pub(super) struct Reading<'a> {
    pub lighting: &'a ViewLighting,
    pub lights: Option<&'a Buffer>,
    pub ids: &'a TextureView,
    pub device: &'a RenderDevice,
    pub cache: &'a PipelineCache,
}

impl Reading<'_> {
    /// Our group of the full-screen pass, or of the hulls.
    pub fn group(&self, chosen: Option<Chosen>) -> Option<BindGroup> {
        let lighting = self.lighting;
        let mut entries = vec![
            BindGroupEntry {
                binding: 0,
                resource: lighting.uniform_buffer.as_ref()?.as_entire_binding(),
            },
            BindGroupEntry {
                binding: 3,
                resource: self.ids.into_binding(),
            },
        ];
        if chosen != Some(Chosen::Nothing) {
            entries.extend([
                BindGroupEntry {
                    binding: 1,
                    resource: self.lights?.as_entire_binding(),
                },
                BindGroupEntry {
                    binding: 2,
                    resource: lighting.list_buffer.as_ref()?.as_entire_binding(),
                },
            ]);
        }
        if let (Some(_), Some(occlusion)) = (chosen, &lighting.occlusion) {
            entries.push(BindGroupEntry {
                binding: 5,
                resource: occlusion.visible.default_view.into_binding(),
            });
        }
        let last = match chosen {
            Some(Chosen::Tiled) => Some(lighting.tiles.as_ref()?.lists.as_entire_binding()),
            Some(Chosen::Volumes) => Some(lighting.gathered.as_ref()?.default_view.into_binding()),
            _ => None,
        };
        entries.extend(last.map(|resource| BindGroupEntry {
            binding: 4,
            resource,
        }));
        let layout = self.cache.get_bind_group_layout(&light_layout(
            chosen,
            chosen.is_some() && lighting.occlusion.is_some(),
        ));
        Some(
            self.device
                .create_bind_group("dolomite_deferred_light", &layout, &entries),
        )
    }
}

/// Lights a view: lists or hulls first, then the full-screen pass.
pub fn light(
    view: ViewQuery<(
        &ExtractedCamera,
        &ViewLighting,
        &MeshViewBindGroup,
        &ViewUniformOffset,
        &ViewTarget,
        &ViewDepthTexture,
        &ViewPrepassTextures,
        &DeferredLightingIdDepthTexture,
    )>,
    cache: Res<PipelineCache>,
    lights: Res<Lights>,
    uniforms: Res<ViewUniforms>,
    mut hulls: Local<Hulls>,
    mut ctx: RenderContext,
) {
    let (camera, lighting, bevys, offset, target, depth, prepass, id_depth) = view.into_inner();
    let (Some(chosen), Some(ids), Some(depths)) = (
        lighting.variation.map(|variation| variation.chosen),
        prepass.deferred_lighting_pass_id.as_ref(),
        prepass.depth_view(),
    ) else {
        return;
    };
    let device = ctx.render_device().clone();
    let reading = Reading {
        lighting,
        lights: lights.buffer.as_ref(),
        ids: &ids.texture.default_view,
        device: &device,
        cache: &cache,
    };
    let models: Vec<_> = lighting
        .pipelines
        .light
        .iter()
        .filter_map(|id| cache.get_render_pipeline(*id))
        .collect();
    let Some(group) = reading.group(Some(chosen)).filter(|_| !models.is_empty()) else {
        return;
    };
    let before = match chosen {
        Chosen::Tiled => list(&reading, depths, offset, &uniforms, &mut ctx),
        Chosen::Volumes => gather(&reading, camera, bevys, depth, &mut hulls, &mut ctx),
        Chosen::Nothing | Chosen::BruteForce => Some(()),
    };
    // Without its lists the view would be lit by those of another frame.
    if before.is_none()
        || occlude(&reading, (depths, prepass), offset, &uniforms, &mut ctx).is_none()
    {
        return;
    }
    let diagnostics = ctx.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("dolomite_deferred_light"),
        color_attachments: &[Some(target.get_color_attachment())],
        depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
            view: &id_depth.texture.default_view,
            depth_ops: Some(Operations {
                load: LoadOp::Load,
                store: StoreOp::Discard,
            }),
            stencil_ops: None,
        }),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = diagnostics.pass_span(&mut pass, "dolomite_deferred_light");
    for pipeline in models {
        pass.set_render_pipeline(pipeline);
        pass.set_bind_group(0, &bevys.main, &bevys.main_offsets);
        pass.set_bind_group(1, &bevys.binding_array, &[]);
        pass.set_bind_group(2, &group, &[]);
        pass.draw(0..3, 0..1);
    }
    span.end(&mut pass);
}

/// Looks for ambient occlusion, where the camera asks for it; `None` if it should and cannot.
pub(super) fn occlude(
    reading: &Reading,
    (depths, prepass): (&TextureView, &ViewPrepassTextures),
    offset: &ViewUniformOffset,
    uniforms: &ViewUniforms,
    ctx: &mut RenderContext,
) -> Option<()> {
    let Some(view) = &reading.lighting.occlusion else {
        return Some(());
    };
    let [trace, filter] = reading
        .lighting
        .pipelines
        .occlusion?
        .map(|id| reading.cache.get_compute_pipeline(id));
    let recording = occlusion::Recording {
        occlusion: view,
        pipelines: [trace?, filter?],
        depths,
        words: &prepass.deferred.as_ref()?.texture.default_view,
        views: uniforms.uniforms.binding()?,
        offset: offset.offset,
    };
    let diagnostics = ctx.diagnostic_recorder();
    occlusion::record(
        &recording,
        reading.device,
        reading.cache,
        diagnostics.as_deref(),
        ctx.command_encoder(),
    );
    Some(())
}

/// Tells which lights lie behind what is drawn, where that is worth it; `None` if it should and cannot.
fn look<'a>(
    reading: &Reading<'a>,
    depths: &TextureView,
    offset: &ViewUniformOffset,
    uniforms: &ViewUniforms,
    ctx: &mut RenderContext,
) -> Option<Option<&'a ViewPyramid>> {
    let lighting = reading.lighting;
    let (pyramid, ids) = match (&lighting.pyramid, lighting.pipelines.pyramid) {
        (Some(pyramid), Some(ids)) => (pyramid, ids),
        (None, None) => return Some(None),
        _ => return None,
    };
    let [depth, above, lights] = ids.map(|id| reading.cache.get_compute_pipeline(id));
    let seen = [
        uniforms.uniforms.binding()?,
        lighting.uniform_buffer.as_ref()?.as_entire_binding(),
        reading.lights?.as_entire_binding(),
        lighting.list_buffer.as_ref()?.as_entire_binding(),
    ];
    let recording = Recording {
        pyramid,
        pipelines: [depth?, above?, lights?],
        depths,
        seen,
        offset: offset.offset,
        lights: lighting.uniform.in_tiles,
    };
    pyramid::record(
        recording,
        reading.device,
        reading.cache,
        ctx.command_encoder(),
    );
    Some(Some(pyramid))
}

/// Lists the lights of each tile.
fn list(
    reading: &Reading,
    depths: &TextureView,
    offset: &ViewUniformOffset,
    uniforms: &ViewUniforms,
    ctx: &mut RenderContext,
) -> Option<()> {
    let lighting = reading.lighting;
    let id = lighting.pipelines.tiles?;
    let pipeline = reading.cache.get_compute_pipeline(id)?;
    let tiles = lighting.tiles.as_ref()?;
    let pyramid = look(reading, depths, offset, uniforms, ctx)?;
    let mut resources = vec![
        uniforms.uniforms.binding()?,
        lighting.uniform_buffer.as_ref()?.as_entire_binding(),
        reading.lights?.as_entire_binding(),
        lighting.list_buffer.as_ref()?.as_entire_binding(),
        depths.into_binding(),
        tiles.used.as_entire_binding(),
        tiles.lists.as_entire_binding(),
    ];
    resources.extend(pyramid.map(|pyramid| pyramid.shown.as_entire_binding()));
    let entries: Vec<BindGroupEntry> = (0..)
        .zip(resources)
        .map(|(binding, resource)| BindGroupEntry { binding, resource })
        .collect();
    let layout = reading
        .cache
        .get_bind_group_layout(&tiles_layout(pyramid.is_some()));
    let group = reading
        .device
        .create_bind_group("dolomite_deferred_tiles", &layout, &entries);
    let diagnostics = ctx.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let encoder = ctx.command_encoder();
    encoder.clear_buffer(&tiles.used, 0, None);
    let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
        label: Some("dolomite_deferred_tiles"),
        timestamp_writes: None,
    });
    let span = diagnostics.pass_span(&mut pass, "dolomite_deferred_tiles");
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, &group, &[offset.offset]);
    let [x, y] = lighting.uniform.tiles;
    pass.dispatch_workgroups(x, y, 1);
    span.end(&mut pass);
    Some(())
}

/// Adds up the light of points and spots.
fn gather(
    reading: &Reading,
    camera: &ExtractedCamera,
    bevys: &MeshViewBindGroup,
    depth: &ViewDepthTexture,
    hulls: &mut Hulls,
    ctx: &mut RenderContext,
) -> Option<()> {
    let lighting = reading.lighting;
    let ids = [lighting.pipelines.volumes, lighting.pipelines.casting];
    let pipelines =
        ids.map(|ids| ids.map(|pair| pair.map(|id| reading.cache.get_render_pipeline(id))));
    let [Some(open), casting] = pipelines else {
        return None;
    };
    let group = reading.group(None)?;
    let gathered = lighting.gathered.as_ref()?;
    let hulls = hulls.0.get_or_insert_with(|| {
        [
            hull::sphere().buffer(reading.device, "dolomite_deferred_sphere"),
            hull::spot().buffer(reading.device, "dolomite_deferred_spot"),
        ]
    });
    let diagnostics = ctx.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("dolomite_deferred_volumes"),
        color_attachments: &[Some(RenderPassColorAttachment {
            view: &gathered.default_view,
            depth_slice: None,
            resolve_target: None,
            ops: Operations {
                load: LoadOp::Clear(default()),
                store: StoreOp::Store,
            },
        })],
        depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
            view: depth.view(),
            // Read, not written.
            depth_ops: None,
            stencil_ops: None,
        }),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = diagnostics.pass_span(&mut pass, "dolomite_deferred_volumes");
    if let Some(viewport) = &camera.viewport {
        pass.set_camera_viewport(viewport);
    }
    let pipelines = open.into_iter().chain(casting.unwrap_or([None; 2]));
    let kinds = lighting.listed.runs().into_iter().zip(pipelines);
    for ((range, pipeline), (corners, count)) in kinds.zip(hulls.iter().cycle()) {
        // A run that the last variation has no pipeline for waits.
        let Some(pipeline) = pipeline.filter(|_| !range.is_empty()) else {
            continue;
        };
        pass.set_render_pipeline(pipeline);
        pass.set_bind_group(0, &bevys.main, &bevys.main_offsets);
        pass.set_bind_group(1, &bevys.binding_array, &[]);
        pass.set_bind_group(2, &group, &[]);
        pass.set_vertex_buffer(0, corners.slice(..));
        pass.draw(0..*count, range);
    }
    span.end(&mut pass);
    Some(())
}
