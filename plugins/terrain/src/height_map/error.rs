//! Why a height map cannot be used, and what to do about it.

use super::HeightMap;
use bevy::math::DVec2;
use thiserror::Error;

/// A height map that cannot be used; every message names the file, the reason and the way out.
#[derive(Debug, Error)]
pub enum HeightMapError {
    /// The file cannot be read: missing, a folder, not permitted.
    #[error("{file}: cannot be read ({reason}); check the path and its permissions")]
    Read {
        /// The file.
        file: String,
        /// What the system said.
        reason: String,
    },
    /// Not a PNG, or a damaged one.
    #[error("{file}: not a complete PNG ({reason}); export it again as 16-bit grey PNG")]
    Png {
        /// The file.
        file: String,
        /// What the decoder said.
        reason: String,
    },
    /// A PNG of another kind than 16-bit grey.
    #[error(
        "{file}: found {found}, but heights need 16-bit grey; convert it, for instance with `magick {file} -colorspace gray -depth 16 PNG48:out.png` or export as 16-bit from the source"
    )]
    Depth {
        /// The file.
        file: String,
        /// The kind found.
        found: &'static str,
    },
    /// A raw file with too few or too many bytes.
    #[error(
        "{file}: {width} x {height} samples of {sample_bytes} bytes are {expected} bytes, but the file has {found}; check width, height and format"
    )]
    RawLength {
        /// The file.
        file: String,
        /// Columns asked for.
        width: u32,
        /// Rows asked for.
        height: u32,
        /// Bytes a sample.
        sample_bytes: u64,
        /// Bytes that would be right.
        expected: u64,
        /// Bytes there are.
        found: u64,
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
    #[error("{file}: {width} x {height} samples, but at most {side} a side and {total} in all are taken; scale it down or cut it", side = HeightMap::MAX_SIDE, total = HeightMap::MAX_SAMPLES)]
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
