//! What the tags of a TIFF say of its samples, and what of it is refused before any memory is taken for them.

use ::tiff::tags::{ByteOrder, Tag};

use super::Tiff;
use super::failure::Failure;
use crate::about::NumberType;
use crate::error::ElevationError;

/// Twelve bits of LZW stand for at most some 3 840 bytes, eight of deflate for 1 032.
const MOST_PACKED: u64 = 4096;

/// What the tags say of the samples.
pub(super) struct Layout {
    pub(super) size: [u32; 2],
    pub(super) number: NumberType,
    pub(super) bands: u32,
    pub(super) planar: bool,
    /// Whether the decoder turns numbers over, as black is the highest.
    pub(super) inverted: bool,
    pub(super) compression: u16,
    pub(super) predictor: u16,
    /// Whether bytes are the greatest first.
    pub(super) big: bool,
    pub(super) offsets: Vec<u64>,
    pub(super) counts: Vec<u64>,
    /// Columns and rows of a chunk.
    pub(super) chunk: [u32; 2],
    pub(super) tiled: bool,
}

/// Reads them, and refuses what is not read.
pub(super) fn layout(tiff: &mut Tiff<'_>, failure: &Failure<'_>) -> Result<Layout, ElevationError> {
    let tags = |error| failure.of("its tags", error);
    let (columns, rows) = tiff.dimensions().map_err(tags)?;
    let mut tag = |tag: Tag, default: u16| -> Result<u16, ElevationError> {
        let values = tiff.find_tag_unsigned_vec::<u16>(tag);
        let values = values.map_err(|error| failure.of(&format!("tag {tag:?}"), error))?;
        Ok(values.and_then(|v| v.first().copied()).unwrap_or(default))
    };
    let bits = tag(Tag::BitsPerSample, 1)?;
    let format = tag(Tag::SampleFormat, 1)?;
    let compression = tag(Tag::Compression, 1)?;
    let predictor = tag(Tag::Predictor, 1)?;
    let bands = u32::from(tag(Tag::SamplesPerPixel, 1)?);
    let planar = tag(Tag::PlanarConfiguration, 1)? == 2 && bands > 1;
    let inverted = tag(Tag::PhotometricInterpretation, 1)? == 0;
    if compression == 5 && (!(1..=3).contains(&predictor) || predictor == 3 && format != 3) {
        return Err(failure.damaged(
            "tag Predictor",
            format!("{predictor} is none of these samples"),
        ));
    }
    let packed = match compression {
        1 | 5 | 8 | 32_946 | 32_773 => None,
        6 | 7 => Some("JPEG"),
        34_887 => Some("LERC"),
        34_925 => Some("LZMA"),
        50_000 => Some("ZSTD"),
        50_001 => Some("WebP"),
        50_002 | 52_546 => Some("JPEG XL"),
        _ => Some("of another kind"),
    };
    if let Some(name) = packed {
        let what = format!("compression {compression} ({name})");
        return Err(failure.unsupported(what, "-co COMPRESS=DEFLATE"));
    }
    let number = match (format, bits) {
        (1 | 4, 8) => NumberType::U8,
        (1 | 4, 16) => NumberType::U16,
        (1 | 4, 32) => NumberType::U32,
        (1 | 4, 64) => NumberType::U64,
        (2, 8) => NumberType::I8,
        (2, 16) => NumberType::I16,
        (2, 32) => NumberType::I32,
        (2, 64) => NumberType::I64,
        (3, 16) => NumberType::F16,
        (3, 32) => NumberType::F32,
        (3, 64) => NumberType::F64,
        _ => {
            let what = format!("sample format {format} of {bits} bits");
            return Err(failure.unsupported(what, "-ot Float32 -co COMPRESS=DEFLATE"));
        }
    };
    // The decoder makes 1 − v of floats then, which is not undone to the bit.
    if inverted && !matches!(format, 1 | 4) {
        let what = format!("{number} where black is the highest");
        return Err(failure.unsupported(what, "-co PHOTOMETRIC=MINISBLACK -co COMPRESS=DEFLATE"));
    }
    let tiled = tiff.find_tag(Tag::TileOffsets).map_err(tags)?.is_some();
    let names = if tiled {
        [Tag::TileOffsets, Tag::TileByteCounts]
    } else {
        [Tag::StripOffsets, Tag::StripByteCounts]
    };
    let mut list = |tag: Tag| -> Result<Vec<u64>, ElevationError> {
        let list = tiff.find_tag_unsigned_vec::<u64>(tag);
        let list = list.map_err(|error| failure.of(&format!("tag {tag:?}"), error))?;
        list.ok_or_else(|| failure.damaged(format!("tag {tag:?}"), "it is missing"))
    };
    let (offsets, counts) = (list(names[0])?, list(names[1])?);
    // The decoder's own answer panics where a strip has no rows.
    let mut side = |tag: Tag, default: u32| -> Result<u32, ElevationError> {
        let side = tiff.find_tag_unsigned::<u32>(tag);
        let side = side.map_err(|error| failure.of(&format!("tag {tag:?}"), error))?;
        match side.unwrap_or(default) {
            0 => Err(failure.damaged(format!("tag {tag:?}"), "it is 0")),
            side => Ok(side),
        }
    };
    let chunk = if tiled {
        [side(Tag::TileWidth, 0)?, side(Tag::TileLength, 0)?]
    } else {
        let rows_per_strip = side(Tag::RowsPerStrip, rows.max(1))?;
        [columns.max(1), rows_per_strip.min(rows.max(1))]
    };
    Ok(Layout {
        size: [columns, rows],
        number,
        bands,
        planar,
        inverted,
        compression,
        predictor,
        big: tiff.byte_order() == ByteOrder::BigEndian,
        offsets,
        counts,
        chunk,
        tiled,
    })
}

impl Layout {
    pub(super) fn grid(&self) -> [u32; 2] {
        [0, 1].map(|k| self.size[k].div_ceil(self.chunk[k]))
    }

    /// Number of the first chunk of the band, and how many there are.
    pub(super) fn chunks(&self, band: u32) -> (usize, usize) {
        let [across, down] = self.grid().map(|n| n as usize);
        let count = across.saturating_mul(down);
        let first = if self.planar {
            band as usize * count
        } else {
            0
        };
        (first, count)
    }

    pub(super) fn name(&self, chunk: usize) -> String {
        let [across, _] = self.grid().map(|n| n as usize);
        if self.tiled {
            let (column, row) = (
                chunk % across * self.chunk[0] as usize,
                chunk / across * self.chunk[1] as usize,
            );
            format!("tile {chunk} (column {column}, row {row})")
        } else {
            format!("strip {chunk} (row {})", chunk * self.chunk[1] as usize)
        }
    }

    /// Columns and rows of a chunk that lie in the map.
    pub(super) fn within(&self, chunk: usize) -> [u32; 2] {
        let across = self.grid()[0] as usize;
        let at = [chunk % across, chunk / across];
        [0, 1].map(|k| self.chunk[k].min(self.size[k] - at[k] as u32 * self.chunk[k]))
    }

    /// Refuses what the decoder must not see, before any memory is taken for samples.
    pub(super) fn check(
        &self,
        bytes: u64,
        band: u32,
        failure: &Failure<'_>,
    ) -> Result<(), ElevationError> {
        let (first, count) = self.chunks(band);
        let planes = if self.planar { self.bands as usize } else { 1 };
        let expected = count.saturating_mul(planes);
        if self.offsets.len() != expected || self.counts.len() != expected {
            let name = if self.tiled {
                "TileOffsets"
            } else {
                "StripOffsets"
            };
            return Err(failure.damaged(
                format!("tag {name}"),
                format!(
                    "{} x {} samples are {expected} chunks, but {} are listed",
                    self.size[0],
                    self.size[1],
                    self.offsets.len().min(self.counts.len())
                ),
            ));
        }
        let bands = if self.planar {
            1
        } else {
            u64::from(self.bands)
        };
        for chunk in 0..count {
            let (offset, length) = (self.offsets[first + chunk], self.counts[first + chunk]);
            if length == 0 {
                continue;
            }
            if offset == 0 || offset.checked_add(length).is_none_or(|end| end > bytes) {
                return Err(failure.damaged(
                    self.name(chunk),
                    format!("{length} bytes from {offset} on, but the file has {bytes}"),
                ));
            }
            // Tiles are stored whole, strips as far as there are rows.
            let rows = if self.tiled {
                self.chunk[1]
            } else {
                self.within(chunk)[1]
            };
            let unpacked = u64::from(self.chunk[0]) * u64::from(rows) * bands;
            let unpacked = unpacked.saturating_mul(self.number.bytes());
            let most = match self.compression {
                1 => length,
                _ => length.saturating_mul(MOST_PACKED),
            };
            if unpacked > most {
                return Err(failure.damaged(
                    self.name(chunk),
                    format!("{unpacked} bytes of samples cannot be in {length}"),
                ));
            }
        }
        Ok(())
    }

    pub(super) fn packing(&self, absent: usize) -> String {
        let compression = match self.compression {
            1 => "not compressed",
            5 => "LZW",
            32_773 => "PackBits",
            _ => "deflate",
        };
        let [columns, rows] = self.chunk;
        let chunks = if self.tiled {
            format!("tiles of {columns} x {rows}")
        } else {
            format!("strips of {rows} rows")
        };
        let sparse = if absent > 0 { ", sparse" } else { "" };
        format!("{compression}, {chunks}{sparse}")
    }
}
