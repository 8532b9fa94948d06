//! Heights of many places at once: tiles and lists, on one core or on all.
//!
//! The bits are those of [`Terrain::sample`] for each place, for any number of threads and any
//! instruction set. On one core of a machine with 512-bit vectors an 8-octave FBM tile costs some
//! 6 ns a sample, value and gradient together; a list some five times that, one point by itself
//! thirty times.

use crate::ground::{GroundPoint, Height, fixed};
use crate::noise::PreparedFractal;
use crate::noise::points::{self, BLOCK};
use crate::noise::tile::{self, Grid, Out};
use crate::terrain::{MaskStep, Prepared, Terrain};
use bevy::math::{DVec2, Vec2};
use bevy::tasks::{ComputeTaskPool, TaskPool};
use fearless_simd::{Level, dispatch};
use thiserror::Error;

/// A regular grid of places: sample (column, row) lies at origin + (column, row) × spacing, columns
/// along +X, rows along +Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeightTile {
    /// Place of column 0, row 0.
    pub origin: GroundPoint,
    /// Distance of columns and of rows, metres; taken to the nearest 2⁻³² m below.
    pub spacing: DVec2,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl HeightTile {
    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.width.saturating_mul(self.height)
    }

    /// Whether there is no sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The place of a sample.
    #[must_use]
    pub fn point(&self, column: usize, row: usize) -> GroundPoint {
        let grid = self.grid();
        GroundPoint::from_fixed([grid.position(0, column), grid.position(1, row)])
    }

    fn grid(&self) -> Grid {
        let spacing = [fixed(self.spacing.x), fixed(self.spacing.y)];
        Grid {
            origin: self.origin.to_fixed(),
            spacing,
            width: self.width,
        }
    }
}

/// Where a batch writes: one number a sample in each plane, row after row.
#[derive(Debug)]
pub struct Planes<'a> {
    /// Heights, metres.
    pub value: &'a mut [f32],
    /// ∂height/∂x.
    pub dx: &'a mut [f32],
    /// ∂height/∂z.
    pub dz: &'a mut [f32],
}

/// A batch that cannot be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("a plane holds {found} numbers, but the batch has {expected} samples")]
pub struct BatchError {
    /// Samples of the batch.
    pub expected: usize,
    /// Length of the first plane that differs.
    pub found: usize,
}

impl<'a> Planes<'a> {
    fn check(&self, expected: usize) -> Result<(), BatchError> {
        for found in [self.value.len(), self.dx.len(), self.dz.len()] {
            if found != expected {
                return Err(BatchError { expected, found });
            }
        }
        Ok(())
    }

    /// Parts of at most `length` samples each, in order.
    fn parts(self, length: usize) -> impl Iterator<Item = Planes<'a>> {
        let value = self.value.chunks_mut(length);
        let dx = self.dx.chunks_mut(length);
        let dz = self.dz.chunks_mut(length);
        value
            .zip(dx)
            .zip(dz)
            .map(|((value, dx), dz)| Planes { value, dx, dz })
    }

    fn set(&mut self, index: usize, height: Height) {
        self.value[index] = height.value;
        self.dx[index] = height.gradient.x;
        self.dz[index] = height.gradient.y;
    }

    /// Adds as many samples under a mask, each as [`MaskStep::apply`] does: loops that compilers put into
    /// vectors.
    #[inline(always)]
    fn add(&mut self, mask: MaskStep, added: &Planes) {
        let count = self.value.len();
        let (value, dx, dz) = (&mut *self.value, &mut *self.dx, &mut *self.dz);
        let (dx, dz) = (&mut dx[..count], &mut dz[..count]);
        let (more, more_dx) = (&added.value[..count], &added.dx[..count]);
        let more_dz = &added.dz[..count];
        for i in 0..count {
            let below = Height {
                value: value[i],
                gradient: Vec2::new(dx[i], dz[i]),
            };
            let above = Height {
                value: more[i],
                gradient: Vec2::new(more_dx[i], more_dz[i]),
            };
            let sum = mask.apply(below, above);
            value[i] = sum.value;
            dx[i] = sum.gradient.x;
            dz[i] = sum.gradient.y;
        }
    }
}

/// Rows handed to one task of the all-core functions: enough that a task lasts some 100 µs.
const ROWS_PER_TASK: usize = 32;
/// Samples worked on together where layers are added up: they stay in the first-level cache.
const PART: usize = 1024;

/// Anything a batch can be filled from.
trait Batch: Sync {
    /// Fills `rows` of the grid; the planes hold exactly these rows.
    fn rows(&self, grid: &Grid, rows: core::ops::Range<usize>, out: &mut Planes);
    /// Fills a list of places.
    fn list(&self, points: &[GroundPoint], out: &mut Planes);
}

impl Batch for PreparedFractal {
    fn rows(&self, grid: &Grid, rows: core::ops::Range<usize>, out: &mut Planes) {
        if self.warp.is_none() {
            let Planes { value, dx, dz } = out;
            return tile::fill(self, grid, rows, Out { value, dx, dz });
        }
        let first = rows.start;
        fill_blocks(self, out, |index| {
            let (row, column) = (first + index / grid.width, index % grid.width);
            [grid.position(0, column), grid.position(1, row)]
        });
    }

    fn list(&self, points: &[GroundPoint], out: &mut Planes) {
        fill_blocks(self, out, |index| points[index].to_fixed());
    }
}

/// Fills the planes block by block with the fractal at `position(index)`; the last block is padded with
/// its last place.
fn fill_blocks(fractal: &PreparedFractal, out: &mut Planes, position: impl Fn(usize) -> [i64; 2]) {
    let level = Level::new();
    let count = out.value.len();
    for start in (0..count).step_by(BLOCK) {
        let place = |i: usize| position((start + i).min(count - 1));
        let positions = points::positions(place);
        let [value, dx, dz] = points::block(level, fractal, &positions);
        let taken = BLOCK.min(count - start);
        out.value[start..start + taken].copy_from_slice(&value[..taken]);
        out.dx[start..start + taken].copy_from_slice(&dx[..taken]);
        out.dz[start..start + taken].copy_from_slice(&dz[..taken]);
    }
}

impl Batch for Terrain {
    fn rows(&self, grid: &Grid, rows: core::ops::Range<usize>, out: &mut Planes) {
        // Few rows at a time, so that a layer's planes stay in the cache until they are added.
        let step = (PART / grid.width).clamp(1, rows.len().max(1));
        let planes = Planes {
            value: out.value,
            dx: out.dx,
            dz: out.dz,
        };
        for (start, mut part) in rows
            .clone()
            .step_by(step)
            .zip(planes.parts(step * grid.width))
        {
            let rows = start..rows.end.min(start + step);
            self.layers(&mut part, |source, out| match source {
                Prepared::Fractal(fractal) => fractal.rows(grid, rows.clone(), out),
                other => each(other, out, |index| {
                    let (row, column) = (rows.start + index / grid.width, index % grid.width);
                    GroundPoint::from_fixed([grid.position(0, column), grid.position(1, row)])
                }),
            });
        }
    }

    fn list(&self, points: &[GroundPoint], out: &mut Planes) {
        let planes = Planes {
            value: out.value,
            dx: out.dx,
            dz: out.dz,
        };
        for (points, mut part) in points.chunks(PART).zip(planes.parts(PART)) {
            self.layers(&mut part, |source, out| match source {
                Prepared::Fractal(fractal) => fractal.list(points, out),
                other => each(other, out, |index| points[index]),
            });
        }
    }
}

/// Fills the planes with a source that has no vector form, place by place.
fn each(source: &Prepared, out: &mut Planes, point: impl Fn(usize) -> GroundPoint) {
    for index in 0..out.value.len() {
        out.set(index, source.sample(point(index)));
    }
}

impl Terrain {
    /// Adds up the layers over one part; `fill` writes a source's own heights.
    fn layers(&self, out: &mut Planes, fill: impl Fn(&Prepared, &mut Planes)) {
        out.value.fill(self.data().base);
        out.dx.fill(0.0);
        out.dz.fill(0.0);
        let count = out.value.len();
        let mut scratch = vec![0.0; 3 * count];
        for (source, mask) in self.prepared() {
            let mask = MaskStep::new(mask);
            // A source that counts nowhere here is not evaluated.
            if out.value.iter().all(|&below| mask.hides(below)) {
                continue;
            }
            let (value, rest) = scratch.split_at_mut(count);
            let (dx, dz) = rest.split_at_mut(count);
            let mut added = Planes { value, dx, dz };
            fill(source, &mut added);
            dispatch!(Level::new(), _simd => out.add(mask, &added));
        }
    }
}

/// Fills a tile on this thread.
fn fill_tile(batch: &impl Batch, tile: &HeightTile, mut out: Planes) -> Result<(), BatchError> {
    out.check(tile.len())?;
    if !tile.is_empty() {
        batch.rows(&tile.grid(), 0..tile.height, &mut out);
    }
    Ok(())
}

/// Fills a tile by the threads of a pool: bands of rows, each written by one task.
fn fill_tile_on(
    batch: &impl Batch,
    pool: &TaskPool,
    tile: &HeightTile,
    out: Planes,
) -> Result<(), BatchError> {
    out.check(tile.len())?;
    if tile.is_empty() {
        return Ok(());
    }
    let grid = tile.grid();
    pool.scope(|scope| {
        let starts = (0..tile.height).step_by(ROWS_PER_TASK);
        for (start, mut part) in starts.zip(out.parts(ROWS_PER_TASK * tile.width)) {
            let rows = start..tile.height.min(start + ROWS_PER_TASK);
            scope.spawn(async move { batch.rows(&grid, rows, &mut part) });
        }
    });
    Ok(())
}

/// Fills a list on this thread.
fn fill_points(
    batch: &impl Batch,
    points: &[GroundPoint],
    mut out: Planes,
) -> Result<(), BatchError> {
    out.check(points.len())?;
    batch.list(points, &mut out);
    Ok(())
}

macro_rules! batch_methods {
    ($($type:ty),*) => {$(
        impl $type {
            /// Heights and gradients of a tile, on this thread.
            ///
            /// # Errors
            /// A plane whose length is not the number of samples.
            pub fn fill_tile(&self, tile: &HeightTile, out: Planes) -> Result<(), BatchError> {
                fill_tile(self, tile, out)
            }

            /// The same on all cores (Bevy's compute task pool, started if need be): the same
            /// bits.
            ///
            /// # Errors
            /// As above.
            pub fn fill_tile_parallel(&self, tile: &HeightTile, out: Planes) -> Result<(), BatchError> {
                let pool = ComputeTaskPool::get_or_init(TaskPool::default);
                fill_tile_on(self, pool, tile, out)
            }

            /// The same by this thread and those of `pool`: the same bits. What is made in the background takes
            /// Bevy's `AsyncComputeTaskPool`: of the compute task pool the systems of every frame have need, and wait
            /// behind what it has been given before.
            ///
            /// # Errors
            /// As above.
            pub fn fill_tile_on(
                &self,
                pool: &TaskPool,
                tile: &HeightTile,
                out: Planes,
            ) -> Result<(), BatchError> {
                fill_tile_on(self, pool, tile, out)
            }

            /// Heights and gradients of a list of places, on this thread.
            ///
            /// # Errors
            /// A plane whose length is not the number of places.
            pub fn fill_points(&self, points: &[GroundPoint], out: Planes) -> Result<(), BatchError> {
                fill_points(self, points, out)
            }
        }
    )*};
}
batch_methods!(Terrain, PreparedFractal);
