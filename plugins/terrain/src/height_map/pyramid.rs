//! What a part of a map can reach, without looking at each sample.
//!
//! For blocks of 4 × 4 samples, and blocks of 2 × 2 blocks above them, the extremes of the samples
//! and of their differences. From these, bounds of the interpolated height, slope and bend follow:
//!
//! * bilinear: heights are weighted means of samples; slopes are means of first differences.
//! * Catmull-Rom along one axis, with first differences d and second differences e of the
//!   samples: the weights sum to 1 and their absolute values to at most 5/4 (at t = ½); the
//!   derivative is Σ cᵢdᵢ with Σ|cᵢ| ≤ 3/2 (at t = ½); the second derivative is
//!   (2 − 3t)e₀ + (3t − 1)e₁, and |2 − 3t| + |3t − 1| ≤ 3 (at the ends). Along two axes the
//!   factors multiply.

use super::{Filter, HeightMap};
use crate::interval::{CellBounds, Interval, SecondOrder};
use bevy::math::DVec2;
use bevy::tasks::{ComputeTaskPool, TaskPool};

/// Extremes of a block. The differences of a sample are those towards larger indices, the second
/// differences those around it; the border samples go on beyond the border.
#[derive(Clone, Copy, Debug)]
struct Extremes {
    low: f32,
    high: f32,
    /// Largest |first difference| along x, z.
    step: [f32; 2],
    /// Largest |second difference| along x, z, and mixed.
    bend: [f32; 3],
}

impl Extremes {
    const NONE: Self = Self {
        low: f32::INFINITY,
        high: f32::NEG_INFINITY,
        step: [0.0; 2],
        bend: [0.0; 3],
    };

    fn join(&mut self, other: &Self) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
        for (a, b) in self.step.iter_mut().zip(other.step) {
            *a = a.max(b);
        }
        for (a, b) in self.bend.iter_mut().zip(other.bend) {
            *a = a.max(b);
        }
    }
}

/// Samples along the side of a lowest block: 4, and 8 of maps that are larger than a GPU is sure to bind, so that their
/// pyramid takes a seventh of the samples' memory and not three fifths.
const fn block_side(samples: usize) -> usize {
    if samples > 1 << 25 { 8 } else { 4 }
}

#[derive(Debug)]
struct Level {
    width: usize,
    height: usize,
    blocks: Vec<Extremes>,
}

/// Extremes of ever larger blocks. Takes 7/16 + 1/3 of that of the samples' memory (7/64 + 1/3 of that of large maps).
#[derive(Debug)]
pub(super) struct Pyramid {
    /// Samples along the side of a lowest block.
    block: usize,
    levels: Vec<Level>,
}

impl Pyramid {
    pub(super) fn new(samples: &[f32], width: usize, height: usize) -> Self {
        if samples.is_empty() {
            let (block, levels) = (1, Vec::new());
            return Self { block, levels };
        }
        let block = block_side(samples.len());
        let lowest = Level {
            width: width.div_ceil(block),
            height: height.div_ceil(block),
            blocks: lowest(samples, width, height, block),
        };
        let mut levels = vec![lowest];
        while let Some(below) = levels
            .last()
            .filter(|level| level.width.max(level.height) > 1)
        {
            let (width, height) = (below.width.div_ceil(2), below.height.div_ceil(2));
            let mut blocks = vec![Extremes::NONE; width * height];
            for (at, block) in below.blocks.iter().enumerate() {
                let (x, z) = (at % below.width, at / below.width);
                blocks[z / 2 * width + x / 2].join(block);
            }
            levels.push(Level {
                width,
                height,
                blocks,
            });
        }
        Self { block, levels }
    }

    /// Extremes over samples `low`..=`high` (column, row), which must lie in the map: of a cover
    /// of at most 3 × 3 blocks.
    fn query(&self, low: [usize; 2], high: [usize; 2]) -> Extremes {
        let [x0, z0] = low.map(|i| i / self.block);
        let [x1, z1] = high.map(|i| i / self.block);
        let mut result = Extremes::NONE;
        for (k, level) in self.levels.iter().enumerate() {
            let (x0, x1, z0, z1) = (x0 >> k, x1 >> k, z0 >> k, z1 >> k);
            if x1 - x0 > 2 || z1 - z0 > 2 {
                continue;
            }
            for z in z0..=z1 {
                for x in x0..=x1 {
                    result.join(&level.blocks[z * level.width + x]);
                }
            }
            break;
        }
        result
    }
}

/// The lowest blocks, from the samples; rows of blocks on all cores.
fn lowest(samples: &[f32], width: usize, height: usize, block: usize) -> Vec<Extremes> {
    let columns = width.div_ceil(block);
    let mut blocks = vec![Extremes::NONE; columns * height.div_ceil(block)];
    let pool = ComputeTaskPool::get_or_init(TaskPool::default);
    // As many rows a task as make its cost small.
    let share = (1 << 18) / width.max(1) / block + 1;
    pool.scope(|scope| {
        for (k, blocks) in blocks.chunks_mut(columns * share).enumerate() {
            scope.spawn(async move {
                for (row, line) in blocks.chunks_mut(columns).enumerate() {
                    let row = (k * share + row) * block;
                    for z in row..(row + block).min(height) {
                        join_row(samples, [width, height], z, line, block);
                    }
                }
            });
        }
    });
    blocks
}

/// Joins the samples of row `z` to their blocks.
fn join_row(
    samples: &[f32],
    [width, height]: [usize; 2],
    z: usize,
    blocks: &mut [Extremes],
    block: usize,
) {
    let row = |z: usize| &samples[z * width..][..width];
    let (above, here, below) = (
        row(z.saturating_sub(1)),
        row(z),
        row((z + 1).min(height - 1)),
    );
    for x in 0..width {
        let (west, east) = (x.saturating_sub(1), (x + 1).min(width - 1));
        let s = here[x];
        let (dx, dz) = (here[east] - s, below[x] - s);
        blocks[x / block].join(&Extremes {
            low: s,
            high: s,
            step: [dx.abs(), dz.abs()],
            bend: [
                (dx - (s - here[west])).abs(),
                (dz - (s - above[x])).abs(),
                ((below[east] - below[x]) - dx).abs(),
            ],
        });
    }
}

impl HeightMap {
    /// Lowest and highest sample, metres.
    #[must_use]
    pub fn extremes(&self) -> [f32; 2] {
        if let Some(stream) = self.stream() {
            return stream.ends();
        }
        let last = [self.width() as usize - 1, self.height() as usize - 1];
        let all = self.over([0; 2], last);
        [all.low, all.high]
    }

    /// Extremes over samples, or over more.
    fn over(&self, low: [usize; 2], high: [usize; 2]) -> Extremes {
        match self.stream() {
            Some(stream) => {
                let found = stream.extremes(low, high);
                Extremes {
                    low: found.low,
                    high: found.high,
                    step: [found.step; 2],
                    // A second difference is one of two first ones.
                    bend: [2.0 * found.step; 3],
                }
            }
            None => self.0.pyramid.query(low, high),
        }
    }

    /// From the lowest to the highest height that the map gives, or a little more, metres.
    pub(crate) fn range(&self) -> f32 {
        let [low, high] = self.extremes();
        let apart = high - low;
        match self.filter() {
            Filter::Bilinear => apart,
            // The weights' absolute values sum to 5/4 along each axis.
            Filter::Bicubic => 1.25 * 1.25 * apart,
        }
    }

    /// Bounds over a rectangle centred on `centre` with half sides `half`, metres.
    pub(crate) fn cell_bounds(&self, centre: DVec2, half: DVec2) -> CellBounds {
        let spacing = self.spacing();
        let reach = |side: f64, axis: usize| {
            let size = [self.width(), self.height()][axis];
            let at = (centre[axis] + side * half[axis] - self.origin()[axis]) / spacing[axis];
            // One cell more than the filter reaches, against rounding at cell borders.
            let (before, after) = match self.filter() {
                Filter::Bilinear => (-1.0, 2.0),
                Filter::Bicubic => (-2.0, 3.0),
            };
            let index = at.floor() + if side < 0.0 { before } else { after };
            index.clamp(0.0, f64::from(size - 1)) as usize
        };
        let found = self.over(
            [reach(-1.0, 0), reach(-1.0, 1)],
            [reach(1.0, 0), reach(1.0, 1)],
        );
        let step = DVec2::new(f64::from(found.step[0]), f64::from(found.step[1])) / spacing;
        let (low, high) = (f64::from(found.low), f64::from(found.high));
        if self.stream().is_some() {
            // The height at the centre may be that of a coarser level: what it is near to tells nothing.
            let (range, factor) = match self.filter() {
                Filter::Bilinear => (0.0, 1.0),
                Filter::Bicubic => ((1.25 * 1.25 - 1.0) * 0.5 * (high - low), 1.5 * 1.25),
            };
            return CellBounds {
                height: Interval::new(low - range, high + range),
                slope: (step * factor).length(),
            };
        }
        let sample = self.sample_f64(centre);
        match self.filter() {
            Filter::Bilinear => {
                let reach = step.dot(half);
                let near = Interval::new(sample.height - reach, sample.height + reach);
                CellBounds {
                    height: near.intersect(Interval::new(low, high)),
                    slope: step.length(),
                }
            }
            Filter::Bicubic => {
                let (middle, range) = ((low + high) * 0.5, (high - low) * 0.5);
                let overshoot = 1.25 * 1.25 * range;
                let wide = Interval::new(middle - overshoot, middle + overshoot);
                let [xx, zz, xz] = found.bend.map(f64::from);
                let second = SecondOrder {
                    xx: 3.0 * 1.25 * xx / (spacing.x * spacing.x),
                    xz: 1.5 * 1.5 * xz / (spacing.x * spacing.y),
                    zz: 3.0 * 1.25 * zz / (spacing.y * spacing.y),
                };
                let near = second.bounds(sample.height, sample.gradient, half);
                CellBounds {
                    height: near.height.intersect(wide),
                    slope: near.slope.min((step * (1.5 * 1.25)).length()),
                }
            }
        }
    }
}
