//! Heights between samples of what is in memory, and how true they are.

use super::clip::ClipLevel;
use super::{Stream, read};
use crate::ground::{GroundSample, Height};
use crate::height_map::interpolate::{bicubic, bicubic_f64, bilinear, bilinear_f64};
use crate::height_map::{Filter, HeightMap};
use bevy::math::{DVec2, Vec2};
use dolomite_elevation::unpack_slope;

/// A rectangle that begins or ends so close to a sample, in samples of the map, takes it to be its border: windows reach a whole one
/// farther, and rounding would else add a row of them in f32 and not in f64. The same as in `shaders/src/terrain/clip.wgsl`.
const WITHIN: f64 = 1.0 / 64.0;

/// A cell of a level, and where in it.
struct Cell<T> {
    at: [i32; 2],
    within: [T; 2],
}

impl Stream {
    /// The finest level that has all samples about a cell of level 0, from `before` it to `after` it.
    fn level(levels: &[ClipLevel], [i, j]: [i32; 2], filter: Filter) -> usize {
        let (before, after) = match filter {
            Filter::Bilinear => (0, 1),
            Filter::Bicubic => (1, 2),
        };
        let holds = |&level: &usize| {
            let at = [i, j].map(|n| i64::from(n >> level));
            levels[level].holds(at.map(|n| n - before), at.map(|n| n + after))
        };
        // The last is always there as a whole.
        (0..levels.len()).find(holds).unwrap_or(levels.len() - 1)
    }

    /// Height in metres and gradient a sample, f32.
    pub(in crate::height_map) fn sample(
        &self,
        [i, j]: [i32; 2],
        [fx, fz]: [f32; 2],
        filter: Filter,
    ) -> Height {
        let levels = read(&self.levels);
        let level = Self::level(&levels, [i, j], filter);
        let clip = &levels[level];
        let part = |n: i32, f: f32| {
            let rest = n & ((1 << level) - 1);
            (rest as f32 + f) / (1_u32 << level) as f32
        };
        let cell = Cell {
            at: [i >> level, j >> level],
            within: [part(i, fx), part(j, fz)],
        };
        let [x, z] = cell.at;
        let [u, v] = cell.within;
        let middle = clip.height(x, z);
        let at =
            |di: i32, dj: i32| clip.height(x.saturating_add(di), z.saturating_add(dj)) - middle;
        let mut height = match filter {
            Filter::Bilinear => bilinear(at, u, v),
            Filter::Bicubic => bicubic(at, u, v),
        };
        height.value += middle;
        if level > 0 {
            let slope = |di: i32, dj: i32| clip.slope(x.saturating_add(di), z.saturating_add(dj));
            let [north, south] = [0, 1].map(|dj| {
                let west = slope(0, dj);
                west + (slope(1, dj) - west) * u
            });
            height.gradient = north + (south - north) * v;
        }
        height
    }

    /// The same in f64.
    pub(in crate::height_map) fn sample_f64(
        &self,
        [i, j]: [i32; 2],
        [fx, fz]: [f64; 2],
        filter: Filter,
    ) -> GroundSample {
        let levels = read(&self.levels);
        let level = Self::level(&levels, [i, j], filter);
        let clip = &levels[level];
        let part = |n: i32, f: f64| {
            let rest = n & ((1 << level) - 1);
            (f64::from(rest) + f) / f64::from(1_u32 << level)
        };
        let [x, z] = [i >> level, j >> level];
        let [u, v] = [part(i, fx), part(j, fz)];
        let at =
            |di: i32, dj: i32| f64::from(clip.height(x.saturating_add(di), z.saturating_add(dj)));
        let mut sample = match filter {
            Filter::Bilinear => bilinear_f64(at, u, v),
            Filter::Bicubic => bicubic_f64(at, u, v),
        };
        if level > 0 {
            let slope = |di: i32, dj: i32| {
                clip.slope(x.saturating_add(di), z.saturating_add(dj))
                    .as_dvec2()
            };
            let [north, south] = [0, 1].map(|dj| slope(0, dj).lerp(slope(1, dj), u));
            sample.gradient = north.lerp(south, v);
        }
        sample
    }

    /// How far the height at a cell of level 0 may be from the whole map's, metres: 0 where the finest samples are in memory.
    pub(in crate::height_map) fn error(&self, [i, j]: [i32; 2], filter: Filter) -> f32 {
        let levels = read(&self.levels);
        let level = Self::level(&levels, [i, j], filter);
        if level == 0 {
            return 0.0;
        }
        let clip = &levels[level];
        let at = [i64::from(i >> level), i64::from(j >> level)];
        match filter {
            // Both the surface and what is between four samples of this level are within D of one plane.
            Filter::Bilinear => 2.0 * clip.deviation(at),
            // Catmull-Rom through samples of the level is off bilinear by an eighth of their second differences along one axis and 5/32
            // along the other, and these are four times the deviation of a window at most, without the share of 25/16: 9/8 · 16/25.
            Filter::Bicubic => {
                let windows = [[0, 0], [1, 0], [0, 1], [1, 1]];
                let all = windows.map(|[x, z]| clip.deviation([at[0] - x, at[1] - z]));
                2.72 * all.into_iter().fold(0.0, f32::max)
            }
        }
    }

    /// What samples `apart` may miss, over a rectangle from `low` to `high`, all in samples of the map; `None`: more than is known here.
    pub(in crate::height_map) fn missed(
        &self,
        low: [f64; 2],
        high: [f64; 2],
        apart: f64,
    ) -> Option<f32> {
        let levels = read(&self.levels);
        // A lattice made for the map's own spacing may be wider by a rounding; windows reach a sample farther.
        let first = (1..levels.len()).find(|&k| 1.001 * (1_u64 << k) as f64 >= apart)?;
        for (k, clip) in levels.iter().enumerate().skip(first) {
            let step = (1_u64 << k) as f64;
            let begin = low.map(|n| ((n + WITHIN) / step).floor() as i64);
            let end = high.map(|n| ((n - WITHIN) / step).ceil() as i64 - 1);
            let end = [0, 1].map(|axis| end[axis].max(begin[axis]));
            if !clip.holds(begin, end) {
                continue;
            }
            let mut largest = 0.0_f32;
            for z in begin[1]..=end[1] {
                for x in begin[0]..=end[0] {
                    largest = largest.max(clip.deviation([x, z]));
                }
            }
            return Some(2.0 * largest);
        }
        None
    }
}

impl ClipLevel {
    fn place(&self, column: i64, row: i64) -> usize {
        let cut = |n: i64, k: usize| n.clamp(0, i64::from(self.samples[k]) - 1) as u32;
        self.at([cut(column, 0), cut(row, 1)])
    }

    fn height(&self, column: i32, row: i32) -> f32 {
        self.heights[self.place(column.into(), row.into())]
    }

    fn slope(&self, column: i32, row: i32) -> Vec2 {
        let bits = self.slopes.get(self.place(column.into(), row.into()));
        unpack_slope(bits.copied().unwrap_or(0)).into()
    }

    fn deviation(&self, [column, row]: [i64; 2]) -> f32 {
        let deviation = self.deviations.get(self.place(column, row));
        deviation.copied().unwrap_or(0.0)
    }
}

impl HeightMap {
    /// How far the height that is given at (x, z) may be from that of the whole map, metres: 0 of a map in memory, and of one that is
    /// read by tiles where its finest tiles are there.
    #[must_use]
    pub fn error_at(&self, xz: DVec2) -> f32 {
        let Some(stream) = self.stream() else {
            return 0.0;
        };
        let [x, z] = self.lattice().frequency;
        let at = xz - self.lattice().origin.to_dvec2();
        let (i, _) = x.coordinate_f64(at.x, 0);
        let (j, _) = z.coordinate_f64(at.y, 0);
        stream.error([i, j], self.filter())
    }
}
