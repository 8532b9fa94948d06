//! What control functions are told of a view, and the stage's own buffers there.

use std::collections::HashMap;

use bevy::prelude::*;
use bevy::render::render_resource::{BindGroup, Buffer, BufferDescriptor, BufferId, BufferUsages};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bytemuck::{Zeroable, bytes_of};
use dolomite_geometry::render::{GeometryView, ViewFrame};

use crate::Domain;
use crate::layout::{BLOCK, StageParams, StageView};

/// The view as control functions see it.
pub fn stage_view(frame: &ViewFrame, animated: bool) -> StageView {
    let [time, previous_time] = if animated { frame.time } else { [0.0; 2] };
    StageView {
        planes: frame.planes,
        sweep: frame.sweep.extend(0.0).to_array(),
        eye: frame.eye.to_array(),
        pixels_per_radian: frame.pixels_per_radian,
        anchor: frame.anchor.as_vec3().to_array(),
        pixels_per_edge: frame.pixels_per_edge,
        time,
        previous_time,
        orthographic: f32::from(u8::from(frame.orthographic)),
        camera: frame.number,
    }
}

/// One kind in one view: what of it is the stage's own.
pub struct StageViewState {
    pub params: StageParams,
    pub version: u64,
    pub uniform: Buffer,
    pub groups: Option<StageGroups>,
    /// The buffers that the groups hold.
    pub bound: Vec<BufferId>,
}

/// States by view.
pub type StageViews = HashMap<Entity, StageViewState>;

/// Bind groups of the passes.
pub struct StageGroups {
    pub work: BindGroup,
    pub emit: BindGroup,
    pub ranges: Option<BindGroup>,
}

impl StageViewState {
    pub fn new(device: &RenderDevice) -> Self {
        Self {
            params: StageParams::zeroed(),
            version: 0,
            uniform: device.create_buffer(&BufferDescriptor {
                label: Some("stage_params"),
                size: size_of::<StageParams>() as u64,
                usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            groups: None,
            bound: Vec::new(),
        }
    }

    /// Takes over this frame's inputs; unsettles the view if any of them changed. Where the draws
    /// evaluate, the time is theirs alone; of a view that nothing depends on, the anchor counts.
    pub fn update(
        &mut self,
        queue: &RenderQueue,
        state: &mut GeometryView,
        params: &StageParams,
        version: u64,
        [evaluated, still]: [bool; 2],
    ) {
        let what_counts = |params: &StageParams| {
            let mut params = *params;
            if evaluated {
                [params.view.time, params.view.previous_time] = [0.0; 2];
            }
            if still {
                params.view = StageView {
                    anchor: params.view.anchor,
                    camera: params.view.camera,
                    ..Zeroable::zeroed()
                };
            }
            params
        };
        if what_counts(&self.params) != what_counts(params) || self.version != version {
            state.settled = false;
            self.version = version;
        }
        if self.params != *params {
            self.params = *params;
            queue.write_buffer(&self.uniform, 0, bytes_of(params));
        }
    }
}

/// Workgroups of the passes: of 64 patches, of a block of items, of 256 halves of sides.
pub const fn workgroups(params: &StageParams, domain: Domain) -> [u32; 3] {
    [
        params.patches.div_ceil(64),
        params.items().div_ceil(BLOCK),
        params.strip_threads(domain).div_ceil(256),
    ]
}
