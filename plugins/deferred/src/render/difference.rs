//! How far what a view is lit with is from the reference: each pixel goes through all lights of the world once more, into a
//! texture of its own.
//!
//! The reference has everything of its own but the G-buffer, Bevy's shadow maps and the shading models: its list of lights,
//! which nothing was culled from, and its ambient occlusion. While no camera has a
//! [`LightingDifference`](crate::LightingDifference) each system here is a run condition.

use bevy::core_pipeline::deferred::copy_lighting_id::DeferredLightingIdDepthTexture;
use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::pbr::MeshViewBindGroup;
use bevy::prelude::*;
use bevy::render::camera::ExtractedCamera;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::binding_types::texture_2d;
use bevy::render::render_resource::{
    BindGroupEntries, BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedRenderPipelineId,
    ColorTargetState, ColorWrites, Extent3d, FragmentState, LoadOp, Operations, PipelineCache,
    RenderPassColorAttachment, RenderPassDepthStencilAttachment, RenderPassDescriptor,
    RenderPipelineDescriptor, ShaderStages, StoreOp, TextureDescriptor, TextureDimension,
    TextureFormat, TextureSampleType, TextureUsages, VertexState,
};
use bevy::render::renderer::{RenderContext, RenderDevice, ViewQuery};
use bevy::render::texture::{CachedTexture, TextureCache};
use bevy::render::view::{ExtractedView, ViewTarget, ViewUniformOffset, ViewUniforms};

use super::lights::Lights;
use super::pass::{Reading, occlude};
use super::prepare::{Lit, Tools, ViewLighting};
use super::shaders::Shaders;
use crate::choice::Chosen;
use crate::components::{LightingDifference, Way};

/// What is found of a view that has a [`LightingDifference`]; on its entity in the render world.
#[derive(Component)]
pub struct ViewDifference {
    lighting: ViewLighting,
    /// Lit by the reference.
    reference: CachedTexture,
    /// A float a pixel of the target: the greatest difference of a channel, as a share of the reference's greatest
    /// channel; −1 where nothing was lit.
    pub found: CachedTexture,
}

/// The pipeline that compares, once a camera asked for it.
#[derive(Resource, Default)]
pub struct Comparison(Option<CachedRenderPipelineId>);

/// The format of [`ViewDifference::found`].
const FOUND: TextureFormat = TextureFormat::R32Float;

fn layout() -> BindGroupLayoutDescriptor {
    let texture = || texture_2d(TextureSampleType::Float { filterable: false });
    BindGroupLayoutDescriptor::new(
        "dolomite_deferred_difference",
        &BindGroupLayoutEntries::sequential(ShaderStages::FRAGMENT, (texture(), texture())),
    )
}

fn descriptor(shaders: &Shaders) -> RenderPipelineDescriptor {
    RenderPipelineDescriptor {
        label: Some("dolomite_deferred_difference".into()),
        layout: vec![layout()],
        vertex: VertexState {
            shader: shaders.difference.clone(),
            entry_point: Some("vertex".into()),
            ..default()
        },
        fragment: Some(FragmentState {
            shader: shaders.difference.clone(),
            entry_point: Some("fragment".into()),
            targets: vec![Some(ColorTargetState {
                format: FOUND,
                blend: None,
                write_mask: ColorWrites::ALL,
            })],
            ..default()
        }),
        ..default()
    }
}

/// Lists the lights of the reference, and makes textures as large as the target.
pub fn prepare(
    mut commands: Commands,
    mut views: Query<
        (
            Entity,
            Lit,
            &ExtractedCamera,
            &ExtractedView,
            Option<&mut ViewDifference>,
        ),
        With<LightingDifference>,
    >,
    lights: Res<Lights>,
    mut tools: Tools,
    device: Res<RenderDevice>,
    mut textures: ResMut<TextureCache>,
    (mut comparison, shaders, cache): (ResMut<Comparison>, Res<Shaders>, Res<PipelineCache>),
) {
    for (entity, lit, camera, view, old) in &mut views {
        let mut lighting = ViewLighting::default();
        let mut old = old;
        let known = old
            .as_deref_mut()
            .map_or(&mut lighting, |old| &mut old.lighting);
        known.fill(Way::BruteForce, &lit, &lights, &mut tools, &mut textures);
        let size = camera
            .physical_target_size
            .unwrap_or(UVec2::ONE)
            .max(UVec2::ONE);
        let mut texture = |label, format| {
            let usage = TextureUsages::RENDER_ATTACHMENT
                | TextureUsages::TEXTURE_BINDING
                | TextureUsages::COPY_SRC;
            let descriptor = TextureDescriptor {
                label: Some(label),
                size: Extent3d {
                    width: size.x,
                    height: size.y,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            };
            textures.get(&device, descriptor)
        };
        // Rounded as the target is.
        let reference = texture("dolomite_deferred_reference", view.target_format);
        let found = texture("dolomite_deferred_difference", FOUND);
        comparison
            .0
            .get_or_insert_with(|| cache.queue_render_pipeline(descriptor(&shaders)));
        match old {
            Some(mut old) => (old.reference, old.found) = (reference, found),
            None => {
                commands.entity(entity).insert(ViewDifference {
                    lighting,
                    reference,
                    found,
                });
            }
        }
    }
}

/// Lights the view once more, before it is lit: that takes the depths of the lighting ids away.
pub fn light(
    view: ViewQuery<(
        &ViewDifference,
        &MeshViewBindGroup,
        &ViewUniformOffset,
        &ViewPrepassTextures,
        &DeferredLightingIdDepthTexture,
    )>,
    (cache, lights, uniforms): (Res<PipelineCache>, Res<Lights>, Res<ViewUniforms>),
    mut ctx: RenderContext,
) {
    let (own, bevys, offset, prepass, id_depth) = view.into_inner();
    let device = ctx.render_device().clone();
    let (Some(chosen), Some(ids), Some(depths)) = (
        own.lighting.variation.map(|variation| variation.chosen),
        prepass.deferred_lighting_pass_id.as_ref(),
        prepass.depth_view(),
    ) else {
        return;
    };
    let reading = Reading {
        lighting: &own.lighting,
        lights: lights.buffer.as_ref(),
        ids: &ids.texture.default_view,
        device: &device,
        cache: &cache,
    };
    // Without lights it goes through none.
    let lists = matches!(chosen, Chosen::BruteForce | Chosen::Nothing);
    let ready =
        lists && occlude(&reading, (depths, prepass), offset, &uniforms, &mut ctx).is_some();
    let group = reading.group(Some(chosen)).filter(|_| ready);
    let models = own.lighting.pipelines.light.iter();
    let models = models.filter_map(|id| cache.get_render_pipeline(*id));
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("dolomite_deferred_reference"),
        color_attachments: &[Some(RenderPassColorAttachment {
            view: &own.reference.default_view,
            depth_slice: None,
            resolve_target: None,
            ops: Operations {
                load: LoadOp::Clear(default()),
                store: StoreOp::Store,
            },
        })],
        depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
            view: &id_depth.texture.default_view,
            depth_ops: Some(Operations {
                load: LoadOp::Load,
                store: StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = recorder.pass_span(&mut pass, "dolomite_deferred_reference");
    if let Some(group) = &group {
        for pipeline in models {
            pass.set_render_pipeline(pipeline);
            pass.set_bind_group(0, &bevys.main, &bevys.main_offsets);
            pass.set_bind_group(1, &bevys.binding_array, &[]);
            pass.set_bind_group(2, group, &[]);
            pass.draw(0..3, 0..1);
        }
    }
    span.end(&mut pass);
}

/// Compares both, once the view is lit and before anything else is drawn into it.
pub fn compare(
    view: ViewQuery<(&ViewDifference, &ViewTarget)>,
    (cache, comparison): (Res<PipelineCache>, Res<Comparison>),
    mut ctx: RenderContext,
) {
    let (own, target) = view.into_inner();
    let id = comparison.0;
    let Some(pipeline) = id.and_then(|id| cache.get_render_pipeline(id)) else {
        return;
    };
    let group = ctx.render_device().create_bind_group(
        "dolomite_deferred_difference",
        &cache.get_bind_group_layout(&layout()),
        &BindGroupEntries::sequential((target.main_texture_view(), &own.reference.default_view)),
    );
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("dolomite_deferred_difference"),
        color_attachments: &[Some(RenderPassColorAttachment {
            view: &own.found.default_view,
            depth_slice: None,
            resolve_target: None,
            ops: Operations {
                load: LoadOp::Clear(default()),
                store: StoreOp::Store,
            },
        })],
        depth_stencil_attachment: None,
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = recorder.pass_span(&mut pass, "dolomite_deferred_difference");
    pass.set_render_pipeline(pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.draw(0..3, 0..1);
    span.end(&mut pass);
}
