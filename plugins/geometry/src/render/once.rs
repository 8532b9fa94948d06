//! What is kept of surfaces until they are shaded, once a pixel ([`DrawTraits::shaded_once`](super::DrawTraits::shaded_once)):
//! a texture as large as the depth buffer, once a view that has such a producer.

use std::collections::HashMap;

use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::prelude::*;
use bevy::render::render_resource::{
    BindGroup, BindGroupEntries, LoadOp, Operations, PipelineCache, RenderPassColorAttachment,
    StoreOp, TextureDescriptor, TextureDimension, TextureUsages, TextureView,
};
use bevy::render::renderer::RenderDevice;
use bevy::render::texture::TextureCache;
use bevy::render::view::ViewDepthTexture;

use super::pipeline::{SURFACE_FORMAT, surfaces_layout};
use super::producer::{Producer, Producers};

/// What was kept of the surfaces of each view, in this frame.
#[derive(Resource, Default)]
pub struct Surfaces(HashMap<Entity, ViewSurfaces>);

/// Of one view.
struct ViewSurfaces {
    target: TextureView,
    group: BindGroup,
}

impl Surfaces {
    /// Where the draws of a view go, cleared; and the group by which they are read.
    pub fn of(&self, view: Entity) -> Option<(RenderPassColorAttachment<'_>, &BindGroup)> {
        let own = self.0.get(&view)?;
        let attachment = RenderPassColorAttachment {
            view: &own.target,
            depth_slice: None,
            resolve_target: None,
            ops: Operations {
                // All words 0: nothing was drawn.
                load: LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: StoreOp::Store,
            },
        };
        Some((attachment, &own.group))
    }
}

/// Whether a producer draws something into a view that is shaded once a pixel.
fn is_once(producer: &Producer, view: Entity) -> bool {
    let shown = |view: &super::GeometryView| view.is_shown() && !view.shown[1];
    producer.traits.shaded_once && producer.views.get(&view).is_some_and(shown)
}

/// The textures that this frame needs; none where no producer draws so.
pub fn keep(
    producers: Res<Producers>,
    views: Query<(Entity, &ViewDepthTexture, &ViewPrepassTextures)>,
    mut surfaces: ResMut<Surfaces>,
    mut textures: ResMut<TextureCache>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
) {
    surfaces.0.clear();
    for (view, depth, prepass) in &views {
        // Without a G-buffer the draws shade.
        if prepass.deferred.is_none() || !producers.iter().any(|producer| is_once(producer, view)) {
            continue;
        }
        let texture = textures.get(
            &device,
            TextureDescriptor {
                label: Some("geometry_surfaces"),
                size: depth.texture.size(),
                mip_level_count: 1,
                sample_count: 1,
                dimension: TextureDimension::D2,
                format: SURFACE_FORMAT,
                usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            },
        );
        let group = device.create_bind_group(
            "geometry_surfaces",
            &cache.get_bind_group_layout(&surfaces_layout()),
            &BindGroupEntries::single(&texture.default_view),
        );
        let own = ViewSurfaces {
            target: texture.default_view,
            group,
        };
        surfaces.0.insert(view, own);
    }
}
