//! Bounds of fractal sums over the cells of a rectangle.
//!
//! Constants of the noise, lattice units, for gradients g with |g| ≤ 1 in each component. Write
//! U₁ = u(t) for the quintic fade, U₀ = 1 − u, dᵢ = t − i; with m(t) = Σ Uᵢ|dᵢ| ≤ ½,
//! a(t) = Σ |(Uᵢdᵢ)′|, b(t) = Σ |(Uᵢdᵢ)″| the noise being linear in the g gives
//!
//! |n| ≤ m(x) + m(z) ≤ 1,
//! |nₓ| ≤ a(x) + 2u′(x)m(z) ≤ 11/4 (at the cell's centre: 7/8 + 15/8),
//! |nₓₓ| ≤ b(x) + 2|u″(x)|m(z) ≤ 20/√3 (where u″ is largest, 10/√3; b = |u″| there),
//! |nₓ_z| ≤ 2u′(z)a(x) + 2u′(x)a(z) ≤ 6.87 (near x = ½, z = 0.28).
//!
//! A test scans these functions.

use super::Cells;
use super::sum::{ROUNDING, SECOND, State, Unit};
use crate::ground::fixed;
use crate::interval::{CellBounds, Interval};
use crate::noise::points::{self, BLOCK, Positions};
use crate::noise::sum::Fbm;
use crate::noise::tile::{self, Grid, Out};
use crate::noise::{Octave, PreparedFractal, PreparedPermutation, PreparedWarp, Sum};
use bevy::math::DVec2;
use fearless_simd::Level;

/// Bound of |n|.
const VALUE: f64 = 1.0;
/// Bound of |∂n/∂x| and |∂n/∂z|, 1/cell.
const FIRST: f64 = 2.75;
/// As [`ROUNDING`], as a share of amplitude × frequency, for the gradient.
const ROUNDING_FIRST: f64 = 1e-5;

/// Noise of one octave at the centres of the cells: value, and gradient a metre.
type Centres = Vec<(f64, DVec2)>;

/// Where the centres lie.
enum Places {
    Grid(Grid),
    List(Vec<[i64; 2]>),
}

impl Places {
    fn grid(cells: &Cells) -> Self {
        let spacing = cells.half * 2.0;
        Self::Grid(Grid {
            origin: [fixed(cells.first.x), fixed(cells.first.y)],
            spacing: [fixed(spacing.x), fixed(spacing.y)],
            width: cells.n,
        })
    }

    /// Amplitude 1 of the octave at every centre.
    fn noise(&self, octave: &Octave) -> Centres {
        let unit = [octave.unit()];
        let level = Level::new();
        let mut out = Vec::new();
        let mut put = |value: f32, dx: f32, dz: f32| {
            out.push((f64::from(value), DVec2::new(f64::from(dx), f64::from(dz))));
        };
        match self {
            Self::Grid(grid) => {
                let count = grid.width * grid.width;
                let mut planes = [(); 3].map(|()| vec![0.0; count]);
                let [value, dx, dz] = &mut planes;
                let to = Out { value, dx, dz };
                tile::fill_octaves::<Fbm>(level, &unit, 0.0, grid, 0..grid.width, to);
                (0..count).for_each(|i| put(planes[0][i], planes[1][i], planes[2][i]));
            }
            Self::List(list) => {
                for part in list.chunks(BLOCK) {
                    let block = points::octaves::<Fbm>(level, &unit, 0.0, &padded(part));
                    (0..part.len()).for_each(|i| put(block[0][i], block[1][i], block[2][i]));
                }
            }
        }
        out
    }
}

/// A block of at most [`BLOCK`] places, filled up with the last.
fn padded(part: &[[i64; 2]]) -> Positions {
    points::positions(|i| part[i.min(part.len() - 1)])
}

/// An FBM in one cell.
#[derive(Clone, Copy)]
struct Smooth {
    height: Interval,
    /// Largest |∂/∂x|, |∂/∂z|.
    gradient: DVec2,
}

/// FBM over cells of half sides `half`: the octaves that Taylor's theorem serves are added up
/// before it is applied, so that slopes that cancel do cancel.
fn fbm(
    octaves: &[Octave],
    half: DVec2,
    count: usize,
    noise: impl Fn(&Octave) -> Centres,
) -> Vec<Smooth> {
    let mut centres = vec![(0.0, DVec2::ZERO); count];
    let (mut rest, mut turn) = (0.0, DVec2::ZERO);
    let (mut widest, mut steepest) = (0.0, 0.0);
    for octave in octaves {
        let (amplitude, slope) = (octave.amplitude.abs(), octave.slope().abs());
        widest += amplitude * (VALUE + ROUNDING);
        steepest += slope * (FIRST + ROUNDING_FIRST);
        let cells = half * octave.frequency.value();
        let octave_rest = SECOND.rest(cells);
        if octave_rest < VALUE {
            for (sum, (value, gradient)) in centres.iter_mut().zip(noise(octave)) {
                sum.0 += octave.amplitude * value;
                sum.1 += gradient * octave.amplitude;
            }
            rest += amplitude * (octave_rest + ROUNDING);
            turn += (SECOND.turn(cells) + ROUNDING_FIRST) * slope;
        } else {
            rest += amplitude * (VALUE + ROUNDING);
            turn += DVec2::splat(slope * (FIRST + ROUNDING_FIRST));
        }
    }
    let wide = Interval::around(0.0, widest);
    let bound = |(value, gradient): (f64, DVec2)| {
        // Octaves without Taylor are in `turn` as their whole gradient and need no reach.
        let reach = gradient.abs().dot(half) + rest;
        Smooth {
            height: Interval::around(value, reach).intersect(wide),
            gradient: (gradient.abs() + turn).min(DVec2::splat(steepest)),
        }
    };
    centres.into_iter().map(bound).collect()
}

/// One octave over the cells.
fn units(octave: &Octave, half: DVec2, count: usize, places: &Places) -> Vec<Unit> {
    let frequency = octave.frequency.value();
    let first = Interval::around(0.0, frequency * (FIRST + ROUNDING_FIRST));
    let all = Unit {
        value: Interval::around(0.0, VALUE + ROUNDING),
        gradient: [first; 2],
    };
    let cells = half * frequency;
    let rest = SECOND.rest(cells);
    if rest >= VALUE {
        return vec![all; count];
    }
    let turn = (SECOND.turn(cells) + ROUNDING_FIRST) * frequency;
    let bound = |(value, gradient): (f64, DVec2)| Unit {
        value: Interval::around(value, gradient.abs().dot(half) + rest + ROUNDING)
            .intersect(all.value),
        gradient: [
            Interval::around(gradient.x, turn.x).intersect(first),
            Interval::around(gradient.y, turn.y).intersect(first),
        ],
    };
    places.noise(octave).into_iter().map(bound).collect()
}

/// Bounds of a fractal of permutation noise.
pub(super) fn permutation(permutation: &PreparedPermutation, cells: &Cells) -> Vec<CellBounds> {
    let noise = |octave: &Octave| {
        let at = |i| {
            let n = permutation.noise_f64(octave, cells.centre(i));
            (n.value, n.gradient * octave.frequency.value())
        };
        (0..cells.len()).map(at).collect()
    };
    let smooth = fbm(&permutation.octaves, cells.half, cells.len(), noise);
    smooth
        .into_iter()
        .map(|s| CellBounds {
            height: s.height,
            slope: s.gradient.length(),
        })
        .collect()
}

/// Bounds of a fractal.
pub(super) fn fractal(fractal: &PreparedFractal, cells: &Cells) -> Vec<CellBounds> {
    let count = cells.len();
    // The centres of the grid are cut to 2⁻³² m, up to n steps of it.
    let half = cells.half + DVec2::splat(1e-7);
    let grid = Places::grid(cells);
    let Some(warp) = &fractal.warp else {
        return sum(fractal, half, count, &grid);
    };
    let warped = Warped::new(warp, cells, half, &grid);
    let mut bounds = sum(fractal, warped.half, count, &Places::List(warped.places));
    for (bounds, stretch) in bounds.iter_mut().zip(warped.stretch) {
        bounds.slope *= stretch;
    }
    bounds
}

/// Where the cells go under a warp.
struct Warped {
    /// The displaced centres.
    places: Vec<[i64; 2]>,
    /// Half sides that hold the image of every cell about its displaced centre.
    half: DVec2,
    /// Norm of the Jacobian of the displaced position, each cell.
    stretch: Vec<f64>,
}

impl Warped {
    fn new(warp: &PreparedWarp, cells: &Cells, half: DVec2, grid: &Places) -> Self {
        let count = cells.len();
        let noise = |octave: &Octave| grid.noise(octave);
        let x = fbm(&warp.x, half, count, noise);
        let z = fbm(&warp.z, half, count, noise);
        let largest = |w: &[Smooth]| w.iter().fold(DVec2::ZERO, |m, s| m.max(s.gradient));
        let (gx, gz) = (largest(&x), largest(&z));
        // |p + W(p) − c − W(c)| on each axis, and the f32 error of W.
        let reach: f64 = warp.x.iter().map(|octave| octave.amplitude.abs()).sum();
        let half = DVec2::new(half.x + gx.dot(half), half.y + gz.dot(half))
            + DVec2::splat(reach * 2.0 * ROUNDING + 1e-6);
        let centres: Vec<[i64; 2]> = (0..count)
            .map(|i| cells.centre(i))
            .map(|c| [fixed(c.x), fixed(c.y)])
            .collect();
        let places = centres.chunks(BLOCK).flat_map(|part| {
            let moved = points::displaced(Level::new(), warp, &padded(part));
            (0..part.len()).map(move |i| [moved[0][i], moved[1][i]])
        });
        // ‖I + J‖ ≤ 1 + ‖J‖ (Frobenius).
        let norm = |(x, z): (&Smooth, &Smooth)| {
            1.0 + (x.gradient.length_squared() + z.gradient.length_squared()).sqrt()
        };
        Self {
            places: places.collect(),
            half,
            stretch: x.iter().zip(&z).map(norm).collect(),
        }
    }
}

/// Bounds of the sum about the given places.
fn sum(fractal: &PreparedFractal, half: DVec2, count: usize, places: &Places) -> Vec<CellBounds> {
    let octaves = &fractal.octaves;
    if fractal.sum == Sum::Fbm {
        let smooth = fbm(octaves, half, count, |octave| places.noise(octave));
        return smooth
            .into_iter()
            .map(|s| CellBounds {
                height: s.height,
                slope: s.gradient.length(),
            })
            .collect();
    }
    let Some(first) = octaves.first() else {
        return Vec::new();
    };
    let mut states = vec![State::START; count];
    for octave in octaves {
        let relative = octave.slope() / first.slope();
        for (state, unit) in states.iter_mut().zip(units(octave, half, count, places)) {
            match fractal.sum {
                Sum::Ridged => state.ridged(octave, &unit),
                Sum::Eroded => state.eroded(octave, &unit, relative, f64::from(fractal.erosion)),
                Sum::Billow | Sum::Fbm => state.billow(octave, &unit),
            }
        }
    }
    states.into_iter().map(|state| state.sum).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// m, a, b of the module's head at t, with u′ and u″.
    fn parts(t: f64) -> [f64; 5] {
        let u = t * t * t * (t * (6.0 * t - 15.0) + 10.0);
        let u1 = 30.0 * t * t * (1.0 - t) * (1.0 - t);
        let u2 = 60.0 * t * (1.0 - t) * (1.0 - 2.0 * t);
        let m = (1.0 - u) * t + u * (1.0 - t);
        let a = ((1.0 - u) - t * u1).abs() + (u + (t - 1.0) * u1).abs();
        let b = (2.0 * u1 + t * u2).abs() + (2.0 * u1 + (t - 1.0) * u2).abs();
        [m, a, b, u1, u2]
    }

    #[test]
    fn constants_hold_and_are_not_idle() {
        let mut largest = [0.0_f64; 4];
        for i in 0..=500 {
            for j in 0..=500 {
                let [m, a, b, u1, u2] = parts(f64::from(i) / 500.0);
                let [mz, az, _, w1, _] = parts(f64::from(j) / 500.0);
                let found = [
                    m + mz,
                    a + 2.0 * u1 * mz,
                    b + 2.0 * u2.abs() * mz,
                    2.0 * (w1 * a + u1 * az),
                ];
                for (l, f) in largest.iter_mut().zip(found) {
                    *l = l.max(f);
                }
            }
        }
        // Between grid points 1/500 apart the functions change by less than 1e-3 near a maximum.
        for (bound, found) in [VALUE, FIRST, SECOND.xx, SECOND.xz]
            .into_iter()
            .zip(largest)
        {
            assert!(
                found <= bound + 1e-12 && found > bound - 0.02,
                "{bound}: {found}"
            );
        }
    }
}
