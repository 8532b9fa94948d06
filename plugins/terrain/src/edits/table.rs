//! Edits as the GPU reads them: a table of the tree's nodes by place, and the samples of tiles.
//!
//! `shaders/src/terrain/edits.wgsl` looks nodes up by hashing their level and place, with linear probing. An entry has
//! [`ENTRY_WORDS`]: x, z, level + 1 (0: free), number of the tile's samples, then as f32 bits lowest and highest
//! height and the bends along x, z and mixed, all metres, and three spare. Tiles follow the table, row by row.

use super::layer::Edits;
use super::tile::{SAMPLES, STEP, metres};
use super::tree::{self, Node};

/// Words of an entry.
pub(crate) const ENTRY_WORDS: usize = 12;
/// A node that is no tile.
const NO_TILE: u32 = u32::MAX;

/// How much a table has room for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EditRoom {
    /// Entries, as a power of two; half of them at most are used.
    pub entries_log2: u32,
    /// Tiles.
    pub tiles: u32,
}

impl EditRoom {
    /// Room for a layer, and for as much again.
    #[must_use]
    pub fn of(edits: &Edits) -> Self {
        let [tiles, nodes] = edits.counts();
        let levels = edits.lattice().level() + 1;
        let tiles = (2 * tiles).max(256).next_power_of_two();
        let nodes = (2 * nodes).max(tiles + tiles / 2 + 16 * levels);
        Self {
            entries_log2: (2 * nodes).next_power_of_two().trailing_zeros(),
            tiles,
        }
    }

    /// Whether a layer fits.
    #[must_use]
    pub fn holds(&self, edits: &Edits) -> bool {
        let [tiles, nodes] = edits.counts();
        tiles <= self.tiles && nodes <= self.most_nodes()
    }

    const fn most_nodes(&self) -> u32 {
        1 << (self.entries_log2 - 1)
    }

    /// Words of the table and the tiles behind it.
    #[must_use]
    pub const fn words(&self) -> usize {
        (ENTRY_WORDS << self.entries_log2) + self.tiles as usize * SAMPLES
    }

    /// Where the samples of the first tile begin, words.
    #[must_use]
    pub(crate) const fn tiles_at(&self) -> usize {
        ENTRY_WORDS << self.entries_log2
    }
}

/// Words to be written, from the first word of the table on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EditWrite {
    /// Of the first one.
    pub at: usize,
    /// What is written.
    pub words: Vec<u32>,
}

/// What a GPU's table holds: knows what to write when the layer has changed.
#[derive(Clone, Debug, PartialEq)]
pub struct EditTable {
    room: EditRoom,
    edits: Edits,
    /// Level + 1, x, z, tile of each entry; level 0 is free.
    keys: Vec<[u32; 4]>,
    used: u32,
    tiles: u32,
}

/// As in `edits.wgsl`.
fn hash([x, z]: [u32; 2], level: u32) -> u32 {
    let mut h =
        x.wrapping_mul(0x9e37_79b9) ^ z.wrapping_mul(0x85eb_ca6b) ^ level.wrapping_mul(0xc2b2_ae35);
    h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
    h ^ (h >> 13)
}

impl EditTable {
    /// An empty table for layers on the lattice of `edits`.
    #[must_use]
    pub fn new(room: EditRoom, edits: &Edits) -> Self {
        Self {
            room,
            edits: Edits::none(*edits.lattice()),
            keys: vec![[0; 4]; 1 << room.entries_log2],
            used: 0,
            tiles: 0,
        }
    }

    /// How much there is room for.
    #[must_use]
    pub const fn room(&self) -> EditRoom {
        self.room
    }

    /// The layer that it holds.
    #[must_use]
    pub const fn edits(&self) -> &Edits {
        &self.edits
    }

    /// Takes another layer over: what has to be written, in proportion to what it differs in; `None` where it does not fit.
    /// What is gone keeps its entry, with nothing in it, until its room is needed.
    pub fn update(&mut self, edits: &Edits) -> Option<Vec<EditWrite>> {
        if !self.room.holds(edits) || edits.lattice() != self.edits.lattice() {
            return None;
        }
        if let Some(writes) = self.write(edits) {
            return Some(writes);
        }
        // Full of what is gone: anew.
        let cleared = EditWrite {
            at: 0,
            words: vec![0; self.room.tiles_at()],
        };
        *self = Self::new(self.room, edits);
        let mut writes = vec![cleared];
        writes.extend(self.write(edits)?);
        Some(writes)
    }

    fn write(&mut self, edits: &Edits) -> Option<Vec<EditWrite>> {
        let mut writes = Vec::new();
        let mut full = false;
        let before = self.edits.clone();
        let level = edits.lattice().level();
        tree::differences(&before.root, &edits.root, level, [0; 2], &mut |node| {
            full |= full
                || self
                    .put(node.level, node.place, node.now, &mut writes)
                    .is_none();
        });
        self.edits = edits.clone();
        (!full).then_some(writes)
    }

    /// Writes a node's entry and samples; `None` where there is no room.
    fn put(
        &mut self,
        level: u32,
        place: [u32; 2],
        node: Option<&Node>,
        writes: &mut Vec<EditWrite>,
    ) -> Option<()> {
        let mask = self.keys.len() - 1;
        let mut at = hash(place, level) as usize & mask;
        let [x, z] = place;
        loop {
            let [key, kx, kz, _] = self.keys[at];
            if key == 0 {
                if self.used >= self.room.most_nodes() {
                    return None;
                }
                let tile = if level == 0 {
                    if self.tiles >= self.room.tiles {
                        return None;
                    }
                    self.tiles += 1;
                    self.tiles - 1
                } else {
                    NO_TILE
                };
                self.used += 1;
                self.keys[at] = [level + 1, x, z, tile];
                break;
            }
            if [key, kx, kz] == [level + 1, x, z] {
                break;
            }
            at = (at + 1) & mask;
        }
        let tile = self.keys[at][3];
        let extremes = node.map(Node::extremes).unwrap_or_default();
        let [xx, zz, xz] = extremes.bend;
        let numbers = [extremes.low, extremes.high, xx, zz, xz];
        let mut words = vec![x, z, level + 1, tile];
        words.extend(numbers.map(|steps| (steps as f32 * STEP as f32).to_bits()));
        words.resize(ENTRY_WORDS, 0);
        writes.push(EditWrite {
            at: at * ENTRY_WORDS,
            words,
        });
        if level == 0 {
            let words = node.and_then(Node::tile).map_or_else(
                || vec![0; SAMPLES],
                |tile| {
                    let steps = tile.steps().iter();
                    steps.map(|step| metres(*step).to_bits()).collect()
                },
            );
            writes.push(EditWrite {
                at: self.room.tiles_at() + tile as usize * SAMPLES,
                words,
            });
        }
        Some(())
    }
}
