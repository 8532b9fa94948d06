//! ESRI ASCII grids: keys and numbers as text.
//!
//! Keys come in any order and case, the place is that of a corner or of a centre, `dx` and `dy` may stand in
//! place of `cellsize`, rows may wrap anywhere. There is no default for no data.

use crate::about::{FileKind, NumberType};
use crate::error::ElevationError;
use crate::georeference::Registration;
use crate::grid::{Grid, check_size};
use crate::input::Input;
use crate::lattice::{First, Lattice, Own};
use crate::number::{LONGEST, number};
use crate::samples::Elevation;
use crate::sidecars::Numbers;
use std::io::{BufRead, BufReader, Read};

/// The keys that there are.
const KEYS: [&str; 10] = [
    "ncols",
    "nrows",
    "xllcorner",
    "yllcorner",
    "xllcenter",
    "yllcenter",
    "cellsize",
    "dx",
    "dy",
    "nodata_value",
];

/// Whether a file that begins so is one: its first word is a key.
pub(crate) fn is_header(head: &[u8]) -> bool {
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let first = head
        .split(u8::is_ascii_whitespace)
        .find(|word| !word.is_empty());
    first.is_some_and(|word| {
        KEYS.iter()
            .any(|key| key.as_bytes().eq_ignore_ascii_case(word))
    })
}

/// Whether a grid may begin beyond these first bytes of a file: they are blanks, or the first word may go on.
pub(crate) fn may_begin_later(head: &[u8]) -> bool {
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let longest = KEYS.iter().map(|key| key.len()).max().unwrap_or(0);
    head.trim_ascii_start().len() <= longest
}

/// What the keys say.
#[derive(Default)]
struct Header {
    columns: Option<u32>,
    rows: Option<u32>,
    /// x and y, and whether it is a centre.
    x: Option<(f64, bool)>,
    y: Option<(f64, bool)>,
    step: [Option<f64>; 2],
    nodata: Option<f64>,
}

/// Words between blanks, from a stream.
struct Words<R> {
    from: R,
    word: Vec<u8>,
}

impl<R: BufRead> Words<R> {
    /// The next word; empty at the end.
    fn next(&mut self) -> std::io::Result<&[u8]> {
        self.word.clear();
        loop {
            let buffer = match self.from.fill_buf() {
                Ok(buffer) => buffer,
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            };
            if buffer.is_empty() {
                return Ok(&self.word);
            }
            // What C calls a blank; zeros, and the mark of DOS for the end of a text.
            let blank = |b: &u8| b.is_ascii_whitespace() || matches!(b, 0 | 0x0b | 0x1a);
            if self.word.is_empty() {
                let skip = buffer
                    .iter()
                    .position(|b| !blank(b))
                    .unwrap_or(buffer.len());
                if skip > 0 {
                    self.from.consume(skip);
                    continue;
                }
            }
            let end = buffer.iter().position(blank);
            let taken = end.unwrap_or(buffer.len());
            let room = (LONGEST + 1).saturating_sub(self.word.len());
            self.word.extend_from_slice(&buffer[..taken.min(room)]);
            self.from.consume(taken);
            if end.is_some() {
                return Ok(&self.word);
            }
        }
    }
}

/// Columns and rows, which its keys tell.
pub(crate) fn size(input: &mut Input<'_>) -> Result<[u32; 2], ElevationError> {
    let mut words = Words {
        from: BufReader::with_capacity(1 << 12, &mut *input.source as &mut dyn Read),
        word: Vec::new(),
    };
    header(&mut words, input.file).map(|(_, size, _)| size)
}

/// Keys, columns and rows, and the first word that is no key.
fn header<R: BufRead>(
    words: &mut Words<R>,
    file: &str,
) -> Result<(Header, [u32; 2], Vec<u8>), ElevationError> {
    let damaged = |place: String, reason: String| ElevationError::Damaged {
        file: file.to_owned(),
        kind: "ESRI ASCII grid",
        place,
        reason,
    };
    let failed = |error: std::io::Error| crate::error::read_error(file, &error);
    let mut header = Header::default();
    // The first word that is no key is the first sample.
    let first = loop {
        let word = words.next().map_err(failed)?.to_vec();
        let plain = word.strip_prefix(b"\xef\xbb\xbf");
        if plain.is_some_and(<[u8]>::is_empty) {
            // The mark of UTF-8, and blanks behind it.
            continue;
        }
        let word = plain.unwrap_or(&word).to_vec();
        let Some(key) = KEYS
            .iter()
            .find(|key| key.as_bytes().eq_ignore_ascii_case(&word))
        else {
            break word;
        };
        let value = words.next().map_err(failed)?;
        let shown = value.escape_ascii().to_string();
        header.set(key, value).ok_or_else(|| {
            damaged(
                format!("key {key}"),
                format!("its value {shown:?} is not one"),
            )
        })?;
    };
    let missing = |key: &str| damaged(format!("key {key}"), "it is missing".to_owned());
    let columns = header.columns.ok_or_else(|| missing("ncols"))?;
    let rows = header.rows.ok_or_else(|| missing("nrows"))?;
    Ok((header, [columns, rows], first))
}

pub(crate) fn read(input: &mut Input<'_>) -> Result<Elevation, ElevationError> {
    let file = input.file.to_owned();
    let feed = std::mem::take(&mut input.feed);
    let bytes = input.bytes;
    let sidecars = std::mem::take(&mut input.sidecars);
    let damaged = |place: String, reason: String| ElevationError::Damaged {
        file: file.clone(),
        kind: "ESRI ASCII grid",
        place,
        reason,
    };
    let failed = |error: std::io::Error| crate::error::read_error(&file, &error);
    let mut words = Words {
        from: BufReader::with_capacity(1 << 16, &mut *input.source as &mut dyn Read),
        word: Vec::new(),
    };
    let (header, size, first) = header(&mut words, &file)?;
    let [columns, rows] = size;
    check_size(&file, size, input.options)?;
    // A digit and a blank each, but for the last.
    let samples = u64::from(columns) * u64::from(rows);
    if 2 * samples - 1 > bytes {
        return Err(damaged(
            "its length".to_owned(),
            format!("{samples} samples cannot be in {bytes} bytes"),
        ));
    }
    let own = Numbers {
        nodata: header.nodata.into_iter().collect(),
        ..Numbers::default()
    };
    let numbers = sidecars.numbers(1, own, First::File);
    let (nodata, scale) = (&numbers.nodata[..], numbers.scaled());
    let own = (nodata, scale);
    let too_wide = || damaged("key ncols".to_owned(), "a row is too long".to_owned());
    let mut grid = Grid::fed(&file, size, input.options, feed, own, 1, too_wide)?;
    grid.wide(nodata, scale);
    let mut word = first;
    let mut line = Vec::new();
    for row in 0..rows as usize {
        line.clear();
        for column in 0..columns as usize {
            let sample = number(&word).ok_or_else(|| {
                let reason = match word.len() {
                    0 => "the file ends before it".to_owned(),
                    _ => format!("{:?} is not a number", word.escape_ascii().to_string()),
                };
                damaged(format!("column {column}, row {row}"), reason)
            })?;
            line.push(sample);
            word.clear();
            word.extend_from_slice(words.next().map_err(failed)?);
        }
        grid.put_wide(row, 0, line.iter().copied());
    }
    if !word.is_empty() {
        return Err(damaged(
            format!("after row {}", rows - 1),
            "there are more numbers than columns and rows".to_owned(),
        ));
    }
    drop(words);
    let settled = grid.settle(nodata, scale)?;
    let mut map = Elevation::new(&file, settled, (FileKind::Ascii, size, NumberType::Text));
    numbers.tell(&mut map.about);
    let own = Place(header.lattice(rows));
    sidecars.place(&mut map, (&file, input.options), &own)?;
    if map.georeference.is_none() {
        map.about
            .notes
            .push("place or cell size is missing, so where it lies is not known".to_owned());
    }
    Ok(map)
}

impl Header {
    fn set(&mut self, key: &str, value: &[u8]) -> Option<()> {
        let real = || number(value).filter(|n| n.is_finite());
        // Some write `10.0` rows.
        let count = || {
            let n = real()?;
            (n >= 0.0 && n <= f64::from(u32::MAX) && n.fract() == 0.0).then_some(n as u32)
        };
        let step = || real().filter(|&n| n > 0.0);
        match key {
            "ncols" => self.columns = Some(count()?),
            "nrows" => self.rows = Some(count()?),
            "xllcorner" => self.x = Some((real()?, false)),
            "xllcenter" => self.x = Some((real()?, true)),
            "yllcorner" => self.y = Some((real()?, false)),
            "yllcenter" => self.y = Some((real()?, true)),
            "cellsize" => self.step = [Some(step()?); 2],
            "dx" => self.step[0] = Some(step()?),
            "dy" => self.step[1] = Some(step()?),
            _ => self.nodata = Some(number(value)?),
        }
        Some(())
    }

    /// Columns and rows on the ground.
    fn lattice(&self, rows: u32) -> Option<Lattice> {
        let ((x, x_centre), (y, y_centre)) = (self.x?, self.y?);
        let step = [self.step[0]?, self.step[1]?];
        let half = |centre: bool| if centre { 0.0 } else { 0.5 };
        let first = [
            x + half(x_centre) * step[0],
            y + (half(y_centre) + f64::from(rows) - 1.0) * step[1],
        ];
        let registration = if x_centre && y_centre {
            Registration::Point
        } else {
            Registration::Area
        };
        Some(Lattice {
            first,
            step,
            registration,
        })
    }
}

/// Its place, of which no key says what its numbers are.
struct Place(Option<Lattice>);

impl Own for Place {
    fn lattice(&self) -> Result<Option<Lattice>, ElevationError> {
        Ok(self.0)
    }

    fn first(&self) -> First {
        First::File
    }

    fn tag(&self) -> &'static str {
        "its place and the .prj beside it"
    }
}
