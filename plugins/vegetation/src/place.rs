//! Where roots are: a function of the place alone, in integers, so that CPU and GPU agree to the bit.
//!
//! A [`Lattice`] divides the ground plane into square cells of a pitch that is a power of two, aligned with the
//! metres of 32.32 fixed-point places. Each cell holds one candidate: at a hashed place within the cell, with a
//! *rank*. A candidate stands where its rank is less than the density there, as a share of the lattice's own. Whoever
//! needs fewer, far away or in a small pool, takes a smaller share and keeps those of the lowest ranks.
//!
//! **Ranks are nested.** Random thinning leaves holes and heaps, and cover is lost by overlap. Here the share 1/4 is
//! one cell of each 2 × 2, 1/16 one of each 4 × 4, up the quadtree: the most significant base-4 digit of a rank orders
//! the four cells below the same parent, the next one orders the four parents below their parent, and so on for
//! [`LEVELS`] levels; the rest is a hash. The order of four children is hashed from their parent: any of them may be
//! first, the second is diagonal to it (the share 1/2 is then a quincunx), the others follow in either order.
//!
//! Cells are counted by `i32` and wrap: roots repeat each 2^(32 + `pitch_log2`) metres, 2²⁸ m at a pitch of 1/16 m.

use bytemuck::{Pod, Zeroable};
use dolomite_terrain::GroundPoint;
use dolomite_terrain::noise::hash::{pcg, point_hash, row_hash};

/// Bits of a rank: every rank and every threshold is exact as an f32.
pub const RANK_BITS: u32 = 24;

/// Levels of the quadtree that order ranks: each takes two bits.
pub const LEVELS: u32 = 8;

/// Added to the seed for the order of the cells at a level, so that levels are independent of each other.
const LEVEL_SALT: u32 = 0x9E37_79B9;

/// Bits of a distance to the middle of a clump in its cell: squares of three cells fit 32 bits.
const CLUMP_BITS: u32 = 12;

/// Square cells of the ground plane, aligned with its origin.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Pod, Zeroable)]
pub struct Lattice {
    /// Seed of all its hashes, itself a hash: seeds that follow each other would give the same pattern, a cell on.
    pub seed: u32,
    /// Side of a cell: 2 to this power, metres; [`Lattice::LEAST`] to [`Lattice::MOST`].
    pub pitch_log2: i32,
}

/// What a cell holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Root {
    /// The cell: x, z.
    pub cell: [i32; 2],
    /// Place in the cell in 2⁻¹⁶ of its side: x in the high half, z in the low one.
    pub at: u32,
    /// Below 2²⁴; the candidate stands where this is less than the density, see [`threshold`].
    pub rank: u32,
    /// For everything else that is random about it; see [`salted`].
    pub hash: u32,
}

/// The nearest clump of a place, by Worley's cellular pattern: one middle a cell of the clumps' lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Clump {
    /// Hash of its cell.
    pub hash: u32,
    /// Squared distance to its middle, in (2⁻¹² of its cell's side)².
    pub near: u32,
    /// The same to the middle of the next nearest.
    pub next: u32,
}

/// Hash of a cell, as `dolomite_terrain` hashes those of its noise.
#[inline]
#[must_use]
pub const fn cell_hash(seed: u32, [x, z]: [i32; 2]) -> u32 {
    point_hash(x.cast_unsigned(), row_hash(z.cast_unsigned(), seed))
}

/// One of the numbers that belong to a hash: different `salt`s give independent ones.
#[inline]
#[must_use]
pub const fn salted(hash: u32, salt: u32) -> u32 {
    pcg(hash ^ pcg(salt))
}

/// In [0, 1): the highest 24 bits.
#[inline]
#[must_use]
pub const fn unit(hash: u32) -> f32 {
    (hash >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Ranks below this stand where the density is `share` of the lattice's own: 0 for NaN and below 0, all above 1. The
/// product is exact, so that it is the same number on every processor.
#[inline]
#[must_use]
pub const fn threshold(share: f32) -> u32 {
    // Not `max` and `clamp`: a NaN has to give 0 in WGSL as well, where comparisons alone are certain.
    if share > 0.0 {
        if share < 1.0 {
            (share * 16_777_216.0) as u32
        } else {
            1 << RANK_BITS
        }
    } else {
        0
    }
}

/// The rank of a cell whose hash is `hash`.
#[must_use]
pub const fn rank(seed: u32, cell: [i32; 2], hash: u32) -> u32 {
    let [mut x, mut z] = cell;
    let mut rank = 0;
    let mut level = 0;
    while level < LEVELS {
        let child = (x & 1).cast_unsigned() | ((z & 1).cast_unsigned() << 1);
        x >>= 1;
        z >>= 1;
        let order = cell_hash(
            seed.wrapping_add(LEVEL_SALT.wrapping_mul(level + 1)),
            [x, z],
        );
        // Counted from the first child: itself 0, the one diagonal to it 1, those beside it 2 and 3 or 3 and 2.
        let from_first = child ^ (order >> 30);
        let digit = (0b01_11_10_00 >> (2 * from_first)) & 3;
        rank = (rank << 2) | (digit ^ ((order >> 29) & (digit >> 1)));
        level += 1;
    }
    (rank << (RANK_BITS - 2 * LEVELS)) | (hash & ((1 << (RANK_BITS - 2 * LEVELS)) - 1))
}

impl Lattice {
    /// Least `pitch_log2`: 1/64 m.
    pub const LEAST: i32 = -6;
    /// Greatest `pitch_log2`: 64 m.
    pub const MOST: i32 = 6;

    /// The coarsest lattice with at least `density` cells a square metre; `seed` is hashed.
    #[must_use]
    pub fn of_density(seed: u32, density: f32) -> Self {
        let seed = pcg(seed);
        let mut pitch_log2 = Self::MOST;
        while pitch_log2 > Self::LEAST && (Self { seed, pitch_log2 }).density() < density {
            pitch_log2 -= 1;
        }
        Self { seed, pitch_log2 }
    }

    /// Side of a cell, metres: a power of two.
    #[inline]
    #[must_use]
    pub const fn pitch(self) -> f32 {
        f32::from_bits(((127 + self.pitch_log2) as u32) << 23)
    }

    /// Cells a square metre.
    #[inline]
    #[must_use]
    pub const fn density(self) -> f32 {
        1.0 / (self.pitch() * self.pitch())
    }

    /// The candidate of a cell.
    #[inline]
    #[must_use]
    pub const fn root(self, cell: [i32; 2]) -> Root {
        let hash = cell_hash(self.seed, cell);
        Root {
            cell,
            at: salted(hash, 1),
            rank: rank(self.seed, cell, hash),
            hash,
        }
    }

    /// The cell that holds a place; cells wrap.
    #[inline]
    #[must_use]
    pub const fn cell_of(self, place: GroundPoint) -> [i32; 2] {
        let [x, z] = place.to_fixed();
        let shift = 32 + self.pitch_log2;
        [(x >> shift) as i32, (z >> shift) as i32]
    }

    /// Every cell that meets the rectangle between two places, row by row.
    pub fn cells(self, least: GroundPoint, most: GroundPoint) -> impl Iterator<Item = [i32; 2]> {
        let shift = 32 + self.pitch_log2;
        let [from, to] = [least, most].map(|place| place.to_fixed().map(|k| k >> shift));
        (from[1]..=to[1]).flat_map(move |z| (from[0]..=to[0]).map(move |x| [x as i32, z as i32]))
    }

    /// Where a candidate is, exactly, on the sheet of the plane around the origin where cells do not wrap.
    #[inline]
    #[must_use]
    pub const fn place(self, root: Root) -> GroundPoint {
        let shift = 16 + self.pitch_log2;
        let [x, z] = root.cell;
        GroundPoint::from_fixed([
            (((x as i64) << 16) | (root.at >> 16) as i64) << shift,
            (((z as i64) << 16) | (root.at & 0xFFFF) as i64) << shift,
        ])
    }

    /// The nearest clump of a candidate: clumps are 2^`size` cells of this lattice wide (`size` from 0 to 12), and
    /// `seed` is theirs, so that kinds can share them where their lattices differ.
    #[must_use]
    pub const fn clump(self, root: Root, seed: u32, size: u32) -> Clump {
        let [x, z] = root.cell;
        let mask = (1 << size) - 1;
        // Place in the cell of the clumps, of which a side is 2^CLUMP_BITS.
        let cut = 16 + size - CLUMP_BITS;
        let at = [
            ((((x.cast_unsigned() & mask) << 16) | (root.at >> 16)) >> cut) as i32,
            ((((z.cast_unsigned() & mask) << 16) | (root.at & 0xFFFF)) >> cut) as i32,
        ];
        let mut found = Clump {
            hash: 0,
            near: u32::MAX,
            next: u32::MAX,
        };
        let mut k = 0;
        while k < 9 {
            let step = [k % 3 - 1, k / 3 - 1];
            let hash = cell_hash(
                seed,
                [
                    (x >> size).wrapping_add(step[0]),
                    (z >> size).wrapping_add(step[1]),
                ],
            );
            let word = salted(hash, 1);
            // In the middle half of the cell: no middle farther off than one cell is then ever the nearest.
            let middle = [
                ((1 << (CLUMP_BITS - 2)) + (word >> (33 - CLUMP_BITS))) as i32,
                ((1 << (CLUMP_BITS - 2)) + ((word & 0xFFFF) >> (17 - CLUMP_BITS))) as i32,
            ];
            let away = [
                (step[0] << CLUMP_BITS) + middle[0] - at[0],
                (step[1] << CLUMP_BITS) + middle[1] - at[1],
            ];
            let far = (away[0] * away[0] + away[1] * away[1]).cast_unsigned();
            if far < found.near {
                found = Clump {
                    hash,
                    near: far,
                    next: found.near,
                };
            } else if far < found.next {
                found.next = far;
            }
            k += 1;
        }
        found
    }
}

#[cfg(test)]
mod tests;
