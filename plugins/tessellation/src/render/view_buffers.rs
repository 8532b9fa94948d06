//! Buffers of one kind in one view, and whether they are up to date.

use bevy::math::{DMat4, DVec3};
use bevy::prelude::*;
use bevy::render::render_resource::{BindGroup, Buffer, BufferDescriptor, BufferUsages};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bytemuck::Zeroable;

use super::kind::PatchPool;
use super::prepare::KindTraits;
use super::ranges::ShadowRanges;
use super::readback::Counters;
use crate::layout::{DRAW_SLOT, StageParams, StageView, WorkHead};
use crate::patches::BINDING_LIMIT;

/// Shadow views that a view draws into at most.
pub const SHADOW_SLOTS: u64 = 16;

/// One kind in one view.
pub struct ViewKind {
    pub params: StageParams,
    /// What the positions in the pool are relative to.
    pub(super) anchor: DVec3,
    pub(super) version: u64,
    /// False when this frame has to dispatch.
    pub settled: bool,
    /// Whether the buffers hold a finished tessellation.
    pub filled: bool,
    pub uniform: Buffer,
    pub work: Buffer,
    pub vertices: Buffer,
    pub indices: Buffer,
    pub previous: Option<Buffer>,
    pub draw: Buffer,
    pub counters: Counters<WorkHead>,
    pub groups: Option<ViewGroups>,
    /// Whether triangles are filled, whether their edges are drawn.
    pub shown: [bool; 2],
    /// Of the kind's buffers that the bind groups hold.
    pub(super) generation: u64,
    pub(super) previous_clip: Option<DMat4>,
    /// From the stage to clip space, without the jitter of temporal anti-aliasing.
    pub steady_clip: Mat4,
    /// Shadow views to draw into, and the slot of each.
    pub shadows: Vec<(Entity, u32)>,
    /// What of the kind they see, if it has bounds.
    pub ranges: Option<ShadowRanges>,
    pub cleared: u64,
    /// Workgroups: of 64 patches, of a block of items, of 256 halves of sides.
    pub groups_of: [u32; 3],
}

/// Bind groups of one kind in one view.
pub struct ViewGroups {
    pub work: BindGroup,
    pub emit: BindGroup,
    pub given: BindGroup,
    pub draw: BindGroup,
    /// Of draws that fetch their vertices; made when there is one.
    pub fetch: Option<BindGroup>,
}

/// The pool, but not more than can be filled or bound, and room for one of each at least.
pub(super) fn pool_sizes(pool: PatchPool, greatest: [u64; 2], vertex_bytes: u64) -> [u32; 2] {
    let size = |wanted: u32, greatest: u64, bytes: u64| {
        u64::from(wanted)
            .min(greatest)
            .min(BINDING_LIMIT / bytes)
            .max(1) as u32
    };
    [
        size(pool.vertices, greatest[0], vertex_bytes),
        size(pool.primitives, greatest[1], 12),
    ]
}

impl ViewKind {
    /// What the stage's passes are told.
    pub const fn params(&self) -> &StageParams {
        &self.params
    }

    /// Patches of all entities.
    pub const fn patches(&self) -> u32 {
        self.params.patches
    }

    pub(super) fn new(device: &RenderDevice, params: &StageParams, traits: &KindTraits) -> Self {
        let buffer = |label, size: u64, usage| {
            device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size,
                usage: usage | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let storage = BufferUsages::STORAGE;
        let vertices = u64::from(params.max_vertices);
        Self {
            params: StageParams {
                max_vertices: params.max_vertices,
                max_primitives: params.max_primitives,
                ..Zeroable::zeroed()
            },
            anchor: DVec3::ZERO,
            version: 0,
            settled: false,
            filled: false,
            uniform: buffer(
                "stage_params",
                size_of::<StageParams>() as u64,
                BufferUsages::UNIFORM,
            ),
            work: work_buffer(device, params.work_bytes()),
            vertices: buffer(
                "stage_vertices",
                vertices * traits.vertex_bytes(),
                storage | BufferUsages::VERTEX,
            ),
            indices: buffer(
                "stage_indices",
                u64::from(params.max_primitives) * 12,
                storage | BufferUsages::INDEX,
            ),
            previous: traits.moves.then(|| {
                buffer(
                    "stage_previous",
                    vertices * 12,
                    storage | BufferUsages::VERTEX,
                )
            }),
            draw: buffer(
                "stage_draw",
                DRAW_SLOT * (SHADOW_SLOTS + 1),
                BufferUsages::UNIFORM,
            ),
            counters: Counters::new(device),
            groups: None,
            shown: [true, false],
            generation: 0,
            previous_clip: None,
            steady_clip: Mat4::IDENTITY,
            shadows: Vec::new(),
            ranges: traits.bounded.then(|| ShadowRanges::new(device)),
            cleared: 0,
            groups_of: [0; 3],
        }
    }

    /// Makes the working memory large enough for the kind's patches, and drops bind groups of
    /// buffers that were replaced.
    pub(super) fn fit(
        &mut self,
        device: &RenderDevice,
        params: &StageParams,
        traits: &KindTraits,
        generation: u64,
    ) {
        if self.work.size() < params.work_bytes() {
            // A quarter to spare, so that patches which come and go seldom need a new one.
            self.work = work_buffer(device, params.work_bytes() / 4 * 5);
            self.filled = false;
            self.unbind();
        }
        if self.generation != generation {
            self.generation = generation;
            self.unbind();
        }
        self.cleared = params.cleared_bytes();
        self.groups_of = [
            params.patches.div_ceil(64),
            params.items().div_ceil(crate::layout::BLOCK),
            params.strip_threads(traits.layout.domain).div_ceil(256),
        ];
    }

    /// Drops the bind groups.
    fn unbind(&mut self) {
        self.groups = None;
        if let Some(ranges) = &mut self.ranges {
            ranges.group = None;
        }
    }

    /// Takes over this frame's inputs; unsettles the view if any of them changed. Where the draws
    /// evaluate, the time is theirs alone; of a view that nothing depends on, the anchor counts.
    pub(super) fn update(
        &mut self,
        queue: &RenderQueue,
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
            self.settled = false;
            self.version = version;
        }
        if self.params != *params {
            self.params = *params;
            queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(params));
        }
    }
}

fn work_buffer(device: &RenderDevice, size: u64) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some("stage_work"),
        size: size.next_multiple_of(4),
        usage: BufferUsages::STORAGE
            | BufferUsages::INDIRECT
            | BufferUsages::COPY_SRC
            | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
