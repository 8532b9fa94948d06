//! How far a part of a map is from any plane: what samples that stand apart may miss between them.
//!
//! A window of level k begins at a multiple of 2ᵏ samples and is 2ᵏ⁺¹ long, so that every square of at most
//! 2ᵏ samples lies in one. For each the least D is kept, over offsets, such that the samples stay within D
//! of a plane with the mean slope of the window's sides. Between three heights of the surface in a window
//! the plane through them is within D of that plane too, so it misses the surface there by 2·D at most.
//!
//! Bilinear heights are weighted means of samples. Catmull-Rom reaches one sample farther, with weights
//! whose absolute values sum to 5/4 along each axis (see `pyramid.rs`): windows take in one sample more on
//! every side, and D counts 25/16.

use super::{Filter, HeightMap};
use bevy::tasks::{ComputeTaskPool, TaskPool};

/// The windows of a level, row by row.
#[derive(Debug)]
pub(crate) struct Level {
    /// Windows along x; their first begins 2ᵏ samples before the map.
    pub width: usize,
    pub windows: Vec<f32>,
}

/// The level whose windows are as large as a map of so many samples.
fn last_level([width, height]: [usize; 2]) -> usize {
    let last = (1..).find(|&k| (1_usize << k) + 1 >= width.max(height));
    last.unwrap_or(1)
}

impl HeightMap {
    /// Words that a GPU holds of it: samples and windows.
    pub(crate) fn gpu_words(&self) -> u64 {
        if let Some(stream) = self.stream() {
            return stream.gpu_words();
        }
        let sides = [self.width(), self.height()].map(|n| n as usize);
        let levels = (1..=last_level(sides)).map(|k| sides.map(|n| windows(n, k) as u64));
        let windows: u64 = levels.map(|[columns, rows]| columns * rows).sum();
        self.samples().len() as u64 + windows
    }
}

/// Levels 1 and up; the last has windows as large as the map.
#[derive(Debug)]
pub(crate) struct Deviations(Vec<Level>);

/// How many windows of level `k` there are along a side of so many samples.
const fn windows(samples: usize, k: usize) -> usize {
    ((samples - 1) >> k) + 2
}

impl Deviations {
    pub(super) fn new(map: &HeightMap) -> Self {
        let [width, height] = [map.width(), map.height()].map(|n| n as usize);
        let levels = (1..=last_level([width, height])).map(|k| {
            let [columns, rows] = [width, height].map(|n| windows(n, k));
            let mut windows = vec![0.0; columns * rows];
            let pool = ComputeTaskPool::get_or_init(TaskPool::default);
            pool.scope(|scope| {
                for (row, out) in windows.chunks_mut(columns).enumerate() {
                    scope.spawn(async move {
                        for (column, out) in out.iter_mut().enumerate() {
                            *out = deviation(map, k, [column, row]);
                        }
                    });
                }
            });
            Level {
                width: columns,
                windows,
            }
        });
        Self(levels.collect())
    }

    pub(crate) fn levels(&self) -> &[Level] {
        &self.0
    }

    /// What may lie between samples of the surface that stand `spacing` apart, over the square from `low`
    /// to `high`; all in units of the map's samples. `None`: more than the map's windows tell.
    pub(super) fn missed(&self, low: [f64; 2], high: [f64; 2], spacing: f64) -> Option<f32> {
        let k = (1..=self.0.len()).find(|&k| (1_u64 << k) as f64 >= spacing)?;
        let level = &self.0[k - 1];
        let size = (1_u64 << k) as f64;
        let rows = level.windows.len() / level.width;
        // The first window is number −1.
        let first = |low: f64, count: usize| {
            ((low / size).floor() + 1.0).clamp(0.0, count as f64 - 1.0) as usize
        };
        let last =
            |high: f64, count: usize| (high / size).ceil().clamp(0.0, count as f64 - 1.0) as usize;
        let mut largest = 0.0_f32;
        for z in first(low[1], rows)..=last(high[1], rows) {
            let row = &level.windows[z * level.width..][..level.width];
            for &window in &row[first(low[0], level.width)..=last(high[0], level.width)] {
                largest = largest.max(window);
            }
        }
        Some(2.0 * largest)
    }
}

/// D of a window of level `k`, metres, rounded up.
fn deviation(map: &HeightMap, k: usize, [column, row]: [usize; 2]) -> f32 {
    let [width, height] = [map.width(), map.height()].map(i64::from);
    let samples = map.samples();
    let at = |x: i64, z: i64| {
        let (x, z) = (x.clamp(0, width - 1), z.clamp(0, height - 1));
        f64::from(samples[(z * width + x) as usize])
    };
    let (margin, share) = match map.filter() {
        Filter::Bilinear => (0, 1.0),
        Filter::Bicubic => (1, 25.0 / 16.0),
    };
    let begin = |n: usize| ((n as i64 - 1) << k) - margin;
    let side = (2_i64 << k) + 2 * margin;
    let (x0, z0) = (begin(column), begin(row));
    let corners = [
        at(x0, z0),
        at(x0 + side, z0),
        at(x0, z0 + side),
        at(x0 + side, z0 + side),
    ];
    let half = 0.5 / side as f64;
    let along_x = (corners[1] - corners[0] + corners[3] - corners[2]) * half;
    let along_z = (corners[2] - corners[0] + corners[3] - corners[1]) * half;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for z in 0..=side {
        for x in 0..=side {
            let off = at(x0 + x, z0 + z) - along_x * x as f64 - along_z * z as f64;
            low = low.min(off);
            high = high.max(off);
        }
    }
    // Rounded to f32 by up to 6e-8.
    (0.5 * (high - low) * share * (1.0 + 1e-7)) as f32
}

#[cfg(test)]
mod tests {
    use crate::{Filter, GroundRect, HeightMap};
    use bevy::math::DVec2;

    fn map(filter: Filter, height: impl Fn(u32, u32) -> f32) -> HeightMap {
        let samples = (0..61 * 47).map(|k| height(k % 61, k / 61)).collect();
        let spacing = DVec2::new(3.0, 2.0);
        HeightMap::new(61, 47, samples, DVec2::new(-50.0, 20.0), spacing, filter).expect("valid")
    }

    fn noise(x: u32, z: u32) -> f32 {
        let mut h = x.wrapping_mul(0x9e37_79b9) ^ z.wrapping_mul(0x85eb_ca6b);
        h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
        (h >> 8) as f32 / (1 << 24) as f32
    }

    #[test]
    fn a_plane_is_never_missed() {
        for filter in [Filter::Bilinear, Filter::Bicubic] {
            let map = map(filter, |x, z| 3.0 * x as f32 - 2.0 * z as f32);
            let inside = GroundRect::new(DVec2::new(0.0, 40.0), DVec2::new(64.0, 72.0));
            // Two roundings of heights of 180 m in f64, one of D.
            assert!(map.missed(&inside, 16.0) < 1e-4);
        }
    }

    /// The plane through the corners of half a square between samples of the surface, anywhere.
    #[test]
    fn nothing_between_samples_is_missed_by_more() {
        for filter in [Filter::Bilinear, Filter::Bicubic] {
            let map = map(filter, |x, z| {
                let lone = if (x, z) == (40, 9) { 30.0 } else { 0.0 };
                lone + 4.0 * noise(x, z) + 0.01 * (x * x) as f32
            });
            let height = |p: DVec2| map.sample_f64(p).height;
            let mut tightest: f64 = 0.0;
            for k in 0..3000 {
                let unit = |salt| f64::from(noise(k, salt));
                let spacing = [3.1, 5.0, 8.0, 14.0, 33.0, 90.0][k as usize % 6];
                let low = DVec2::new(-80.0 + 210.0 * unit(1), 0.0 + 130.0 * unit(2));
                let rect = GroundRect::new(low, low + spacing);
                let bound = f64::from(map.missed(&rect, spacing));
                let corners = [low, low + DVec2::new(spacing, 0.0), low + spacing].map(height);
                for j in 0..40 {
                    let (u, v) = (unit(100 + j), unit(200 + j));
                    let (u, v) = (u.max(v), u.min(v));
                    let plane = corners[0] * (1.0 - u) + corners[1] * (u - v) + corners[2] * v;
                    let off = (height(low + DVec2::new(u, v) * spacing) - plane).abs();
                    assert!(off <= bound + 1e-9, "{filter:?} {spacing}: {off} > {bound}");
                    tightest = tightest.max(off / bound);
                }
            }
            assert!(tightest > 0.4, "{tightest}");
        }
    }
}
