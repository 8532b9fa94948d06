//! Buffers of one producer in one view.

use bevy::math::DMat4;
use bevy::prelude::*;
use bevy::render::render_resource::{BindGroup, Buffer, BufferDescriptor, BufferUsages};
use bevy::render::renderer::{RenderDevice, RenderQueue};

use super::ranges::ShadowRanges;
use super::readback::Counters;
use super::record::Pools;
use super::shared::GeometryShared;
use super::space::ViewFrame;
use super::traits::{DrawTraits, GeometryPool};
use crate::layout::{DRAW_SLOT, GeometryHead, HEAD_WORDS, PREVIOUS_BYTES};

/// Slots that a view's uniform of draws begins with: its own and those of a sun of four cascades.
const FIRST_SLOTS: u64 = 5;

/// A shadow view that a view's primitives are drawn into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShadowSlot {
    /// Bevy's view of the light.
    pub light: Entity,
    /// Place in the uniform of draws, bytes.
    pub offset: u32,
}

impl ShadowSlot {
    /// Number of the shadow view among those of its view.
    #[must_use]
    pub const fn number(&self) -> u32 {
        self.offset / DRAW_SLOT as u32 - 1
    }
}

/// One producer in one view.
pub struct GeometryView {
    /// Room of the pools.
    pub pool: GeometryPool,
    /// Vertices, [`DrawTraits::vertex_bytes`] each.
    pub vertices: Buffer,
    /// Indices, three a triangle or two a segment.
    pub indices: Buffer,
    /// Where vertices were in the last frame, if they move inside.
    pub previous: Option<Buffer>,
    /// Begins with a [`GeometryHead`]; behind it the producer may keep what its passes leave each other, so
    /// that they bind one buffer. See [`Self::fit_work`].
    pub work: Buffer,
    /// The view in this frame.
    pub frame: ViewFrame,
    /// Whether what the pools hold is that of this frame's inputs. Producers clear it when inputs change, and
    /// set it when they have recorded their passes.
    pub settled: bool,
    /// Whether the pools hold something that can be drawn. Set by producers.
    pub filled: bool,
    /// How many patches or blocks the producer looked at.
    pub looked_at: u32,
    /// Bytes that the producer keeps for this view in buffers of its own.
    pub own_bytes: u64,
    /// What the GPU counted.
    pub counters: Counters<GeometryHead>,
    /// Whether triangles are filled, whether their edges are drawn.
    pub shown: [bool; 2],
    /// Shadow views to draw into.
    pub shadows: Vec<ShadowSlot>,
    /// What of the producer's primitives they see, if it has bounds.
    pub ranges: Option<ShadowRanges>,
    /// Group 0 of the draws. Made by the producer, unless its layout is empty.
    pub inputs: Option<BindGroup>,
    pub(super) draw: Buffer,
    pub(super) groups: Option<DrawGroups>,
    pub(super) previous_clip: Option<DMat4>,
}

/// Bind groups of one producer's draws in one view.
pub struct DrawGroups {
    pub draw: BindGroup,
    /// Of draws that fetch their vertices; made when there is one.
    pub fetch: Option<BindGroup>,
}

impl GeometryView {
    pub(super) fn new(
        device: &RenderDevice,
        frame: ViewFrame,
        pool: GeometryPool,
        traits: &DrawTraits,
    ) -> Self {
        let storage = BufferUsages::STORAGE;
        let vertices = u64::from(pool.vertices);
        Self {
            pool,
            vertices: buffer(
                device,
                "geometry_vertices",
                vertices * traits.vertex_bytes(),
                storage | BufferUsages::VERTEX,
            ),
            indices: buffer(
                device,
                "geometry_indices",
                u64::from(pool.primitives) * 12,
                storage | BufferUsages::INDEX,
            ),
            previous: traits.moves.then(|| {
                buffer(
                    device,
                    "geometry_previous",
                    vertices * PREVIOUS_BYTES,
                    storage | BufferUsages::VERTEX,
                )
            }),
            work: work_buffer(device, HEAD_WORDS * 4),
            frame,
            settled: false,
            filled: false,
            looked_at: 0,
            own_bytes: 0,
            counters: Counters::default(),
            shown: [true, false],
            shadows: Vec::new(),
            ranges: traits.bounded.then(|| ShadowRanges::new(device)),
            inputs: None,
            draw: draw_buffer(device, FIRST_SLOTS),
            groups: None,
            previous_clip: None,
        }
    }

    /// Makes the work buffer at least so many bytes large. Where it was smaller it is replaced by one with a
    /// quarter to spare, so that what comes and goes seldom needs a new one; what was in it is gone, nothing
    /// is drawn until it is filled again, and its bind groups are out of date.
    pub fn fit_work(&mut self, device: &RenderDevice, bytes: u64) {
        if self.work.size() >= bytes {
            return;
        }
        let spare = if self.filled { bytes / 4 } else { 0 };
        self.work = work_buffer(device, bytes + spare);
        self.filled = false;
        self.settled = false;
    }

    /// Fills the pools with what the CPU made: vertices and indices as bytes, no more than there is room for.
    pub fn upload(
        &mut self,
        queue: &RenderQueue,
        shared: &GeometryShared,
        [vertices, indices]: [&[u8]; 2],
        head: GeometryHead,
    ) {
        queue.write_buffer(&self.vertices, 0, vertices);
        queue.write_buffer(&self.indices, 0, indices);
        queue.write_buffer(&self.work, 0, bytemuck::bytes_of(&head));
        shared.count_upload((vertices.len() + indices.len()) as u64);
        self.counters.set(head);
        self.settled = true;
        self.filled = true;
        if let Some(ranges) = &mut self.ranges {
            ranges.due = true;
        }
    }

    /// Makes room for so many slots of the uniform of draws.
    pub(super) fn fit_slots(&mut self, device: &RenderDevice, slots: u64) {
        if self.draw.size() < slots * DRAW_SLOT {
            self.draw = draw_buffer(device, slots.next_power_of_two());
            self.groups = None;
        }
    }

    /// Whether there is anything to draw.
    #[must_use]
    pub const fn is_shown(&self) -> bool {
        self.filled && (self.shown[0] || self.shown[1])
    }

    /// What draws read.
    #[must_use]
    pub fn pools(&self) -> Pools<'_> {
        Pools {
            vertices: &self.vertices,
            previous: self.previous.as_deref(),
            indices: &self.indices,
            work: &self.work,
        }
    }

    /// Bytes of all buffers of this view, the producer's own included.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let pools = self.vertices.size() + self.indices.size() + self.work.size();
        let previous = self.previous.as_ref().map_or(0, |buffer| buffer.size());
        let ranges = self.ranges.as_ref().map_or(0, ShadowRanges::bytes);
        pools + previous + ranges + self.draw.size() + self.counters.bytes() + self.own_bytes
    }
}

fn buffer(device: &RenderDevice, label: &str, size: u64, usage: BufferUsages) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some(label),
        size,
        usage: usage | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn work_buffer(device: &RenderDevice, size: u64) -> Buffer {
    buffer(
        device,
        "geometry_work",
        size.next_multiple_of(4),
        BufferUsages::STORAGE | BufferUsages::INDIRECT,
    )
}

fn draw_buffer(device: &RenderDevice, slots: u64) -> Buffer {
    buffer(
        device,
        "geometry_draw",
        DRAW_SLOT * slots,
        BufferUsages::UNIFORM,
    )
}
