//! Numbers without a header.

use crate::about::{FileKind, NumberType};
use crate::error::ElevationError;
use crate::grid::{Grid, check_size};
use crate::input::{Input, Source, ending};
use crate::lattice::{Nowhere, Own};
use crate::nodata::named;
use crate::options::{ByteOrder, Options, Raw};
use crate::parts::threads;
use crate::progress::ElevationProgress;
use crate::samples::Elevation;
use crate::sidecars::Numbers;
use std::io::SeekFrom;

/// Bytes that are read at a time: more than a disk's block, less than a cache.
const PIECE: usize = 1 << 17;

/// `side`x`side`, if so many bytes are a square of samples.
pub(crate) fn square(bytes: u64, sample: u64) -> Option<String> {
    let side = (bytes / sample).isqrt();
    (side >= 2 && side * side * sample == bytes).then(|| format!("{side}x{side}"))
}

/// The kind of number that an ending stands for.
fn by_ending(file: &str) -> NumberType {
    match ending(file).as_str() {
        "r16" => NumberType::U16,
        "r32" | "f32" => NumberType::F32,
        _ => NumberType::I16,
    }
}

pub(crate) fn read(input: &mut Input<'_>, raw: &Raw) -> Result<Elevation, ElevationError> {
    read_with(input, raw, Numbers::default(), &Nowhere)
}

/// As [`read`], of a kind that says more of its numbers and its place.
pub(crate) fn read_with(
    input: &mut Input<'_>,
    raw: &Raw,
    own: Numbers,
    place: &dyn Own,
) -> Result<Elevation, ElevationError> {
    let sidecars = std::mem::take(&mut input.sidecars);
    let numbers = sidecars.numbers(1, own, place.first());
    let (nodata, scale) = (&numbers.nodata[..], numbers.scaled());
    let is_scaled = scale != (1.0, 0.0);
    let (number, size) = told(input.file, input.bytes, raw)?;
    let plan = Plan::new(input.file, input.bytes, input.options, raw, number, size)?;
    let feed = std::mem::take(&mut input.feed);
    // f32 does not hold them all: one by one, before they are rounded.
    let told = named(input.options, nodata);
    let wide =
        number == NumberType::U32 && (is_scaled || told.iter().any(|&n| n > f64::from(1 << 24)));
    let grid = if feed.sink.is_some() || feed.mask.is_some() || wide {
        let convert = || ElevationError::Memory {
            file: input.file.to_owned(),
            again: input.options.command(input.file),
            bytes: 4 * u64::from(size[0]),
        };
        let own = (nodata, scale);
        let mut grid = Grid::fed(input.file, size, input.options, feed, own, 1, convert)?;
        if wide {
            grid.wide(nodata, scale);
        }
        plan.feed(&mut *input.source, &mut grid, wide)
            .map_err(|error| crate::error::read_error(input.file, &error))?;
        grid
    } else {
        let layout = Layout {
            plan,
            every: input.options.every.max(1) as usize,
            progress: feed.progress,
        };
        layout
            .progress
            .begin("reading", input.file, u64::from(size[1]));
        let mut grid = Grid::new(input.file, size, input.options, raw.flip)?;
        samples(input, &layout, &mut grid)?;
        grid
    };
    let settled = grid.settle(nodata, scale)?;
    let mut map = Elevation::new(input.file, settled, (FileKind::Raw, size, number));
    map.about.packing = packing(raw.order);
    numbers.tell(&mut map.about);
    // Whether they look swapped is seen of the numbers as they are stored.
    let short = matches!(number, NumberType::U16 | NumberType::I16) && !is_scaled;
    if short && looks_swapped(number, size[0] as usize, &map.samples) {
        let other = match raw.order {
            ByteOrder::Little => "big",
            ByteOrder::Big => "little",
        };
        map.about.notes.push(format!(
            "these look like numbers in the other byte order: with `--raw-order {other}` neighbours differ sixteen times less"
        ));
    }
    sidecars.place(&mut map, (input.file, input.options), place)?;
    Ok(map)
}

/// What people call an order of bytes.
pub(crate) fn packing(order: ByteOrder) -> String {
    match order {
        ByteOrder::Little => "little-endian",
        ByteOrder::Big => "big-endian",
    }
    .to_owned()
}

/// Where a raw file's numbers are, borne out by its length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Bytes from a row to the next.
    stride: u64,
    header: u64,
    flip: bool,
    convert: Convert,
}

impl Plan {
    pub fn new(
        file: &str,
        bytes: u64,
        options: &Options,
        raw: &Raw,
        number: NumberType,
        size: [u32; 2],
    ) -> Result<Self, ElevationError> {
        check_size(file, size, options)?;
        let [columns, rows] = size.map(u64::from);
        // Below 2^67 in all: counted in 128 bits.
        let row = u128::from(columns) * u128::from(number.bytes()) + u128::from(raw.row_padding);
        let expected = u128::from(raw.header) + u128::from(rows) * row;
        // Some leave the padding of the last row out.
        let least = expected - u128::from(raw.row_padding);
        let found = u128::from(bytes);
        if found != expected && found != least {
            return Err(ElevationError::RawLength {
                file: file.to_owned(),
                columns: size[0],
                rows: size[1],
                sample_bytes: number.bytes(),
                header: raw.header,
                row_padding: raw.row_padding,
                expected: u64::try_from(expected).unwrap_or(u64::MAX),
                found: bytes,
            });
        }
        Ok(Self {
            size,
            stride: columns * number.bytes() + raw.row_padding,
            header: raw.header,
            flip: raw.flip,
            convert: Convert::of(file, number, raw.order)?,
        })
    }

    pub fn sample_bytes(&self) -> u64 {
        self.convert.number.bytes()
    }

    /// Where a sample of the map stands: rows from the north.
    pub fn at(&self, column: u64, row: u64) -> u64 {
        let row = if self.flip {
            u64::from(self.size[1]) - 1 - row
        } else {
            row
        };
        self.header + row * self.stride + column * self.sample_bytes()
    }

    /// The numbers of `bytes`.
    pub fn numbers(&self, bytes: &[u8], to: &mut [f32]) {
        self.convert.fill(bytes, to);
    }

    /// Hands on all rows, from the north. `wide`: u32 that are not to be rounded yet.
    fn feed(
        &self,
        source: &mut dyn Source,
        grid: &mut Grid<'_>,
        wide: bool,
    ) -> std::io::Result<()> {
        let columns = self.size[0] as usize;
        let mut bytes = vec![0; columns * self.sample_bytes() as usize];
        let mut line = vec![0.0; columns];
        let mut place = u64::MAX;
        for row in 0..self.size[1] {
            let at = self.at(0, row.into());
            if at != place {
                source.seek(SeekFrom::Start(at))?;
            }
            source.read_exact(&mut bytes)?;
            place = at + bytes.len() as u64;
            if wide {
                let (quads, _) = bytes.as_chunks::<4>();
                let number = |b: &[u8; 4]| match self.convert.big {
                    true => f64::from(u32::from_be_bytes(*b)),
                    false => f64::from(u32::from_le_bytes(*b)),
                };
                grid.put_wide(row as usize, 0, quads.iter().map(number));
                continue;
            }
            self.numbers(&bytes, &mut line);
            grid.put(row as usize, 0, 1, line.iter().copied());
        }
        Ok(())
    }
}

/// The kind of number of a raw file, and its size.
///
/// # Errors
/// A size that nobody told.
pub(crate) fn told(
    file: &str,
    bytes: u64,
    raw: &Raw,
) -> Result<(NumberType, [u32; 2]), ElevationError> {
    let number = raw.number.unwrap_or_else(|| by_ending(file));
    let size = raw.size.ok_or_else(|| ElevationError::RawSize {
        file: file.to_owned(),
        guess: square(bytes.saturating_sub(raw.header), number.bytes()),
    })?;
    Ok((number, size))
}

/// How samples are kept that are read at once.
struct Layout {
    plan: Plan,
    every: usize,
    progress: ElevationProgress,
}

/// Reads all samples, on all cores where the file can be opened more than once.
fn samples(
    input: &mut Input<'_>,
    layout: &Layout,
    grid: &mut Grid<'_>,
) -> Result<(), ElevationError> {
    let (width, samples) = grid.parts();
    let threads = threads(samples.len());
    let rows = samples.len() / width;
    let share = rows.div_ceil(threads);
    let sources: Option<Vec<_>> = (1..rows.div_ceil(share))
        .map(|_| input.source.again())
        .collect();
    let Some(mut sources) = sources else {
        return layout
            .rows(&mut *input.source, 0, width, samples)
            .map_err(|error| input.failed(&error));
    };
    let file = input.file;
    let own = &mut *input.source;
    let all = std::thread::scope(|scope| {
        let mut shares = samples.chunks_mut(share * width).enumerate();
        let first = shares.next();
        let others: Vec<_> = shares
            .zip(&mut sources)
            .map(|((k, part), source)| {
                scope.spawn(move || layout.rows(&mut **source, k * share, width, part))
            })
            .collect();
        let mut all = first.map_or(Ok(()), |(_, part)| layout.rows(own, 0, width, part));
        for other in others {
            let other = match other.join() {
                Ok(result) => result,
                Err(panic) => std::panic::resume_unwind(panic),
            };
            all = all.and(other);
        }
        all
    });
    all.map_err(|error| crate::error::read_error(file, &error))
}

impl Layout {
    /// Fills whole rows of the map from row `first` on.
    fn rows(
        &self,
        source: &mut dyn Source,
        first: usize,
        width: usize,
        samples: &mut [f32],
    ) -> std::io::Result<()> {
        let Plan {
            size,
            stride,
            header,
            flip,
            convert,
        } = self.plan;
        let [columns, rows] = size.map(|n| n as usize);
        let bytes = convert.number.bytes() as usize;
        let mut filled = 0;
        let mut tell = |samples: usize| {
            filled += samples;
            if filled >= width {
                self.progress.add((filled / width * self.every) as u64);
                filled %= width;
            }
        };
        let mut buffer = vec![0; PIECE.min(bytes * samples.len() * self.every)];
        let gapless = stride == (columns * bytes) as u64;
        let plain = gapless && !flip && self.every == 1;
        // Rows without gaps are one long row.
        let line = if plain { samples.len() } else { width };
        for (row, line) in samples.chunks_mut(line).enumerate() {
            let row = (first + row) * self.every;
            let row = if flip { rows - 1 - row } else { row };
            source.seek(SeekFrom::Start(header + row as u64 * stride))?;
            let piece = buffer.len() / bytes;
            // In pieces that begin at a sample that is kept.
            let kept = (piece / self.every).max(1);
            for (k, part) in line.chunks_mut(kept).enumerate() {
                if self.every == 1 {
                    let bytes = &mut buffer[..part.len() * bytes];
                    source.read_exact(bytes)?;
                    convert.fill(bytes, part);
                    tell(part.len());
                    continue;
                }
                let column = k * kept * self.every;
                let last = (column + kept * self.every).min(columns);
                buffer.resize(buffer.len().max((last - column) * bytes), 0);
                let read = &mut buffer[..(last - column) * bytes];
                source.read_exact(read)?;
                for (to, from) in part.iter_mut().zip(read.chunks(bytes * self.every)) {
                    convert.fill(&from[..bytes], std::slice::from_mut(to));
                }
                tell(part.len());
            }
        }
        Ok(())
    }
}

/// Whether 16-bit numbers are far smoother with their bytes the other way round: over some thousand pairs of
/// neighbours the sum of differences is a sixteenth.
fn looks_swapped(number: NumberType, columns: usize, samples: &[f32]) -> bool {
    let bits = |sample: f32| match number {
        NumberType::I16 => sample as i16 as u16,
        _ => sample as u16,
    };
    let value = |bits: u16| match number {
        NumberType::I16 => i32::from(bits as i16),
        _ => i32::from(bits),
    };
    let step = (samples.len() / 4096).max(1);
    let (mut as_read, mut swapped) = (0_u64, 0_u64);
    for pair in samples
        .windows(2)
        .step_by(step)
        .filter(|pair| !pair[0].is_nan() && !pair[1].is_nan())
    {
        let [a, b] = [bits(pair[0]), bits(pair[1])];
        as_read += u64::from(value(a).abs_diff(value(b)));
        swapped += u64::from(value(a.swap_bytes()).abs_diff(value(b.swap_bytes())));
    }
    columns > 1 && swapped > 0 && as_read / 16 > swapped
}

/// From bytes to f32.
#[derive(Clone, Copy, Debug)]
struct Convert {
    number: NumberType,
    big: bool,
}

impl Convert {
    fn of(file: &str, number: NumberType, order: ByteOrder) -> Result<Self, ElevationError> {
        use NumberType::{F32, I16, U8, U16, U32};
        if !matches!(number, U8 | U16 | I16 | U32 | F32) {
            return Err(ElevationError::Unsupported {
                file: file.to_owned(),
                what: format!("a raw file of {number}"),
                convert: format!(
                    "dolomite heights {} --raw-type i16",
                    crate::error::typed(file)
                ),
            });
        }
        Ok(Self {
            number,
            big: order == ByteOrder::Big,
        })
    }

    /// The numbers of `bytes` into `to`, as many as there are.
    fn fill(self, bytes: &[u8], to: &mut [f32]) {
        let (pairs, _) = bytes.as_chunks::<2>();
        let (quads, _) = bytes.as_chunks::<4>();
        macro_rules! each {
            ($from:expr, $one:expr) => {
                for (to, from) in to.iter_mut().zip($from) {
                    *to = $one(*from);
                }
            };
        }
        use NumberType::{I16, U8, U16, U32};
        match (self.number, self.big) {
            (U8, _) => each!(bytes, f32::from),
            (U16, false) => each!(pairs, |b| f32::from(u16::from_le_bytes(b))),
            (U16, true) => each!(pairs, |b| f32::from(u16::from_be_bytes(b))),
            (I16, false) => each!(pairs, |b| f32::from(i16::from_le_bytes(b))),
            (I16, true) => each!(pairs, |b| f32::from(i16::from_be_bytes(b))),
            (U32, false) => each!(quads, |b| u32::from_le_bytes(b) as f32),
            (U32, true) => each!(quads, |b| u32::from_be_bytes(b) as f32),
            (_, false) => each!(quads, f32::from_le_bytes),
            (_, true) => each!(quads, f32::from_be_bytes),
        }
    }
}
