//! PNG: grey or one channel of a coloured one, 1 to 16 bits, row by row also where it is interlaced.
//!
//! Chunks on colour (gAMA, sRGB, cHRM, iCCP, sBIT) change no number. tRNS of a grey picture names the number that is no
//! data, as GDAL writes it; that of a coloured one names a colour, that of a palette an alpha of each entry. An alpha of 0 is no data.

use crate::about::{FileKind, NumberType};
use crate::error::ElevationError;
use crate::grid::{Grid, check_size};
use crate::input::Input;
use crate::lattice::{First, Nowhere};
use crate::options::{NoData, Options};
use crate::samples::Elevation;
use crate::sidecars::Numbers;
use png::{ColorType, Decoder, DecodingError, Limits, Transformations};
use std::io::BufReader;

/// Deflate makes at most 1032 bytes of one.
const MOST_DEFLATE: u64 = 1032;

/// How the numbers of a row become samples.
struct Channels {
    color: ColorType,
    /// Numbers a pixel.
    count: usize,
    /// Which of them is the height; for a palette, the channel of its colours.
    band: usize,
    bits: usize,
    /// Whether the last one tells where there is data.
    alpha: bool,
    palette: Option<Vec<u8>>,
    /// The colour that stands for no data.
    colour: Option<[u16; 3]>,
    /// Alphas of the first entries of a palette.
    alphas: Vec<u8>,
}

fn number_of(bits: usize) -> NumberType {
    match bits {
        16 => NumberType::U16,
        _ => NumberType::U8,
    }
}

/// Columns and rows, and the kind of its numbers, which its header tells.
pub(crate) fn head(input: &mut Input<'_>) -> Result<([u32; 2], NumberType), ElevationError> {
    let limits = Limits { bytes: 64 << 20 };
    let from = BufReader::with_capacity(1 << 12, &mut *input.source);
    let mut decoder = Decoder::new_with_limits(from, limits);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let info = decoder.read_header_info();
    let info = info.map_err(|error| ElevationError::Damaged {
        file: input.file.to_owned(),
        kind: "PNG",
        place: "its header".to_owned(),
        reason: error.to_string(),
    })?;
    let number = number_of(info.bit_depth as usize);
    Ok(([info.width, info.height], number))
}

pub(crate) fn read(input: &mut Input<'_>) -> Result<Elevation, ElevationError> {
    let (file, options, bytes) = (input.file, input.options, input.bytes);
    let feed = std::mem::take(&mut input.feed);
    let sidecars = std::mem::take(&mut input.sidecars);
    let damaged = |place: &str, error: DecodingError| match error {
        DecodingError::IoError(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => {
            crate::error::read_error(file, &error)
        }
        error => ElevationError::Damaged {
            file: file.to_owned(),
            kind: "PNG",
            place: place.to_owned(),
            reason: error.to_string(),
        },
    };
    // A row of any size that is taken, and what the decoder holds besides.
    let limits = Limits { bytes: 64 << 20 };
    let from = BufReader::with_capacity(1 << 16, &mut *input.source);
    let mut decoder = Decoder::new_with_limits(from, limits);
    decoder.set_transformations(Transformations::IDENTITY);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let mut reader = decoder
        .read_info()
        .map_err(|error| damaged("its header", error))?;
    let info = reader.info();
    let (size, interlaced) = ([info.width, info.height], info.interlaced);
    check_size(file, size, options)?;
    let bits = info.bit_depth as usize;
    let channels = Channels::new(file, options, info)?;
    let nodata: Vec<f64> = match (&info.trns, info.color_type) {
        (Some(trns), ColorType::Grayscale) => match trns[..] {
            [high, low, ..] => vec![f64::from(u16::from_be_bytes([high, low]))],
            [one] => vec![f64::from(one)],
            [] => Vec::new(),
        },
        _ => Vec::new(),
    };
    let own = Numbers {
        nodata,
        ..Numbers::default()
    };
    let numbers = sidecars.numbers(options.band.unwrap_or(1), own, First::File);
    let (nodata, scale) = (&numbers.nodata[..], numbers.scaled());
    let row_bytes = (u64::from(size[0]) * (channels.count * bits) as u64).div_ceil(8);
    let raw = row_bytes.saturating_mul(u64::from(size[1]));
    if raw / MOST_DEFLATE > bytes {
        return Err(ElevationError::Damaged {
            file: file.to_owned(),
            kind: "PNG",
            place: "its header".to_owned(),
            reason: format!(
                "{} x {} pixels cannot be in {} bytes",
                size[0], size[1], bytes
            ),
        });
    }
    let too_large = || ElevationError::Unsupported {
        file: file.to_owned(),
        what: "an interlaced PNG of this size, row by row,".to_owned(),
        convert: format!("gdal_translate {} plain.tif", crate::error::typed(file)),
    };
    let complete = if interlaced { size[1] } else { 1 };
    let own = (nodata, scale);
    let mut grid = Grid::fed(file, size, options, feed, own, complete, too_large)?;
    let mut passes = passes(size, interlaced).into_iter().flatten();
    let mut rows = 0;
    while let Some(row) = reader
        .next_row()
        .map_err(|error| damaged(&format!("row {rows}"), error))?
    {
        let Some((row_at, place)) = passes.next() else {
            break;
        };
        channels.put(&mut grid, row_at, place, row.data());
        rows += 1;
    }
    let missing = passes.next().is_some();
    reader
        .finish()
        .map_err(|error| damaged("after its last row", error))?;
    if missing {
        let reason = format!("it ends before row {rows}");
        return Err(ElevationError::Damaged {
            file: file.to_owned(),
            kind: "PNG",
            place: format!("row {rows}"),
            reason,
        });
    }
    drop(reader);
    let settled = grid.settle_with_gaps(nodata, scale, true)?;
    let number = number_of(bits);
    let mut map = Elevation::new(file, settled, (FileKind::Png, size, number));
    map.about.bands = channels.count as u32;
    map.about.packing = format!("{bits}-bit {}", name(channels.color));
    if interlaced {
        map.about.packing.push_str(", interlaced");
    }
    numbers.tell(&mut map.about);
    if bits <= 8 {
        map.about.notes.push(format!(
            "{bits} bits a sample are {} steps of height: hills will have terraces",
            1 << bits
        ));
    }
    sidecars.place(&mut map, (file, options), &Nowhere)?;
    Ok(map)
}

/// Where the pixels of a row that is stored go.
#[derive(Clone, Copy)]
struct Place {
    column: usize,
    step: usize,
    width: usize,
}

/// Rows in the order in which they are stored, pass by pass: where passes begin and how far their pixels are apart
/// (PNG specification, 8.2).
fn passes(size: [u32; 2], interlaced: bool) -> Vec<impl Iterator<Item = (usize, Place)>> {
    let [columns, rows] = size.map(|n| n as usize);
    let adam7 = [
        [0, 8, 0, 8],
        [4, 8, 0, 8],
        [0, 4, 4, 8],
        [2, 4, 0, 4],
        [0, 2, 2, 4],
        [1, 2, 0, 2],
        [0, 1, 1, 2],
    ];
    let plain = [[0, 1, 0, 1]];
    let passes = if interlaced { &adam7[..] } else { &plain[..] };
    let passes = passes.iter().filter(|[x, ..]| *x < columns);
    let passes = passes.map(|&[column, step, row, apart]| {
        let width = (columns - column).div_ceil(step);
        let place = Place {
            column,
            step,
            width,
        };
        (row..rows).step_by(apart).map(move |row| (row, place))
    });
    passes.collect()
}

fn name(color: ColorType) -> &'static str {
    match color {
        ColorType::Grayscale => "grey",
        ColorType::GrayscaleAlpha => "grey with alpha",
        ColorType::Rgb => "colour",
        ColorType::Rgba => "colour with alpha",
        ColorType::Indexed => "palette",
    }
}

impl Channels {
    fn new(file: &str, options: &Options, info: &png::Info<'_>) -> Result<Self, ElevationError> {
        let color = info.color_type;
        let bits = info.bit_depth as usize;
        let bands = match color {
            ColorType::Grayscale | ColorType::GrayscaleAlpha => 1,
            ColorType::Rgb | ColorType::Rgba | ColorType::Indexed => 3,
        };
        let band = match options.band {
            Some(band) if (1..=bands).contains(&band) => band,
            Some(band) => {
                return Err(ElevationError::NoBand {
                    file: file.to_owned(),
                    band,
                    bands,
                });
            }
            None if bands == 1 => 1,
            None => {
                return Err(ElevationError::Bands {
                    file: file.to_owned(),
                    again: options.command(file),
                    found: format!("{bits}-bit {}", name(color)),
                    bands,
                });
            }
        };
        // Who says that every number is a height means it.
        let gaps = options.nodata != NoData::None;
        let trns = info.trns.as_deref().filter(|_| gaps);
        // The decoder leaves the high bytes of 8 bits away.
        let colour = match (color, trns.unwrap_or_default()) {
            (ColorType::Rgb, &[r, s, g, h, b, c]) => {
                Some([[r, s], [g, h], [b, c]].map(u16::from_be_bytes))
            }
            (ColorType::Rgb, &[red, green, blue]) => Some([red, green, blue].map(u16::from)),
            _ => None,
        };
        let is_palette = color == ColorType::Indexed;
        let alphas = trns.filter(|_| is_palette).unwrap_or_default().to_vec();
        Ok(Self {
            color,
            count: color.samples(),
            band: band as usize - 1,
            bits,
            alpha: gaps && matches!(color, ColorType::GrayscaleAlpha | ColorType::Rgba),
            colour,
            alphas,
            palette: match color {
                ColorType::Indexed => info.palette.as_deref().map(<[u8]>::to_vec),
                _ => None,
            },
        })
    }

    /// Puts the pixels of a row.
    fn put(&self, grid: &mut Grid<'_>, row: usize, place: Place, data: &[u8]) {
        let Place {
            column,
            step,
            width,
        } = place;
        let (pairs, _) = data.as_chunks::<2>();
        if self.bits == 16 && self.count == 1 {
            let values = pairs.iter().map(|b| f32::from(u16::from_be_bytes(*b)));
            return grid.put(row, column, step, values.take(width));
        }
        if self.bits == 8 && self.count == 1 && self.palette.is_none() {
            let values = data.iter().map(|&b| f32::from(b));
            return grid.put(row, column, step, values.take(width));
        }
        let at = |k: usize| match self.bits {
            16 => pairs.get(k).map_or(0, |b| u16::from_be_bytes(*b)),
            8 => data.get(k).map_or(0, |&b| u16::from(b)),
            bits => {
                // The first pixel is in the highest bits.
                let byte = data.get(k * bits / 8).copied().unwrap_or(0);
                let shift = 8 - bits - k * bits % 8;
                u16::from(byte >> shift) & ((1 << bits) - 1)
            }
        };
        let value = |pixel: usize| {
            let first = pixel * self.count;
            let is_clear = || self.alphas.get(usize::from(at(first))) == Some(&0);
            if self.alpha && at(first + self.count - 1) == 0
                || self
                    .colour
                    .is_some_and(|c| c == [0, 1, 2].map(|k| at(first + k)))
                || !self.alphas.is_empty() && is_clear()
            {
                return f32::NAN;
            }
            match &self.palette {
                Some(palette) => {
                    let index = 3 * usize::from(at(first)) + self.band;
                    f32::from(palette.get(index).copied().unwrap_or(0))
                }
                None => f32::from(at(first + self.band)),
            }
        };
        grid.put(row, column, step, (0..width).map(value));
    }
}
