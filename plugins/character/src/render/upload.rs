//! The figures of a frame to the GPU: 16 bytes each, and only those of crowds that changed.

use super::crowd::{Crowd, CrowdLook};
use crate::crowd::CrowdFigure;
use bevy::asset::AssetId;
use bevy::ecs::prelude::*;
use bevy::platform::collections::HashMap;
use bevy::render::Extract;
use bevy::render::render_asset::RenderAssets;
use bevy::render::renderer::RenderQueue;
use bevy::render::storage::{GpuShaderBuffer, ShaderBuffer};

/// Figures that wait for their buffer, and what was sent.
#[derive(Resource, Default)]
pub struct CrowdUploads {
    waiting: HashMap<AssetId<ShaderBuffer>, Vec<CrowdFigure>>,
    /// Bytes of figures that were sent since the start.
    pub bytes: u64,
}

pub(super) fn extract(
    crowds: Extract<Query<(&Crowd, &CrowdLook), Or<(Changed<Crowd>, Added<CrowdLook>)>>>,
    mut uploads: ResMut<CrowdUploads>,
) {
    for (crowd, look) in &crowds {
        uploads.waiting.insert(look.buffer(), crowd.figures.clone());
    }
}

/// Whether figures wait for their buffer.
pub(super) fn is_due(uploads: Res<CrowdUploads>) -> bool {
    !uploads.waiting.is_empty()
}

pub(super) fn send(
    buffers: Res<RenderAssets<GpuShaderBuffer>>,
    queue: Res<RenderQueue>,
    mut uploads: ResMut<CrowdUploads>,
) {
    let CrowdUploads { waiting, bytes } = &mut *uploads;
    waiting.retain(|id, figures| {
        let data: &[u8] = bytemuck::cast_slice(figures);
        match buffers.get(*id) {
            // One that is still to grow is waited for.
            Some(gpu) if gpu.buffer.size() >= data.len() as u64 => {
                queue.write_buffer(&gpu.buffer, 0, data);
                *bytes += data.len() as u64;
                false
            }
            _ => true,
        }
    });
}
