//! Blocks of ground that changed within rectangles, made anew in their slots.
//!
//! Parents come first. A block is made anew where its own samples are reached, or where what it cuts by has become another; it is
//! refreshed where only what it copies has; and where neither has it is as it was, and so is all that is finer below it, whose
//! samples lie within its own. So the work is that of what the change reaches, and a fraction of it more: coarse vertices near the
//! change are copied into every finer block that has them.

use dolomite_terrain::{GroundRect, Terrain};

use super::changed::{EditReach, is_reached};
use super::kept::{KeptBlocks, lattice_of};
use super::make::make;
use super::others::{Others, refreshed};

/// What a change came to, blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Remade {
    /// Made anew from their samples.
    pub made: usize,
    /// Given anew what they copy from their parents.
    pub refreshed: usize,
}

impl KeptBlocks {
    /// The ground is `terrain` from now on, which differs within these rectangles alone: blocks that are others are made anew or
    /// refreshed in their slots, parents first. Afterwards blocks are those of a ground that never was another. Where the terrain
    /// has another lattice all begins anew.
    pub fn change(&mut self, terrain: Terrain, finest: f32, changed: &[GroundRect]) -> Remade {
        if lattice_of(&terrain, finest) != self.lattice {
            let keep = self.keep;
            *self = Self::new(terrain, finest);
            self.keep = keep;
            return Remade {
                made: self.len(),
                refreshed: 0,
            };
        }
        let edits = EditReach::between(self.terrain(), &terrain, &self.lattice);
        self.set_terrain(terrain);
        let mut remade = Remade::default();
        // Blocks, and whether they copy or cut by what has become another of their parents.
        let mut open: Vec<(u32, [bool; 2])> = self
            .roots()
            .iter()
            .map(|&root| (root, [false; 2]))
            .collect();
        while let Some((slot, [copies, cuts])) = open.pop() {
            let place = self.place(slot);
            let old = self.block(slot);
            let parent = (!place.is_root(&self.lattice)).then(|| self.block(old.head.parent));
            let block = if cuts || is_reached(&self.lattice, place, edits, changed) {
                remade.made += 1;
                let (mut block, _) = make(self.terrain(), &self.lattice, place, parent);
                block.head.parent = old.head.parent;
                block.head.children = old.head.children;
                block.head.looked = old.head.looked;
                block
            } else if let (true, Some(parent)) = (copies, parent) {
                remade.refreshed += 1;
                refreshed(old, place, parent)
            } else {
                continue;
            };
            let others = Others::between(old, &block);
            let children = block.head.children.into_iter().enumerate();
            let follow = |quarter| [others.are_copied(quarter), others.are_cut_by(quarter)];
            open.extend(
                children
                    .filter(|&(_, child)| child != 0)
                    .map(|(quarter, child)| (child, follow(quarter))),
            );
            self.replace(slot, block);
        }
        remade
    }
}
