//! Where vertices and cells stand, in integers.
//!
//! The extent of the ground is cut into near-square **roots**; a root is halved `depth` times into cells.
//! Lattice coordinates count half sides of the finest cell from the extent's least corner. A cell is
//! named by its centre alone: both coordinates are odd multiples of its half side, a power of two. A
//! side's middle is an odd multiple of it in one coordinate and an even one in the other; so each vertex
//! but the roots' corners belongs to one depth, and its coordinates tell which.
//!
//! Sides count from west (−x) over north (−z) and east to south; corner k lies between side k and side
//! k + 1: 0 north-west, 1 north-east, 2 south-east, 3 south-west. Side k runs from corner k − 1 to
//! corner k.

use bevy::math::{DVec2, IVec2, UVec2};
use dolomite_terrain::{GroundPoint, GroundRect};

/// Most halvings of a root: 16 km become 1 mm, and 64 roots a side still fit 32 bits.
pub const MAX_DEPTH: u32 = 24;
/// Most roots along a side.
const MAX_ROOTS: u32 = 64;
/// 2³²: fixed-point steps a metre.
pub(crate) const STEPS: f64 = 4_294_967_296.0;

/// A cell: its centre in lattice coordinates, and half its side, a power of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CellPlace {
    /// Both odd multiples of `half`.
    pub centre: UVec2,
    /// Half the side, lattice steps.
    pub half: u32,
}

/// Directions of the corners.
const CORNERS: [IVec2; 4] = [
    IVec2::new(-1, -1),
    IVec2::new(1, -1),
    IVec2::new(1, 1),
    IVec2::new(-1, 1),
];
/// Directions of the sides.
const SIDES: [IVec2; 4] = [
    IVec2::new(-1, 0),
    IVec2::new(0, -1),
    IVec2::new(1, 0),
    IVec2::new(0, 1),
];

fn moved(at: UVec2, direction: IVec2, by: u32) -> UVec2 {
    at.wrapping_add_signed(direction * by as i32)
}

impl CellPlace {
    /// The cell whose centre stands there.
    #[must_use]
    pub const fn of_centre(centre: UVec2) -> Self {
        Self {
            centre,
            half: 1 << centre.x.trailing_zeros(),
        }
    }

    /// The place of a corner.
    #[must_use]
    pub fn corner(self, k: usize) -> UVec2 {
        moved(self.centre, CORNERS[k & 3], self.half)
    }

    /// The place of a side's middle.
    #[must_use]
    pub fn mid(self, side: usize) -> UVec2 {
        moved(self.centre, SIDES[side & 3], self.half)
    }

    /// The quarter at a corner as a cell; `None` for the finest.
    #[must_use]
    pub fn child(self, corner: usize) -> Option<Self> {
        let half = self.half / 2;
        (half > 0).then(|| Self {
            centre: moved(self.centre, CORNERS[corner & 3], half),
            half,
        })
    }

    /// At which corner of its parent the cell lies. Roots count as if they had parents, so that the
    /// pattern of diagonals goes on.
    #[must_use]
    pub const fn quarter(self) -> usize {
        let east = (self.centre.x / self.half) & 2 != 0;
        let south = (self.centre.y / self.half) & 2 != 0;
        match (east, south) {
            (false, false) => 0,
            (true, false) => 1,
            (true, true) => 2,
            (false, true) => 3,
        }
    }

    /// The cell that it is a quarter of. The parent of a root is no cell of the lattice.
    #[must_use]
    pub fn parent(self) -> Self {
        // The parent's centre is the corner opposite to the outer one.
        Self {
            centre: self.corner(self.quarter() + 2),
            half: self.half * 2,
        }
    }

    /// The cell of the same size beyond a side. It may lie outside; see [`DetailLattice::holds`].
    #[must_use]
    pub fn neighbour(self, side: usize) -> Self {
        Self {
            centre: moved(self.centre, SIDES[side & 3], self.half * 2),
            half: self.half,
        }
    }
}

/// The vertices between which a vertex lies in the middle: the ends of the edge that it cuts.
#[must_use]
pub fn ends(vertex: UVec2) -> [UVec2; 2] {
    let (tx, tz) = (vertex.x.trailing_zeros(), vertex.y.trailing_zeros());
    if tx == tz {
        let cell = CellPlace::of_centre(vertex);
        let outer = cell.quarter();
        return [cell.corner(outer + 2), cell.corner(outer)];
    }
    let half = 1_u32 << tx.min(tz);
    let along = if tx < tz { IVec2::X } else { IVec2::Y };
    [
        moved(vertex, along, half.wrapping_neg()),
        moved(vertex, along, half),
    ]
}

/// The two cells that share a side's middle, and which of their sides it is: first the one with the
/// lesser coordinate, which owns the vertex where it exists.
#[must_use]
pub fn cells_of_mid(mid: UVec2) -> [(CellPlace, usize); 2] {
    let (tx, tz) = (mid.x.trailing_zeros(), mid.y.trailing_zeros());
    let half = 1 << if tx < tz { tx } else { tz };
    let cell = |x, z| CellPlace {
        centre: UVec2::new(x, z),
        half,
    };
    if tx < tz {
        [
            (cell(mid.x, mid.y.wrapping_sub(half)), 3),
            (cell(mid.x, mid.y.wrapping_add(half)), 1),
        ]
    } else {
        [
            (cell(mid.x.wrapping_sub(half), mid.y), 2),
            (cell(mid.x.wrapping_add(half), mid.y), 0),
        ]
    }
}

/// The lattice over an extent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DetailLattice {
    /// The least corner.
    pub origin: GroundPoint,
    /// A lattice step along x and z, 2⁻³² m.
    pub step: [u64; 2],
    /// Roots along x and z.
    pub roots: UVec2,
    /// How often a root is halved.
    pub depth: u32,
    /// The outermost columns and rows, where they are narrower or wider than the others.
    pub border: Border,
}

/// Outermost columns and rows of a lattice whose lines stand on the samples of a map: all that is moved are the
/// outermost lines, to the border of the extent, and what is finer within these columns evenly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Border {
    /// How many lattice steps wide they are, a power of two; 0: all are alike.
    pub width: u32,
    /// A lattice step in the first column and the first row, 2⁻³² m.
    pub first: [u64; 2],
    /// The same in the last ones.
    pub last: [u64; 2],
}

impl DetailLattice {
    /// A lattice whose finest cells are at most `finest` metres wide, as far as [`MAX_DEPTH`] allows.
    /// The lattice covers the extent, and less than 2⁻⁸ m more.
    #[must_use]
    pub fn new(extent: GroundRect, finest: f32) -> Self {
        let size = (extent.max - extent.min).max(DVec2::splat(1e-3));
        let roots = (size / size.min_element())
            .round()
            .as_uvec2()
            .clamp(UVec2::ONE, UVec2::splat(MAX_ROOTS));
        let root = (size / roots.as_dvec2()).max_element();
        let finest = f64::from(finest).max(1e-4);
        let mut depth = 0;
        while depth < MAX_DEPTH && root / f64::from(1_u32 << depth) > finest * 1.000_001 {
            depth += 1;
        }
        let steps = (roots << (depth + 1)).as_dvec2();
        let step = size * STEPS / steps;
        Self {
            origin: GroundPoint::new(extent.min),
            step: [step.x.ceil() as u64, step.y.ceil() as u64],
            roots,
            depth,
            border: Border::default(),
        }
    }

    /// Fixed-point metres from the origin to a lattice line, which may lie outside.
    const fn along(&self, axis: usize, at: i64) -> i64 {
        let step = self.step[axis] as i64;
        let width = self.border.width as i64;
        if width == 0 {
            return step.wrapping_mul(at);
        }
        let (first, last) = (
            self.border.first[axis] as i64,
            self.border.last[axis] as i64,
        );
        let roots = if axis == 0 {
            self.roots.x
        } else {
            self.roots.y
        };
        let inner = ((roots as i64) << (self.depth + 1)) - width;
        if at <= width {
            first.wrapping_mul(at)
        } else if at <= inner {
            first * width + step * (at - width)
        } else {
            first * width + step * (inner - width) + last.wrapping_mul(at - inner)
        }
    }

    /// World place of a lattice point that may lie outside, before the first line too.
    #[must_use]
    pub const fn signed_point(&self, at: [i64; 2]) -> GroundPoint {
        let [x, z] = self.origin.to_fixed();
        GroundPoint::from_fixed([
            x.wrapping_add(self.along(0, at[0])),
            z.wrapping_add(self.along(1, at[1])),
        ])
    }

    /// Lattice coordinates of a place, in f64: for places on the lattice.
    #[must_use]
    pub fn coordinates(&self, place: GroundPoint) -> DVec2 {
        let (at, origin) = (place.to_fixed(), self.origin.to_fixed());
        let along = |axis: usize| {
            let off = at[axis].wrapping_sub(origin[axis]);
            let width = i64::from(self.border.width);
            let from = |line: i64, step: u64| {
                let rest = off.wrapping_sub(self.along(axis, line));
                line as f64 + rest as f64 / step as f64
            };
            let roots = i64::from(self.roots.to_array()[axis]);
            let inner = (roots << (self.depth + 1)) - width;
            if width == 0 {
                from(0, self.step[axis])
            } else if off <= self.along(axis, width) {
                from(0, self.border.first[axis])
            } else if off <= self.along(axis, inner) {
                from(width, self.step[axis])
            } else {
                from(inner, self.border.last[axis])
            }
        };
        DVec2::new(along(0), along(1))
    }

    /// Half the side of a root.
    #[must_use]
    pub const fn root_half(&self) -> u32 {
        1 << self.depth
    }

    /// The roots, row by row.
    pub fn root_cells(&self) -> impl Iterator<Item = CellPlace> {
        let (roots, half) = (self.roots, self.root_half());
        (0..roots.y).flat_map(move |z| {
            (0..roots.x).map(move |x| CellPlace {
                centre: UVec2::new(2 * x + 1, 2 * z + 1) * half,
                half,
            })
        })
    }

    /// Whether a cell lies on the ground.
    #[must_use]
    pub fn holds(&self, cell: CellPlace) -> bool {
        cell.centre.cmplt(self.roots << (self.depth + 1)).all()
    }

    /// World place of a lattice point.
    #[must_use]
    pub const fn point(&self, at: UVec2) -> GroundPoint {
        self.signed_point([at.x as i64, at.y as i64])
    }

    /// Sides of a cell of this half side, metres; of those that the border does not change.
    #[must_use]
    pub fn sides(&self, half: u32) -> DVec2 {
        let side = |step: u64| step as f64 / STEPS * 2.0 * f64::from(half);
        DVec2::new(side(self.step[0]), side(self.step[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice() -> DetailLattice {
        DetailLattice::new(GroundRect::square(DVec2::ZERO, 4096.0), 1.0)
    }

    /// Cells down to three depths, from every root corner of the pattern.
    fn some_cells() -> Vec<CellPlace> {
        let mut cells: Vec<_> =
            DetailLattice::new(GroundRect::new(DVec2::ZERO, DVec2::new(300.0, 200.0)), 10.0)
                .root_cells()
                .collect();
        let mut first = 0;
        for _ in 0..3 {
            let last = cells.len();
            for at in first..last {
                let of = cells[at];
                cells.extend((0..4).filter_map(|k| of.child(k)));
            }
            first = last;
        }
        cells
    }

    #[test]
    fn cells_find_their_way_up_and_down() {
        for cell in some_cells() {
            assert_eq!(CellPlace::of_centre(cell.centre), cell);
            for k in 0..4 {
                let Some(child) = cell.child(k) else { continue };
                assert_eq!((child.parent(), child.quarter()), (cell, k));
                assert_eq!(child.corner(k), cell.corner(k));
                assert_eq!(child.corner(k + 1), cell.mid(k + 1));
                assert_eq!(child.corner(k + 3), cell.mid(k));
                let there = cell.neighbour(k);
                assert_eq!(there.neighbour(k + 2), cell);
                assert_eq!(there.mid(k + 2), cell.mid(k));
            }
        }
    }

    #[test]
    fn vertices_lie_between_their_ends_and_know_their_cells() {
        for cell in some_cells() {
            let [a, b] = ends(cell.centre);
            assert_eq!(a + b, cell.centre * 2);
            if let Some(child) = cell.child(0) {
                assert!(ends(child.centre).contains(&cell.centre));
            }
            for side in 0..4 {
                let mid = cell.mid(side);
                assert_eq!(ends(mid).iter().sum::<UVec2>(), mid * 2);
                assert!(ends(mid).contains(&cell.corner(side)));
                assert!(cells_of_mid(mid).contains(&(cell, side)));
                // The owner is the cell with the lesser coordinate: its east and south sides.
                assert_eq!(cells_of_mid(mid)[0].1, side | 2);
            }
        }
    }

    #[test]
    fn the_lattice_covers_the_extent() {
        let lattice = lattice();
        assert_eq!(lattice.depth, 12);
        let far = lattice.roots << (lattice.depth + 1);
        assert_eq!(lattice.point(UVec2::ZERO).to_dvec2(), DVec2::splat(-2048.0));
        assert_eq!(lattice.point(far).to_dvec2(), DVec2::splat(2048.0));
        let odd = DetailLattice::new(
            GroundRect::new(DVec2::splat(-1e6), DVec2::new(-1e6 + 777.7, -1e6 + 1501.3)),
            0.01,
        );
        assert_eq!(odd.roots, UVec2::new(1, 2));
        let far = odd.point(odd.roots << (odd.depth + 1)).to_dvec2();
        let beyond = far - DVec2::new(-1e6 + 777.7, -1e6 + 1501.3);
        assert!(beyond.min_element() >= 0.0 && beyond.max_element() < 1.0 / 256.0);
    }

    #[test]
    fn depth_ends_where_32_bits_do() {
        let lattice = DetailLattice::new(GroundRect::square(DVec2::ZERO, 1e8), 1e-3);
        assert_eq!(lattice.depth, MAX_DEPTH);
        let last = lattice.root_cells().last().expect("a root");
        assert!(lattice.holds(last) && !lattice.holds(last.neighbour(2)));
        assert!(
            !lattice.holds(last.neighbour(0).neighbour(0)),
            "wraps to the far end"
        );
    }
}
