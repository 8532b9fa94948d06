//! The blocks of a ground, which all views of it with the same smallest cell share.
//!
//! What a view makes of them (error ratios, lists, vertices) is its own; see [`super::state`]. Views choose one after
//! the other, in the order of their cameras, so that none meets a block half made.

use bevy::render::render_resource::{Buffer, BufferDescriptor, BufferUsages};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bytemuck::cast_slice;
use dolomite_terrain::Terrain;

use crate::blocks::changed::{EditReach, edit_rounds, edited_lines, join_edited};
use crate::blocks::kept::{KeptBlocks, lattice_of};
use crate::blocks::layout::{
    Beginning, HEAD_BYTES, LEAST_SLOTS, RECORD_WORDS, SAMPLE_BYTES, STOCK_HEAD_BYTES,
};
use crate::detail::layout::EditedRect;
use crate::detail::{DetailGround, TerrainLod};
use crate::render::room::Room;

/// Vertices of a view for which there is room for a block: at the defaults 95 MiB a terrain.
const VERTICES_A_BLOCK: u32 = 38;

/// Bytes of a block's record.
const RECORD_BYTES: u64 = 4 * RECORD_WORDS as u64;

/// One ground's blocks.
pub(in crate::render) struct BlockStore {
    /// The ground and the lattice of its blocks.
    pub ground: DetailGround,
    /// What the CPU has made of it, where it chooses.
    pub kept: Option<KeptBlocks>,
    /// Where it was edited since the newest choice.
    pub edited: Vec<EditedRect>,
    finest: f32,
    /// What buffers begin with.
    pub beginning: Beginning,
    /// Blocks that there is room for, and the first slot, which is none.
    pub slots: u32,
    /// Whether nothing has been made yet.
    pub fresh: bool,
    /// Number of the newest choice of all its views. Numbers are those of the kind: what comes back late of a store that
    /// is gone is older than all of the next one.
    pub stamp: u32,
    /// What was made.
    pub records: Buffer,
    /// Where blocks stand, and how they hang together.
    pub heads: Buffer,
    /// What is in use.
    pub stock: Buffer,
    /// Heights about what is being made.
    pub samples: Buffer,
    room: Room,
}

/// How many slots a view with this detail takes.
pub(super) fn slots_for(device: &RenderDevice, detail: &TerrainLod) -> u32 {
    let limits = device.limits();
    let most = limits
        .max_storage_buffer_binding_size
        .min(limits.max_buffer_size)
        / RECORD_BYTES;
    let most = u32::try_from(most).unwrap_or(u32::MAX).max(LEAST_SLOTS);
    (detail.max_vertices / VERTICES_A_BLOCK).clamp(LEAST_SLOTS, most)
}

/// A terrain on the lattice of its blocks.
fn ground_of(terrain: &Terrain, finest: f32) -> DetailGround {
    DetailGround::on(terrain.clone(), lattice_of(terrain, finest))
}

impl BlockStore {
    /// Buffers for so many slots; nothing is made. `stamp` is the number of the newest choice of the kind.
    pub fn new(
        device: &RenderDevice,
        queue: &RenderQueue,
        terrain: &Terrain,
        (finest, slots): (f32, u32),
        stamp: u32,
    ) -> Self {
        let ground = ground_of(terrain, finest);
        let beginning = Beginning::new(&ground.lattice);
        let empty = |label, size: u64| {
            device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let room = u64::from(slots);
        let heads = empty("blocks_heads", HEAD_BYTES * room);
        let stock = empty("blocks_stock", STOCK_HEAD_BYTES + 4 * room);
        queue.write_buffer(&heads, 0, cast_slice(&beginning.heads));
        queue.write_buffer(&stock, 0, cast_slice(&beginning.stock()));
        Self {
            records: empty("blocks_records", RECORD_BYTES * room),
            heads,
            stock,
            samples: empty("blocks_samples", SAMPLE_BYTES),
            ground,
            kept: None,
            edited: Vec::new(),
            finest,
            beginning,
            slots,
            fresh: true,
            stamp,
            room: Room::default(),
        }
    }

    /// Takes other edits of the same ground over: before the next choice blocks are made anew that they reach. Whether they
    /// reach any, so that views have to choose anew; `None` where it is other ground, so that a store of its own is needed.
    pub fn follow_edits(&mut self, terrain: &Terrain) -> Option<bool> {
        let known = self.ground.terrain();
        if known.same(terrain) {
            return Some(false);
        }
        if !known.same_base(terrain) {
            return None;
        }
        // What has arrived of a map that is read by tiles makes no block another.
        let now = known.with_edits(terrain.edits().cloned());
        let lattice = &self.ground.lattice;
        let reach = EditReach::between(known, terrain, lattice);
        let mut edited = edited_lines(lattice, reach, &now.changed_since(known)?);
        self.ground = ground_of(terrain, self.finest);
        self.kept = None;
        let is_reached = !edited.is_empty();
        // What has not been made yet is made of the ground as it is then.
        if !self.fresh {
            self.edited.append(&mut edited);
            join_edited(&mut self.edited);
        }
        Some(is_reached)
    }

    /// In how many rounds blocks are made anew before the next choice, `most` of them, if any are.
    pub fn edit_rounds(&self, most: u32) -> Option<u32> {
        let most = self.slots.min(most);
        (!self.edited.is_empty()).then(|| edit_rounds(&self.ground.lattice, most))
    }

    /// Bytes of its buffers.
    pub fn bytes(&self) -> u64 {
        [&self.records, &self.heads, &self.stock, &self.samples]
            .iter()
            .map(|buffer| buffer.size())
            .sum()
    }

    /// Before a choice: whether blocks are to be dropped, of `used` ones of which all views look at `needed`, and
    /// which: see [`Room::sweep`].
    pub fn sweep(&mut self, used: u32, needed: u32, views: u32) -> Option<u32> {
        let Self {
            room, slots, stamp, ..
        } = self;
        room.sweep(*slots, *stamp, used, needed, views)
    }

    /// Whether there is nothing left to drop.
    pub const fn is_swept(&self) -> bool {
        self.room.is_swept()
    }
}
