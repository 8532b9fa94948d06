//! TIFF, GeoTIFF and BigTIFF: tags as the `tiff` crate reads them, strips and tiles chunk by chunk.
//!
//! Chunks are unpacked here, numbers as they are stored: what a picture's colours would mean changes no height.
//! A chunk whose byte count is 0 is absent (GDAL's sparse files): no data there. The crate (0.11.3) makes samples of
//! whatever the file begins with there. For the same reason a chunk must lie within the file, and an uncompressed one
//! be as long as its samples.

mod beside;
mod chunks;
mod directory;
mod failure;
mod geo;
mod layout;
mod mask;
mod metadata;
mod rows;
mod text;
mod unpack;

pub(crate) use beside::open_mask;

use crate::about::{FileKind, Head};
use crate::error::ElevationError;
use crate::grid::{Grid, check_size};
use crate::input::{Input, Source};
use crate::lattice::First;
use crate::options::NoData;
use crate::samples::Elevation;
use crate::sidecars::Numbers;
use ::tiff::decoder::Decoder;
use ::tiff::tags::ByteOrder;
use chunks::Gaps;
use failure::Failure;
use geo::{Keys, OwnPlace};
use layout::layout;
use mask::Mask;
use metadata::{Metadata, nodata};
use std::io::BufReader;

type Tiff<'a> = Decoder<BufReader<Box<dyn Source + 'a>>>;

/// Whether a file that begins so is one: its first eight bytes.
pub(crate) fn begins(head: &[u8]) -> bool {
    [
        &b"II\x2a\0"[..],
        b"MM\0\x2a",
        b"II\x2b\0\x08\0\0\0",
        b"MM\0\x2b\0\x08\0\0",
    ]
    .iter()
    .any(|magic| head.starts_with(magic))
}

/// The decoder of a map.
fn decoder<'a>(
    source: &'a mut (dyn Source + '_),
    failure: &Failure<'_>,
) -> Result<Tiff<'a>, ElevationError> {
    let from: Box<dyn Source + 'a> = Box::new(source);
    Decoder::new(BufReader::with_capacity(1 << 16, from))
        .map_err(|error| failure.of("its directory", error))
}

/// What its first directory tells.
pub(crate) fn head(input: &mut Input<'_>) -> Result<Head, ElevationError> {
    let failure = Failure { file: input.file };
    let band = input.options.band.unwrap_or(1).saturating_sub(1);
    let found = directory::check(input)?;
    let mut tiff = decoder(&mut *input.source, &failure)?;
    let is_big_endian = tiff.byte_order() == ByteOrder::BigEndian;
    let layout = layout(&mut tiff.image_ifd(), is_big_endian, &failure)?;
    let metadata = Metadata::read(&mut tiff, band, &failure)?;
    let own = Numbers {
        unit: metadata.unit.or(Keys::read(&mut tiff, &failure)?.vertical),
        ..Numbers::default()
    };
    let unit = input.sidecars.numbers(band + 1, own, First::Beside).unit;
    Ok(Head::new(kind(found.big), layout.size, layout.number, unit))
}

fn kind(big: bool) -> FileKind {
    match big {
        true => FileKind::BigTiff,
        false => FileKind::Tiff,
    }
}

pub(crate) fn read(input: &mut Input<'_>) -> Result<Elevation, ElevationError> {
    let (file, options, bytes) = (input.file, input.options, input.bytes);
    let mut feed = std::mem::take(&mut input.feed);
    let sidecars = std::mem::take(&mut input.sidecars);
    let failure = Failure { file };
    let directory::Found { big, masks } = directory::check(input)?;
    let mut tiff = decoder(&mut *input.source, &failure)?;
    let is_big_endian = tiff.byte_order() == ByteOrder::BigEndian;
    let layout = layout(&mut tiff.image_ifd(), is_big_endian, &failure)?;
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
        None if layout.heights() == 1 => 0,
        None => {
            return Err(ElevationError::Bands {
                file: file.to_owned(),
                again: options.command(file),
                found: format!("TIFF of {}", layout.number),
                bands: layout.heights(),
            });
        }
    };
    layout.check(bytes, band, &failure)?;
    let keys = Keys::read(&mut tiff, &failure)?;
    let metadata = Metadata::read(&mut tiff, band, &failure)?;
    let own = Numbers {
        nodata: nodata(&mut tiff, options, &failure)?,
        scale: metadata.scale,
        unit: metadata.unit.or(keys.vertical),
        ..Numbers::default()
    };
    let numbers = sidecars.numbers(band + 1, own, First::Beside);
    // Who says that every number is a height means it; who asks for the band that tells where there is data gets it.
    let gaps = options.nodata != NoData::None;
    let alpha = layout.alpha.filter(|&alpha| gaps && alpha != band);
    if let Some(alpha) = alpha {
        layout.check(bytes, alpha, &failure)?;
    }
    let masks = if gaps { &masks[..] } else { &[] };
    let mask = Mask::find(&mut tiff, masks, (&layout, bytes), &failure)?;
    if mask.is_some() {
        // Its own goes before one beside it.
        feed.mask = None;
    }
    let has_gaps = alpha.is_some() || mask.is_some();
    let (nodata, scale) = (&numbers.nodata[..], numbers.scaled());
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
        (nodata, scale),
        complete,
        too_tall,
    )?;
    if layout.number.is_wide() {
        grid.wide(nodata, scale);
    }
    let is_masked = mask.is_some();
    let gaps = Gaps {
        alpha: alpha.is_some(),
        mask,
    };
    let absent = layout.samples(&mut tiff, band, gaps, &mut grid, &failure)?;
    drop(tiff);
    let settled = grid.settle_with_gaps(nodata, scale, absent > 0 || has_gaps)?;
    let mut map = Elevation::new(file, settled, (kind(big), layout.size, layout.number));
    let about = &mut map.about;
    about.bands = layout.bands;
    about.packing = layout.packing(absent);
    numbers.tell(about);
    if is_masked {
        about
            .notes
            .push("a mask tells where there is no data".to_owned());
    }
    if absent > 0 {
        let one = if layout.tiled { "tiles" } else { "strips" };
        about
            .notes
            .push(format!("{absent} {one} are absent: there is no data"));
    }
    let own = OwnPlace {
        keys: &keys,
        file,
        options,
    };
    sidecars.place(&mut map, (file, options), &own)?;
    Ok(map)
}

#[cfg(test)]
mod tests {
    use crate::{Elevation, NoData, Options};
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
    fn a_mask_tells_where_there_is_no_data() {
        let options = Options::default();
        for purpose in [0, 1, 2, 5] {
            let map = Elevation::decode("a.tif", &with_second(purpose), &options);
            assert_eq!(
                map.expect("an overview or a page").samples,
                [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
            );
        }
        let masked = with_second(4);
        let map = Elevation::decode("a.tif", &masked, &options).expect("a mask");
        assert!(map.samples[1].is_nan() && map.about.holes == 1);
        assert_eq!(map.samples[2..], [3.0, 4.0, 5.0, 6.0]);
        // Who says that every number is a height means it.
        let all = Options {
            nodata: NoData::None,
            ..options
        };
        let map = Elevation::decode("a.tif", &masked, &all).expect("heights");
        assert_eq!(map.samples[1], 2.0);
        for length in 0..masked.len() {
            let _ = Elevation::decode("a.tif", &masked[..length], &options);
        }
    }
}
