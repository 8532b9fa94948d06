//! What is kept of a block: numbers that depend on the ground alone, never on a view.
//!
//! All lengths are metres in f32; nothing is stored in fewer bits. Errors and intervals must be nested from a
//! vertex to those that need it, exactly, and a rounding to 16 bits would undo that unless it were repeated at
//! each step; four more bytes a vertex are the lesser price.
//!
//! **Order of computing**, for shaders that do the same. What two blocks both have must have the same bits in
//! both. So every number is a function of places on the lattice alone; nothing is taken relative to the block.
//!
//! 1. *Samples*: bed heights at 89 × 89 lattice points, a quarter of a cell apart, from corner (−3, −3) to corner
//!    (19, 19). Two surfaces of it: the drawn one, max(bed, sea), and the bed as far as it is seen,
//!    clamp(bed, sea − [`OPAQUE_DEPTH`](crate::range::OPAQUE_DEPTH), sea), whose errors count by half.
//! 2. *Tail* of each of the 22 × 22 cells: what may lie between its samples; and by how much the bed may lie beyond
//!    them (`between.rs`).
//! 3. *Own errors* of triangles: largest |sample − plane| over the samples inside and on the sides, as `triangle.rs`
//!    writes it: differences to the right-angled corner first, then weights that are multiples of ⅛.
//! 4. *Nested errors* of vertices that stand on samples, from the finest up: E = max(own + tail, [`GROWTH`] ·
//!    largest E of those that need the vertex); own of the two triangles that it cuts, tail the largest of the
//!    cells that it touches. Those that need the middle of a side of two steps stand on no sample: there E is
//!    that tail, or a quarter of the largest twist of four neighbouring samples in those cells. Triangles that
//!    are not on the lattice have no error, vertices beyond it E = 0.
//! 5. *Errors of vertices*: of mixed corners and centres, cut from above, e = min(E,
//!    [`NEST`] · least e of the parents). Mixed corners first, of the ring of one too, then centres, of the
//!    ring too. Parents that are not on the lattice do not count.
//! 6. *Intervals* of cells −2 to 17: lowest and highest sample of the bed in it, 5 × 5, less and plus the most by
//!    which the bed may lie beyond samples in it and the eight cells around; no lower than the sea; cut with the interval
//!    of the parent's cell. Cells that are not on the lattice are empty: [`EMPTY`].
//! 7. *Intervals* of vertices: union over the cells that the region of their descendants touches: 3 × 3 about a
//!    centre, 4 × 4 about a mixed corner.
//!
//! Vertices that are older than the block have all of their numbers from the parent's record. Roots have no
//! parents: their corners have e = [`ALWAYS`], and nothing is cut from above there.
//!
//! **Enough is known.** A child cuts the e of its mixed corners, ring included, with those of the parent's
//! cells beside them: the child's corners −1 to 17 lie in the parent's cells −1 to 8 or 7 to 16 along each
//! axis. It cuts intervals of its cells −2 to 17, which lie in the same. So a record keeps the e of centres,
//! and intervals of cells, of its own cells and of a ring of one around them: [`Block::centre_error`],
//! [`Block::cell_interval`].
//!
//! **Why a ring of three.** The child needs the e of the parent's centres in the ring of one as the parent's
//! neighbour has them, to the bit: else the vertices of a common side would differ. So the E of a centre in the
//! ring must see all that needs it, and so must that of its mixed corners, at −1 and 17: which reach two cells
//! farther (see below).
//!
//! **Regions.** A centre of a cell of side s is at most 1.5 s from what descends from it along each axis, a
//! mixed corner of cells of side s at most 2 s: the centre's children are the mixed corners half a side away,
//! of cells of s/2, which reach s farther; a mixed corner's are centres half a side away, which reach 1.5 s
//! farther. Each region contains its descendants' regions cell by cell, so the intervals are nested as well.

use bevy::math::{IVec2, UVec2, Vec2};

use super::place::{BlockPlace, CELLS, VERTICES, centre_number};

/// Between this share of the tolerance and all of it a vertex is on its way to the ground. Nearer 1 errors are
/// nested more closely, so that fewer vertices are there for the sake of others, and each moves faster. At 0.8
/// the classic map took 1.03 times as many triangles as at 0.82; flying at 200 m/s the ground moves by 0.20 pixels a
/// frame at most.
pub const WINDOW: f32 = 0.82;
/// A vertex errs at most by this share of those that it needs: [`WINDOW`], less what f32 rounds a view's
/// numbers by (1/800).
pub const NEST: f32 = 0.819;
/// How much errors grow a bisection, from the samples up: 1 / [`NEST`] and one part in 2000, so that the cut
/// from above does nothing where all is known from below.
pub const GROWTH: f32 = 1.221_61;
/// The error of what is always there. Not the greatest f32: the shortest decimal of that one is above it, and some
/// implementations of WGSL refuse it as a literal.
pub const ALWAYS: f32 = 3e38;
/// The interval of what is not there: lowest above highest.
pub const EMPTY: [f32; 2] = [3e38, -3e38];
/// Slot of a block that has not been made. The first slot is never used.
pub const NO_BLOCK: u32 = 0;

/// Cells along a side with a ring of one around.
pub const RINGED: usize = CELLS as usize + 2;
/// Cells with a ring of one around.
pub const RINGED_COUNT: usize = RINGED * RINGED;
/// Cells of the ring of one.
pub const RING: usize = RINGED_COUNT - (CELLS * CELLS) as usize;

/// Number of cell (i, j) among those with a ring of one, −1 to [`CELLS`] each.
#[must_use]
pub const fn ringed_number(at: IVec2) -> usize {
    (at.y + 1) as usize * RINGED + (at.x + 1) as usize
}

/// Number of cell (i, j) in the ring of one: the northern row, the southern row, then west and east of each row
/// between; `None` inside.
#[must_use]
pub const fn ring_number(at: IVec2) -> Option<usize> {
    if at.y == -1 {
        Some((at.x + 1) as usize)
    } else if at.y == CELLS {
        Some(RINGED + (at.x + 1) as usize)
    } else if at.x == -1 {
        Some(2 * RINGED + 2 * at.y as usize)
    } else if at.x == CELLS {
        Some(2 * RINGED + 2 * at.y as usize + 1)
    } else {
        None
    }
}

/// What a block is found and left out by. 48 bytes on the GPU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockHead {
    /// Centre of its square, lattice coordinates.
    pub centre: UVec2,
    /// Half its side, lattice steps.
    pub half: u32,
    /// Slot of the parent; [`NO_BLOCK`] for roots.
    pub parent: u32,
    /// Slots of the quarters that have been made, else [`NO_BLOCK`].
    pub children: [u32; 4],
    /// Number of the last choice that looked at it.
    pub looked: u32,
    /// Largest error of its mixed corners, metres.
    pub mixed_error: f32,
    /// Lowest of its vertices' intervals, metres: with [`Self::high`] and [`Self::REACH`] a box that holds every
    /// vertex's box.
    pub low: f32,
    /// Highest of them.
    pub high: f32,
}

impl BlockHead {
    /// How far boxes of its own vertices reach beyond its square, cells: a mixed corner of the border reaches 2.
    pub const REACH: i32 = 2;

    /// The place.
    #[must_use]
    pub fn place(&self) -> Option<BlockPlace> {
        BlockPlace::of_centre(self.centre)
    }
}

/// A block. 13 812 bytes on the GPU, head included.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// What it is found by.
    pub head: BlockHead,
    /// Height of the bed at each vertex, metres.
    pub heights: [f32; VERTICES],
    /// Gradient of the bed at each vertex, packed by [`pack_gradient`].
    pub gradients: [u32; VERTICES],
    /// Error of each vertex, metres: by how much the surface drawn without it, or without any that needs it,
    /// misses the ground at most. [`ALWAYS`] where it is always there.
    pub errors: [f32; VERTICES],
    /// Interval of the drawn surface over the region of a vertex: lowest, metres.
    pub lows: [f32; VERTICES],
    /// See `lows`: highest.
    pub highs: [f32; VERTICES],
    /// Errors of the centres in the ring of one, by [`ring_number`].
    pub ring_errors: [f32; RING],
    /// Intervals of the cells with a ring of one, by [`ringed_number`]: lowest.
    pub cell_lows: [f32; RINGED_COUNT],
    /// See `cell_lows`: highest.
    pub cell_highs: [f32; RINGED_COUNT],
}

impl Block {
    /// Error of the centre of cell (i, j), −1 to [`CELLS`] each.
    #[must_use]
    pub const fn centre_error(&self, at: IVec2) -> f32 {
        match ring_number(at) {
            Some(number) => self.ring_errors[number],
            None => self.errors[centre_number(at)],
        }
    }

    /// Lowest and highest of the drawn surface in cell (i, j), −1 to [`CELLS`] each.
    #[must_use]
    pub const fn cell_interval(&self, at: IVec2) -> [f32; 2] {
        let number = ringed_number(at);
        [self.cell_lows[number], self.cell_highs[number]]
    }
}

/// A gradient in 32 bits: the upward normal (−x, 1, −z) divided by the sum of its absolute values (octahedral;
/// Q. Meyer and others 2010), its x and z as signed 16-bit shares of 1, rounded to the nearest; x in the low
/// half. The slope is off by 2⁻¹⁶ · (1 + slope)² at most.
#[must_use]
pub fn pack_gradient(gradient: Vec2) -> u32 {
    let share = -gradient / (1.0 + gradient.x.abs() + gradient.y.abs());
    let bits = |x: f32| u32::from((x.clamp(-1.0, 1.0) * 32_767.0).round() as i16 as u16);
    bits(share.x) | bits(share.y) << 16
}

/// What [`pack_gradient`] packed. The steepest that can be told is 32 767.
#[must_use]
pub fn unpack_gradient(bits: u32) -> Vec2 {
    let part = |bits: u32| f32::from(bits as u16 as i16) / 32_767.0;
    let share = Vec2::new(part(bits), part(bits >> 16));
    let up = (1.0 - share.x.abs() - share.y.abs()).max(1.0 / 32_767.0);
    -share / up
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ring_numbers_are_all_different() {
        let mut seen = [0; RING];
        for k in 0..RINGED_COUNT as i32 {
            let at = IVec2::new(k % RINGED as i32 - 1, k / RINGED as i32 - 1);
            assert_eq!(ringed_number(at), k as usize);
            if let Some(number) = ring_number(at) {
                seen[number] += 1;
            } else {
                assert!(at.min_element() >= 0 && at.max_element() < CELLS);
            }
        }
        assert_eq!(seen, [1; RING]);
    }

    #[test]
    fn errors_grow_as_fast_as_they_are_nested() {
        let slack = GROWTH * NEST;
        assert!(slack > 1.0004 && slack < 1.001, "{slack}");
        const { assert!(NEST < WINDOW * 0.9988) };
    }

    #[test]
    fn gradients_keep_their_slope() {
        for k in 0..10_000_u32 {
            let hash = |salt: u32| {
                let mut h = k.wrapping_mul(0x9e37_79b9) ^ salt.wrapping_mul(0x85eb_ca6b);
                h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
                (h >> 8) as f32 / (1 << 23) as f32 - 1.0
            };
            let slope = 20.0 * hash(1) * hash(1) * hash(1);
            let gradient = Vec2::new(slope, 4.0 * hash(2) * hash(2));
            let off = (unpack_gradient(pack_gradient(gradient)) - gradient).abs();
            let sum = 1.0 + gradient.x.abs() + gradient.y.abs();
            assert!(off.max_element() < sum / 32_768.0 * sum, "{gradient} {off}");
        }
        let steep = unpack_gradient(pack_gradient(Vec2::new(1e9, 0.0)));
        assert!(steep.x > 3e4 && steep.x.is_finite(), "{steep}");
        assert_eq!(unpack_gradient(pack_gradient(Vec2::ZERO)), Vec2::ZERO);
    }
}
