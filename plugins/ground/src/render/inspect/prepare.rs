//! Textures of the views that are inspected, and what is drawn into them.

use bevy::core_pipeline::core_3d::CORE_3D_DEPTH_FORMAT;
use bevy::prelude::*;
use bevy::render::camera::ExtractedCamera;
use bevy::render::render_resource::{
    BindGroupEntries, BufferInitDescriptor, BufferUsages, Extent3d, PipelineCache,
    TextureDescriptor, TextureDimension, TextureFormat, TextureUsages,
};
use bevy::render::renderer::RenderDevice;
use bevy::render::texture::TextureCache;
use bytemuck::bytes_of;
use dolomite_geometry::render::Producers;

use super::pipeline::{Key, Pipelines, format, heights_layout, view_layout};
use super::{Draw, Inspected, InspectionShader, ViewInspection};
use crate::detail::layout::without;
use crate::inspection::{GroundInspection, InspectionParams};
use crate::render::blocks::prepare::BlockViews;
use crate::render::detail::extract::ExtractedGround;
use crate::render::detail::want::DetailData;
use crate::render::detail::{DetailKind, detail_key};

/// Textures as large as the target of each view.
pub(super) fn textures(
    mut commands: Commands,
    inspected: Res<Inspected>,
    cameras: Query<&ExtractedCamera>,
    known: Query<Entity, With<ViewInspection>>,
    mut cache: ResMut<TextureCache>,
    device: Res<RenderDevice>,
) {
    let is_inspected = |view: &Entity| inspected.views.iter().any(|(entity, _)| entity == view);
    for view in known.iter().filter(|view| !is_inspected(view)) {
        commands.entity(view).remove::<ViewInspection>();
    }
    for (view, what) in &inspected.views {
        let size = cameras.get(*view).ok();
        let Some(size) = size.and_then(|camera| camera.physical_target_size) else {
            continue;
        };
        let mut texture = |label, format: TextureFormat, usage| {
            cache.get(
                &device,
                TextureDescriptor {
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
                    usage: TextureUsages::RENDER_ATTACHMENT | usage,
                    view_formats: &[],
                },
            )
        };
        let read = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC;
        let depth = CORE_3D_DEPTH_FORMAT;
        commands.entity(*view).insert(ViewInspection {
            what: *what,
            found: texture("ground_inspection", format(*what), read),
            depth: texture("ground_inspection_depth", depth, TextureUsages::empty()),
        });
    }
}

/// Nothing is inspected any more.
pub(super) fn clear(mut commands: Commands, views: Query<Entity, With<ViewInspection>>) {
    for view in &views {
        commands.entity(view).remove::<ViewInspection>();
    }
}

/// The ground of a kind in the views that are inspected.
pub(super) fn draws<K: DetailKind>(
    producers: Res<Producers>,
    (bound, blocks, ground): (
        Res<DetailData<K>>,
        Res<BlockViews<K>>,
        Res<ExtractedGround<K>>,
    ),
    mut inspected: ResMut<Inspected>,
    (mut pipelines, shader): (ResMut<Pipelines>, Res<InspectionShader>),
    (cache, device): (Res<PipelineCache>, Res<RenderDevice>),
) {
    let (Some(producer), Some(heights), Some(terrain)) = (
        producers.get(detail_key::<K>()),
        &bound.heights,
        &ground.terrain,
    ) else {
        return;
    };
    let Inspected { views, draws } = &mut *inspected;
    for (view, what) in views {
        let (Some(state), Some((lattice, metric))) =
            (producer.views.get(view), blocks.lattice(*view))
        else {
            continue;
        };
        let frame = &state.frame;
        let params =
            InspectionParams::new(lattice, frame.anchor, frame.steady_clip, frame.size, metric);
        let tolerance = params.tolerance;
        let params = device.create_buffer_with_data(&BufferInitDescriptor {
            label: Some("ground_inspection"),
            contents: bytes_of(&params),
            usage: BufferUsages::UNIFORM,
        });
        let mut groups = vec![device.create_bind_group(
            "ground_inspection",
            &cache.get_bind_group_layout(&view_layout()),
            &BindGroupEntries::sequential((
                params.as_entire_binding(),
                state.vertices.as_entire_binding(),
                state.indices.as_entire_binding(),
            )),
        )];
        let reads = *what == GroundInspection::Error;
        if reads {
            let [layers, table, uniform] = heights;
            groups.push(device.create_bind_group(
                "ground_inspection_heights",
                &cache.get_bind_group_layout(&heights_layout()),
                &BindGroupEntries::sequential((
                    layers.as_entire_binding(),
                    table.as_entire_binding(),
                    uniform.as_entire_binding(),
                )),
            ));
        }
        let key = Key {
            what: *what,
            without: if reads { without(terrain) } else { Vec::new() },
            double_sided: producer.traits.double_sided,
        };
        draws.push(Draw {
            view: *view,
            pipeline: pipelines.get(key, &shader.handle, &cache),
            groups,
            tolerance,
            work: state.work.clone(),
        });
    }
}
