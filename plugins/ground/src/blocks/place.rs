//! Where blocks and their vertices stand, in integers.
//!
//! A **block** is a square of the lattice of [`crate::detail::lattice`], seen as [`CELLS`] × [`CELLS`] cells;
//! it has their corners and their centres as vertices. Its four quarters are blocks too. A cell's samples are
//! lattice points: so the half side of a cell is at least [`LEAST_CELL_HALF`] lattice steps, and a block's at
//! least [`LEAST_HALF`].
//!
//! Corner (i, j) of a block is i cells east and j cells south of its north-western corner; cell (i, j) lies
//! south-east of corner (i, j). Both are also asked for outside of the block, where i or j is negative or
//! beyond: the **ring**. As blocks begin at even cells of their own size, the parity of i and j is that of the
//! whole lattice.
//!
//! | corner | is | cuts |
//! |---|---|---|
//! | both even | of an older block | |
//! | both odd | the centre of a cell of the parent | that cell's diagonal |
//! | **mixed** | new: the middle of a side of the parent's cells | that side |
//!
//! A centre cuts the diagonal of its cell. Mixed corners and centres are a block's own vertices; the others it has
//! from its parent.
//!
//! A vertex **needs** its two **parents**: the corners opposite to the edge that it cuts, of the two triangles
//! beside that edge. A mixed corner's are the two both-odd corners beside it along the other axis; a centre's
//! are the two mixed corners of its cell.

use bevy::math::{IVec2, UVec2};

use crate::detail::{CellPlace, DetailLattice};

/// Cells along a side of a block.
pub const CELLS: i32 = 16;
/// Corners along a side of a block.
pub const CORNERS: usize = CELLS as usize + 1;
/// Corners of a block.
pub const CORNER_COUNT: usize = CORNERS * CORNERS;
/// Vertices of a block: corners row by row, then centres row by row.
pub const VERTICES: usize = CORNER_COUNT + (CELLS * CELLS) as usize;
/// Least half side of a cell, lattice steps: a sample stands every quarter of a side.
pub const LEAST_CELL_HALF: u32 = 2;
/// Least half side of a block, lattice steps.
pub const LEAST_HALF: u32 = LEAST_CELL_HALF * CELLS as u32;
/// Halvings of a root that a lattice needs for one block to fit.
pub const LEAST_DEPTH: u32 = LEAST_HALF.trailing_zeros();

/// What a corner is in its block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerKind {
    /// Both coordinates even.
    Older,
    /// Both coordinates odd: the centre of a cell of the parent.
    ParentCentre,
    /// The middle of a side of the parent's cells.
    Mixed,
}

/// Kind of the corner (i, j), in the ring too.
#[must_use]
pub const fn corner_kind(at: IVec2) -> CornerKind {
    match (at.x & 1, at.y & 1) {
        (0, 0) => CornerKind::Older,
        (1, 1) => CornerKind::ParentCentre,
        _ => CornerKind::Mixed,
    }
}

/// Number of the vertex at corner (i, j), 0 to [`CELLS`] each.
#[must_use]
pub const fn corner_number(at: IVec2) -> usize {
    at.y as usize * CORNERS + at.x as usize
}

/// Number of the vertex in the centre of cell (i, j), 0 to [`CELLS`] − 1 each.
#[must_use]
pub const fn centre_number(at: IVec2) -> usize {
    CORNER_COUNT + at.y as usize * CELLS as usize + at.x as usize
}

/// Where the vertex of a number stands, in half cells from the block's north-western corner: even numbers are
/// corners, odd ones centres.
#[must_use]
pub const fn vertex_at(number: usize) -> IVec2 {
    if number < CORNER_COUNT {
        IVec2::new(2 * (number % CORNERS) as i32, 2 * (number / CORNERS) as i32)
    } else {
        let k = number - CORNER_COUNT;
        let cells = CELLS as usize;
        IVec2::new(2 * (k % cells) as i32 + 1, 2 * (k / cells) as i32 + 1)
    }
}

/// At which corner of its parent's cell the cell (i, j) lies, as [`CellPlace::quarter`].
#[must_use]
pub const fn cell_quarter(at: IVec2) -> usize {
    match (at.x & 1, at.y & 1) {
        (0, 0) => 0,
        (1, 0) => 1,
        (1, 1) => 2,
        _ => 3,
    }
}

/// The parents of a mixed corner: corners, maybe in the ring.
#[must_use]
pub const fn mixed_parents(at: IVec2) -> [IVec2; 2] {
    if at.x & 1 == 1 {
        [IVec2::new(at.x, at.y - 1), IVec2::new(at.x, at.y + 1)]
    } else {
        [IVec2::new(at.x - 1, at.y), IVec2::new(at.x + 1, at.y)]
    }
}

/// The parents of the centre of cell (i, j): first its mixed corner with odd i, then the one with odd j.
#[must_use]
pub const fn centre_parents(at: IVec2) -> [IVec2; 2] {
    let (odd_x, odd_y) = (at.x + 1 - (at.x & 1), at.y + 1 - (at.y & 1));
    let (even_x, even_y) = (at.x + (at.x & 1), at.y + (at.y & 1));
    [IVec2::new(odd_x, even_y), IVec2::new(even_x, odd_y)]
}

/// The ends of the diagonal of cell (i, j): first the centre of the parent's cell, then the outer corner.
#[must_use]
pub const fn diagonal(at: IVec2) -> [IVec2; 2] {
    let odd = IVec2::new(at.x + 1 - (at.x & 1), at.y + 1 - (at.y & 1));
    let even = IVec2::new(at.x + (at.x & 1), at.y + (at.y & 1));
    [odd, even]
}

/// A block's square: a cell whose half side is at least [`LEAST_HALF`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BlockPlace(CellPlace);

impl BlockPlace {
    /// The block whose centre stands there; `None` where it would be too small.
    #[must_use]
    pub fn of_centre(centre: UVec2) -> Option<Self> {
        Self::of_cell(CellPlace::of_centre(centre))
    }

    /// The block on the square of a cell; `None` where it would be too small.
    #[must_use]
    pub fn of_cell(cell: CellPlace) -> Option<Self> {
        (cell.half >= LEAST_HALF).then_some(Self(cell))
    }

    /// The roots of a lattice, row by row; none if it is less than [`LEAST_DEPTH`] deep.
    pub fn roots(lattice: &DetailLattice) -> impl Iterator<Item = Self> {
        lattice.root_cells().filter_map(Self::of_cell)
    }

    /// The square.
    #[must_use]
    pub const fn cell(self) -> CellPlace {
        self.0
    }

    /// Half the side of its cells, lattice steps.
    #[must_use]
    pub const fn cell_half(self) -> u32 {
        self.0.half / CELLS as u32
    }

    /// Lattice steps between its samples.
    #[must_use]
    pub const fn sample_step(self) -> u32 {
        self.cell_half() / 2
    }

    /// The block at a corner; `None` for the finest.
    #[must_use]
    pub fn child(self, quarter: usize) -> Option<Self> {
        self.0.child(quarter).and_then(Self::of_cell)
    }

    /// The block that it is a quarter of. Of a root it is none of the lattice.
    #[must_use]
    pub fn parent(self) -> Self {
        Self(self.0.parent())
    }

    /// At which corner of its parent it lies; roots count as if they had parents.
    #[must_use]
    pub const fn quarter(self) -> usize {
        self.0.quarter()
    }

    /// Whether it is a root.
    #[must_use]
    pub const fn is_root(self, lattice: &DetailLattice) -> bool {
        self.0.half == lattice.root_half()
    }

    /// The lattice point so many half cells from the north-western corner. Outside of the lattice it wraps.
    #[must_use]
    pub fn lattice_point(self, half_cells: IVec2) -> UVec2 {
        self.0
            .corner(0)
            .wrapping_add_signed(half_cells * self.cell_half() as i32)
    }

    /// The cell (i, j), in the ring too.
    #[must_use]
    pub fn cell_at(self, at: IVec2) -> CellPlace {
        CellPlace {
            centre: self.lattice_point(at * 2 + 1),
            half: self.cell_half(),
        }
    }

    /// Cell (i, j) of this block lies in this cell of its parent.
    #[must_use]
    pub const fn cell_in_parent(self, at: IVec2) -> IVec2 {
        let corner = self.corner_in_parent();
        IVec2::new((at.x >> 1) + corner.x, (at.y >> 1) + corner.y)
    }

    /// Its north-western corner among its parent's.
    #[must_use]
    pub const fn corner_in_parent(self) -> IVec2 {
        let half = CELLS / 2;
        match self.quarter() {
            0 => IVec2::ZERO,
            1 => IVec2::new(half, 0),
            2 => IVec2::new(half, half),
            _ => IVec2::new(0, half),
        }
    }

    /// Number in the parent of a corner that is not mixed.
    #[must_use]
    pub const fn number_in_parent(self, corner: IVec2) -> usize {
        let first = self.corner_in_parent();
        let at = IVec2::new((corner.x >> 1) + first.x, (corner.y >> 1) + first.y);
        match corner_kind(corner) {
            CornerKind::ParentCentre => centre_number(at),
            _ => corner_number(at),
        }
    }

    /// The ends of the edge that a vertex cuts, as numbers of this block; `None` for the corners of the block,
    /// which stand on the ground wherever it is drawn.
    #[must_use]
    pub const fn ends(self, number: usize) -> Option<[usize; 2]> {
        // In half cells every vertex is an odd multiple of a power of two along the axis where that is less.
        let at = vertex_at(number);
        let (tx, ty) = (at.x.trailing_zeros(), at.y.trailing_zeros());
        let least = if tx < ty { tx } else { ty };
        if least > CELLS.trailing_zeros() {
            return None;
        }
        let half = 1_i32 << least;
        let (dx, dy) = if tx < ty {
            (half, 0)
        } else if ty < tx {
            (0, half)
        } else {
            // The diagonal through the outer corner. The block's own centre lies by the block's place.
            let quarter = if half == CELLS {
                self.quarter()
            } else {
                cell_quarter(IVec2::new(at.x >> (least + 1), at.y >> (least + 1)))
            };
            if quarter % 2 == 0 {
                (half, half)
            } else {
                (half, -half)
            }
        };
        Some([
            number_at(IVec2::new(at.x - dx, at.y - dy)),
            number_at(IVec2::new(at.x + dx, at.y + dy)),
        ])
    }
}

/// Number of the vertex that stands there, in half cells: both even or both odd.
#[must_use]
pub const fn number_at(half_cells: IVec2) -> usize {
    let at = IVec2::new(half_cells.x >> 1, half_cells.y >> 1);
    if half_cells.x & 1 == 1 {
        centre_number(at)
    } else {
        corner_number(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detail::lattice;
    use bevy::math::DVec2;
    use dolomite_terrain::GroundRect;

    /// All blocks down to three halvings of two roots.
    fn some_blocks() -> (DetailLattice, Vec<BlockPlace>) {
        let rect = GroundRect::new(DVec2::ZERO, DVec2::new(300.0, 150.0));
        let lattice = DetailLattice::new(rect, 150.0 / 256.0);
        let mut blocks: Vec<_> = BlockPlace::roots(&lattice).collect();
        assert_eq!((blocks.len(), lattice.depth), (2, 8));
        let mut first = 0;
        for _ in 0..3 {
            let last = blocks.len();
            for at in first..last {
                let of = blocks[at];
                blocks.extend((0..4).filter_map(|k| of.child(k)));
            }
            first = last;
        }
        assert_eq!(blocks.len(), 2 * (1 + 4 + 16 + 64));
        (lattice, blocks)
    }

    #[test]
    fn the_finest_blocks_have_no_children_and_integer_samples() {
        let (_, blocks) = some_blocks();
        let least = blocks.iter().map(|b| b.sample_step()).min();
        assert_eq!(least, Some(1));
        for block in &blocks {
            assert_eq!(block.child(0).is_none(), block.sample_step() == 1);
        }
        assert_eq!(BlockPlace::of_centre(UVec2::splat(LEAST_HALF / 2)), None);
        let shallow = GroundRect::square(DVec2::ZERO, 4.0);
        assert_eq!(
            BlockPlace::roots(&DetailLattice::new(shallow, 1.0)).count(),
            0
        );
    }

    #[test]
    fn numbers_kinds_and_ends_are_those_of_the_lattice() {
        for block in some_blocks().1 {
            for number in 0..VERTICES {
                let at = vertex_at(number);
                assert_eq!(number_at(at), number);
                let place = block.lattice_point(at);
                let Some(ends) = block.ends(number) else {
                    assert!((0..4).any(|k| block.cell().corner(k) == place));
                    continue;
                };
                let mut found = ends.map(|end| block.lattice_point(vertex_at(end)));
                let mut expected = lattice::ends(place);
                found.sort_by_key(|p| p.to_array());
                expected.sort_by_key(|p| p.to_array());
                assert_eq!(found, expected, "{block:?} {number}");
            }
        }
    }

    #[test]
    fn parents_and_diagonals_are_those_of_the_lattice() {
        for block in some_blocks().1 {
            let corner = |at: IVec2| block.lattice_point(at * 2);
            for k in 0..20 * 20 {
                let at = IVec2::new(k % 20 - 2, k / 20 - 2);
                let cell = block.cell_at(at);
                assert_eq!(cell.quarter(), cell_quarter(at));
                let (inner, outer) = (cell.corner(cell.quarter() + 2), cell.corner(cell.quarter()));
                assert_eq!(diagonal(at).map(corner), [inner, outer]);
                let [x, z] = centre_parents(at);
                assert!(x.x & 1 == 1 && x.y & 1 == 0 && z.x & 1 == 0 && z.y & 1 == 1);
                for parent in [x, z] {
                    assert_eq!(corner_kind(parent), CornerKind::Mixed);
                    let others = [cell.quarter() + 1, cell.quarter() + 3];
                    assert!(others.iter().any(|&k| cell.corner(k) == corner(parent)));
                    // A mixed corner's parents are the centres of the cells beside the side.
                    let mut found = mixed_parents(parent).map(corner);
                    let mut expected =
                        lattice::cells_of_mid(corner(parent)).map(|(cell, _)| cell.centre);
                    found.sort_by_key(|p| p.to_array());
                    expected.sort_by_key(|p| p.to_array());
                    assert_eq!(found, expected);
                }
            }
        }
    }

    #[test]
    fn children_find_their_vertices_and_cells_in_their_parents() {
        for block in some_blocks().1 {
            for quarter in 0..4 {
                let Some(child) = block.child(quarter) else {
                    continue;
                };
                assert_eq!((child.parent(), child.quarter()), (block, quarter));
                for number in 0..CORNER_COUNT {
                    let corner = vertex_at(number) / 2;
                    if corner_kind(corner) != CornerKind::Mixed {
                        let there = vertex_at(child.number_in_parent(corner));
                        assert_eq!(block.lattice_point(there), child.lattice_point(corner * 2));
                    }
                }
                for k in 0..20 * 20 {
                    let at = IVec2::new(k % 20 - 2, k / 20 - 2);
                    let above = block.cell_at(child.cell_in_parent(at));
                    assert_eq!(child.cell_at(at).parent(), above);
                }
            }
        }
    }
}
