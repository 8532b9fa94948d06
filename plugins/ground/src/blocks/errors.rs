//! How far the triangles of a block's cells are from its samples, and how large that may become below the samples.
//!
//! Space: steps between samples, from sample (0, 0) at corner (−3, −3) of the block. Every sample is a vertex
//! of the bisection: a **middle** of a side of cells of n steps, n = 2, 4, 8, or a **centre** of one of 2 or 4.
//! A middle cuts two triangles whose right angles are the centres on both sides; a centre cuts the two halves
//! of its cell, whose right angles are the two middles at its corners.
//!
//! **Nested.** The error of a vertex is the largest of its own triangles, and of all vertices that need it,
//! grown by [`GROWTH`] from each to the next. It has to be taken over vertices: a middle needs the centres on
//! both sides, so either of these errs by what the triangle on the *other* side of the middle errs by. (Nested
//! by triangles alone the error reached 2.2 times the tolerance on the classic map.)

use super::record::GROWTH;
use super::triangle::{AROUND, SAMPLE_COUNT, SAMPLES, STEPS, Surface, WIDE, greater};

/// What may lie between samples, as a multiple of the largest second difference ε of neighbouring samples in a
/// cell: how far a triangle between three neighbours may be from the ground. Its long side is √2 steps, that of the
/// triangles of ε two: a smooth surface errs by ½ ε there, noise whose octaves are as high as they are long by 0.7
/// of what it errs by on the mean, of which ε is the largest of twelve. Beyond that it is a margin, as noise may be
/// calm where it is sampled. With 0.7 the largest of 700 000 errors was 0.88 of the bound, with 0.9 0.71; the
/// classic map takes as many triangles with 0.7 as with 1.
pub const TAIL: f32 = 0.9;
/// Share by which a bed's error counts.
pub const BED_SHARE: f32 = 0.5;

/// The part of the samples that lies on the lattice: first and last, along both axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inside {
    /// First, of columns and rows.
    pub first: [i32; 2],
    /// Last.
    pub last: [i32; 2],
}

impl Inside {
    /// All of them.
    pub const ALL: Self = Self {
        first: [0; 2],
        last: [SAMPLES as i32 - 1; 2],
    };

    const fn holds(&self, at: [i32; 2]) -> bool {
        at[0] >= self.first[0]
            && at[1] >= self.first[1]
            && at[0] <= self.last[0]
            && at[1] <= self.last[1]
    }
}

/// Nested errors of the vertices that stand on samples.
struct Errors<'a> {
    surfaces: &'a [(Surface<'a>, f32)],
    tails: &'a [f32],
    twists: Vec<f32>,
    inside: Inside,
    rulers: Option<&'a [Vec<f32>; 2]>,
    /// By sample.
    all: Vec<f32>,
}

/// Nested errors of vertices, by sample: of the corners −1 to 17 that are mixed, and of the centres of cells −2
/// to 17. `tails` is what may lie between samples in each of the wide cells, metres.
#[must_use]
pub fn nested(
    surfaces: &[(Surface, f32)],
    tails: &[f32],
    inside: Inside,
    rulers: Option<&[Vec<f32>; 2]>,
) -> Vec<f32> {
    let mut errors = Errors {
        surfaces,
        tails,
        twists: twists(surfaces),
        inside,
        rulers,
        all: vec![0.0; SAMPLE_COUNT],
    };
    for half in [1, 2, 4] {
        for j in 0..SAMPLES as i32 {
            for i in 0..SAMPLES as i32 {
                if errors.is_odd([i, j], half) == [true, false]
                    || errors.is_odd([i, j], half) == [false, true]
                {
                    errors.middle([i, j], half);
                }
            }
        }
        if half == STEPS as i32 {
            break;
        }
        let from = (half - OFFSET).rem_euclid(2 * half) as usize;
        for j in (from..SAMPLES).step_by(2 * half as usize) {
            for i in (from..SAMPLES).step_by(2 * half as usize) {
                errors.centre([i as i32, j as i32], half);
            }
        }
    }
    errors.all
}

/// Sample 0 stands so many steps before the block.
const OFFSET: i32 = -(AROUND * STEPS as i32);

impl Errors<'_> {
    /// Whether a sample's coordinates are odd multiples of `half`, true, or even ones, false. What is neither
    /// gives two equal ones.
    fn is_odd(&self, at: [i32; 2], half: i32) -> [bool; 2] {
        let at = at.map(|c| c + OFFSET);
        if at.iter().any(|c| c.rem_euclid(half) != 0) {
            return [false; 2];
        }
        at.map(|c| c.rem_euclid(2 * half) != 0)
    }

    fn known(&self, at: [i32; 2]) -> f32 {
        if Inside::ALL.holds(at) {
            self.all[at[1] as usize * SAMPLES + at[0] as usize]
        } else {
            0.0
        }
    }

    /// What may lie between samples about a vertex: the greatest of the cells that it touches. Those beyond the lattice count:
    /// without them a place beside the border was farther off than its bound.
    fn tail(&self, at: [i32; 2]) -> f32 {
        self.touched(at, self.tails)
    }

    fn touched(&self, at: [i32; 2], of: &[f32]) -> f32 {
        let mut most = 0.0;
        for (x, z) in [(-1, -1), (0, -1), (-1, 0), (0, 0)] {
            let cell = [(at[0] + x).div_euclid(4), (at[1] + z).div_euclid(4)];
            if cell.iter().all(|&c| (0..WIDE as i32).contains(&c)) {
                most = greater(most, of[cell[1] as usize * WIDE + cell[0] as usize]);
            }
        }
        most
    }

    /// The own error of a triangle in which samples do not stand evenly.
    fn uneven(&self, corners: [[i32; 2]; 3], middle: [i32; 2]) -> Option<f32> {
        let rulers = self.rulers?;
        let mut largest = None;
        for (surface, share) in self.surfaces {
            let own = share * surface.uneven(rulers, corners, middle)?;
            largest = Some(greater(largest.unwrap_or(0.0), own));
        }
        largest
    }

    fn put(&mut self, at: [i32; 2], own: f32, finer: f32) {
        let error = greater(own + self.tail(at), GROWTH * finer);
        self.all[at[1] as usize * SAMPLES + at[0] as usize] = error;
    }

    /// A mixed corner of cells of 2 · `half` steps.
    fn middle(&mut self, at: [i32; 2], half: i32) {
        if !self.inside.holds(at) {
            return;
        }
        let along_x = self.is_odd(at, half)[0];
        let (mut own, mut finer) = (0.0, 0.0);
        // The triangles beyond: their apexes, and the side on which the vertex lies of them.
        let beside = if along_x {
            [([at[0], at[1] - half], 3), ([at[0], at[1] + half], 1)]
        } else {
            [([at[0] - half, at[1]], 2), ([at[0] + half, at[1]], 0)]
        };
        for (apex, side) in beside {
            // Its ends lie as far as the apex along the side.
            let ends = if along_x {
                [[at[0] - half, at[1]], [at[0] + half, at[1]]]
            } else {
                [[at[0], at[1] - half], [at[0], at[1] + half]]
            };
            let all = [apex, ends[0], ends[1]];
            if all
                .iter()
                .all(|&at| self.inside.holds(at) && Inside::ALL.holds(at))
            {
                if let Some(uneven) = self.uneven([apex, ends[0], ends[1]], at) {
                    own = greater(own, uneven);
                    continue;
                }
                let apex = apex.map(|c| c as usize);
                for (surface, share) in self.surfaces {
                    own = greater(own, share * surface.side(apex, half as usize, side));
                }
            }
        }
        let quarter = half / 2;
        if quarter == 0 {
            finer = greater(self.tail(at), self.touched(at, &self.twists));
        } else {
            for (x, z) in [(-1, -1), (1, -1), (1, 1), (-1, 1)] {
                finer = greater(
                    finer,
                    self.known([at[0] + x * quarter, at[1] + z * quarter]),
                );
            }
        }
        self.put(at, own, finer);
    }

    /// The centre of a cell of 2 · `half` steps.
    fn centre(&mut self, at: [i32; 2], half: i32) {
        let corner = |x: i32, z: i32| [at[0] + x * half, at[1] + z * half];
        if ![corner(-1, -1), corner(1, 1)]
            .iter()
            .all(|&at| self.inside.holds(at) && Inside::ALL.holds(at))
        {
            return;
        }
        let (mut own, mut finer) = (0.0, 0.0);
        // The diagonal runs through the outer corner: north-west to south-east where both coordinates of the
        // cell are even or both odd.
        let cell = at.map(|c| (c + OFFSET).div_euclid(2 * half));
        let apexes = if (cell[0] + cell[1]) % 2 == 0 {
            [(1, -1), (-1, 1)]
        } else {
            [(-1, -1), (1, 1)]
        };
        for (x, z) in apexes {
            let ends = [corner(-x, z), corner(x, -z)];
            if let Some(uneven) = self.uneven([corner(x, z), ends[0], ends[1]], at) {
                own = greater(own, uneven);
                continue;
            }
            let apex = corner(x, z).map(|c| c as usize);
            for (surface, share) in self.surfaces {
                let off = surface.half(apex, 2 * half as usize, x < 0, z < 0);
                own = greater(own, share * off);
            }
        }
        for (x, z) in [(-1, 0), (0, -1), (1, 0), (0, 1)] {
            finer = greater(finer, self.known([at[0] + x * half, at[1] + z * half]));
        }
        self.put(at, own, finer);
    }
}

/// By how much a bilinear surface between four neighbouring samples differs from its two triangles at most, in
/// each of the wide cells: a quarter of its twist. Of a saddle along the axes no second difference tells.
#[must_use]
pub fn twists(surfaces: &[(Surface, f32)]) -> Vec<f32> {
    let mut all = vec![0.0; WIDE * WIDE];
    for (k, largest) in all.iter_mut().enumerate() {
        let first = [k % WIDE * STEPS, k / WIDE * STEPS];
        for (surface, share) in surfaces {
            let at = |i: usize, j: usize| surface.at(first[0] + i, first[1] + j);
            for j in 0..STEPS {
                for i in 0..STEPS {
                    let north = at(i + 1, j) - at(i, j);
                    let south = at(i + 1, j + 1) - at(i, j + 1);
                    *largest = greater(*largest, share * 0.25 * (south - north).abs());
                }
            }
        }
    }
    all
}
