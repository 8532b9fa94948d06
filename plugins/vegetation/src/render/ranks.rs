//! Ranks of what grows in each pixel of the cameras that have [`VegetationRanks`]: what their records hold is drawn once
//! more behind the picture's depths, into a texture of its own.
//!
//! While no camera has one each system here is a run condition, and one looks for cameras.

use std::num::NonZero;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use bevy::camera::{MainPassResolutionOverride, Viewport};
use bevy::core_pipeline::core_3d::main_opaque_pass_3d;
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::prelude::*;
use bevy::render::camera::ExtractedCamera;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::binding_types::uniform_buffer_sized;
use bevy::render::render_resource::{
    BindGroup, BindGroupEntries, BindGroupLayoutDescriptor, BindGroupLayoutEntries,
    BufferInitDescriptor, BufferUsages, CachedRenderPipelineId, Extent3d, LoadOp, Operations,
    PipelineCache, RenderPassColorAttachment, RenderPassDepthStencilAttachment,
    RenderPassDescriptor, ShaderStages, StoreOp, TextureDescriptor, TextureDimension,
    TextureFormat, TextureUsages,
};
use bevy::render::renderer::{RenderContext, RenderDevice, ViewQuery};
use bevy::render::sync_world::RenderEntity;
use bevy::render::texture::{CachedTexture, TextureCache};
use bevy::render::view::ViewDepthTexture;
use bevy::render::{Extract, ExtractSchedule, Render, RenderApp, RenderSystems};

use super::extract::ExtractedVegetation;
use super::layers::layers;
use super::layout::{LISTS, LayerParams, MOST_LAYERS};
use super::lists::vertices_of;
use super::prepare::{self, VegetationGrounds, VegetationViews};
use super::record::record_draws;
use crate::components::{VegetationRanks, VegetationView};

/// What was found of a view. On the view's entity in the render world.
#[derive(Component, Clone)]
pub struct ViewRanks {
    /// As large as the target, two floats a pixel: the rank as a share of all 2²⁴, −1 where nothing grows; and the share
    /// below which ranks stand where the kind grows best.
    pub found: CachedTexture,
}

/// How many passes were recorded, over all views: 0 as long as no camera had [`VegetationRanks`]. The same in both worlds.
#[derive(Resource, Clone, Debug, Default)]
pub struct RankPasses(Arc<AtomicU64>);

impl RankPasses {
    /// The count.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

/// Views that ask for ranks, and on which of their grounds with which group; there while one does.
#[derive(Resource, Default)]
struct Ranked {
    views: Vec<Entity>,
    groups: Vec<((Entity, usize), BindGroup)>,
}

#[derive(Resource, Default)]
struct RankPipelines([Option<CachedRenderPipelineId>; LISTS]);

const FORMAT: TextureFormat = TextureFormat::Rg32Float;

/// `Ranks` in `shaders/src/vegetation/rank.wgsl`.
type Kinds = [[u32; 4]; MOST_LAYERS];

fn kinds_of(layers: &[LayerParams; MOST_LAYERS]) -> Kinds {
    layers.map(|layer| {
        let lattice = layer.growth.lattice;
        [
            lattice.seed,
            lattice.pitch_log2.cast_unsigned(),
            layer.growth.full.to_bits(),
            0,
        ]
    })
}

fn layout() -> BindGroupLayoutDescriptor {
    let size = NonZero::new(size_of::<Kinds>() as u64);
    BindGroupLayoutDescriptor::new(
        "vegetation_ranks",
        &BindGroupLayoutEntries::single(ShaderStages::VERTEX, uniform_buffer_sized(false, size)),
    )
}

/// Adds it to an app that renders.
pub(super) fn build(app: &mut App) {
    let passes = RankPasses::default();
    app.insert_resource(passes.clone());
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .insert_resource(passes)
        .init_resource::<RankPipelines>()
        .add_systems(ExtractSchedule, extract)
        .add_systems(
            Render,
            (
                textures
                    .run_if(resource_exists::<Ranked>)
                    .in_set(RenderSystems::PrepareResources),
                clear
                    .run_if(resource_removed::<Ranked>)
                    .in_set(RenderSystems::PrepareResources),
                bind.run_if(resource_exists::<Ranked>)
                    .in_set(RenderSystems::PrepareBindGroups)
                    .after(prepare::prepare),
            ),
        )
        .add_systems(
            Core3d,
            draw.run_if(resource_exists::<Ranked>)
                .in_set(Core3dSystems::MainPass)
                .before(main_opaque_pass_3d),
        );
}

type Asking = (With<VegetationRanks>, With<VegetationView>);

fn extract(
    mut commands: Commands,
    cameras: Extract<Query<(RenderEntity, &Camera), Asking>>,
    known: Option<Res<Ranked>>,
) {
    let active = cameras.iter().filter(|(_, camera)| camera.is_active);
    let views: Vec<_> = active.map(|(entity, _)| entity).collect();
    if !views.is_empty() {
        let groups = Vec::new();
        commands.insert_resource(Ranked { views, groups });
    } else if known.is_some() {
        commands.remove_resource::<Ranked>();
    }
}

/// Textures as large as the target of each view.
fn textures(
    mut commands: Commands,
    ranked: Res<Ranked>,
    cameras: Query<&ExtractedCamera>,
    known: Query<Entity, With<ViewRanks>>,
    mut cache: ResMut<TextureCache>,
    device: Res<RenderDevice>,
) {
    for view in known.iter().filter(|view| !ranked.views.contains(view)) {
        commands.entity(view).remove::<ViewRanks>();
    }
    for view in &ranked.views {
        let size = cameras.get(*view).ok();
        let Some(size) = size.and_then(|camera| camera.physical_target_size) else {
            continue;
        };
        let found = cache.get(
            &device,
            TextureDescriptor {
                label: Some("vegetation_ranks"),
                size: Extent3d {
                    width: size.x,
                    height: size.y,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: TextureDimension::D2,
                format: FORMAT,
                usage: TextureUsages::RENDER_ATTACHMENT
                    | TextureUsages::TEXTURE_BINDING
                    | TextureUsages::COPY_SRC,
                view_formats: &[],
            },
        );
        commands.entity(*view).insert(ViewRanks { found });
    }
}

/// Nobody asks any more.
fn clear(mut commands: Commands, views: Query<Entity, With<ViewRanks>>) {
    for view in &views {
        commands.entity(view).remove::<ViewRanks>();
    }
}

/// Pipelines of the lists that are used, and what the kinds of each view are.
fn bind(
    vegetation: Res<VegetationViews>,
    grown: Res<ExtractedVegetation>,
    mut ranked: ResMut<Ranked>,
    mut ranks: ResMut<RankPipelines>,
    (cache, device): (Res<PipelineCache>, Res<RenderDevice>),
) {
    let (Some(pipelines), Some(kinds)) = (&vegetation.pipelines, &grown.kinds) else {
        return;
    };
    let layout = layout();
    let vertices = vertices_of(layers(&kinds.kinds));
    for (list, id) in ranks.0.iter_mut().enumerate() {
        if vertices[list] > 0 && id.is_none() {
            let descriptor = pipelines.ranks(list, &layout, FORMAT);
            *id = Some(cache.queue_render_pipeline(descriptor));
        }
    }
    let Ranked { views, groups } = &mut *ranked;
    for (key, state) in &vegetation.views {
        if !views.contains(&key.0) {
            continue;
        }
        let buffer = device.create_buffer_with_data(&BufferInitDescriptor {
            label: Some("vegetation_ranks"),
            contents: bytemuck::bytes_of(&kinds_of(&state.params.layers)),
            usage: BufferUsages::UNIFORM,
        });
        let group = device.create_bind_group(
            "vegetation_ranks",
            &cache.get_bind_group_layout(&layout),
            &BindGroupEntries::single(buffer.as_entire_binding()),
        );
        groups.push((*key, group));
    }
}

type RankedView<'a> = (
    Entity,
    &'a ExtractedCamera,
    Option<&'a MainPassResolutionOverride>,
    &'a ViewDepthTexture,
    &'a ViewRanks,
);

/// What grows in a view, behind the picture's depths.
fn draw(
    view: ViewQuery<RankedView>,
    (vegetation, grounds): (Res<VegetationViews>, Res<VegetationGrounds>),
    (ranked, ranks): (Res<Ranked>, Res<RankPipelines>),
    (cache, passes): (Res<PipelineCache>, Res<RankPasses>),
    mut ctx: RenderContext,
) {
    let (entity, camera, resolution, depth, own) = view.into_inner();
    passes.0.fetch_add(1, Ordering::Relaxed);
    let pipelines = ranks
        .0
        .map(|id| id.and_then(|id| cache.get_render_pipeline(id)));
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let nothing = LinearRgba::new(-1.0, 1.0, 0.0, 0.0);
    let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("vegetation_ranks"),
        color_attachments: &[Some(RenderPassColorAttachment {
            view: &own.found.default_view,
            depth_slice: None,
            resolve_target: None,
            ops: Operations {
                load: LoadOp::Clear(nothing.into()),
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
    let span = recorder.pass_span(&mut pass, "vegetation_ranks");
    let viewport = Viewport::from_viewport_and_override(camera.viewport.as_ref(), resolution);
    if let Some(viewport) = &viewport {
        pass.set_camera_viewport(viewport);
    }
    for place in 0..grounds.0.len() {
        let key = (entity, place);
        let group = ranked.groups.iter().find(|(known, _)| *known == key);
        let state = vegetation.views.get(&key).filter(|state| state.grown);
        let (Some((_, kinds)), Some(state)) = (group, state) else {
            continue;
        };
        let Some(groups) = &state.groups else {
            continue;
        };
        pass.wgpu_pass().set_bind_group(1, &**kinds, &[]);
        record_draws(
            pass.wgpu_pass(),
            pipelines.map(|pipeline| pipeline.map(|pipeline| &**pipeline)),
            groups.draws.each_ref().map(|group| &**group),
            &state.buffers.arguments,
        );
    }
    span.end(&mut pass);
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;

    #[test]
    fn kinds_are_told_by_seed_pitch_and_density() {
        let mut layers: [LayerParams; MOST_LAYERS] = Zeroable::zeroed();
        layers[3].growth.lattice.seed = 7;
        layers[3].growth.lattice.pitch_log2 = -2;
        layers[3].growth.full = 0.25;
        let kinds = kinds_of(&layers);
        assert_eq!(kinds[3], [7, 0xffff_fffe, 0x3e80_0000, 0]);
        assert_eq!(kinds[2], [0; 4]);
    }
}
