//! From a file to samples: which kind it is, and who reads it.

use crate::about::{FileKind, Head, NumberType};
use crate::error::{ElevationError, read_error};
use crate::gaps::MaskBeside;
use crate::grid::{Feed, MOST_SAMPLES};
use crate::input::{Input, Source, ending};
use crate::lattice::First;
use crate::options::{NoData, Options, Raw};
use crate::progress::ElevationProgress;
use crate::samples::Elevation;
use crate::sidecars::{Numbers, Sidecars};
use crate::{ascii, hgt, picture, raw, tiff};
use std::fs::File;
use std::io::{Cursor, Read, Seek, SeekFrom};
use std::path::Path;

/// A file that can be opened once more.
struct Opened<'a> {
    file: File,
    path: &'a Path,
}

impl Read for Opened<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        self.file.read(buffer)
    }
}

impl Seek for Opened<'_> {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.file.seek(to)
    }
}

impl Source for Opened<'_> {
    fn again(&self) -> Option<Box<dyn Source>> {
        // A handle of its own: clones share one position.
        let file = File::open(self.path).ok()?;
        Some(Box::new(file))
    }
}

/// The first bytes tell the kind; no header that is looked for is longer, blanks before it aside.
const HEAD: u64 = 512;
/// Blanks before the header of a grid of text that are passed over, at most.
const BLANKS: u64 = 1 << 16;

impl Elevation {
    /// Reads a file.
    ///
    /// # Errors
    /// [`ElevationError`], naming the file, the place and a way out.
    pub fn read(path: &Path, options: &Options) -> Result<Self, ElevationError> {
        Self::read_telling(path, options, &ElevationProgress::default())
    }

    /// As [`Self::read`], and says how far it has come.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_telling(
        path: &Path,
        options: &Options,
        progress: &ElevationProgress,
    ) -> Result<Self, ElevationError> {
        let feed = Feed {
            progress: progress.clone(),
            ..Feed::default()
        };
        Self::fed(path, options, feed)
    }

    /// Columns and rows of a file, from its head alone.
    ///
    /// # Errors
    /// As [`Self::read`], as far as the head tells.
    pub fn size(path: &Path, options: &Options) -> Result<[u32; 2], ElevationError> {
        Self::head(path, options).map(|head| head.size)
    }

    /// What the head of a file tells, without its samples.
    ///
    /// # Errors
    /// As [`Self::read`], as far as the head tells.
    pub fn head(path: &Path, options: &Options) -> Result<Head, ElevationError> {
        let any = Options {
            max_samples: MOST_SAMPLES,
            ..*options
        };
        with_input(path, &any, Feed::default(), |mut input| {
            let kind = found(&mut input)?;
            let beside = |band| {
                input
                    .sidecars
                    .numbers(band, Numbers::default(), First::Beside)
                    .unit
            };
            let (unit, of_band) = (beside(1), beside(options.band.unwrap_or(1)));
            Ok(match &kind {
                Found::Raw(told) => {
                    let (number, size) = raw::told(input.file, input.bytes, told)?;
                    Head::new(FileKind::Raw, size, number, unit)
                }
                Found::Png => {
                    let (size, number) = picture::head(&mut input)?;
                    Head::new(FileKind::Png, size, number, of_band)
                }
                Found::Tiff => tiff::head(&mut input)?,
                Found::Ascii => {
                    let size = ascii::size(&mut input)?;
                    Head::new(FileKind::Ascii, size, NumberType::Text, unit)
                }
                Found::Hgt => {
                    let size = hgt::size(&input)?;
                    Head::new(FileKind::Hgt, size, NumberType::I16, Some(1.0))
                }
            })
        })
    }

    /// As [`Self::read`]; rows go where `feed` says, and none is kept if that is anywhere.
    pub(crate) fn fed(
        path: &Path,
        options: &Options,
        feed: Feed<'_>,
    ) -> Result<Self, ElevationError> {
        with_input(path, options, feed, read)
    }

    /// Reads the bytes of a file; `name` is what errors call it, and its ending counts.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn decode(name: &str, bytes: &[u8], options: &Options) -> Result<Self, ElevationError> {
        read(Input {
            file: name,
            bytes: bytes.len() as u64,
            source: &mut Cursor::new(bytes),
            options,
            sidecars: Sidecars::default(),
            feed: Feed::default(),
        })
    }
}

/// Opens a file, looks for what stands beside it, and lets `work` read it.
pub(crate) fn with_input<R>(
    path: &Path,
    options: &Options,
    feed: Feed<'_>,
    work: impl FnOnce(Input<'_>) -> Result<R, ElevationError>,
) -> Result<R, ElevationError> {
    let name = path.display().to_string();
    let file = File::open(path).map_err(|error| read_error(&name, &error))?;
    let data = file.metadata().map_err(|error| read_error(&name, &error))?;
    if !data.is_file() {
        let error = std::io::Error::other("it is not a file");
        return Err(read_error(&name, &error));
    }
    let sidecars = Sidecars::of(path)?;
    // Who says that every number is a height means it.
    let mask = sidecars.mask().filter(|_| options.nodata != NoData::None);
    let mask = mask.map(|mask| MaskBeside {
        path: mask.to_owned(),
        open: tiff::open_mask,
    });
    let mut source = Opened { file, path };
    work(Input {
        file: &name,
        source: &mut source,
        bytes: data.len(),
        options,
        sidecars,
        feed: Feed { mask, ..feed },
    })
}

/// What a file is, and with that who reads it.
pub(crate) enum Found {
    Png,
    Tiff,
    Ascii,
    Hgt,
    Raw(Raw),
}

/// The kind by the content, then by the ending.
pub(crate) fn found(input: &mut Input<'_>) -> Result<Found, ElevationError> {
    if let Some(raw) = input.options.raw {
        return Ok(Found::Raw(raw));
    }
    let mut head = Vec::new();
    let mut read = (&mut input.source).take(HEAD).read_to_end(&mut head);
    if read.is_ok() && ascii::may_begin_later(&head) {
        read = (&mut input.source).take(BLANKS).read_to_end(&mut head);
    }
    read.and_then(|_| input.source.rewind())
        .map_err(|error| input.failed(&error))?;
    if head.starts_with(b"\x89PNG\r\n\x1a\n") {
        return Ok(Found::Png);
    }
    if tiff::begins(&head) {
        return Ok(Found::Tiff);
    }
    if ascii::is_header(&head) {
        return Ok(Found::Ascii);
    }
    let ending = ending(input.file);
    match ending.as_str() {
        "hgt" => Ok(Found::Hgt),
        "raw" | "r16" | "r32" | "f32" => Ok(Found::Raw(Raw::default())),
        other => Err(unknown(input, &head, other)),
    }
}

fn read(mut input: Input<'_>) -> Result<Elevation, ElevationError> {
    match found(&mut input)? {
        Found::Raw(raw) => raw::read(&mut input, &raw),
        Found::Png => picture::read(&mut input),
        Found::Tiff => tiff::read(&mut input),
        Found::Ascii => ascii::read(&mut input),
        Found::Hgt => hgt::read(&mut input),
    }
}

fn unknown(input: &Input<'_>, head: &[u8], ending: &str) -> ElevationError {
    let found = match (head.len(), ending) {
        (0, _) => "it is empty".to_owned(),
        (_, "png" | "tif" | "tiff" | "asc") => {
            let first = &head[..head.len().min(8)];
            format!(
                "its ending is .{ending}, but it begins with {}",
                first.escape_ascii()
            )
        }
        _ => format!("{} bytes", input.bytes),
    };
    let (size, number) = [(2, "i16"), (4, "f32"), (1, "u8")]
        .into_iter()
        .find_map(|(bytes, number)| Some((raw::square(input.bytes, bytes)?, number)))
        .unwrap_or_else(|| ("COLUMNSxROWS".to_owned(), "u16"));
    ElevationError::Kind {
        file: input.file.to_owned(),
        found,
        size,
        number,
    }
}
