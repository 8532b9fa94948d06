//! Vertices and triangles of a view.
//!
//! A vertex on its way lies by its share between the middle of the ends of the edge that it cuts, and the
//! ground; its gradient alike. All that it needs has arrived then, the ends too; so a triangle has one corner
//! on its way at most, and what is drawn is a mean of the mesh without that vertex and the one with it: its
//! error is at most the coarsening times the tolerance.

use bevy::math::{UVec2, Vec2};

use super::choose::{Choice, ViewBlock};
use super::kept::KeptBlocks;
use super::leaves::{Presence, leaves};
use super::place::{VERTICES, vertex_at};
use super::record::unpack_gradient;

/// A vertex of the drawn ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockVertex {
    /// Where it stands on the lattice.
    pub at: UVec2,
    /// Height of the drawn surface, metres.
    pub height: f32,
    /// Height of the bed, metres: less where there is water.
    pub bed: f32,
    /// Gradient of the bed.
    pub gradient: Vec2,
    /// Share of its way to the ground.
    pub share: f32,
}

/// What a block draws.
#[derive(Clone, Debug, Default)]
pub struct BlockMesh {
    /// The vertices that are used, by their numbers in the block.
    pub vertices: Vec<BlockVertex>,
    /// Counter-clockwise from above.
    pub triangles: Vec<[u32; 3]>,
}

/// A vertex where it is drawn.
#[must_use]
pub fn placed(
    blocks: &KeptBlocks,
    block: &ViewBlock,
    presence: &Presence,
    number: usize,
) -> BlockVertex {
    let record = blocks.block(block.slot);
    let sea = blocks.sea();
    let ground = |number: usize| {
        let bed = record.heights[number];
        (bed.max(sea), bed, unpack_gradient(record.gradients[number]))
    };
    let (mut height, mut bed, mut gradient) = ground(number);
    let share = presence.share(number);
    if share < 1.0
        && let Some(ends) = block.place.ends(number)
    {
        let [a, b] = ends.map(ground);
        // From the ends: where it is not on its way, nothing is added to what it is.
        let mix = |own: f32, a: f32, b: f32| {
            let middle = 0.5 * (a + b);
            middle + share * (own - middle)
        };
        height = mix(height, a.0, b.0);
        bed = mix(bed, a.1, b.1);
        gradient = Vec2::new(mix(gradient.x, a.2.x, b.2.x), mix(gradient.y, a.2.y, b.2.y));
    }
    BlockVertex {
        at: block.place.lattice_point(vertex_at(number)),
        height,
        bed,
        gradient,
        share,
    }
}

/// The mesh of one block.
#[must_use]
pub fn block_mesh(blocks: &KeptBlocks, choice: &Choice, block: &ViewBlock) -> BlockMesh {
    let presence = Presence::new(&block.ratios, choice.coarsening);
    let mut triangles = Vec::new();
    let children = choice.children(block, blocks);
    leaves(&presence, block.place, children, |corners| {
        triangles.push(corners);
    });
    let mut numbers = [u32::MAX; VERTICES];
    for corner in triangles.iter().flatten() {
        numbers[*corner] = 0;
    }
    let mut out = BlockMesh::default();
    for (number, at) in numbers.iter_mut().enumerate() {
        if *at == 0 {
            *at = out.vertices.len() as u32;
            out.vertices.push(placed(blocks, block, &presence, number));
        }
    }
    let numbered = triangles.iter().map(|corners| corners.map(|k| numbers[k]));
    out.triangles = numbered.collect();
    out
}

/// The mesh of a view: all blocks, each with vertices of its own.
#[must_use]
pub fn mesh(blocks: &KeptBlocks, choice: &Choice) -> BlockMesh {
    let mut all = BlockMesh::default();
    for block in &choice.blocks {
        if !choice.exists(block, blocks) {
            continue;
        }
        let first = all.vertices.len() as u32;
        let own = block_mesh(blocks, choice, block);
        all.vertices.extend(own.vertices);
        let moved = own
            .triangles
            .iter()
            .map(|corners| corners.map(|k| k + first));
        all.triangles.extend(moved);
    }
    all
}
