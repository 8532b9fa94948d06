//! The samples of the classic surface, and the bilinear surface through them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy::math::{DVec2, Vec2, Vec3};
use dolomite_terrain::{Filter, GroundRect, HeightMap, Layer, Source, Terrain, TerrainData};
use thiserror::Error;

/// Samples along a side; they lie a metre apart.
pub const SAMPLES: u32 = 1024;

/// Side of the square, metres.
pub const SIDE: f32 = 1024.0;

/// Metres for 1 of a sample.
pub const SCALE: f32 = 100.0;

/// Where the file lies in the folder of shared data.
pub const FILE: &str = "data/classic/heights_1024_f32le.raw";

/// Why the samples were refused.
#[derive(Debug, Error)]
pub enum ClassicHeightsError {
    /// The file cannot be read.
    #[error(
        "heights of the classic scene, {}: {source}; the file is part of the data that are shared \
         beside the project, not of the checkout: name their folder with `--data` or DOLOMITE_SHARED",
        .path.display()
    )]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Not 1024 × 1024 numbers of four bytes.
    #[error(
        "heights of the classic scene, {}: {bytes} bytes, but 1024 x 1024 numbers of 4 bytes are \
         {wanted}; take the file from the shared data again",
        .path.display(),
        wanted = SAMPLES * SAMPLES * 4
    )]
    Size {
        /// The file.
        path: PathBuf,
        /// What it has.
        bytes: usize,
    },
    /// A number that is no height.
    #[error(
        "heights of the classic scene, {}: sample {index} is {value}, not a number of -10 to 10; \
         take the file from the shared data again",
        .path.display()
    )]
    NotAHeight {
        /// The file.
        path: PathBuf,
        /// Which sample, row by row.
        index: usize,
        /// What it is.
        value: f32,
    },
}

/// 1024 × 1024 samples, row by row along x. Cheap to clone.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassicHeights(Arc<[f32]>);

impl ClassicHeights {
    /// Reads little-endian f32 from `path`.
    ///
    /// # Errors
    /// [`ClassicHeightsError`], naming the file.
    pub fn load(path: &Path) -> Result<Self, ClassicHeightsError> {
        let bytes = std::fs::read(path).map_err(|source| ClassicHeightsError::Read {
            path: path.to_owned(),
            source,
        })?;
        Self::decode(&bytes, path)
    }

    /// The samples in a file's bytes; errors name `path`.
    ///
    /// # Errors
    /// [`ClassicHeightsError`] for another size, or for what is no height.
    pub fn decode(bytes: &[u8], path: &Path) -> Result<Self, ClassicHeightsError> {
        if bytes.len() != (SAMPLES * SAMPLES * 4) as usize {
            return Err(ClassicHeightsError::Size {
                path: path.to_owned(),
                bytes: bytes.len(),
            });
        }
        let (numbers, _) = bytes.as_chunks::<4>();
        let samples: Arc<[f32]> = numbers.iter().map(|b| f32::from_le_bytes(*b)).collect();
        // NaN is in no range.
        let wrong = samples.iter().position(|s| !(-10.0..=10.0).contains(s));
        match wrong {
            Some(index) => Err(ClassicHeightsError::NotAHeight {
                path: path.to_owned(),
                index,
                value: samples[index],
            }),
            None => Ok(Self(samples)),
        }
    }

    /// The numbers, as they stand in the file.
    #[must_use]
    pub fn samples(&self) -> &[f32] {
        &self.0
    }

    /// The four samples around a place, in metres, and where it lies between them.
    fn around(&self, place: Vec2) -> ([f32; 4], Vec2) {
        // Sample i stands at i + 1/2 metres from the border at -512.
        let at = place + 511.5;
        let low = at.floor();
        let (column, row) = (low.x as i32, low.y as i32);
        let sample = |i: i32, j: i32| {
            let wrap = |k: i32| (k & (SAMPLES as i32 - 1)) as usize;
            SCALE * self.0[wrap(row + j) * SAMPLES as usize + wrap(column + i)]
        };
        let near = [sample(0, 0), sample(1, 0), sample(0, 1), sample(1, 1)];
        (near, at - low)
    }

    /// Height at (x, z), metres: bilinear, repeated at the borders. f32 throughout; within 2e-5 m of
    /// the exact surface for places that f32 holds exactly (four roundings of up to 110 m).
    #[must_use]
    pub fn height(&self, place: Vec2) -> f32 {
        let ([a, b, c, d], t) = self.around(place);
        let near = a + (b - a) * t.x;
        let far = c + (d - c) * t.x;
        near + (far - near) * t.y
    }

    /// The same surface as a terrain: a bilinear map with a sample more at each border, repeated from the
    /// other side.
    ///
    /// # Panics
    /// Never: the samples were checked.
    #[must_use]
    pub fn terrain(&self) -> Terrain {
        let sample = |k: u32| (k.wrapping_sub(1) & (SAMPLES - 1)) as usize;
        let row = |j: u32| (0..SAMPLES + 2).map(move |i| (sample(i), sample(j)));
        let metres = (0..SAMPLES + 2)
            .flat_map(row)
            .map(|(i, j)| SCALE * self.0[j * SAMPLES as usize + i])
            .collect();
        let first = f64::from(-0.5 - SIDE * 0.5);
        let map = HeightMap::new(
            SAMPLES + 2,
            SAMPLES + 2,
            metres,
            DVec2::splat(first),
            DVec2::ONE,
            Filter::Bilinear,
        )
        .expect("samples are numbers");
        Terrain::new(TerrainData {
            extent: GroundRect::square(DVec2::ZERO, f64::from(SIDE)),
            layers: vec![Layer {
                source: Source::Map(map),
                mask: None,
            }],
            base: 0.0,
            sea_level: None,
        })
        .expect("a square with one map")
    }

    /// Upward normal at (x, z), not of length 1: of the bilinear patch between four samples.
    #[must_use]
    pub fn normal(&self, place: Vec2) -> Vec3 {
        let ([a, b, c, d], t) = self.around(place);
        let along_x = (b - a) + ((d - c) - (b - a)) * t.y;
        let along_z = (c - a) + ((d - b) - (c - a)) * t.x;
        Vec3::new(-along_x, 1.0, -along_z)
    }

    /// Least and greatest height in a rectangle whose sides are whole metres: a bilinear surface has
    /// its extremes at samples, and on the border between two.
    #[must_use]
    pub fn range(&self, low: Vec2, high: Vec2) -> (f32, f32) {
        let mut range = (f32::INFINITY, f32::NEG_INFINITY);
        let (columns, rows) = ((high.x - low.x) as i32, (high.y - low.y) as i32);
        for j in -1..=rows {
            for i in -1..=columns {
                // One sample beyond each border bounds what lies between.
                let ([height, ..], _) = self.around(low + Vec2::new(i as f32, j as f32) + 0.5);
                range = (range.0.min(height), range.1.max(height));
            }
        }
        range
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sample (i, j) is f(i, j).
    pub(crate) fn made(f: impl Fn(u32, u32) -> f32) -> ClassicHeights {
        let numbers =
            (0..SAMPLES * SAMPLES).flat_map(|k| f(k % SAMPLES, k / SAMPLES).to_le_bytes());
        let bytes: Vec<u8> = numbers.collect();
        ClassicHeights::decode(&bytes, Path::new("made")).expect("heights")
    }

    #[test]
    fn samples_stand_in_the_middle_of_their_metre_and_repeat() {
        let heights = made(|i, j| if (i, j) == (3, 5) { 0.5 } else { 0.0 });
        let at = Vec2::new(-512.0 + 3.5, -512.0 + 5.5);
        assert_eq!(heights.height(at), 50.0);
        assert_eq!(heights.height(at + Vec2::new(0.25, 0.0)), 37.5);
        assert_eq!(heights.height(at + Vec2::new(-0.5, 0.5)), 12.5);
        assert_eq!(heights.height(at + SIDE), 50.0);
        assert_eq!(heights.height(at - Vec2::new(SIDE, 0.0)), 50.0);
        // The border lies between the last and the first sample.
        let border = made(|i, _| if i == 0 { 1.0 } else { 0.0 });
        assert_eq!(border.height(Vec2::new(-512.0, 9.0)), 50.0);
        assert_eq!(border.height(Vec2::new(512.0, 9.0)), 50.0);
    }

    #[test]
    fn as_a_terrain_it_is_the_same_surface_up_to_the_borders() {
        let heights = made(|i, j| ((i * 7 + j * 13) % 11) as f32 * 0.1 - 0.5);
        let terrain = heights.terrain();
        for k in 0..4000_u32 {
            // Every 32nd of a metre: exact in f32. The borders too.
            let at = |k: u32| (k.wrapping_mul(2_654_435_761) % 32_769) as f32 / 32.0 - 512.0;
            let edge = if k % 2 == 0 { -512.0 } else { 512.0 };
            let place = match k % 5 {
                0 => Vec2::new(edge, at(k)),
                1 => Vec2::new(at(k), edge),
                _ => Vec2::new(at(k), at(k + 9999)),
            };
            let there = terrain.sample_f64(place.as_dvec2()).height;
            let off = there - f64::from(heights.height(place));
            // Four roundings of 50 m in f32.
            assert!(off.abs() < 2e-5, "{place}: {off}");
        }
    }

    #[test]
    fn the_normal_is_that_of_the_slope() {
        let heights = made(|i, j| 0.002 * i as f32 - 0.001 * j as f32);
        let normal = heights.normal(Vec2::new(10.3, -7.8));
        // Differences of heights below 205 m, an f32 step of 1.5e-5 each.
        assert!(
            normal.distance(Vec3::new(-0.2, 1.0, 0.1)) < 1e-4,
            "{normal}"
        );
    }

    #[test]
    fn ranges_hold_the_surface() {
        let heights = made(|i, j| ((i * 7 + j * 13) % 31) as f32 / 31.0);
        let (low, high) = (Vec2::new(-512.0, 32.0), Vec2::new(-496.0, 48.0));
        let range = heights.range(low, high);
        for k in 0..=64 * 64 {
            let share = Vec2::new((k % 65) as f32, (k / 65) as f32) / 64.0;
            let height = heights.height(low + share * (high - low));
            assert!(
                (range.0..=range.1).contains(&height),
                "{share}: {height} {range:?}"
            );
        }
        assert!(range.0 >= 0.0 && range.1 <= 100.0);
    }

    #[test]
    fn what_is_no_height_is_refused_by_name() {
        let path = Path::new("some/file.raw");
        let short = ClassicHeights::decode(&[0; 12], path)
            .unwrap_err()
            .to_string();
        assert!(
            short.contains("some/file.raw") && short.contains("12 bytes"),
            "{short}"
        );
        let mut bytes = vec![0; (SAMPLES * SAMPLES * 4) as usize];
        bytes[40..44].copy_from_slice(&f32::NAN.to_le_bytes());
        let wrong = ClassicHeights::decode(&bytes, path)
            .unwrap_err()
            .to_string();
        assert!(wrong.contains("sample 10 is NaN"), "{wrong}");
        let missing = ClassicHeights::load(Path::new("no/such.raw"))
            .unwrap_err()
            .to_string();
        assert!(
            missing.contains("no/such.raw") && missing.contains("shared"),
            "{missing}"
        );
    }
}
