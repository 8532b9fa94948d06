//! Which blocks a view draws, how coarse it has to be, and what it wants made.
//!
//! A block **exists** in a view if one of its mixed corners is there; a root always does. Whatever is there
//! needs others that are there, so the parent of a block that exists does too: the tree is followed down from
//! the roots.
//!
//! **Coarsening.** All ratios are divided by c ≥ 1. Where a centre has a ratio of 1 or more and the block on
//! its quadrant has not been made, c is at least that ratio: then the mixed corners of that block, which need
//! such a centre, are not there, as if it had been made. So the mesh never depends on what has been made but by
//! c, and the error is within c times the tolerance. Pools raise c as well.

use bevy::platform::collections::HashMap;

use super::kept::{KeptBlocks, Wish};
use super::leaves::{Presence, count};
use super::place::{BlockPlace, CELLS, CORNER_COUNT, CornerKind, VERTICES, corner_kind, vertex_at};
use super::ratio::{most_of, ratios};
use super::record::{NEST, NO_BLOCK, WINDOW};
use crate::detail::DetailView;

/// A block is made ahead from this ratio of a centre on.
pub const AHEAD: f32 = 0.9;
/// Steps in which pools raise the tolerance, in an octave.
const OCTAVE: f32 = 8.0;

/// What a view may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Most vertices, those of each block by themselves.
    pub vertices: u32,
    /// Most blocks that are made before the next choice.
    pub made: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            vertices: 1 << 22,
            made: usize::MAX,
        }
    }
}

/// A block that a view looked at.
#[derive(Clone, Debug)]
pub struct ViewBlock {
    /// Its slot.
    pub slot: u32,
    /// Where it is.
    pub place: BlockPlace,
    /// Ratios of its vertices, before any coarsening.
    pub ratios: Vec<f32>,
    /// The largest of its mixed corners.
    pub mixed: f32,
    /// The largest of the centres of each quadrant.
    pub quadrants: [f32; 4],
}

/// What a view draws.
#[derive(Clone, Debug, Default)]
pub struct Choice {
    /// The blocks that were looked at, parents first.
    pub blocks: Vec<ViewBlock>,
    /// Where a slot is among them.
    pub numbers: HashMap<u32, usize>,
    /// By how much the tolerance was raised, for what is not made and for the pools.
    pub coarsening: f32,
    /// The bound that is held everywhere, in tolerances: the coarsening, or what the finest cells leave.
    pub held: f32,
    /// What is wanted, the most urgent first.
    pub wishes: Vec<Wish>,
}

impl Choice {
    /// Whether a block exists.
    #[must_use]
    pub fn exists(&self, block: &ViewBlock, blocks: &KeptBlocks) -> bool {
        block.mixed > WINDOW * self.coarsening || block.place.is_root(&blocks.lattice)
    }

    /// The block of a slot, if it was looked at and exists.
    #[must_use]
    pub fn find(&self, slot: u32, blocks: &KeptBlocks) -> Option<&ViewBlock> {
        let block = &self.blocks[*self.numbers.get(&slot)?];
        self.exists(block, blocks).then_some(block)
    }

    /// Which quadrants of a block are drawn by its children.
    #[must_use]
    pub fn children(&self, block: &ViewBlock, blocks: &KeptBlocks) -> [bool; 4] {
        let head = &blocks.block(block.slot).head;
        head.children
            .map(|child| child != NO_BLOCK && self.find(child, blocks).is_some())
    }
}

/// The quadrant of a vertex that stands so many half cells from the corner.
const fn quadrant(x: i32, y: i32) -> usize {
    match (x >= CELLS, y >= CELLS) {
        (false, false) => 0,
        (true, false) => 1,
        (true, true) => 2,
        (false, true) => 3,
    }
}

fn look(blocks: &KeptBlocks, view: &DetailView, slot: u32) -> Option<ViewBlock> {
    let (block, place) = (blocks.block(slot), blocks.place(slot));
    let lattice = &blocks.lattice;
    let root = place.is_root(lattice);
    // A hundredth more: the bound is of another box.
    if !root && most_of(view, lattice, block, place) <= WINDOW * 0.99 {
        return None;
    }
    let ratios = ratios(view, lattice, block, place);
    let mut looked = ViewBlock {
        slot,
        place,
        mixed: 0.0,
        quadrants: [0.0; 4],
        ratios,
    };
    for number in 0..VERTICES {
        let at = vertex_at(number);
        let ratio = looked.ratios[number];
        if number >= CORNER_COUNT {
            let largest = &mut looked.quadrants[quadrant(at.x, at.y)];
            *largest = largest.max(ratio);
        } else if corner_kind(at / 2) == CornerKind::Mixed {
            looked.mixed = looked.mixed.max(ratio);
        }
    }
    Some(looked)
}

/// Chooses what a view draws, and makes up to `limits.made` blocks for the next one.
pub fn choose(blocks: &mut KeptBlocks, view: &DetailView, limits: Limits) -> Choice {
    blocks.stamp = blocks.stamp.wrapping_add(1);
    let mut choice = Choice {
        coarsening: 1.0,
        ..Choice::default()
    };
    let mut open: Vec<u32> = blocks.roots().to_vec();
    let mut rest = 0.0_f32;
    while let Some(slot) = open.pop() {
        let Some(looked) = look(blocks, view, slot) else {
            continue;
        };
        blocks.looked_at(slot);
        if !choice.exists(&looked, blocks) {
            continue;
        }
        let children = blocks.block(slot).head.children;
        for (quarter, child) in children.into_iter().enumerate() {
            let ratio = looked.quadrants[quarter];
            if child != NO_BLOCK {
                open.push(child);
            } else if looked.place.child(quarter).is_none() {
                rest = rest.max(ratio);
            } else {
                choice.coarsening = choice.coarsening.max(ratio);
                if ratio >= AHEAD {
                    choice.wishes.push(Wish {
                        parent: slot,
                        quarter,
                        ratio,
                    });
                }
            }
        }
        choice.numbers.insert(slot, choice.blocks.len());
        choice.blocks.push(looked);
    }
    fit(&mut choice, blocks, limits.vertices);
    // What is finer than the finest cells would have needed at most so much.
    choice.held = choice.coarsening.max(NEST * rest);
    choice.wishes.sort_by(|a, b| {
        let places = [a, b].map(|wish| (wish.parent, wish.quarter));
        b.ratio.total_cmp(&a.ratio).then(places[0].cmp(&places[1]))
    });
    let now = choice.wishes.len().min(limits.made);
    blocks.make(&choice.wishes[..now]);
    choice
}

/// Chooses again until nothing more is made: what a still view comes to.
pub fn settle(blocks: &mut KeptBlocks, view: &DetailView, limits: Limits) -> Choice {
    loop {
        let choice = choose(blocks, view, limits);
        let made = choice.wishes.iter().any(|wish| {
            let parent = blocks.block(wish.parent);
            parent.head.children[wish.quarter] != NO_BLOCK
        });
        if !made {
            return choice;
        }
    }
}

/// Raises the coarsening until the vertices fit.
fn fit(choice: &mut Choice, blocks: &KeptBlocks, most: u32) {
    let first = choice.coarsening;
    let mut step = 0;
    loop {
        let vertices: usize = choice
            .blocks
            .iter()
            .filter(|block| choice.exists(block, blocks))
            .map(|block| {
                let presence = Presence::new(&block.ratios, choice.coarsening);
                count(&presence, block.place, choice.children(block, blocks))
            })
            .sum();
        // Roots cannot be left out.
        if vertices <= most as usize || step > 40 * OCTAVE as u32 {
            return;
        }
        step += 1;
        choice.coarsening = first * bevy::math::ops::exp2(step as f32 / OCTAVE);
    }
}
