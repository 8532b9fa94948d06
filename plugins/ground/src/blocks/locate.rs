//! Height queries: the drawn triangle under a place.
//!
//! A place is followed from its root to the block that draws it, and there from square to square to its leaf
//! triangle.
//!
//! **Bound.** The vertex that would cut the triangle next knows how far the triangle is from the ground where
//! all corners stand on it. A corner on its way lies off the ground; between the corners the surface is off by
//! the mean of that, weighted as the place lies. Heights themselves are rounded.

use bevy::math::DVec2;
use dolomite_terrain::GroundPoint;

use super::choose::{Choice, ViewBlock};
use super::kept::KeptBlocks;
use super::leaves::{Presence, Square};
use super::mesh::{BlockVertex, placed};
use super::place::{BlockPlace, CELLS, vertex_at};
use super::record::{ALWAYS, NEST};

/// Error of an f32 height as a share of the largest, twice what the accuracy tests of the terrain see.
const ROUNDING: f64 = 6e-7;

/// What is drawn at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Located {
    /// The triangle.
    pub corners: [BlockVertex; 3],
    /// How much each corner counts at the place.
    pub weights: [f64; 3],
    /// Height of the drawn surface, metres.
    pub height: f64,
    /// How far it is from the true surface at most, metres.
    pub bound: f64,
    /// How far the triangle is from it at most where all corners stand on the ground, metres; infinite where that is not
    /// known.
    pub error: f32,
}

/// Where a place is in a block, in half cells from its north-western corner.
fn place_in(blocks: &KeptBlocks, block: BlockPlace, place: GroundPoint) -> DVec2 {
    let first = block.cell().corner(0).as_dvec2();
    (blocks.lattice.coordinates(place) - first) / f64::from(block.cell_half())
}

/// The quarter of a square in which a place lies.
fn quarter_at(square: Square, at: DVec2) -> usize {
    match (
        at.x >= f64::from(square.centre.x),
        at.y >= f64::from(square.centre.y),
    ) {
        (false, false) => 0,
        (true, false) => 1,
        (true, true) => 2,
        (false, true) => 3,
    }
}

/// The leaf triangle of a block at a place, as numbers of its vertices, with its error where they stand on the
/// ground; or the quadrant that a child draws.
fn leaf(
    errors: &[f32],
    presence: &Presence,
    block: BlockPlace,
    children: [bool; 4],
    at: DVec2,
) -> Result<([usize; 3], f32), usize> {
    let mut square = Square::whole(block);
    loop {
        let centre = square.centre_number();
        let off = at - square.centre.as_dvec2();
        if !presence.there(centre) {
            let outer = square.quarter;
            let towards = |k: usize| vertex_at(square.corner(k)) - square.centre;
            let beyond = |of: DVec2| of.perp_dot(towards(outer).as_dvec2());
            let same = beyond(off) * beyond(towards(outer + 1).as_dvec2()) >= 0.0;
            let corner = |k: usize| square.corner(outer + k);
            // The right-angled corner first, as the pass has it.
            let corners = if same {
                [corner(1), corner(0), corner(2)]
            } else {
                [corner(3), corner(2), corner(0)]
            };
            return Ok((corners, errors[centre]));
        }
        let quarter = quarter_at(square, at);
        if square.half == CELLS && children[quarter] {
            return Err(quarter);
        }
        if square.has_child(presence, quarter)
            && let Some(child) = square.child(quarter)
        {
            square = child;
            continue;
        }
        // A quarter lies at the end of the side of its number and at the beginning of the next.
        let ends = (off.x.abs() > off.y.abs()) == quarter.is_multiple_of(2);
        let side = if ends { quarter } else { (quarter + 1) & 3 };
        let Some(middle) = square.middle(side) else {
            // The middle is the child's, and errs by less than what it needs.
            let corners = [centre, square.corner(side), square.corner(side + 3)];
            return Ok((corners, NEST * errors[centre]));
        };
        if !presence.there(middle) {
            let corners = [centre, square.corner(side), square.corner(side + 3)];
            return Ok((corners, errors[middle]));
        }
        let corner = square.corner(quarter);
        let corners = if ends {
            [centre, corner, middle]
        } else {
            [centre, middle, corner]
        };
        let cut = square
            .child(quarter)
            .map_or(centre, |child| child.centre_number());
        return Ok((corners, errors[cut]));
    }
}

/// What a view draws at a place; `None` outside of the lattice.
#[must_use]
pub fn locate(blocks: &KeptBlocks, choice: &Choice, place: GroundPoint) -> Option<Located> {
    let size = f64::from(2 * CELLS);
    let mut block: &ViewBlock = blocks
        .roots()
        .iter()
        .filter_map(|&slot| choice.find(slot, blocks))
        .find(|root| {
            let at = place_in(blocks, root.place, place);
            at.cmpge(DVec2::ZERO).all() && at.cmple(DVec2::splat(size)).all()
        })?;
    loop {
        let record = blocks.block(block.slot);
        let presence = Presence::new(&block.ratios, choice.coarsening);
        let children = choice.children(block, blocks);
        let at = place_in(blocks, block.place, place);
        match leaf(&record.errors, &presence, block.place, children, at) {
            Err(quarter) => block = choice.find(record.head.children[quarter], blocks)?,
            Ok((numbers, error)) => {
                return Some(answer(blocks, block, &presence, numbers, error, at));
            }
        }
    }
}

fn answer(
    blocks: &KeptBlocks,
    block: &ViewBlock,
    presence: &Presence,
    numbers: [usize; 3],
    error: f32,
    at: DVec2,
) -> Located {
    let [a, b, c] = numbers.map(|k| vertex_at(k).as_dvec2());
    let area = (b - a).perp_dot(c - a);
    let u = (b - at).perp_dot(c - at) / area;
    let v = (c - at).perp_dot(a - at) / area;
    let weights = [u, v, 1.0 - u - v];
    let corners = numbers.map(|k| placed(blocks, block, presence, k));
    let record = blocks.block(block.slot);
    let sea = blocks.sea();
    let error = if error == ALWAYS {
        f32::INFINITY
    } else {
        error
    };
    let (mut height, mut bound, mut largest) = (0.0, f64::from(error), 0.0_f64);
    for ((weight, corner), number) in weights.into_iter().zip(corners).zip(numbers) {
        let drawn = f64::from(corner.height);
        let ground = f64::from(record.heights[number].max(sea));
        height += weight * drawn;
        bound += weight.max(0.0) * (drawn - ground).abs();
        largest = largest.max(drawn.abs());
    }
    Located {
        corners,
        weights,
        height,
        bound: bound + ROUNDING * largest,
        error,
    }
}
