//! What the ground of a cell may do between its samples.
//!
//! Of noise nothing tells that but what it does from sample to sample: ε, the largest second difference of neighbouring
//! samples. It serves twice. Errors are taken over triangles larger than the steps, to which little is added:
//! [`TAIL`] ε. Intervals are of the samples alone, so that all of what lies beyond them has to be added: [`BEYOND`] ε.
//!
//! Octaves that the samples of a cell do not meet ([`Terrain::unseen`]) are added to both. Of a tail it may be less to say it
//! of nine cells of which it is one: their samples drift through more of an octave's cells, and the largest ε of nine is little
//! more than that of one. Without that, and with every octave met by twice its distance from the lattice alone, the massif of
//! the game took 1.6 times the triangles at 1 px.
//!
//! Intervals are cut with those of the cells above, so that what is missing in one of a cell a kilometre wide is missing in
//! all below it. With [`TAIL`] ε some summits of a massif stood 85 m above their intervals: who stood on one was
//! nowhere near it by these numbers, or did not see it at all, and the ground at their feet was 20 times the bound off.

use bevy::math::IVec2;
use dolomite_terrain::{GroundRect, Terrain};

use super::errors::TAIL;
use super::place::{BlockPlace, CELLS};
use super::record::EMPTY;
use super::triangle::{AROUND, STEPS, Surface, WIDE, greater};
use crate::detail::DetailLattice;

/// By how much the ground of a cell may lie beyond its samples, as a multiple of the largest ε in it and in the eight
/// cells around. Of 22 800 cells of noise from 1 m to 1 km one in a hundred was beyond by up to 1.1 ε of its own, one in
/// a thousand by up to 1.8, the worst by 2.0.
pub const BEYOND: f32 = 4.0;

/// What is known of the ground between samples in each of the wide cells, metres.
pub struct Between {
    /// By how much it may differ from what the samples tell: of errors.
    pub tails: Vec<f32>,
    /// Lowest and highest sample of the bed.
    extremes: Vec<[f32; 2]>,
    /// By how much the bed may lie beyond them.
    beyond: Vec<f32>,
}

impl Between {
    /// Of the samples of a block: `heights` of the bed, and the `surfaces` whose errors count, with their shares.
    #[must_use]
    pub fn new(
        terrain: &Terrain,
        (lattice, place): (&DetailLattice, BlockPlace),
        heights: Surface,
        surfaces: &[(Surface, f32)],
        sea: f32,
    ) -> Self {
        let with = (lattice, place);
        let (drawn, bed) = (bends(surfaces), bends(&[(heights, 1.0)]));
        let mut all = Self {
            tails: vec![0.0; WIDE * WIDE],
            extremes: vec![EMPTY; WIDE * WIDE],
            beyond: vec![0.0; WIDE * WIDE],
        };
        for k in 0..WIDE * WIDE {
            let at = IVec2::new((k % WIDE) as i32, (k / WIDE) as i32);
            let first = at * STEPS as i32;
            let [mut low, mut high] = EMPTY;
            for z in first.y as usize..=first.y as usize + STEPS {
                for x in first.x as usize..=first.x as usize + STEPS {
                    let height = heights.at(x, z);
                    low = low.min(height);
                    high = high.max(height);
                }
            }
            all.extremes[k] = [low, high];
            let alone = alone(terrain, with, at, 0).unwrap_or(0.0);
            all.beyond[k] = BEYOND * bed[k] + alone;
            let tail = TAIL * drawn[k] + alone;
            let tail = match wider(terrain, with, at, &drawn) {
                Some(wider) if wider < tail => wider,
                _ => tail,
            };
            // Where samples are under water ground may rise out of it between them: by no more than it may
            // differ, and no higher than it may be.
            let dry = if low < sea {
                (TAIL * bed[k] + alone).min(high + all.beyond[k] - sea)
            } else {
                0.0
            };
            all.tails[k] = greater(tail, dry);
        }
        all
    }

    /// Lowest and highest of the drawn surface in a wide cell that is not one of the outermost.
    #[must_use]
    pub fn interval(&self, at: IVec2, sea: f32) -> [f32; 2] {
        let mut beyond = 0.0;
        for z in at.y - 1..=at.y + 1 {
            for x in at.x - 1..=at.x + 1 {
                beyond = greater(beyond, self.beyond[z as usize * WIDE + x as usize]);
            }
        }
        let [low, high] = self.extremes[at.y as usize * WIDE + at.x as usize];
        [(low - beyond).max(sea), (high + beyond).max(sea)]
    }
}

/// What samples of a cell, and of `around` cells about it on each side, do not meet; `None` where these are not all on the
/// lattice.
fn alone(
    terrain: &Terrain,
    (lattice, place): (&DetailLattice, BlockPlace),
    at: IVec2,
    around: i32,
) -> Option<f32> {
    let [first, last] = [-around, around].map(|by| place.cell_at(at + by - AROUND));
    if !(lattice.holds(first) && lattice.holds(last)) {
        return None;
    }
    let min = lattice.point(first.corner(0)).to_dvec2();
    let max = lattice.point(last.corner(2)).to_dvec2();
    let steps = STEPS as i32 * (2 * around + 1);
    let spacing = (max - min).max_element() / f64::from(steps);
    Some(terrain.unseen(&GroundRect::new(min, max), spacing))
}

/// The middle of nine cells with a cell of the block or its ring of three among them: the cell itself but for those beside which
/// a block that has the cell in its ring knows no further. So they are the same for every block that has it.
fn middle_of_nine(cell: IVec2) -> IVec2 {
    let last = CELLS + AROUND - 1;
    let [x, z] = cell.to_array().map(|at| {
        let own = at.rem_euclid(CELLS);
        let is_first = own == (-AROUND).rem_euclid(CELLS);
        let is_last = own == last.rem_euclid(CELLS);
        at + i32::from(is_first) - i32::from(is_last)
    });
    IVec2::new(x, z)
}

/// The tail of a cell as that of nine cells is told from the samples of all, of which the largest `bends` are given. Three times as many samples in a row meet more of an octave whose cells are nearly as wide as their steps.
fn wider(
    terrain: &Terrain,
    with: (&DetailLattice, BlockPlace),
    at: IVec2,
    bends: &[f32],
) -> Option<f32> {
    let middle = middle_of_nine(at - AROUND) + AROUND;
    let alone = alone(terrain, with, middle, 1)?;
    let mut most = 0.0;
    for z in middle.y - 1..=middle.y + 1 {
        for x in middle.x - 1..=middle.x + 1 {
            most = greater(most, bends[z as usize * WIDE + x as usize]);
        }
    }
    Some(TAIL * most + alone)
}

/// The largest second difference along rows and columns of each of the wide cells.
fn bends(surfaces: &[(Surface, f32)]) -> Vec<f32> {
    let mut all = vec![0.0; WIDE * WIDE];
    for (k, largest) in all.iter_mut().enumerate() {
        let first = [k % WIDE * STEPS, k / WIDE * STEPS];
        for (surface, share) in surfaces {
            let at = |i: usize, j: usize| surface.at(first[0] + i, first[1] + j);
            for even in (0..=STEPS).step_by(2) {
                for odd in (1..STEPS).step_by(2) {
                    let off =
                        |middle: f32, a: f32, b: f32| (0.5 * ((middle - a) + (middle - b))).abs();
                    let along = off(at(odd, even), at(odd - 1, even), at(odd + 1, even));
                    let across = off(at(even, odd), at(even, odd - 1), at(even, odd + 1));
                    *largest = greater(*largest, share * greater(along, across));
                }
            }
        }
    }
    all
}
