//! Why a height map cannot be used, and what to do about it.

use super::HeightMap;
use bevy::math::DVec2;
use dolomite_elevation::ElevationError;
use thiserror::Error;

/// A height map that cannot be used; every message names the file, the reason and the way out.
#[derive(Debug, Error)]
pub enum HeightMapError {
    /// The file: missing, damaged, of a kind that is not read, with holes that nobody named.
    #[error(transparent)]
    File(#[from] ElevationError),
    /// Nothing tells how far apart the samples are.
    #[error(
        "{file}: nothing in it tells how far apart its samples are; say it in metres: `--spacing 30`, or in a scene file `spacing: (30.0, 30.0)`"
    )]
    NoSpacing {
        /// The file.
        file: String,
    },
    /// No sample has data.
    #[error("{file}: no sample has data; check `--nodata`, or in a scene file `nodata`")]
    AllHoles {
        /// The file.
        file: String,
    },
    /// Maps that were to be joined but do not lie on one grid.
    #[error(
        "{file} and {other}: their samples do not lie on one grid; give both the same `spacing` and `filter`, and a `centre` a whole number of samples away"
    )]
    NotOneGrid {
        /// One map.
        file: String,
        /// The other.
        other: String,
    },
    /// A map that was to be joined with others is not in memory.
    #[error(
        "{file}: it is read by tiles, and only maps in memory are put together; give it more room, in a scene file `budget`"
    )]
    ByTiles {
        /// The map.
        file: String,
    },
    /// A size of 0.
    #[error(
        "{file}: {width} x {height} samples; a height map needs at least one row and one column"
    )]
    Empty {
        /// The file.
        file: String,
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// More samples than we take.
    #[error("{file}: {width} x {height} samples, but at most {side} a side and {total} in all are taken; take fewer: `--every 2`, or in a scene file `every: 2`", side = HeightMap::MAX_SIDE, total = HeightMap::MAX_SAMPLES)]
    TooLarge {
        /// The file.
        file: String,
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// A number of samples that is not width × height.
    #[error("{file}: {expected} samples expected, {found} given")]
    SampleCount {
        /// The file or source.
        file: String,
        /// Width × height.
        expected: usize,
        /// Samples given.
        found: usize,
    },
    /// NaN, infinite or absurd.
    #[error(
        "{file}: the sample in column {column}, row {row} is {value} m after scale and offset; heights must be finite and at most 1e6 m either way; fill the gap in the data"
    )]
    NotAHeight {
        /// The file.
        file: String,
        /// Column of the first such sample.
        column: u32,
        /// Its row.
        row: u32,
        /// Its value.
        value: f32,
    },
    /// A distance of samples that cannot be used.
    #[error("{file}: sample spacing {spacing} m; it must be from {min} m to 1e6 m on both axes", min = HeightMap::MIN_SPACING)]
    Spacing {
        /// The file.
        file: String,
        /// Along x and z, metres.
        spacing: DVec2,
    },
    /// A place that cannot be used.
    #[error(
        "{file}: the first sample lies at {origin}; both numbers must be at most 1e8 m either way"
    )]
    Origin {
        /// The file.
        file: String,
        /// x and z, metres.
        origin: DVec2,
    },
}

/// Refuses a size of 0 or beyond the limits.
pub(super) fn check_size(file: &str, width: u32, height: u32) -> Result<(), HeightMapError> {
    let file = || file.to_owned();
    if width == 0 || height == 0 {
        return Err(HeightMapError::Empty {
            file: file(),
            width,
            height,
        });
    }
    let total = u64::from(width) * u64::from(height);
    if width.max(height) > HeightMap::MAX_SIDE || total > HeightMap::MAX_SAMPLES as u64 {
        return Err(HeightMapError::TooLarge {
            file: file(),
            width,
            height,
        });
    }
    Ok(())
}
