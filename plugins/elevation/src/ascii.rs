//! ESRI ASCII grids: keys and numbers as text.
//!
//! Keys come in any order and case, the place is that of a corner or of a centre, `dx` and `dy` may stand in
//! place of `cellsize`, rows may wrap anywhere. There is no default for no data.

use crate::about::{FileKind, NumberType};
use crate::error::ElevationError;
use crate::georeference::{Crs, FOOT, Georeference, Registration, US_FOOT};
use crate::grid::{Grid, check_size};
use crate::input::{Input, LONGEST, number};
use crate::samples::Elevation;
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
    let failed = |error: std::io::Error| crate::input::read_error(file, &error);
    let mut header = Header::default();
    // The first word that is no key is the first sample.
    let first = loop {
        let word = words.next().map_err(failed)?.to_vec();
        let word = word.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&word).to_vec();
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
    let projection = input.projection.take();
    let damaged = |place: String, reason: String| ElevationError::Damaged {
        file: file.clone(),
        kind: "ESRI ASCII grid",
        place,
        reason,
    };
    let failed = |error: std::io::Error| crate::input::read_error(&file, &error);
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
    let nodata: Vec<f64> = header.nodata.into_iter().collect();
    let own = (&nodata[..], (1.0, 0.0));
    let too_wide = || damaged("key ncols".to_owned(), "a row is too long".to_owned());
    let mut grid = Grid::fed(&file, size, input.options, feed, own, 1, too_wide)?;
    grid.wide(&nodata, (1.0, 0.0));
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
    let settled = grid.settle(&nodata, (1.0, 0.0))?;
    let mut map = Elevation::new(&file, settled, (FileKind::Ascii, size, NumberType::Text));
    header.place(&mut map, projection.as_deref(), input)?;
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

    /// Tells the map where it lies.
    fn place(
        &self,
        map: &mut Elevation,
        projection: Option<&str>,
        input: &Input<'_>,
    ) -> Result<(), ElevationError> {
        let (Some((x, x_centre)), Some((y, y_centre)), [Some(dx), Some(dy)]) =
            (self.x, self.y, self.step)
        else {
            map.about
                .notes
                .push("place or cell size is missing, so where it lies is not known".to_owned());
            return Ok(());
        };
        let [_, rows] = map.about.size.map(f64::from);
        let half = |centre: bool| if centre { 0.0 } else { 0.5 };
        let first = [
            x + half(x_centre) * dx,
            y + (half(y_centre) + rows - 1.0) * dy,
        ];
        let registration = if x_centre && y_centre {
            Registration::Point
        } else {
            Registration::Area
        };
        let crs = match projection {
            Some(text) => match by_prj(text) {
                Some(crs) => crs,
                None if input.options.any_projection => Crs::Unknown,
                None => {
                    return Err(ElevationError::Projection {
                        file: input.file.to_owned(),
                        again: input.options.command(input.file),
                        tag: "the .prj beside it".to_owned(),
                        name: text.chars().take(60).collect(),
                    });
                }
            },
            None => {
                let south = y + (half(y_centre) - 0.5) * dy;
                let on_earth = x.abs() <= 360.0
                    && south >= -91.0
                    && south + rows * dy <= 91.0
                    && dx.max(dy) <= 1.0;
                let (crs, said) = if on_earth {
                    let name = String::new();
                    (
                        Crs::Degrees { epsg: None, name },
                        "degrees: they all lie on the globe",
                    )
                } else {
                    let (name, epsg) = (String::new(), None);
                    let plane = Crs::Projected {
                        epsg,
                        name,
                        unit: 1.0,
                        mercator: false,
                    };
                    (plane, "metres: they do not lie on a globe in degrees")
                };
                map.about.notes.push(format!(
                    "no .prj stands beside it; its places are taken for {said}"
                ));
                crs
            }
        };
        let georeference = Georeference {
            crs,
            first,
            step: [dx, dy],
            registration,
        };
        map.lies_at(georeference, input.options.every);
        Ok(())
    }
}

/// The coordinate system of a `.prj`: well-known text, or ESRI's old keys and values.
fn by_prj(text: &str) -> Option<Crs> {
    // Spaces may stand about brackets and commas.
    let text = text
        .trim_start_matches('\u{feff}')
        .trim()
        .replace(" [", "[");
    let text = text.as_str();
    let upper = text.to_ascii_uppercase();
    let quoted = |text: &str| text.split('"').nth(1).unwrap_or_default().to_owned();
    // A compound system holds the plane, or the globe, before the heights.
    let part = |words: &[&str]| {
        let at = words.iter().filter_map(|word| upper.find(word)).min()?;
        Some(at..at + bracketed(&upper[at..])?)
    };
    if let Some(plane) = part(&["PROJCS[", "PROJCRS["]) {
        let (upper, text) = (&upper[plane.clone()], &text[plane]);
        // The last unit is that of the plane: those before it are of the angles.
        let last = upper.rfind("UNIT[")?;
        let number = upper[last..].split(',').nth(1)?;
        let number = number.split(']').next()?.trim();
        let unit: f64 = number.parse().ok()?;
        let name = quoted(text);
        let mercator = upper.contains("MERCATOR_AUXILIARY_SPHERE") || upper.contains("PSEUDO");
        return (unit > 0.0 && unit.is_finite()).then_some(Crs::Projected {
            epsg: None,
            name,
            unit,
            mercator,
        });
    }
    if let Some(globe) = part(&["GEOGCS[", "GEOGCRS[", "GEODCRS["]) {
        return Some(Crs::Degrees {
            epsg: None,
            name: quoted(&text[globe]),
        });
    }
    // PROJECTION GEOGRAPHIC, UNITS DD
    let value = |key: &str| {
        let line = upper
            .lines()
            .find(|line| line.split_whitespace().next() == Some(key))?;
        line.split_whitespace().nth(1).map(str::to_owned)
    };
    let name = value("PROJECTION")?;
    if name == "GEOGRAPHIC" {
        // Seconds and minutes (DS, DM) are other lengths.
        if value("UNITS").is_some_and(|units| units != "DD") {
            return None;
        }
        return Some(Crs::Degrees {
            epsg: None,
            name: String::new(),
        });
    }
    let unit = match value("UNITS")?.as_str() {
        "METERS" | "METRES" | "METER" | "METRE" => 1.0,
        "FEET" => US_FOOT,
        "INTERNATIONAL_FEET" | "FT" => FOOT,
        _ => return None,
    };
    Some(Crs::Projected {
        epsg: None,
        name,
        unit,
        mercator: false,
    })
}

/// Bytes to the bracket that closes the first one, itself too; brackets in quotes do not count.
fn bracketed(text: &str) -> Option<usize> {
    let (mut depth, mut quoted) = (0_usize, false);
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            b'"' => quoted = !quoted,
            b'[' if !quoted => depth += 1,
            b']' if !quoted => {
                depth = depth.checked_sub(1)?;
                if depth == 0 {
                    return Some(at + 1);
                }
            }
            _ => {}
        }
    }
    None
}
