//! Which vertices of a block are there, and its leaf triangles.
//!
//! A vertex of ratio r is **there** if r > [`WINDOW`] · c, c the coarsening. From r ≥ c on it stands on the
//! ground; between them it is by (r/c − w) / (1 − w) on its way.
//!
//! **Leaf triangles.** Take the aligned squares of S × S cells for S = 16, 8, 4, 2, 1. A square exists if S =
//! 16, or if both middles of the larger square's sides beside it are there. If it exists and its centre is not
//! there: two triangles, cut by the diagonal. If the centre is there: for each side whose middle is not there
//! one triangle; for each quarter with exactly one of its two middles there one triangle, half of the quarter.
//! Middles of sides of single cells belong to the child, and are not there. Quadrants that a child draws are
//! left out.

use bevy::math::IVec2;

use super::place::{BlockPlace, CELLS, VERTICES, number_at};
use super::record::WINDOW;

/// Which vertices of a block are there, and how far each is on its way.
#[derive(Clone, Debug)]
pub struct Presence {
    shares: Vec<f32>,
}

impl Presence {
    /// Of the ratios of a block's vertices.
    #[must_use]
    pub fn new(ratios: &[f32], coarsening: f32) -> Self {
        let share = |ratio: f32| {
            // Below 0: not there. A vertex that just appeared may have 0.
            let share = (ratio / coarsening - WINDOW) / (1.0 - WINDOW);
            if ratio > WINDOW * coarsening {
                share.clamp(0.0, 1.0)
            } else {
                -1.0
            }
        };
        Self {
            shares: ratios.iter().map(|&ratio| share(ratio)).collect(),
        }
    }

    /// Whether a vertex is there.
    #[must_use]
    pub fn there(&self, number: usize) -> bool {
        self.shares[number] >= 0.0
    }

    /// Share of its way to the ground, of a vertex that is there.
    #[must_use]
    pub fn share(&self, number: usize) -> f32 {
        self.shares[number]
    }
}

/// Corner directions of a square, in the order of the lattice's.
const CORNER: [IVec2; 4] = [
    IVec2::new(-1, -1),
    IVec2::new(1, -1),
    IVec2::new(1, 1),
    IVec2::new(-1, 1),
];
const SIDE: [IVec2; 4] = [
    IVec2::new(-1, 0),
    IVec2::new(0, -1),
    IVec2::new(1, 0),
    IVec2::new(0, 1),
];

/// A square of cells of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Square {
    /// Half cells from the block's corner.
    pub centre: IVec2,
    /// Half the side, half cells: the number of cells along a side.
    pub half: i32,
    /// At which corner of the larger square it lies.
    pub quarter: usize,
}

impl Square {
    pub fn whole(place: BlockPlace) -> Self {
        Self {
            centre: IVec2::splat(CELLS),
            half: CELLS,
            quarter: place.quarter(),
        }
    }

    pub fn centre_number(&self) -> usize {
        number_at(self.centre)
    }

    pub fn corner(&self, k: usize) -> usize {
        number_at(self.centre + CORNER[k & 3] * self.half)
    }

    /// The middle of a side; `None` for single cells.
    pub fn middle(&self, side: usize) -> Option<usize> {
        (self.half > 1).then(|| number_at(self.centre + SIDE[side & 3] * self.half))
    }

    pub fn child(&self, corner: usize) -> Option<Self> {
        let half = self.half / 2;
        (half > 0).then(|| Self {
            centre: self.centre + CORNER[corner & 3] * half,
            half,
            quarter: corner & 3,
        })
    }

    /// Whether the middle of a side is there.
    pub fn has_middle(&self, presence: &Presence, side: usize) -> bool {
        self.middle(side)
            .is_some_and(|number| presence.there(number))
    }

    /// Whether the quarter at a corner is a square of its own: the sides that meet there have middles.
    pub fn has_child(&self, presence: &Presence, corner: usize) -> bool {
        self.has_middle(presence, corner) && self.has_middle(presence, corner + 1)
    }
}

/// Calls `found` with the corners of each leaf triangle of a block, counter-clockwise from above, but for the
/// quadrants that `children` draw.
pub fn leaves(
    presence: &Presence,
    place: BlockPlace,
    children: [bool; 4],
    mut found: impl FnMut([usize; 3]),
) {
    let mut open = vec![Square::whole(place)];
    while let Some(square) = open.pop() {
        let centre = square.centre_number();
        if !presence.there(centre) {
            let outer = square.quarter;
            let at = |k: usize| square.corner(outer + k);
            found([at(2), at(1), at(0)]);
            found([at(0), at(3), at(2)]);
            continue;
        }
        let whole = square.half == CELLS;
        let drawn = |quarter: usize| whole && children[quarter & 3];
        for side in 0..4 {
            let (before, after) = (square.corner(side + 3), square.corner(side));
            if !square.has_middle(presence, side) {
                found([centre, after, before]);
                continue;
            }
            let Some(middle) = square.middle(side) else {
                continue;
            };
            for (quarter, corners) in [
                (side, [centre, after, middle]),
                (side + 3, [centre, middle, before]),
            ] {
                if !drawn(quarter) && !square.has_child(presence, quarter) {
                    found(corners);
                }
            }
        }
        for quarter in 0..4 {
            if !drawn(quarter) && square.has_child(presence, quarter) {
                open.extend(square.child(quarter));
            }
        }
    }
}

/// How many vertices the leaf triangles of a block use.
#[must_use]
pub fn count(presence: &Presence, place: BlockPlace, children: [bool; 4]) -> usize {
    let mut used = [false; VERTICES];
    leaves(presence, place, children, |corners| {
        for corner in corners {
            used[corner] = true;
        }
    });
    used.into_iter().filter(|used| *used).count()
}
