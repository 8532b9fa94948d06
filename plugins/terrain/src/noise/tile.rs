//! Many points of a fractal in f32: a regular tile, strip by strip, in native vectors.
//!
//! A tile is separable: the lattice coordinate, fraction and fade of a sample along x depend on its
//! column alone, those along z on its row alone. They are computed once a column and once a row, and the
//! gradients of a strip's lattice points are hashed again only when a row enters another lattice
//! row. What is left for each sample and octave is two blends. The operations on a sample are
//! those of `scalar`, in the same order, so the bits are the same.

use super::coordinate::{cell, fraction};
use super::fractal::PreparedFractal;
use super::hash::row_hash;
use super::lattice::{Ends, Fade, Place, cell_gradients, fade};
use super::octave::Octave;
use super::real::{Real, Wide};
use super::sum::{Kind, STATE, Scale, with_kind};
use fearless_simd::{Level, dispatch, prelude::*};

/// Columns worked on together. 64 samples × 12 numbers × 8 octaves = 24 kB stay in the first-level
/// cache; a multiple of every native vector length.
pub(crate) const STRIP: usize = 64;

/// A regular grid of positions: 32.32 fixed-point metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// Position of column 0, row 0.
    pub origin: [i64; 2],
    /// Distance of columns, of rows.
    pub spacing: [i64; 2],
    /// Columns.
    pub width: usize,
}

impl Grid {
    /// Coordinate along an axis (0 = x) of the given column or row; wraps.
    #[inline]
    pub(crate) fn position(&self, axis: usize, index: usize) -> i64 {
        self.origin[axis].wrapping_add(self.spacing[axis].wrapping_mul(index as i64))
    }
}

/// Three planes of output, rows one after the other.
pub(crate) struct Out<'a> {
    pub value: &'a mut [f32],
    pub dx: &'a mut [f32],
    pub dz: &'a mut [f32],
}

type Lane = [f32; STRIP];

/// An octave over the columns of a strip.
struct Columns {
    cell: [u32; STRIP],
    fraction: Lane,
    fade: [Lane; 3],
    /// Gradients at the columns' lattice points: x0, z0, x1, z1 of the left, then of the right.
    gradients: [Lane; 8],
    /// The lattice row that `gradients` belong to.
    row: Option<u32>,
}

impl Columns {
    const EMPTY: Self = Self {
        cell: [0; STRIP],
        fraction: [0.0; STRIP],
        fade: [[0.0; STRIP]; 3],
        gradients: [[0.0; STRIP]; 8],
        row: None,
    };
}

/// Where the samples of a row lie in an octave's lattice.
#[derive(Clone, Copy)]
struct Row {
    cell: u32,
    fraction: f32,
}

/// Fills `rows` of the grid, without the fractal's warp (whose samples are not a regular grid).
/// The planes hold `rows.len() × width` numbers.
pub(crate) fn fill(
    fractal: &PreparedFractal,
    grid: &Grid,
    rows: core::ops::Range<usize>,
    out: Out,
) {
    let level = Level::new();
    with_kind!(fractal.sum, K => {
        fill_octaves::<K>(level, &fractal.octaves, fractal.erosion, grid, rows, out);
    });
}

/// The same for a list of octaves and one kind of sum.
pub(crate) fn fill_octaves<K: Kind>(
    level: Level,
    octaves: &[Octave],
    erosion: f32,
    grid: &Grid,
    rows: core::ops::Range<usize>,
    mut out: Out,
) {
    if octaves.is_empty() {
        return;
    }
    let rows: Vec<Row> = rows
        .flat_map(|row| {
            octaves.iter().map(move |octave| {
                let z = octave.frequency.coordinate(grid.position(1, row));
                let z = z.wrapping_add(octave.offset[1]);
                Row {
                    cell: cell(z),
                    fraction: fraction(z),
                }
            })
        })
        .collect();
    let mut columns: Vec<Columns> = octaves.iter().map(|_| Columns::EMPTY).collect();
    for start in (0..grid.width).step_by(STRIP) {
        let strip = Strip {
            octaves,
            rows: &rows,
            erosion,
            grid,
            start,
        };
        dispatch!(level, simd => strip.fill::<_, K>(simd, &mut columns, &mut out));
    }
}

/// What a strip is computed from.
struct Strip<'a> {
    octaves: &'a [Octave],
    rows: &'a [Row],
    erosion: f32,
    grid: &'a Grid,
    /// First column of the tile in this strip.
    start: usize,
}

impl Strip<'_> {
    #[inline(always)]
    fn fill<S: Simd, K: Kind>(&self, simd: S, columns: &mut [Columns], out: &mut Out) {
        for (octave, columns) in self.octaves.iter().zip(columns.iter_mut()) {
            self.enter(simd, octave, columns);
        }
        let width = self.grid.width;
        let count = STRIP.min(width - self.start);
        for (index, rows) in self.rows.chunks_exact(self.octaves.len()).enumerate() {
            let mut state: [Lane; STATE] = K::START.map(|start| [start; STRIP]);
            for (k, (columns, row)) in columns.iter_mut().zip(rows).enumerate() {
                if columns.row != Some(row.cell) {
                    hash_row(simd, columns, row.cell, self.octaves[k].seed);
                }
                add::<S, K>(
                    simd,
                    columns,
                    row.fraction,
                    &self.octaves[k].scale,
                    self.erosion,
                    &mut state,
                );
            }
            let at = index * width + self.start;
            out.value[at..at + count].copy_from_slice(&state[0][..count]);
            out.dx[at..at + count].copy_from_slice(&state[1][..count]);
            out.dz[at..at + count].copy_from_slice(&state[2][..count]);
        }
    }

    /// Coordinates and fades of the strip's columns. Columns past the tile's edge are computed
    /// too and not written out.
    #[inline(always)]
    fn enter<S: Simd>(&self, simd: S, octave: &Octave, columns: &mut Columns) {
        columns.row = None;
        for i in 0..STRIP {
            let x = octave
                .frequency
                .coordinate(self.grid.position(0, self.start + i));
            let x = x.wrapping_add(octave.offset[0]);
            columns.cell[i] = cell(x);
            columns.fraction[i] = fraction(x);
        }
        for i in (0..STRIP).step_by(S::f32s::LEN) {
            let fade = fade(load(simd, &columns.fraction, i));
            store(fade.value, &mut columns.fade[0], i);
            store(fade.first, &mut columns.fade[1], i);
            store(fade.second, &mut columns.fade[2], i);
        }
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, lane: &Lane, i: usize) -> Wide<S> {
    Wide(S::f32s::from_slice(simd, &lane[i..i + S::f32s::LEN]))
}

#[inline(always)]
fn store<S: Simd>(value: Wide<S>, lane: &mut Lane, i: usize) {
    value.0.store_slice(&mut lane[i..i + S::f32s::LEN]);
}

#[inline(always)]
fn load_ends<S: Simd>(simd: S, from: &[Lane; 8], first: usize, i: usize) -> Ends<Wide<S>> {
    Ends {
        x0: load(simd, &from[first], i),
        z0: load(simd, &from[first + 1], i),
        x1: load(simd, &from[first + 2], i),
        z1: load(simd, &from[first + 3], i),
    }
}

#[inline(always)]
fn store_ends<S: Simd>(ends: &Ends<Wide<S>>, to: &mut [Lane; 8], first: usize, i: usize) {
    store(ends.x0, &mut to[first], i);
    store(ends.z0, &mut to[first + 1], i);
    store(ends.x1, &mut to[first + 2], i);
    store(ends.z1, &mut to[first + 3], i);
}

/// Hashes the lattice points on both sides of lattice row `row`.
#[inline(always)]
fn hash_row<S: Simd>(simd: S, columns: &mut Columns, row: u32, seed: u32) {
    columns.row = Some(row);
    let row0 = S::u32s::splat(simd, row_hash(row, seed));
    let row1 = S::u32s::splat(simd, row_hash(row.wrapping_add(1), seed));
    for i in (0..STRIP).step_by(S::f32s::LEN) {
        let cells = S::u32s::from_slice(simd, &columns.cell[i..i + S::f32s::LEN]);
        let ends = cell_gradients::<Wide<S>>(cells, row0, row1);
        store_ends(&ends[0], &mut columns.gradients, 0, i);
        store_ends(&ends[1], &mut columns.gradients, 4, i);
    }
}

/// Adds one octave to the state of a row of the strip.
#[inline(always)]
fn add<S: Simd, K: Kind>(
    simd: S,
    columns: &Columns,
    fz: f32,
    scale: &Scale,
    erosion: f32,
    state: &mut [Lane; STATE],
) {
    let w = fade(fz);
    let fz = Wide::<S>(S::f32s::splat(simd, fz));
    let w = Fade {
        value: fz.like(w.value),
        first: fz.like(w.first),
        second: fz.like(w.second),
    };
    for i in (0..STRIP).step_by(S::f32s::LEN) {
        let left = load_ends(simd, &columns.gradients, 0, i);
        let right = load_ends(simd, &columns.gradients, 4, i);
        let fx = load(simd, &columns.fraction, i);
        let u = Fade {
            value: load(simd, &columns.fade[0], i),
            first: load(simd, &columns.fade[1], i),
            second: load(simd, &columns.fade[2], i),
        };
        let place = Place::new([left, right], (fx, u), (fz, w));
        let mut lanes = [fx.like(0.0); STATE];
        for k in 0..K::USED {
            lanes[k] = load(simd, &state[k], i);
        }
        K::step(&mut lanes, &place, scale, erosion);
        for k in 0..K::USED {
            store(lanes[k], &mut state[k], i);
        }
    }
}
