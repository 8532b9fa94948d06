//! How far a triangle between samples is from them.
//!
//! Differences to the right-angled corner are taken first: neighbouring heights differ by little, so that they are
//! nearly exact, and the weights are multiples of ⅛. Both blocks beside an edge do the same arithmetic.

use super::place::CELLS;

/// Steps between samples along a side of a cell.
pub const STEPS: usize = 4;
/// Cells of the ring about a block that samples cover, on one side.
pub const AROUND: i32 = 3;
/// Cells along a side with that ring.
pub const WIDE: usize = CELLS as usize + 2 * AROUND as usize;
/// Samples along a side.
pub const SAMPLES: usize = WIDE * STEPS + 1;
/// Samples of a block.
pub const SAMPLE_COUNT: usize = SAMPLES * SAMPLES;

/// The greater; what is not a number counts as nothing.
#[must_use]
pub const fn greater(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

/// One surface at the samples.
#[derive(Clone, Copy)]
pub struct Surface<'a>(pub &'a [f32]);

impl Surface<'_> {
    pub(super) fn at(self, i: usize, j: usize) -> f32 {
        self.0[j * SAMPLES + i]
    }

    /// Largest distance of samples from the half of a cell, right angle at `corner`, legs of `n` steps in the
    /// directions `east` and `south` (else west, north).
    pub(super) fn half(self, corner: [usize; 2], n: usize, east: bool, south: bool) -> f32 {
        let along = |c: usize, k: usize, up: bool| if up { c + k } else { c - k };
        let at =
            |k: usize, l: usize| self.at(along(corner[0], k, east), along(corner[1], l, south));
        let (base, unit) = (at(0, 0), 1.0 / n as f32);
        let (x, z) = (at(n, 0) - base, at(0, n) - base);
        let mut largest = 0.0;
        for l in 0..=n {
            for k in 0..=n - l {
                let off = (at(k, l) - base) - (k as f32 * unit) * x - (l as f32 * unit) * z;
                largest = greater(largest, off.abs());
            }
        }
        largest
    }

    /// The same of the triangle with its right angle at `apex` and its long side `half` steps away on a side of
    /// it: 0 west, 1 north, 2 east, 3 south.
    pub(super) fn side(self, apex: [usize; 2], half: usize, side: usize) -> f32 {
        // At distance r from the apex, t steps along from the lesser end.
        let at = |r: usize, t: usize| {
            let along = |c: usize| c + t - r;
            match side {
                0 => self.at(apex[0] - r, along(apex[1])),
                1 => self.at(along(apex[0]), apex[1] - r),
                2 => self.at(apex[0] + r, along(apex[1])),
                _ => self.at(along(apex[0]), apex[1] + r),
            }
        };
        let (base, unit) = (at(0, 0), 0.5 / half as f32);
        let (a, b) = (at(half, 0) - base, at(half, 2 * half) - base);
        let mut largest = 0.0;
        for r in 1..=half {
            for t in 0..=2 * r {
                let (to_a, to_b) = ((2 * r - t) as f32 * unit, t as f32 * unit);
                let off = (at(r, t) - base) - to_a * a - to_b * b;
                largest = greater(largest, off.abs());
            }
        }
        largest
    }

    /// Own error of a triangle with the ends of its long side last, if samples do not stand evenly in it, as
    /// the vertex `middle` that cuts it sees it. Halving is done on the lattice: there the middle of a side is
    /// not its middle in the world, and a sample may lie in the next triangle. So every sample counts that lies
    /// in the triangle in the world or on the lattice; and how far the mean of the ends, from which the middle
    /// comes, is from the triangle where that stands.
    pub(super) fn uneven(
        self,
        rulers: &[Vec<f32>; 2],
        corners: [[i32; 2]; 3],
        middle: [i32; 2],
    ) -> Option<f32> {
        let low = [0, 1].map(|k| corners.iter().map(|c| c[k]).fold(i32::MAX, i32::min));
        let high = [0, 1].map(|k| corners.iter().map(|c| c[k]).fold(i32::MIN, i32::max));
        let at = |k: usize, c: i32| rulers[k][c as usize];
        let is_even = |k: usize| {
            let step = at(k, low[k] + 1) - at(k, low[k]);
            (low[k]..high[k]).all(|c| (at(k, c + 1) - at(k, c) - step).abs() < 1e-3)
        };
        if is_even(0) && is_even(1) {
            return None;
        }
        // Twice the area beside a side, in the world and on the lattice.
        let world = |c: [i32; 2]| [at(0, c[0]), at(1, c[1])];
        let lattice = |c: [i32; 2]| c.map(|c| c as f32);
        let weights = |of: &dyn Fn([i32; 2]) -> [f32; 2], p: [i32; 2]| {
            let [a, b, c] = corners.map(of);
            let p = of(p);
            let area = |p: [f32; 2], q: [f32; 2], r: [f32; 2]| {
                (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
            };
            let whole = area(a, b, c);
            [
                area(p, b, c) / whole,
                area(a, p, c) / whole,
                area(a, b, p) / whole,
            ]
        };
        let is_in = |weights: [f32; 3]| weights.iter().all(|&w| w > -1e-4);
        let mut largest = 0.0;
        {
            let height = |c: [i32; 2]| self.at(c[0] as usize, c[1] as usize);
            let base = height(corners[0]);
            let [to_b, to_c] = [height(corners[1]) - base, height(corners[2]) - base];
            let plane = |weights: [f32; 3]| weights[1] * to_b + weights[2] * to_c;
            for z in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    let in_world = weights(&world, [x, z]);
                    if is_in(in_world) || is_in(weights(&lattice, [x, z])) {
                        let off = (height([x, z]) - base) - plane(in_world);
                        largest = greater(largest, off.abs());
                    }
                }
            }
            let mean = 0.5 * (to_b + to_c);
            let off = (mean - plane(weights(&world, middle))).abs();
            // It moves from there to the ground: the sum of both is on the way.
            largest += off;
        }
        Some(largest)
    }
}
