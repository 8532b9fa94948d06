//! Edits of the ground on their way into the buffer that its height function reads: what differs from what it holds, and
//! nothing else.

use std::sync::Arc;

use bevy::prelude::*;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_resource::BufferId;
use bevy::render::renderer::RenderQueue;
use bevy::render::storage::{GpuShaderBuffer, ShaderBuffer};
use bevy::render::{Extract, ExtractSchedule, Render, RenderApp, RenderSystems};
use dolomite_terrain::{EditTable, Edits};

use super::kind::GroundKind;

/// What a ground's buffer is to hold.
struct Wanted {
    data: AssetId<ShaderBuffer>,
    laid_out: Arc<(usize, EditTable)>,
    edits: Edits,
}

/// The table of edits of a slot, in the render world.
#[derive(Resource)]
pub(super) struct EditUpload<const SLOT: usize> {
    wanted: Option<Wanted>,
    /// Which buffer holds what.
    held: Option<(BufferId, EditTable)>,
    /// Words that were written since the app began.
    words: u64,
}

impl<const SLOT: usize> Default for EditUpload<SLOT> {
    fn default() -> Self {
        Self {
            wanted: None,
            held: None,
            words: 0,
        }
    }
}

/// Adds the systems of a slot.
pub(super) fn build<const SLOT: usize>(app: &mut App) {
    if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
        render_app
            .init_resource::<EditUpload<SLOT>>()
            .add_systems(ExtractSchedule, extract::<SLOT>)
            .add_systems(
                Render,
                write::<SLOT>
                    .in_set(RenderSystems::PrepareResources)
                    .run_if(|upload: Res<EditUpload<SLOT>>| upload.wanted.is_some()),
            );
    }
}

fn extract<const SLOT: usize>(
    mut upload: ResMut<EditUpload<SLOT>>,
    kind: Extract<Res<GroundKind<SLOT>>>,
) {
    if !kind.is_changed() {
        return;
    }
    let edits = kind.terrain.as_ref().and_then(|terrain| terrain.edits());
    upload.wanted = kind
        .edits
        .as_ref()
        .zip(edits)
        .map(|(laid_out, edits)| Wanted {
            data: kind.data.id(),
            laid_out: laid_out.clone(),
            edits: edits.clone(),
        });
    if kind.edits.is_none() {
        upload.held = None;
    }
}

fn write<const SLOT: usize>(
    mut upload: ResMut<EditUpload<SLOT>>,
    buffers: Res<RenderAssets<GpuShaderBuffer>>,
    queue: Res<RenderQueue>,
) {
    let EditUpload {
        wanted,
        held,
        words,
    } = &mut *upload;
    let Some(Wanted {
        data,
        laid_out,
        edits,
    }) = wanted
    else {
        return;
    };
    // Not there yet: in a later frame.
    let Some(found) = buffers.get(*data) else {
        return;
    };
    let buffer = &found.buffer;
    let (at, table) = &**laid_out;
    if held.as_ref().is_none_or(|(id, _)| *id != buffer.id()) {
        *held = Some((buffer.id(), table.clone()));
    }
    if let Some((_, table)) = held {
        for write in table.update(edits).unwrap_or_default() {
            *words += write.words.len() as u64;
            let offset = 4 * (at + write.at) as u64;
            queue.write_buffer(buffer, offset, bytemuck::cast_slice(&write.words));
        }
    }
    *wanted = None;
}

/// Words of edits that were written into the buffers of the first ground since the app began; for tests.
#[doc(hidden)]
#[must_use]
pub fn words_of_edits(world: &World) -> u64 {
    world
        .get_resource::<EditUpload<0>>()
        .map_or(0, |upload| upload.words)
}
