//! A mask in a file of its own beside the map (`NAME.EXT.msk`, GDAL's): a TIFF of one band of the map's size, 0 where there is no data.

use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

use ::tiff::decoder::Decoder;
use ::tiff::tags::ByteOrder;

use super::failure::Failure;
use super::layout::layout;
use super::mask::Mask;
use super::{Tiff, begins, directory};
use crate::about::NumberType;
use crate::error::{ElevationError, read_error};
use crate::gaps::MaskRows;
use crate::grid::Feed;
use crate::input::{Input, Source};
use crate::options::Options;
use crate::sidecars::Sidecars;

/// A mask that is open.
struct MaskFile {
    name: String,
    tiff: Tiff<'static>,
    mask: Mask,
}

/// Opens one, of a map that errors call `map`; of its pieces those of a row are held, in at most so many bytes.
pub(crate) fn open_mask(
    path: &Path,
    map: &str,
    size: [u32; 2],
    most: u64,
) -> Result<Box<dyn MaskRows>, ElevationError> {
    let name = path.display().to_string();
    let failed = |error: std::io::Error| read_error(&name, &error);
    let wrong = |place: &str, reason: String| ElevationError::Sidecar {
        file: name.clone(),
        map: map.to_owned(),
        place: place.to_owned(),
        reason,
    };
    let mut file = File::open(path).map_err(failed)?;
    let bytes = file.metadata().map_err(failed)?.len();
    let mut head = Vec::new();
    let read = file.by_ref().take(8).read_to_end(&mut head);
    read.and_then(|_| file.rewind()).map_err(failed)?;
    if !begins(&head) {
        return Err(wrong("its first bytes", "it is not a TIFF".to_owned()));
    }
    directory::check(&mut Input {
        file: &name,
        source: &mut file,
        bytes,
        options: &Options::default(),
        sidecars: Sidecars::default(),
        feed: Feed::default(),
    })?;
    let failure = Failure { file: &name };
    let from: Box<dyn Source> = Box::new(file);
    let mut tiff = Decoder::new(BufReader::with_capacity(1 << 16, from))
        .map_err(|error| failure.of("its directory", error))?;
    let big = tiff.byte_order() == ByteOrder::BigEndian;
    let layout = layout(&mut tiff.image_ifd(), big, &failure)?;
    if layout.size != size {
        let [columns, rows] = layout.size;
        let reason = format!(
            "{columns} x {rows} samples, but the map has {} x {}",
            size[0], size[1]
        );
        return Err(wrong("its size", reason));
    }
    if layout.bands != 1 || layout.number != NumberType::U8 {
        let reason = format!(
            "{} bands of {}, but a mask is one of u8",
            layout.bands, layout.number
        );
        return Err(wrong("its samples", reason));
    }
    layout.check(bytes, 0, &failure)?;
    let held = layout
        .row_bytes()
        .saturating_mul(layout.grid()[0].into())
        .saturating_mul(layout.chunk[1].into());
    if held > most {
        let [_, rows] = layout.chunk;
        let what = format!("a mask of this size whose pieces have {rows} rows");
        return Err(failure.unsupported(what, "-co TILED=YES -co COMPRESS=DEFLATE"));
    }
    let mask = Mask::new(layout);
    Ok(Box::new(MaskFile { name, tiff, mask }))
}

impl MaskRows for MaskFile {
    fn row(&mut self, row: usize, there: &mut [bool]) -> Result<(), ElevationError> {
        there.fill(true);
        let failure = Failure { file: &self.name };
        self.mask.row(&mut self.tiff, [0, row], there, &failure)
    }
}
