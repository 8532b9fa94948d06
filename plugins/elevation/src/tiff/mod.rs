//! TIFF, GeoTIFF and BigTIFF: strips and tiles as the `tiff` crate decodes them, chunk by chunk.
//!
//! A chunk whose byte count is 0 is absent (GDAL's sparse files): no data there. The decoder must never see
//! it: of uncompressed ones it would make samples of whatever the file begins with. For the same reason a
//! chunk must lie within the file, and an uncompressed one be as long as its samples.

mod chunks;
mod directory;
mod failure;
mod geo;
mod layout;
mod lzw;
mod metadata;
mod text;

use crate::about::FileKind;
use crate::error::{ElevationError, typed};
use crate::grid::{Grid, check_size};
use crate::input::{Input, Source};
use crate::options::NoData;
use crate::samples::Elevation;
use ::tiff::decoder::{Decoder, Limits};
use failure::Failure;
use geo::Keys;
use layout::layout;
use metadata::{Metadata, nodata};
use std::io::BufReader;

type Tiff<'a> = Decoder<BufReader<&'a mut (dyn Source + 'a)>>;

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
