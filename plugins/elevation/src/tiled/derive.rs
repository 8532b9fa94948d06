//! Coarser levels of a map, from its samples: pure functions of a region.
//!
//! Level k keeps every 2ᵏth sample, the same bits, so that a place that has a sample in two levels has one height. Beside each stands
//! the slope of the finest samples there, and by how much samples of this level miss what lies between:
//!
//! the **deviation** of a sample is D such that the samples of the map from it on, two steps of the level to the east and to the
//! south and one sample of the map more on every side, stay within D of a plane with the mean slope of that window's sides. Between
//! any three heights in the window the plane through them misses the surface by 2·D at most, and the height that is interpolated
//! between the level's own samples does too. Catmull-Rom has weights whose absolute values sum to 25/16: there D counts so much more.

/// Samples along a side of a tile.
pub const TILE: usize = 128;
/// Samples of a tile.
pub const TILE_COUNT: usize = TILE * TILE;
/// Samples that a window reaches beyond two steps of its level, on each side.
const MARGIN: usize = 1;

/// A tile of a level.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TileSamples {
    /// Heights, row by row; [`TILE_COUNT`] of them. Beyond the map its border goes on.
    pub heights: Vec<f32>,
    /// Slopes of the finest samples: two 16-bit floats a sample, east in the low half, height a sample's distance. Empty on level 0,
    /// whose neighbours tell them.
    pub slopes: Vec<u32>,
    /// What lies between the samples of this level is within so much of a plane. Empty on level 0.
    pub deviations: Vec<f32>,
}

/// Samples along a side of the region that a tile of a level with this step is made of: it begins one sample before the tile's first.
pub(super) const fn region_side(step: usize) -> usize {
    (TILE - 1) * step + 2 * step + 2 * MARGIN + 1
}

/// By how much samples may be off a plane in a window of `side` + 1 samples, rounded up.
fn deviation(region: &[f32], width: usize, first: usize, side: usize, ruler: &mut [f32]) -> f32 {
    let corner = |x: usize, z: usize| region[first + z * side * width + x * side];
    let origin = corner(0, 0);
    let [east, south, far] = [corner(1, 0), corner(0, 1), corner(1, 1)].map(|h| h - origin);
    let half = 0.5 / side as f32;
    let along_x = (east + (far - south)) * half;
    let along_z = (south + (far - east)) * half;
    for (k, x) in ruler[..=side].iter_mut().enumerate() {
        *x = along_x * k as f32;
    }
    let (mut low, mut high) = ([f32::INFINITY; 8], [f32::NEG_INFINITY; 8]);
    for z in 0..=side {
        let row = &region[first + z * width..][..=side];
        let down = origin + along_z * z as f32;
        let (eights, rest) = row.as_chunks::<8>();
        let (xs, xs_rest) = ruler[..=side].as_chunks::<8>();
        for (eight, xs) in eights.iter().zip(xs) {
            for k in 0..8 {
                let off = (eight[k] - down) - xs[k];
                low[k] = if off < low[k] { off } else { low[k] };
                high[k] = if off > high[k] { off } else { high[k] };
            }
        }
        for (h, x) in rest.iter().zip(xs_rest) {
            let off = (h - down) - x;
            low[0] = low[0].min(off);
            high[0] = high[0].max(off);
        }
    }
    let low = low.into_iter().fold(f32::INFINITY, f32::min);
    let high = high.into_iter().fold(f32::NEG_INFINITY, f32::max);
    let steep = (along_x.abs() + along_z.abs()) * side as f32;
    // `down` is rounded to the size of the height itself, once a row; the rest to that of the relief.
    let rounding = 1.2e-7 * (origin.abs() + steep) + 5e-7 * ((high - low) + steep);
    0.5 * (high - low) + rounding
}

/// Rows of a region that the deviations of a row of samples are made of.
pub(super) const fn strip_rows(step: usize) -> usize {
    2 * step + 2 * MARGIN + 1
}

/// Deviations of a row of `count` samples every `step`, from a strip of [`strip_rows`] rows, as wide as a region.
pub(super) fn deviations_of(strip: &[f32], step: usize, count: usize, to: &mut Vec<f32>) {
    let width = region_side(step);
    let side = 2 * step + 2 * MARGIN;
    let mut ruler = vec![0.0; side + 1];
    to.extend((0..count).map(|column| deviation(strip, width, column * step, side, &mut ruler)));
}

/// Deviations of samples every `step` of a region of [`region_side`] samples a side, for a whole tile.
pub(super) fn deviations(region: &[f32], step: usize, to: &mut Vec<f32>) {
    let width = region_side(step);
    to.clear();
    for row in 0..TILE {
        let strip = &region[row * step * width..][..strip_rows(step) * width];
        deviations_of(strip, step, TILE, to);
    }
}

/// Two 16-bit floats, rounded to the nearest (relative 2⁻¹¹); beyond 65 504 the largest.
#[must_use]
pub fn pack_slope([east, south]: [f32; 2]) -> u32 {
    u32::from(half(east)) | u32::from(half(south)) << 16
}

/// What [`pack_slope`] packed.
#[must_use]
pub fn unpack_slope(bits: u32) -> [f32; 2] {
    [bits as u16, (bits >> 16) as u16].map(single)
}

fn half(x: f32) -> u16 {
    let sign = ((x.to_bits() >> 16) & 0x8000) as u16;
    let size = x.abs().min(65_504.0);
    // Below the least normal one steps are even: 2⁻²⁴.
    if size < 6.103_515_6e-5 {
        return sign | (size * 16_777_216.0).round_ties_even() as u16;
    }
    let bits = size.to_bits();
    // To the nearest, ties to even, carried into the exponent where it must be; the bias goes from 127 to 15.
    let rounded = bits + 0xfff + ((bits >> 13) & 1);
    sign | ((rounded >> 13) - (112 << 10)).min(0x7bff) as u16
}

fn single(bits: u16) -> f32 {
    let sign = u32::from(bits & 0x8000) << 16;
    let size = u32::from(bits & 0x7fff);
    let value = if size < 0x400 {
        size as f32 / 16_777_216.0
    } else {
        f32::from_bits((size << 13) + (112 << 23))
    };
    f32::from_bits(value.to_bits() | sign)
}

/// A tile of a level with this step, above 1, from its region of the map's samples. `smooth`: slopes are those of Catmull-Rom, else of the
/// cell to the south-east.
pub(super) fn tile_of(region: &[f32], step: usize, smooth: bool) -> TileSamples {
    let width = region_side(step);
    let mut tile = TileSamples {
        heights: Vec::with_capacity(TILE_COUNT),
        slopes: Vec::with_capacity(TILE_COUNT),
        deviations: Vec::with_capacity(TILE_COUNT),
    };
    for row in 0..TILE {
        for column in 0..TILE {
            let at = (row * step + MARGIN) * width + column * step + MARGIN;
            let height = region[at];
            let slope = if smooth {
                [
                    0.5 * (region[at + 1] - region[at - 1]),
                    0.5 * (region[at + width] - region[at - width]),
                ]
            } else {
                [region[at + 1] - height, region[at + width] - height]
            };
            tile.heights.push(height);
            tile.slopes.push(pack_slope(slope));
        }
    }
    deviations(region, step, &mut tile.deviations);
    tile
}

/// By how much the samples of each cell between samples `step` apart are off what is interpolated between those four, rounded up; for
/// [`TILE`] cells along each axis of a tile's region.
pub(super) fn off_bilinear(region: &[f32], step: usize, to: &mut Vec<f32>) {
    let width = region_side(step);
    let share: Vec<f32> = (0..=step).map(|k| k as f32 / step as f32).collect();
    to.clear();
    for row in 0..TILE {
        for column in 0..TILE {
            let first = (row * step + MARGIN) * width + column * step + MARGIN;
            let corner = |x: usize, z: usize| region[first + z * step * width + x * step];
            let origin = corner(0, 0);
            let [east, south, far] = [corner(1, 0), corner(0, 1), corner(1, 1)].map(|h| h - origin);
            let mut most = 0.0_f32;
            for z in 0..=step {
                let west = south * share[z];
                let across = east + (far - south - east) * share[z];
                let line = &region[first + z * width..][..=step];
                for (h, x) in line.iter().zip(&share) {
                    let off = ((h - origin) - (west + across * x)).abs();
                    most = if off > most { off } else { most };
                }
            }
            let relief = east.abs().max(south.abs()).max(far.abs());
            to.push(most + 1e-6 * (relief + most));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(x: usize, z: usize) -> f32 {
        let mut h = (x as u32).wrapping_mul(0x9e37_79b9) ^ (z as u32).wrapping_mul(0x85eb_ca6b);
        h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
        (h >> 8) as f32 / (1 << 24) as f32
    }

    fn region(step: usize, height: impl Fn(usize, usize) -> f32) -> Vec<f32> {
        let side = region_side(step);
        (0..side * side)
            .map(|k| height(k % side, k / side))
            .collect()
    }

    #[test]
    fn halves_are_rounded_to_the_nearest() {
        for k in 0..100_000_u32 {
            let x = f32::from_bits(k.wrapping_mul(0x9e37_79b9));
            if !(x.is_finite() && x.abs() < 65_504.0) {
                continue;
            }
            let [back, same] = unpack_slope(pack_slope([x, x]));
            assert_eq!(back.to_bits(), same.to_bits());
            assert!(
                (back - x).abs() <= x.abs() / 2048.0 + 3e-8,
                "{x} became {back}"
            );
        }
        for x in [0.0, 1.0, -2.5, 65_504.0, 6.103_515_6e-5, 5.960_464_5e-8] {
            assert_eq!(unpack_slope(pack_slope([x, -x])), [x, -x]);
        }
        assert_eq!(unpack_slope(pack_slope([1e9, -1e9])), [65_504.0, -65_504.0]);
    }

    #[test]
    fn a_plane_is_not_missed_and_a_lone_peak_is_by_half_of_it() {
        for step in [1, 2, 8] {
            let plane = region(step, |x, z| 1000.0 + 3.0 * x as f32 - 2.0 * z as f32);
            let mut found = Vec::new();
            deviations(&plane, step, &mut found);
            // Heights of up to 5000 m in f32: steps of 2⁻¹² m.
            assert!(found.iter().all(|d| *d < 0.01), "{step}");
            off_bilinear(&plane, step, &mut found);
            assert!(found.iter().all(|d| *d < 0.01), "{step}");
            let at = 20 * step + step / 2 + 1;
            let peak = region(step, |x, z| if (x, z) == (at, at) { 30.0 } else { 0.0 });
            deviations(&peak, step, &mut found);
            let d = found[20 * TILE + 20];
            assert!((15.0..15.01).contains(&d) || step == 1, "{step}: {d}");
            assert_eq!(found[60 * TILE + 60], 0.0, "far from it");
        }
    }

    /// The plane through any three of a level's heights in a window, and what is interpolated between them.
    #[test]
    fn nothing_between_is_missed_by_more() {
        for step in [2, 4, 8] {
            let height = |x: usize, z: usize| 900.0 + 40.0 * noise(x, z) + 0.01 * (x * z) as f32;
            let region = region(step, height);
            let tile = tile_of(&region, step, true);
            let mut apart = Vec::new();
            off_bilinear(&region, step, &mut apart);
            let mut tightest = 0.0_f32;
            for k in 0..500 {
                let [column, row] = [k * 7 % 126, k * 13 % 126];
                let bound = 2.0 * tile.deviations[row * TILE + column];
                let at = |x: usize, z: usize| height(column * step + 1 + x, row * step + 1 + z);
                assert_eq!(at(0, 0), tile.heights[row * TILE + column], "the same bits");
                let [h, east, south, far] =
                    [[0, 0], [step, 0], [0, step], [step; 2]].map(|[x, z]| at(x, z));
                for z in 0..=step {
                    for x in 0..=step {
                        let [u, v] = [x, z].map(|n| n as f32 / step as f32);
                        let lines = h
                            + u * (east - h)
                            + v * ((south - h) + u * ((far - south) - (east - h)));
                        let off = (at(x, z) - lines).abs();
                        assert!(off <= bound, "{step}: {off} > {bound}");
                        assert!(off <= apart[row * TILE + column] + 1e-3);
                        tightest = tightest.max(off / bound);
                    }
                }
            }
            assert!(tightest > 0.3, "{tightest}");
        }
    }
}
