//! What the tags of a TIFF say of its samples, and what of it is refused before any memory is taken for them.

use ::tiff::decoder::IfdDecoder;
use ::tiff::tags::Tag;

use super::failure::Failure;
use crate::about::NumberType;
use crate::error::ElevationError;

/// Twelve bits of LZW stand for at most some 3 840 bytes, eight of deflate for 1 032.
const MOST_PACKED: u64 = 4096;
/// Four bytes of ZSTD for a block of at most 128 KiB.
const MOST_ZSTD: u64 = 1 << 15;
/// Bytes of a chunk of any map, however small.
const LARGEST: u64 = 1 << 27;

/// What the tags say of the samples.
pub(super) struct Layout {
    pub(super) size: [u32; 2],
    pub(super) number: NumberType,
    /// Bits a sample, of which a whole number may stand in several bytes or several in one.
    pub(super) bits: u32,
    pub(super) bands: u32,
    /// The band, from 0, that tells where there is data: 0 where there is none.
    pub(super) alpha: Option<u32>,
    pub(super) planar: bool,
    pub(super) compression: u16,
    pub(super) predictor: u16,
    /// Whether the first of packed bits is the lowest of a byte.
    pub(super) reversed: bool,
    /// Whether bytes are the greatest first.
    pub(super) big: bool,
    pub(super) offsets: Vec<u64>,
    pub(super) counts: Vec<u64>,
    /// Columns and rows of a chunk.
    pub(super) chunk: [u32; 2],
    pub(super) tiled: bool,
}

/// Reads them, and refuses what is not read. `big`: whether the file's bytes are the greatest first.
pub(super) fn layout(
    tags: &mut IfdDecoder<'_>,
    big: bool,
    failure: &Failure<'_>,
) -> Result<Layout, ElevationError> {
    let list = |tags: &mut IfdDecoder<'_>, tag: Tag| -> Result<Option<Vec<u64>>, ElevationError> {
        let list = tags.find_tag_unsigned_vec::<u64>(tag);
        list.map_err(|error| failure.of(&format!("tag {tag:?}"), error))
    };
    let side = |tags: &mut IfdDecoder<'_>, tag: Tag| -> Result<Option<u32>, ElevationError> {
        let Some(side) = list(tags, tag)?.and_then(|values| values.first().copied()) else {
            return Ok(None);
        };
        let fits = u32::try_from(side).ok().filter(|&side| side > 0);
        let wrong = || failure.damaged(format!("tag {tag:?}"), format!("it is {side}"));
        fits.ok_or_else(wrong).map(Some)
    };
    let missing = |tag: Tag| failure.damaged(format!("tag {tag:?}"), "it is missing");
    let columns = side(tags, Tag::ImageWidth)?.ok_or_else(|| missing(Tag::ImageWidth))?;
    let rows = side(tags, Tag::ImageLength)?.ok_or_else(|| missing(Tag::ImageLength))?;
    let tiled = list(tags, Tag::TileOffsets)?.is_some();
    let chunk = if tiled {
        let wide = side(tags, Tag::TileWidth)?.ok_or_else(|| missing(Tag::TileWidth))?;
        [
            wide,
            side(tags, Tag::TileLength)?.ok_or_else(|| missing(Tag::TileLength))?,
        ]
    } else {
        [
            columns,
            side(tags, Tag::RowsPerStrip)?.unwrap_or(rows).min(rows),
        ]
    };
    let names = if tiled {
        [Tag::TileOffsets, Tag::TileByteCounts]
    } else {
        [Tag::StripOffsets, Tag::StripByteCounts]
    };
    let offsets = list(tags, names[0])?.ok_or_else(|| missing(names[0]))?;
    let counts = list(tags, names[1])?.ok_or_else(|| missing(names[1]))?;
    let first =
        |tags: &mut IfdDecoder<'_>, tag: Tag, default: u64| -> Result<u64, ElevationError> {
            Ok(list(tags, tag)?
                .and_then(|v| v.first().copied())
                .unwrap_or(default))
        };
    let bits = first(tags, Tag::BitsPerSample, 1)?;
    let format = first(tags, Tag::SampleFormat, 1)?;
    let compression = first(tags, Tag::Compression, 1)?;
    let predictor = first(tags, Tag::Predictor, 1)?;
    let bands = first(tags, Tag::SamplesPerPixel, 1)?;
    let planar = first(tags, Tag::PlanarConfiguration, 1)? == 2 && bands > 1;
    let reversed = first(tags, Tag::FillOrder, 1)? == 2;
    let name = match compression {
        1 | 5 | 8 | 32_946 | 32_773 | 50_000 => None,
        6 | 7 => Some("JPEG"),
        34_887 => Some("LERC"),
        34_925 => Some("LZMA"),
        50_001 => Some("WebP"),
        50_002 | 52_546 => Some("JPEG XL"),
        _ => Some("of another kind"),
    };
    if let Some(name) = name {
        let what = format!("compression {compression} ({name})");
        return Err(failure.unsupported(what, "-co COMPRESS=DEFLATE"));
    }
    let number = match (format, bits) {
        (1 | 4, 1..=8) => NumberType::U8,
        (1 | 4, 9..=16) => NumberType::U16,
        (1 | 4, 17..=32) => NumberType::U32,
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
    let whole = bits == 8 * number.bytes();
    if !(1..=3).contains(&predictor) || predictor == 3 && format != 3 || predictor != 1 && !whole {
        return Err(failure.damaged(
            "tag Predictor",
            format!("{predictor} is none of these samples"),
        ));
    }
    let bands = u32::try_from(bands)
        .ok()
        .filter(|&n| (1..=65_535).contains(&n));
    let bands =
        bands.ok_or_else(|| failure.damaged("tag SamplesPerPixel", "it is no number of bands"))?;
    // The last bands are extra ones: 1 and 2 stand for alpha.
    let extra = list(tags, Tag::ExtraSamples)?.unwrap_or_default();
    let alpha = extra.iter().position(|kind| matches!(kind, 1 | 2));
    let alpha = alpha.and_then(|at| (bands as usize + at).checked_sub(extra.len()));
    Ok(Layout {
        size: [columns, rows],
        number,
        bits: bits as u32,
        bands,
        alpha: alpha.map(|band| band as u32).filter(|&band| band > 0),
        planar,
        compression: compression as u16,
        predictor: predictor as u16,
        reversed,
        big,
        offsets,
        counts,
        chunk,
        tiled,
    })
}

impl Layout {
    /// Bands that may hold heights: all, or all but that which tells where there is data.
    pub(super) fn heights(&self) -> u32 {
        match self.alpha {
            Some(alpha) if alpha + 1 == self.bands => alpha,
            _ => self.bands,
        }
    }

    /// Bands of a chunk.
    pub(super) fn together(&self) -> usize {
        if self.planar { 1 } else { self.bands as usize }
    }

    /// Bytes of a row of a chunk.
    pub(super) fn row_bytes(&self) -> u64 {
        let samples = u64::from(self.chunk[0]) * self.together() as u64;
        samples.saturating_mul(self.bits.into()).div_ceil(8)
    }

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
        // A tile may reach over the border of a small map, but not be as many times as large as a packed file allows.
        let all = self.row_bytes() / u64::from(self.chunk[0]) * u64::from(self.size[0]);
        let largest = all.saturating_mul(4 * u64::from(self.size[1])).max(LARGEST);
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
            let unpacked = self.row_bytes().saturating_mul(rows.into());
            let most = match self.compression {
                1 => length,
                50_000 => length.saturating_mul(MOST_ZSTD),
                _ => length.saturating_mul(MOST_PACKED),
            };
            if unpacked > largest {
                return Err(failure.damaged(
                    self.name(chunk),
                    format!("{unpacked} bytes are far more than all of the map's samples"),
                ));
            }
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
            50_000 => "ZSTD",
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
