//! What follows for a block's quarters where its record has become another.
//!
//! A quarter takes two things of its parent's record. It **copies** what is older than itself: all numbers of the vertices on
//! its square. And it **cuts** by the errors of centres and the intervals of cells, of those on its square and of a ring of one
//! about it. What it copies is part of no other of its numbers: where that alone has become another the quarter is [`refreshed`],
//! for which nothing of the ground is asked. What it cuts by counts for its own vertices, and of these only what was cut is kept:
//! there it is made anew. What is neither copied nor cut by leaves it as it is, and all below it.

use bevy::math::IVec2;

use super::make::from_parent;
use super::place::{BlockPlace, CELLS, CORNER_COUNT, VERTICES, vertex_at};
use super::record::{Block, RINGED, RINGED_COUNT, ring_number, ringed_number};

/// From this bit on stand those that cut.
const CUTS: u32 = 4;

/// Quarters of a block that take something of its record which has become another: bits 0 to 3 those that copy it, bits 4 to 7
/// those that cut by it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Others(pub u32);

/// The quarters in these rows and columns, a bit each: `[north, south]` and `[west, east]`.
fn quarters(rows: [bool; 2], columns: [bool; 2]) -> u32 {
    let [north, south] = rows;
    let [west, east] = columns;
    [north && west, north && east, south && east, south && west]
        .into_iter()
        .rev()
        .fold(0, |bits, is_there| bits << 1 | u32::from(is_there))
}

/// Who copies the vertex of a number.
#[must_use]
pub fn copiers(number: usize) -> Others {
    // In half cells the middle of the block is as many from its corner as it has cells along a side.
    let halves = |at: i32| [at <= CELLS, at >= CELLS];
    let at = vertex_at(number);
    Others(quarters(halves(at.y), halves(at.x)))
}

/// Who cuts by the cell (i, j), −1 to [`CELLS`] each: those within one cell of it.
#[must_use]
pub fn cutters(cell: IVec2) -> Others {
    let halves = |at: i32| [at <= CELLS / 2, at >= CELLS / 2 - 1];
    Others(quarters(halves(cell.y), halves(cell.x)) << CUTS)
}

impl Others {
    /// For whom something has become another from a record to the next, to the bit.
    #[must_use]
    pub fn between(before: &Block, after: &Block) -> Self {
        let mut all = 0;
        let differs = |a: f32, b: f32| a.to_bits() != b.to_bits();
        for k in 0..VERTICES {
            let error = differs(before.errors[k], after.errors[k]);
            let is_other = error
                || differs(before.heights[k], after.heights[k])
                || before.gradients[k] != after.gradients[k]
                || differs(before.lows[k], after.lows[k])
                || differs(before.highs[k], after.highs[k]);
            if is_other {
                all |= copiers(k).0;
            }
            if error && k >= CORNER_COUNT {
                all |= cutters(vertex_at(k) / 2).0;
            }
        }
        for k in 0..RINGED_COUNT {
            let cell = IVec2::new((k % RINGED) as i32, (k / RINGED) as i32) - 1;
            debug_assert_eq!(ringed_number(cell), k);
            let error = ring_number(cell)
                .is_some_and(|k| differs(before.ring_errors[k], after.ring_errors[k]));
            let is_other = error
                || differs(before.cell_lows[k], after.cell_lows[k])
                || differs(before.cell_highs[k], after.cell_highs[k]);
            if is_other {
                all |= cutters(cell).0;
            }
        }
        Self(all)
    }

    /// Whether a quarter copies any of it.
    #[must_use]
    pub const fn are_copied(self, quarter: usize) -> bool {
        self.0 >> quarter & 1 == 1
    }

    /// Whether a quarter cuts by any of it.
    #[must_use]
    pub const fn are_cut_by(self, quarter: usize) -> bool {
        self.0 >> CUTS >> quarter & 1 == 1
    }
}

/// A block with what it copies from its parent, as that is by now: the reference of `refresh.wgsl`.
#[must_use]
pub fn refreshed(block: &Block, place: BlockPlace, parent: &Block) -> Box<Block> {
    let mut block = Box::new(block.clone());
    from_parent(&mut block, place, parent);
    block
}
