//! The cells of a ground, which all views of it with the same smallest cell share: heights and error bounds, and how
//! they hang together.
//!
//! What a view makes of them (error ratios, lists, vertices) is its own; see [`super::prepare`]. Views choose one after
//! the other, in the order of their cameras, so that none meets a cell half made.
//!
//! **Room.** Every choice marks the cells that it looks at with its number. Where little room is left, a pass drops
//! blocks of cells that nobody has looked at for long, the oldest first: how long is halved from sweep to sweep until
//! there is room. What a view at rest stands on is kept, since height queries go through it.

use bevy::render::render_resource::{Buffer, BufferDescriptor, BufferInitDescriptor, BufferUsages};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bytemuck::cast_slice;
use dolomite_terrain::Terrain;

use crate::detail::layout::{
    Beginning, EditedRect, LEAST_CAPACITY, MOST_EDITED, SHARED_CELL_BYTES, STOCK_HEAD_BYTES,
};
use crate::detail::{Cell, DetailCells, TerrainLod};
use crate::render::room::Room;

/// Most cells that are kept: 452 MiB, and 408 MiB a view.
const MOST_CELLS: u64 = 1 << 22;

/// One ground's cells.
pub(super) struct CellStore {
    /// The roots; cells that were made on the CPU, where it chooses.
    pub ground: DetailCells,
    /// What lists and links begin with.
    pub beginning: Beginning,
    /// Cells that there is room for.
    pub capacity: u32,
    /// Whether the roots are to be made: nothing has been made yet, or the ground was edited.
    pub fresh: bool,
    /// Where the ground was edited, and since which choice; the newest ones last.
    pub edited: Vec<EditedRect>,
    /// Number of the newest choice of all views.
    pub stamp: u32,
    /// Heights of the roots' corners.
    pub corners: Buffer,
    /// What was made.
    pub cells: Buffer,
    /// How it hangs together.
    pub links: Buffer,
    /// What is in use.
    pub stock: Buffer,
    room: Room,
}

/// How many cells a view with this detail takes.
pub(super) fn capacity_for(device: &RenderDevice, detail: &TerrainLod) -> u32 {
    // A view looks at some two cells a vertex; as many again for other views, and for what the last ones left.
    let most = device.limits().max_storage_buffer_binding_size / size_of::<Cell>() as u64;
    let most = most.clamp(u64::from(LEAST_CAPACITY), MOST_CELLS) as u32;
    let wanted = detail.max_vertices.saturating_mul(4);
    wanted.clamp(LEAST_CAPACITY, most) / 4 * 4
}

impl CellStore {
    /// Buffers for so many cells, none of which is made.
    pub fn new(
        device: &RenderDevice,
        queue: &RenderQueue,
        terrain: &Terrain,
        finest: f32,
        capacity: u32,
    ) -> Self {
        let ground = DetailCells::new(terrain.clone(), finest);
        let beginning = Beginning::new(&ground);
        let empty = |label, size: u64| {
            device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let room = u64::from(capacity);
        let links = empty("detail_links", 16 * room);
        let stock = empty("detail_stock", STOCK_HEAD_BYTES + room);
        queue.write_buffer(&links, 0, cast_slice(&beginning.links));
        queue.write_buffer(&stock, 0, cast_slice(&beginning.stock()));
        Self {
            corners: device.create_buffer_with_data(&BufferInitDescriptor {
                label: Some("detail_corners"),
                contents: cast_slice(&beginning.corners),
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
            }),
            cells: empty("detail_cells", (SHARED_CELL_BYTES - 16) * room),
            links,
            stock,
            ground,
            beginning,
            capacity,
            fresh: true,
            edited: Vec::new(),
            stamp: 0,
            room: Room::default(),
        }
    }

    /// Takes other edits of the same ground over: cells on what changed are made anew when a choice looks at them next.
    /// Whether anything changed; `None` where it is other ground.
    pub fn follow_edits(&mut self, queue: &RenderQueue, terrain: &Terrain) -> Option<bool> {
        let lines = self.ground.follow_edits(terrain)?;
        if lines.is_empty() {
            return Some(false);
        }
        let stamp = self.stamp;
        for [low, high] in lines {
            self.edited.push(EditedRect {
                low: low.to_array(),
                high: high.to_array(),
                stamp,
                ..EditedRect::default()
            });
        }
        join_oldest(&mut self.edited);
        self.beginning.corners = Beginning::new(&self.ground).corners;
        queue.write_buffer(&self.corners, 0, cast_slice(&self.beginning.corners));
        self.fresh = true;
        Some(true)
    }

    /// Number of a new choice.
    pub fn next_stamp(&mut self) -> u32 {
        self.stamp = self.stamp.wrapping_add(1).max(1);
        self.stamp
    }

    /// Bytes of its buffers.
    pub fn bytes(&self) -> u64 {
        [&self.corners, &self.cells, &self.links, &self.stock]
            .iter()
            .map(|buffer| buffer.size())
            .sum()
    }

    /// Before a choice: whether cells are to be dropped, of `used` ones, and which; see [`Room::sweep`].
    pub fn sweep(&mut self, used: u32, vertices: u32, views: u32) -> Option<u32> {
        let Self {
            room,
            capacity,
            stamp,
            ..
        } = self;
        // Some two cells are looked at for a vertex.
        let needed = vertices.saturating_mul(2);
        room.sweep(*capacity, *stamp, used, needed, views)
    }
}

/// Joins rectangles until no more are left than are told: those first that waste the least ground. What is joined counts as
/// edited when the younger of both was, so that nothing is missed; cells that are looked at in every frame are older than
/// the newest edits alone, and these are joined last.
fn join_oldest(edited: &mut Vec<EditedRect>) {
    let area = |rect: &EditedRect| {
        let side = |k: usize| f64::from(rect.high[k] - rect.low[k]);
        side(0) * side(1)
    };
    let both = |a: &EditedRect, b: &EditedRect| EditedRect {
        low: [0, 1].map(|k| a.low[k].min(b.low[k])),
        high: [0, 1].map(|k| a.high[k].max(b.high[k])),
        stamp: a.stamp.max(b.stamp),
        ..EditedRect::default()
    };
    while edited.len() > MOST_EDITED {
        let newest = edited.last().map_or(0, |rect| rect.stamp);
        let older = edited.iter().take_while(|rect| rect.stamp < newest).count();
        // Of one edit alone there may be more than are told.
        let count = if older > 1 { older } else { edited.len() };
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        let waste = |(a, b): &(usize, usize)| {
            let (a, b) = (&edited[*a], &edited[*b]);
            area(&both(a, b)) - area(a) - area(b)
        };
        let Some((a, b)) = pairs.min_by(|x, y| waste(x).total_cmp(&waste(y))) else {
            return;
        };
        let joined = both(&edited[a], &edited[b]);
        edited.remove(b);
        edited[a] = joined;
        // The newest stay last.
        edited.sort_by_key(|rect| rect.stamp);
    }
}
