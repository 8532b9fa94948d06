//! What the ground of a cell may do between its samples.
//!
//! Of noise nothing tells that but what it does from sample to sample: ε, the largest second difference of neighbouring
//! samples. It serves twice. Errors are taken over triangles larger than the steps, to which little is added:
//! [`TAIL`] ε. Intervals are of the samples alone, so that all of what lies beyond them has to be added: [`BEYOND`] ε.
//!
//! Intervals are cut with those of the cells above, so that what is missing in one of a cell a kilometre wide is missing in
//! all below it. With [`TAIL`] ε some summits of a massif stood 85 m above their intervals: who stood on one was
//! nowhere near it by these numbers, or did not see it at all, and the ground at their feet was 20 times the bound off.

use bevy::math::IVec2;
use dolomite_terrain::{GroundRect, Terrain};

use super::errors::TAIL;
use super::place::BlockPlace;
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
        let own = bends(&[(heights, 1.0)]);
        let mut all = Self {
            tails: bends(surfaces),
            extremes: vec![EMPTY; WIDE * WIDE],
            beyond: own,
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
            let cell = place.cell_at(at - AROUND);
            let mut alone = 0.0;
            if lattice.holds(cell) {
                let [min, max] = [0, 2].map(|k| lattice.point(cell.corner(k)).to_dvec2());
                let spacing = (max - min).max_element() / STEPS as f64;
                alone = terrain.unseen(&GroundRect::new(min, max), spacing);
            }
            let bend = all.beyond[k];
            all.beyond[k] = BEYOND * bend + alone;
            let tail = TAIL * all.tails[k] + alone;
            // Where samples are under water ground may rise out of it between them: by no more than it may
            // differ, and no higher than it may be.
            let dry = if low < sea {
                (TAIL * bend + alone).min(high + all.beyond[k] - sea)
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
