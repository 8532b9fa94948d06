//! Why a file cannot be used. Every message names the file, the place and a way out; what stands between
//! backquotes is a command that can be typed as it is.

use thiserror::Error;

/// A file of elevation that cannot be used.
#[derive(Debug, Error)]
pub enum ElevationError {
    /// The file cannot be read: missing, a folder, not permitted.
    #[error("{file}: cannot be read ({reason}); check the path and its permissions")]
    Read {
        /// The file.
        file: String,
        /// What the system said.
        reason: String,
    },
    /// None of the kinds.
    #[error(
        "{file}: neither PNG, TIFF, ESRI ASCII nor HGT by its content ({found}); if it holds plain numbers, say which: `dolomite heights {} --raw-size {size} --raw-type {number}`",
        typed(.file)
    )]
    Kind {
        /// The file.
        file: String,
        /// What it begins with, or its length.
        found: String,
        /// A size that its length would allow.
        size: String,
        /// A kind of number that its length would allow.
        number: &'static str,
    },
    /// Cut off or damaged.
    #[error("{file}: not a complete {kind}, {place}: {reason}; fetch or export it again")]
    Damaged {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: &'static str,
        /// Row, tile or tag.
        place: String,
        /// What is wrong there.
        reason: String,
    },
    /// A raw file without a size.
    #[error(
        "{file}: raw files do not tell their size; add `--raw-size COLUMNSxROWS`{}",
        .guess.as_ref().map_or(String::new(), |guess| format!(", by its length perhaps `dolomite heights {} --raw-size {guess}`", typed(.file)))
    )]
    RawSize {
        /// The file.
        file: String,
        /// A square that fits its length.
        guess: Option<String>,
    },
    /// A raw file with too few or too many bytes.
    #[error(
        "{file}: {columns} x {rows} samples of {sample_bytes} bytes, a header of {header} and {row_padding} after each row are {expected} bytes, but the file has {found}; check width, height and type (`--raw-size`, `--raw-type`), header and padding (`--raw-header`, `--raw-row-padding`)"
    )]
    RawLength {
        /// The file.
        file: String,
        /// Columns asked for.
        columns: u32,
        /// Rows asked for.
        rows: u32,
        /// Bytes a sample.
        sample_bytes: u64,
        /// Bytes before the first sample.
        header: u64,
        /// Bytes after each row.
        row_padding: u64,
        /// Bytes that would be right.
        expected: u64,
        /// Bytes there are.
        found: u64,
    },
    /// A size of 0.
    #[error("{file}: {columns} x {rows} samples; a map needs at least one row and one column")]
    Empty {
        /// The file.
        file: String,
        /// Columns.
        columns: u32,
        /// Rows.
        rows: u32,
    },
    /// More samples than are taken.
    #[error(
        "{file}: {columns} x {rows} samples, but at most {most} are taken; take every {every}th of each row and column: `{again} --every {every}`"
    )]
    TooLarge {
        /// The file.
        file: String,
        /// The command that read it, as it can be typed.
        again: String,
        /// Columns.
        columns: u32,
        /// Rows.
        rows: u32,
        /// Most samples.
        most: u64,
        /// The least step with which it would be taken.
        every: u32,
    },
    /// Memory that the system does not give.
    #[error(
        "{file}: the system does not give {bytes} bytes for its samples; take fewer: `{again} --every 2`"
    )]
    Memory {
        /// The file.
        file: String,
        /// The command that read it, as it can be typed.
        again: String,
        /// Bytes asked for.
        bytes: u64,
    },
    /// Several channels, and none was named.
    #[error(
        "{file}: {found}, {bands} numbers a sample; say which holds the heights, from 1: `{again} --band 1`"
    )]
    Bands {
        /// The file.
        file: String,
        /// The command that read it, as it can be typed.
        again: String,
        /// What was found, for instance "8-bit colour".
        found: String,
        /// How many there are.
        bands: u32,
    },
    /// A channel that is not there.
    #[error("{file}: band {band} was asked for, but there are 1 to {bands}")]
    NoBand {
        /// The file.
        file: String,
        /// What was asked for.
        band: u32,
        /// How many there are.
        bands: u32,
    },
    /// Numbers that can only mean that there is no data.
    #[error(
        "{file}: {count} samples are {value}, the first in column {column}, row {row}, while all others lie from {low} to {high}: these can only mean that there is no data; say so: `{again} --nodata {value}`, or that they are heights: `{again} --nodata none`"
    )]
    LooksLikeNoData {
        /// The file.
        file: String,
        /// The command that read it, as it can be typed.
        again: String,
        /// The number.
        value: f32,
        /// Column of the first.
        column: u32,
        /// Its row.
        row: u32,
        /// How many there are.
        count: u64,
        /// Lowest of the others.
        low: f32,
        /// Highest of the others.
        high: f32,
    },
    /// NaN or infinity without a word that it stands for no data.
    #[error(
        "{file}: {count} samples are {value}, the first in column {column}, row {row}, but heights must be finite; say that there is no data: `{again} --nodata {value}`"
    )]
    NotFinite {
        /// The file.
        file: String,
        /// The command that read it, as it can be typed.
        again: String,
        /// The number.
        value: f32,
        /// Column of the first.
        column: u32,
        /// Its row.
        row: u32,
        /// How many there are.
        count: u64,
    },
    /// A word for no data that is no number.
    #[error(
        "{file}: tag GDAL_NODATA: {text:?} is not a number; say what stands for no data: `{again} --nodata -9999`, or that nothing does: `{again} --nodata none`"
    )]
    NoDataText {
        /// The file.
        file: String,
        /// The command that read it, as it can be typed.
        again: String,
        /// What stands there.
        text: String,
    },
    /// A way of packing that is not read.
    #[error("{file}: {what} is not read; convert it: `{convert}`")]
    Unsupported {
        /// The file.
        file: String,
        /// What is not read.
        what: String,
        /// A command of GDAL that makes a file which is read.
        convert: String,
    },
    /// A georeference that cannot be used.
    #[error("{file}: {tag}: {reason}; convert it: `{convert}`")]
    Georeference {
        /// The file.
        file: String,
        /// Which tag or key.
        tag: String,
        /// What is wrong with it.
        reason: String,
        /// A command of GDAL that makes a file which is read.
        convert: String,
    },
    /// A projection whose unit is not known.
    #[error(
        "{file}: {tag}: the projection {name} is not known, so the distance of samples in metres is not either; say it: `{again} --spacing 30`, for 30 m"
    )]
    Projection {
        /// The file.
        file: String,
        /// The command that read it, as it can be typed.
        again: String,
        /// Which key.
        tag: String,
        /// Name or number of the projection.
        name: String,
    },
    /// A file beside the map that counts for it and cannot be understood.
    #[error(
        "{file}, which stands beside {map}: {place}: {reason}; mend it, or move it away and it does not count"
    )]
    Sidecar {
        /// The file beside the map.
        file: String,
        /// The map.
        map: String,
        /// Line, byte, element or tag.
        place: String,
        /// What is wrong there.
        reason: String,
    },
    /// Tiles that do not make one map.
    #[error("{file} and {other}: {reason}")]
    Tiles {
        /// One tile.
        file: String,
        /// Another.
        other: String,
        /// Why they do not fit, and what to do.
        reason: String,
    },
    /// A file that was changed while it was read.
    #[error("{file}: it was changed while it was read; read it again when nobody writes to it")]
    Changed {
        /// The file.
        file: String,
    },
    /// Holes in a map that is read by tiles, which are not filled from their border.
    #[error(
        "{file}: {count} of its samples or more have no data, and holes of a map that is read by tiles are not filled from their border; let the sea lie there: `--sea-in-holes 0`, or in a scene file `holes: Sea(0.0)`"
    )]
    TiledHoles {
        /// The file.
        file: String,
        /// Samples without data that were seen first.
        count: u64,
    },
    /// A map that takes more memory to be cut into tiles than may be taken.
    #[error(
        "{file}: {columns} x {rows} samples take {needed} bytes of memory to be cut into tiles, but {most} may be taken; allow more (`TileSettings::memory`), or take fewer samples: `{again} --every 2`"
    )]
    TileMemory {
        /// The file.
        file: String,
        /// The command that read it, as it can be typed.
        again: String,
        /// Columns.
        columns: u32,
        /// Rows.
        rows: u32,
        /// Bytes that it takes.
        needed: u64,
        /// Bytes that may be taken.
        most: u64,
    },
    /// A tile that is not what was written.
    #[error(
        "{file}: tile {column}, {row} of level {level} is damaged; delete the file, and it is made anew"
    )]
    DamagedTile {
        /// The file of tiles.
        file: String,
        /// Level of the tile.
        level: u32,
        /// Its column.
        column: u32,
        /// Its row.
        row: u32,
    },
    /// Two tiles that disagree on the border that they share.
    #[error(
        "{file} and {other} share a border but disagree: column {column}, row {row} of the mosaic is {value} in one and {other_value} in the other; cut both from one map, or leave the shared column and row out of one (`overlap: 0`)"
    )]
    Border {
        /// One tile.
        file: String,
        /// The other.
        other: String,
        /// Column of the mosaic.
        column: u32,
        /// Its row.
        row: u32,
        /// What the one says.
        value: f32,
        /// What the other says.
        other_value: f32,
    },
    /// A file that cannot be written.
    #[error("{file}: cannot be written ({reason})")]
    Write {
        /// The file.
        file: String,
        /// What the system said, or why its kind cannot hold the samples.
        reason: String,
    },
}

/// A word as a shell takes it.
pub(crate) fn typed(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+:,@=".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// An error of the system while a file is read.
pub(crate) fn read_error(file: &str, error: &std::io::Error) -> ElevationError {
    ElevationError::Read {
        file: file.to_owned(),
        reason: error.to_string(),
    }
}
