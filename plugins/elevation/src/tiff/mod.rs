//! TIFF, GeoTIFF and BigTIFF: strips and tiles as the `tiff` crate decodes them, chunk by chunk.
//!
//! A chunk whose byte count is 0 is absent (GDAL's sparse files): no data there. The decoder must never see
//! it: of uncompressed ones it would make samples of whatever the file begins with. For the same reason a
//! chunk must lie within the file, and an uncompressed one be as long as its samples.

mod directory;
mod geo;
mod lzw;

use crate::about::{FileKind, NumberType};
use crate::error::{ElevationError, typed};
use crate::grid::{Grid, check_size};
use crate::input::{Input, Source};
use crate::options::NoData;
use crate::samples::Elevation;
use ::tiff::TiffError;
use ::tiff::decoder::ifd::Value;
use ::tiff::decoder::{Decoder, DecodingResult, Limits};
use ::tiff::tags::{ByteOrder, Tag};
use geo::Keys;
use std::io::{BufReader, Read, Seek, SeekFrom};

type Tiff<'a> = Decoder<BufReader<&'a mut (dyn Source + 'a)>>;

/// Twelve bits of LZW stand for at most some 3 840 bytes, eight of deflate for 1 032.
const MOST_PACKED: u64 = 4096;

/// GDAL's own tag: XML with scale, offset and unit.
const GDAL_METADATA: Tag = Tag::Unknown(42112);

/// Error in a place of a file.
struct Failure<'a> {
    file: &'a str,
}

impl Failure<'_> {
    fn damaged(&self, place: impl Into<String>, reason: impl Into<String>) -> ElevationError {
        ElevationError::Damaged {
            file: self.file.to_owned(),
            kind: "TIFF",
            place: place.into(),
            reason: reason.into(),
        }
    }

    fn unsupported(&self, what: impl Into<String>, options: &str) -> ElevationError {
        ElevationError::Unsupported {
            file: self.file.to_owned(),
            what: what.into(),
            convert: format!("gdal_translate {options} {} readable.tif", typed(self.file)),
        }
    }

    fn of(&self, place: &str, error: TiffError) -> ElevationError {
        match error {
            TiffError::UnsupportedError(what) => {
                self.unsupported(what.to_string(), "-co COMPRESS=DEFLATE")
            }
            TiffError::IoError(error)
                if !matches!(
                    error.kind(),
                    std::io::ErrorKind::UnexpectedEof
                        | std::io::ErrorKind::InvalidData
                        | std::io::ErrorKind::InvalidInput
                        | std::io::ErrorKind::Other
                ) =>
            {
                crate::input::read_error(self.file, &error)
            }
            error => self.damaged(place, error.to_string()),
        }
    }
}

/// What the tags say of the samples.
struct Layout {
    size: [u32; 2],
    number: NumberType,
    bands: u32,
    planar: bool,
    /// Whether the decoder turns numbers over, as black is the highest.
    inverted: bool,
    compression: u16,
    predictor: u16,
    /// Whether bytes are the greatest first.
    big: bool,
    offsets: Vec<u64>,
    counts: Vec<u64>,
    /// Columns and rows of a chunk.
    chunk: [u32; 2],
    tiled: bool,
}

/// Columns and rows, which its directory tells.
pub(crate) fn size(input: &mut Input<'_>) -> Result<[u32; 2], ElevationError> {
    let failure = Failure { file: input.file };
    directory::check(input)?;
    let from = BufReader::with_capacity(1 << 16, &mut *input.source as &mut dyn Source);
    let mut tiff = Decoder::new(from).map_err(|error| failure.of("its directory", error))?;
    let size = tiff.dimensions();
    let (columns, rows) = size.map_err(|error| failure.of("its tags", error))?;
    Ok([columns, rows])
}

pub(crate) fn read(input: &mut Input<'_>) -> Result<Elevation, ElevationError> {
    let (file, options, bytes) = (input.file, input.options, input.bytes);
    let feed = std::mem::take(&mut input.feed);
    let failure = Failure { file };
    let directory::Found { big, masked } = directory::check(input)?;
    if masked && options.nodata != NoData::None {
        let mut error = failure.unsupported("a mask of no data beside the samples", "");
        if let ElevationError::Unsupported { convert, .. } = &mut error {
            *convert = format!("gdalwarp -dstnodata -9999 {} readable.tif", typed(file));
        }
        return Err(error);
    }
    let from = BufReader::with_capacity(1 << 16, &mut *input.source as &mut dyn Source);
    let mut tiff = Decoder::new(from).map_err(|error| failure.of("its directory", error))?;
    let layout = layout(&mut tiff, &failure)?;
    check_size(file, layout.size, options)?;
    let band = match options.band {
        Some(band) if (1..=layout.bands).contains(&band) => band - 1,
        Some(band) => {
            return Err(ElevationError::NoBand {
                file: file.to_owned(),
                band,
                bands: layout.bands,
            });
        }
        None if layout.bands == 1 => 0,
        None => {
            return Err(ElevationError::Bands {
                file: file.to_owned(),
                again: options.command(file),
                found: format!("TIFF of {}", layout.number),
                bands: layout.bands,
            });
        }
    };
    layout.check(bytes, band, &failure)?;
    let keys = Keys::read(&mut tiff, &failure)?;
    let metadata = Metadata::read(&mut tiff, band, &failure)?;
    let nodata = nodata(&mut tiff, &failure)?;
    let chunk_bytes = u64::from(layout.chunk[0]) * u64::from(layout.chunk[1]);
    let chunk_bytes = chunk_bytes.saturating_mul(8 * u64::from(layout.bands));
    let limit = usize::try_from(chunk_bytes)
        .unwrap_or(usize::MAX)
        .max(1 << 20);
    let mut limits = Limits::default();
    limits.decoding_buffer_size = limit;
    limits.intermediate_buffer_size = limit;
    let mut tiff = tiff.with_limits(limits);
    let scale = (metadata.scale, metadata.offset);
    let too_tall = || {
        let [_, rows] = layout.chunk;
        let what = format!("a TIFF of this size whose pieces have {rows} rows");
        failure.unsupported(what, "-co TILED=YES -co BIGTIFF=IF_SAFER")
    };
    let complete = layout.chunk[1];
    let mut grid = Grid::fed(
        file,
        layout.size,
        options,
        feed,
        (&nodata, scale),
        complete,
        too_tall,
    )?;
    let absent = layout.samples(&mut tiff, band, &mut grid, &failure)?;
    drop(tiff);
    let settled = grid.settle_with_gaps(&nodata, scale, absent > 0)?;
    let kind = if big {
        FileKind::BigTiff
    } else {
        FileKind::Tiff
    };
    let mut map = Elevation::new(file, settled, (kind, layout.size, layout.number));
    let about = &mut map.about;
    about.bands = layout.bands;
    about.packing = layout.packing(absent);
    (about.scale, about.offset) = (metadata.scale, metadata.offset);
    about.unit_metres = metadata.unit.or(keys.vertical);
    if absent > 0 {
        let one = if layout.tiled { "tiles" } else { "strips" };
        about
            .notes
            .push(format!("{absent} {one} are absent: there is no data"));
    }
    if let Some(georeference) = keys.place(file, options)? {
        map.lies_at(georeference, options.every);
    }
    Ok(map)
}

fn layout(tiff: &mut Tiff<'_>, failure: &Failure<'_>) -> Result<Layout, ElevationError> {
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
    fn grid(&self) -> [u32; 2] {
        [0, 1].map(|k| self.size[k].div_ceil(self.chunk[k]))
    }

    /// Number of the first chunk of the band, and how many there are.
    fn chunks(&self, band: u32) -> (usize, usize) {
        let [across, down] = self.grid().map(|n| n as usize);
        let count = across.saturating_mul(down);
        let first = if self.planar {
            band as usize * count
        } else {
            0
        };
        (first, count)
    }

    fn name(&self, chunk: usize) -> String {
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
    fn within(&self, chunk: usize) -> [u32; 2] {
        let across = self.grid()[0] as usize;
        let at = [chunk % across, chunk / across];
        [0, 1].map(|k| self.chunk[k].min(self.size[k] - at[k] as u32 * self.chunk[k]))
    }

    /// Refuses what the decoder must not see, before any memory is taken for samples.
    fn check(&self, bytes: u64, band: u32, failure: &Failure<'_>) -> Result<(), ElevationError> {
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

    /// Decodes all chunks of the band; returns how many are absent.
    fn samples(
        &self,
        tiff: &mut Tiff<'_>,
        band: u32,
        grid: &mut Grid<'_>,
        failure: &Failure<'_>,
    ) -> Result<usize, ElevationError> {
        let (first, count) = self.chunks(band);
        let across = self.grid()[0] as usize;
        let (step, skip) = if self.planar {
            (1, 0)
        } else {
            (self.bands as usize, band as usize)
        };
        let absent = (0..count).filter(|k| self.counts[first + k] == 0).count();
        if absent > 0 {
            grid.no_data();
        }
        for chunk in (0..count).filter(|k| self.counts[first + k] != 0) {
            let number = u32::try_from(first + chunk)
                .map_err(|_| failure.damaged(self.name(chunk), "there are too many"))?;
            let [mut width, height] = self.within(chunk).map(|n| n as usize);
            let decoded = if self.compression == 5 {
                // Whole tiles, also where they reach over the edge.
                width = self.chunk[0] as usize;
                self.lzw(tiff, first + chunk, height, failure)?
            } else {
                tiff.read_chunk(number)
                    .map_err(|error| failure.of(&self.name(chunk), error))?
            };
            let column = chunk % across * self.chunk[0] as usize;
            let row = chunk / across * self.chunk[1] as usize;
            let (line, within) = (width * step, self.within(chunk)[0] as usize);
            // Only the decoder turns numbers over.
            let inverted = self.inverted && self.compression != 5;
            macro_rules! put {
                ($values:expr, $to:expr) => {{
                    if $values.len() < line * height {
                        return Err(failure.damaged(self.name(chunk), "it is too short"));
                    }
                    for (k, values) in $values.chunks_exact(line).take(height).enumerate() {
                        let values = values.iter().skip(skip).step_by(step).take(within).map($to);
                        grid.put(row + k, column, 1, values);
                    }
                }};
            }
            match decoded {
                DecodingResult::U8(v) => put!(v, |&n| f32::from(if inverted { !n } else { n })),
                DecodingResult::U16(v) => put!(v, |&n| f32::from(if inverted { !n } else { n })),
                DecodingResult::U32(v) => put!(v, |&n| (if inverted { !n } else { n }) as f32),
                DecodingResult::U64(v) => put!(v, |&n| (if inverted { !n } else { n }) as f32),
                DecodingResult::I8(v) => put!(v, |&n| f32::from(n)),
                DecodingResult::I16(v) => put!(v, |&n| f32::from(n)),
                DecodingResult::I32(v) => put!(v, |&n| n as f32),
                DecodingResult::I64(v) => put!(v, |&n| n as f32),
                DecodingResult::F16(v) => put!(v, |n| n.to_f32()),
                DecodingResult::F32(v) => put!(v, |&n| n),
                DecodingResult::F64(v) => put!(v, |&n| n as f32),
            }
        }
        Ok(absent)
    }

    /// Unpacks the first `height` rows of a chunk.
    fn lzw(
        &self,
        tiff: &mut Tiff<'_>,
        chunk: usize,
        height: usize,
        failure: &Failure<'_>,
    ) -> Result<DecodingResult, ElevationError> {
        use NumberType::{F16, F32, F64, I8, I16, I32, I64, Text, U8, U16, U32, U64};
        let name = || self.name(chunk % self.chunks(0).1);
        let from = tiff.inner();
        // At most as long as the file, which was checked.
        let mut packed = vec![0; self.counts[chunk] as usize];
        from.seek(SeekFrom::Start(self.offsets[chunk]))
            .and_then(|_| from.read_exact(&mut packed))
            .map_err(|error| failure.of(&name(), TiffError::IoError(error)))?;
        let bands = if self.planar { 1 } else { self.bands as usize };
        let rows = lzw::Rows {
            samples: self.chunk[0] as usize * bands,
            apart: bands,
            bytes: self.number.bytes() as usize,
            predictor: self.predictor,
            big: self.big,
        };
        let mut bytes = vec![0; rows.samples * rows.bytes * height];
        lzw::unpack(&packed, &mut bytes, rows).map_err(|reason| failure.damaged(name(), reason))?;
        macro_rules! numbers {
            ($kind:ident, $number:ty) => {{
                let (numbers, _) = bytes.as_chunks::<{ size_of::<$number>() }>();
                let numbers = numbers.iter().map(|b| <$number>::from_ne_bytes(*b));
                DecodingResult::$kind(numbers.collect())
            }};
        }
        Ok(match self.number {
            U8 | Text => DecodingResult::U8(bytes),
            I8 => numbers!(I8, i8),
            U16 => numbers!(U16, u16),
            I16 => numbers!(I16, i16),
            U32 => numbers!(U32, u32),
            I32 => numbers!(I32, i32),
            U64 => numbers!(U64, u64),
            I64 => numbers!(I64, i64),
            F32 => numbers!(F32, f32),
            F64 => numbers!(F64, f64),
            F16 => {
                return Err(failure.unsupported("LZW of 16-bit floats", "-ot Float32"));
            }
        })
    }

    fn packing(&self, absent: usize) -> String {
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

/// The number that GDAL says is no data.
fn nodata(tiff: &mut Tiff<'_>, failure: &Failure<'_>) -> Result<Vec<f64>, ElevationError> {
    let Some(text) = text(tiff, Tag::GdalNodata, failure)? else {
        return Ok(Vec::new());
    };
    let text = text.trim();
    if text.is_empty() {
        return Ok(Vec::new());
    }
    let number = text
        .parse::<f64>()
        .map_err(|_| failure.damaged("tag GDAL_NODATA", format!("{text:?} is not a number")))?;
    Ok(vec![number])
}

/// A text tag, without the zeros at its end.
fn text(
    tiff: &mut Tiff<'_>,
    tag: Tag,
    failure: &Failure<'_>,
) -> Result<Option<String>, ElevationError> {
    let fail = |error| failure.of(&format!("tag {tag:?}"), error);
    let text = match tiff.find_tag(tag).map_err(fail)? {
        None => return Ok(None),
        Some(Value::Ascii(text)) => text,
        Some(other) => String::from_utf8_lossy(&other.into_u8_vec().map_err(fail)?).into_owned(),
    };
    Ok(Some(text.trim_end_matches('\0').to_owned()))
}

/// What GDAL's own XML says of the band.
struct Metadata {
    scale: f64,
    offset: f64,
    /// Metres a unit of height.
    unit: Option<f64>,
}

impl Metadata {
    fn read(tiff: &mut Tiff<'_>, band: u32, failure: &Failure<'_>) -> Result<Self, ElevationError> {
        let xml = text(tiff, GDAL_METADATA, failure)?.unwrap_or_default();
        let item = |role: &str| {
            let of_band = format!("sample=\"{band}\"");
            let items = xml.split("<Item").skip(1);
            let mut items = items.filter_map(|item| item.split_once('>'));
            let (_, rest) = items.find(|(attributes, _)| {
                attributes.contains(&format!("role=\"{role}\"")) && attributes.contains(&of_band)
            })?;
            Some(rest.split('<').next()?.trim().to_owned())
        };
        let number = |role| {
            let number: f64 = item(role)?.parse().ok()?;
            number.is_finite().then_some(number)
        };
        Ok(Self {
            scale: number("scale").filter(|&scale| scale != 0.0).unwrap_or(1.0),
            offset: number("offset").unwrap_or(0.0),
            unit: item("unittype").and_then(|name| geo::unit_by_name(&name)),
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::{Elevation, ElevationError, NoData, Options};
    use ::tiff::encoder::{TiffEncoder, colortype};
    use ::tiff::tags::Tag;
    use std::io::Cursor;

    /// A map of 3 x 2 samples with a second picture of this purpose.
    fn with_second(purpose: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = TiffEncoder::new(Cursor::new(&mut bytes)).expect("an empty file");
        encoder
            .write_image::<colortype::Gray16>(3, 2, &[1, 2, 3, 4, 5, 6])
            .expect("six samples");
        let mut second = encoder
            .new_image::<colortype::Gray8>(3, 2)
            .expect("a second one");
        second
            .encoder()
            .write_tag(Tag::NewSubfileType, purpose)
            .expect("a tag");
        second
            .write_data(&[255, 0, 255, 255, 255, 255])
            .expect("six pixels");
        bytes
    }

    #[test]
    fn a_mask_is_not_read_and_not_passed_over() {
        let options = Options::default();
        for purpose in [0, 1, 2, 5] {
            let map = Elevation::decode("a.tif", &with_second(purpose), &options);
            assert_eq!(
                map.expect("an overview or a page").samples[..3],
                [1.0, 2.0, 3.0]
            );
        }
        let masked = with_second(4);
        let error = Elevation::decode("a.tif", &masked, &options).expect_err("a mask");
        assert!(
            matches!(error, ElevationError::Unsupported { .. }),
            "{error}"
        );
        assert!(
            error.to_string().contains("`gdalwarp -dstnodata"),
            "{error}"
        );
        // Who says that every number is a height means it.
        let all = Options {
            nodata: NoData::None,
            ..options
        };
        assert!(Elevation::decode("a.tif", &masked, &all).is_ok());
        for length in 0..masked.len() {
            let _ = Elevation::decode("a.tif", &masked[..length], &options);
        }
    }
}
