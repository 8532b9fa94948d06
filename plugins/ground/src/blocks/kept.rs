//! The blocks of a terrain that were made so far.

use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::tasks::{ComputeTaskPool, TaskPool};
use dolomite_terrain::{GpuTerrainUniform, HeightMap, Source, Terrain};

use super::gate::Gate;
use super::make::{CutCount, make};
use super::place::{BlockPlace, LEAST_DEPTH};
use super::record::{Block, NO_BLOCK};
use crate::detail::DetailLattice;

/// [`KeptBlocks::keep`] if nothing else is said: 54 MiB.
pub const KEPT: usize = 1 << 12;

/// A block to be made: the quarter of one that has been.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wish {
    /// Slot of the parent.
    pub parent: u32,
    /// Which of its quarters.
    pub quarter: usize,
    /// The largest ratio of a centre in it.
    pub ratio: f32,
}

/// The lattice for blocks of a terrain, whose finest cells are at most `finest` metres wide, as far as lattices
/// go. Where the samples of the terrain's finest height map allow it, its lines stand on them: where some number of
/// columns from the map's down to two less, and of rows alike, is the same power of two times
/// [`MOST_ALIGNED`](crate::detail::aligned::MOST_ALIGNED) at most. Others, of 37 samples a side as of 3000, have an even
/// lattice whose lines stand anywhere between samples: as true, but with more triangles.
#[must_use]
pub fn lattice_of(terrain: &Terrain, finest: f32) -> DetailLattice {
    let extent = terrain.extent();
    // At least one block; a sample every quarter of a cell is half a half side.
    let most = extent.size().min_element() as f32 / (1 << LEAST_DEPTH) as f32;
    let finest = (0.5 * finest).min(most);
    let maps = terrain
        .data()
        .layers
        .iter()
        .filter_map(|layer| match &layer.source {
            Source::Map(map) => Some(map),
            _ => None,
        });
    maps.min_by(|a, b| {
        a.spacing()
            .min_element()
            .total_cmp(&b.spacing().min_element())
    })
    .and_then(|map| DetailLattice::aligned(extent, map.origin(), map.spacing(), finest))
    .filter(|lattice| lattice.depth >= LEAST_DEPTH)
    .unwrap_or_else(|| DetailLattice::new(extent, finest))
}

/// The blocks that were made so far, of one terrain on one lattice. The roots always are.
#[derive(Clone, Debug)]
pub struct KeptBlocks {
    /// Where blocks stand.
    pub lattice: DetailLattice,
    terrain: Terrain,
    /// Slot 0 is never used.
    slots: Vec<Option<Box<Block>>>,
    free: Vec<u32>,
    roots: Vec<u32>,
    /// Most blocks that are kept, beside the roots. Beyond, those that no view has looked at for the longest
    /// time are dropped, leaves first.
    pub keep: usize,
    /// Number of the current choice.
    pub stamp: u32,
    /// What the cut from above did so far.
    pub cuts: CutCount,
}

impl KeptBlocks {
    /// The roots of a terrain, on [`lattice_of`] it.
    #[must_use]
    pub fn new(terrain: Terrain, finest: f32) -> Self {
        let lattice = lattice_of(&terrain, finest);
        Self::on(terrain, lattice)
    }

    /// The same on a lattice of at least [`LEAST_DEPTH`] halvings.
    #[must_use]
    pub fn on(terrain: Terrain, lattice: DetailLattice) -> Self {
        let mut blocks = Self {
            lattice,
            terrain,
            slots: vec![None],
            free: Vec::new(),
            roots: Vec::new(),
            keep: KEPT,
            stamp: 0,
            cuts: CutCount {
                least: 1.0,
                ..default()
            },
        };
        for root in BlockPlace::roots(&lattice) {
            let block = blocks.made(root, None);
            let slot = blocks.put(block);
            blocks.roots.push(slot);
        }
        blocks
    }

    fn made(&mut self, place: BlockPlace, parent: Option<&Block>) -> Box<Block> {
        let (block, cuts) = self.make_only(place, parent);
        self.count(cuts);
        block
    }

    fn make_only(&self, place: BlockPlace, parent: Option<&Block>) -> (Box<Block>, CutCount) {
        make(&self.terrain, &self.lattice, place, parent)
    }

    fn count(&mut self, cuts: CutCount) {
        self.cuts.vertices += cuts.vertices;
        self.cuts.cut += cuts.cut;
        self.cuts.least = self.cuts.least.min(cuts.least);
    }

    /// The ground.
    #[must_use]
    pub const fn terrain(&self) -> &Terrain {
        &self.terrain
    }

    /// The ground is another one; the lattice stays.
    pub(super) fn set_terrain(&mut self, terrain: Terrain) {
        self.terrain = terrain;
    }

    /// Puts a block in place of that of a slot in use.
    pub(super) fn replace(&mut self, slot: u32, block: Box<Block>) {
        self.slots[slot as usize] = Some(block);
    }

    /// Height of the water, or far below everything.
    #[must_use]
    pub fn sea(&self) -> f32 {
        self.terrain
            .sea_level()
            .unwrap_or(GpuTerrainUniform::NO_SEA)
    }

    /// Slots of the roots.
    #[must_use]
    pub fn roots(&self) -> &[u32] {
        &self.roots
    }

    /// How many blocks there are, roots too.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.slots.len() - 1 - self.free.len()
    }

    /// Never: the roots are there.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The block of a slot in use.
    ///
    /// # Panics
    /// If the slot is not in use.
    #[must_use]
    pub fn block(&self, slot: u32) -> &Block {
        self.slots[slot as usize].as_deref().expect("a slot in use")
    }

    /// All slots in use.
    pub fn used(&self) -> impl Iterator<Item = u32> {
        (1..self.slots.len() as u32).filter(|&slot| self.slots[slot as usize].is_some())
    }

    /// Where the block of a slot stands.
    #[must_use]
    pub fn place(&self, slot: u32) -> BlockPlace {
        self.block(slot)
            .head
            .place()
            .expect("no block is smaller than the least")
    }

    /// Notes that the current choice looks at a block.
    pub fn looked_at(&mut self, slot: u32) {
        let stamp = self.stamp;
        if let Some(block) = self.slots[slot as usize].as_deref_mut() {
            block.head.looked = stamp;
        }
    }

    fn put(&mut self, block: Box<Block>) -> u32 {
        if let Some(slot) = self.free.pop() {
            self.slots[slot as usize] = Some(block);
            return slot;
        }
        self.slots.push(Some(block));
        self.slots.len() as u32 - 1
    }

    /// Makes what is wished for, in that order, as far as there is room. How many were made.
    pub fn make(&mut self, wishes: &[Wish]) -> usize {
        let room = self.make_room(wishes.len());
        let streamed = self.terrain.streamed().and_then(HeightMap::stream);
        let gate =
            streamed.and_then(|stream| Gate::new(&self.terrain, &self.lattice, &stream.readable()));
        let wishes: Vec<Wish> = wishes
            .iter()
            .copied()
            .filter(|wish| {
                let parent = self
                    .slots
                    .get(wish.parent as usize)
                    .and_then(Option::as_deref);
                parent.is_some_and(|parent| parent.head.children[wish.quarter & 3] == NO_BLOCK)
            })
            .filter(|wish| {
                let place = self.place(wish.parent).child(wish.quarter & 3);
                gate.as_ref()
                    .zip(place)
                    .is_none_or(|(gate, place)| gate.holds(place))
            })
            .take(room)
            .collect();
        let mut made: Vec<Option<(Box<Block>, CutCount)>> = vec![None; wishes.len()];
        let this = &*self;
        ComputeTaskPool::get_or_init(TaskPool::default).scope(|scope| {
            for (wish, out) in wishes.iter().zip(&mut made) {
                scope.spawn(async move {
                    let parent = this.block(wish.parent);
                    let place = this.place(wish.parent).child(wish.quarter & 3);
                    *out = place.map(|place| this.make_only(place, Some(parent)));
                });
            }
        });
        let mut count = 0;
        for (wish, made) in wishes.into_iter().zip(made) {
            let Some((mut block, cuts)) = made else {
                continue;
            };
            self.count(cuts);
            block.head.parent = wish.parent;
            block.head.looked = self.stamp;
            let slot = self.put(block);
            let parent = self.slots[wish.parent as usize].as_deref_mut();
            parent.expect("just read").head.children[wish.quarter & 3] = slot;
            count += 1;
        }
        count
    }

    /// Drops blocks until there is room for `count` more: leaves that this choice did not look at, the oldest
    /// first. How many fit.
    fn make_room(&mut self, count: usize) -> usize {
        let most = self.keep + self.roots.len();
        loop {
            let over = (self.len() + count).saturating_sub(most);
            if over == 0 {
                return count;
            }
            let is_old_leaf = |slot: &u32| {
                let head = &self.block(*slot).head;
                head.looked != self.stamp
                    && head.parent != NO_BLOCK
                    && head.children == [NO_BLOCK; 4]
            };
            let mut old: Vec<u32> = self.used().filter(is_old_leaf).collect();
            if old.is_empty() {
                return most.saturating_sub(self.len()).min(count);
            }
            old.sort_by_key(|&slot| (self.block(slot).head.looked, slot));
            for slot in old.into_iter().take(over) {
                self.drop_block(slot);
            }
        }
    }

    fn drop_block(&mut self, slot: u32) {
        let Some(block) = self.slots[slot as usize].take() else {
            return;
        };
        self.free.push(slot);
        if let Some(parent) = self.slots[block.head.parent as usize].as_deref_mut() {
            for child in &mut parent.head.children {
                if *child == slot {
                    *child = NO_BLOCK;
                }
            }
        }
    }

    /// Numbers by place, for whoever looks for a block; built anew at each call.
    #[must_use]
    pub fn by_place(&self) -> HashMap<UVec2, u32> {
        self.used()
            .map(|slot| (self.block(slot).head.centre, slot))
            .collect()
    }

    /// Changes all blocks: for tests of what a wrong number does.
    #[cfg(test)]
    pub(super) fn alter(&mut self, alter: impl Fn(&mut Block)) {
        for block in self.slots.iter_mut().flatten() {
            alter(block);
        }
    }
}
