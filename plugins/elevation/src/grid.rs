//! Where readers put their numbers, row by row or block by block; then what holds for all kinds: no data,
//! the file's own scale, range, and numbers that cannot be heights.

use crate::about::Text64;
use crate::error::ElevationError;
use crate::options::{NoData, Options};

/// The samples that are kept, row after row from the north.
#[derive(Debug)]
pub(crate) struct Grid<'a> {
    file: &'a str,
    options: &'a Options,
    /// Columns and rows of the file.
    size: [usize; 2],
    /// Columns and rows that are kept.
    kept: [usize; 2],
    samples: Vec<f32>,
    /// Whether the file's rows run from south to north.
    flip: bool,
}

/// What is known of the samples once all are there.
#[derive(Debug)]
pub(crate) struct Settled {
    pub samples: Vec<f32>,
    pub size: [u32; 2],
    pub holes: u64,
    pub range: Option<[f32; 2]>,
    pub nodata: Vec<Text64>,
}

/// Refuses a size of 0 and one beyond the limit. No memory is taken yet.
pub(crate) fn check_size(
    file: &str,
    [columns, rows]: [u32; 2],
    options: &Options,
) -> Result<[u32; 2], ElevationError> {
    if columns == 0 || rows == 0 {
        return Err(ElevationError::Empty {
            file: file.to_owned(),
            columns,
            rows,
        });
    }
    let every = options.every.max(1);
    let kept = |every: u32| [columns.div_ceil(every), rows.div_ceil(every)];
    let samples = |[columns, rows]: [u32; 2]| u64::from(columns) * u64::from(rows);
    if samples(kept(every)) > options.max_samples.min(1 << 32) {
        let fits = (2..64).chain((6..32).map(|k| 1 << k));
        let fits = fits
            .filter(|&n| n > every)
            .find(|&n| samples(kept(n)) <= options.max_samples);
        return Err(ElevationError::TooLarge {
            file: file.to_owned(),
            again: options.command(file),
            columns,
            rows,
            most: options.max_samples,
            every: fits.unwrap_or(u32::MAX),
        });
    }
    Ok(kept(every))
}

impl<'a> Grid<'a> {
    /// Room for the samples, all 0. Call it once the file's length bears out its size.
    pub fn new(
        file: &'a str,
        size: [u32; 2],
        options: &'a Options,
        flip: bool,
    ) -> Result<Self, ElevationError> {
        let kept = check_size(file, size, options)?.map(|n| n as usize);
        let count = kept[0] * kept[1];
        if Vec::<f32>::new().try_reserve_exact(count).is_err() {
            return Err(ElevationError::Memory {
                file: file.to_owned(),
                again: options.command(file),
                bytes: 4 * count as u64,
            });
        }
        Ok(Self {
            file,
            options,
            size: size.map(|n| n as usize),
            kept,
            // The system gives zeros without writing them.
            samples: vec![0.0; count],
            flip,
        })
    }

    fn every(&self) -> usize {
        self.options.every.max(1) as usize
    }

    /// Makes all samples NaN, for readers that may leave some out.
    pub fn no_data(&mut self) {
        self.samples.fill(f32::NAN);
    }

    /// The row of the map that a row of the file becomes, if it is kept.
    fn row(&self, row: usize) -> Option<usize> {
        let row = if self.flip {
            self.size[1] - 1 - row
        } else {
            row
        };
        row.is_multiple_of(self.every()).then(|| row / self.every())
    }

    /// Numbers of the file's row `row` from column `column` on, every `step` columns.
    #[inline]
    pub fn put(
        &mut self,
        row: usize,
        column: usize,
        step: usize,
        values: impl Iterator<Item = f32>,
    ) {
        let Some(row) = self.row(row) else {
            return;
        };
        let (every, width) = (self.every(), self.kept[0]);
        let line = &mut self.samples[row * width..][..width];
        if (every, step) == (1, 1) {
            for (to, value) in line[column.min(width)..].iter_mut().zip(values) {
                *to = value;
            }
            return;
        }
        for (k, value) in values.enumerate() {
            let column = column + k * step;
            if column.is_multiple_of(every)
                && let Some(to) = line.get_mut(column / every)
            {
                *to = value;
            }
        }
    }

    /// Columns that are kept, and all samples, for a reader that fills them itself.
    pub fn parts(&mut self) -> (usize, &mut [f32]) {
        (self.kept[0], &mut self.samples)
    }

    /// Marks what is no data as NaN, applies the file's own scale, and refuses what cannot be a height.
    ///
    /// `file_nodata`: numbers that the file itself names.
    pub fn settle(self, file_nodata: &[f64], scale: (f64, f64)) -> Result<Settled, ElevationError> {
        self.settle_with_gaps(file_nodata, scale, false)
    }

    /// As [`Self::settle`]; `gaps`: the reader itself left NaN where there is no data.
    pub fn settle_with_gaps(
        mut self,
        file_nodata: &[f64],
        (scale, offset): (f64, f64),
        gaps: bool,
    ) -> Result<Settled, ElevationError> {
        let mut nodata: Vec<f64> = match self.options.nodata {
            NoData::None => Vec::new(),
            _ => file_nodata.to_vec(),
        };
        if let NoData::Value(value) = self.options.nodata
            && !nodata.iter().any(|n| n.to_bits() == value.to_bits())
        {
            nodata.push(value);
        }
        let marks = Marks::new(&nodata);
        let parts = in_parts(&mut self.samples, |part| {
            marks.mark(part);
            Extremes::of(part)
        });
        let mut found = Extremes::NONE;
        for part in parts {
            found.join(part);
        }
        let holes = found.nan;
        self.check(gaps || marks.any(), &found)?;
        let mut range = (found.low <= found.high).then_some([found.low, found.high]);
        if (scale, offset) != (1.0, 0.0) {
            let scaled = |number: f32| (f64::from(number) * scale + offset) as f32;
            in_parts(&mut self.samples, |part| {
                for sample in part {
                    *sample = scaled(*sample);
                }
            });
            range = range.map(|range| {
                let [a, b] = range.map(scaled);
                [a.min(b), a.max(b)]
            });
        }
        Ok(Settled {
            size: self.kept.map(|n| n as u32),
            samples: self.samples,
            holes,
            range,
            nodata: nodata.into_iter().map(Text64).collect(),
        })
    }

    /// Refuses NaN without a word that it is no data, infinity, and numbers that can only be no data.
    fn check(&self, marked: bool, found: &Extremes) -> Result<(), ElevationError> {
        let at = |index: usize| {
            let every = self.options.every.max(1);
            let place = [index % self.kept[0], index / self.kept[0]];
            place.map(|n| n as u32 * every)
        };
        let find = |is: &dyn Fn(f32) -> bool| {
            let first = self.samples.iter().position(|&sample| is(sample));
            let count = self.samples.iter().filter(|&&sample| is(sample)).count();
            first.map(|first| (at(first), count as u64))
        };
        let again = || self.options.command(self.file);
        let not_finite = |value: f32, is: &dyn Fn(f32) -> bool| {
            find(is).map(|([column, row], count)| ElevationError::NotFinite {
                file: self.file.to_owned(),
                again: again(),
                value,
                column,
                row,
                count,
            })
        };
        // What was marked is NaN as well: only where nothing could mark is a NaN the file's own.
        if found.nan > 0
            && !marked
            && let Some(error) = not_finite(f32::NAN, &|s| s.is_nan())
        {
            return Err(error);
        }
        for infinite in [f32::INFINITY, f32::NEG_INFINITY] {
            if (found.low == infinite || found.high == infinite)
                && let Some(error) = not_finite(infinite, &|s| s == infinite)
            {
                return Err(error);
            }
        }
        if self.options.nodata == NoData::None {
            return Ok(());
        }
        for value in [found.low, found.high] {
            if !is_customary(value) {
                continue;
            }
            let mut others = Extremes::NONE;
            let parts = self.samples.chunks(1 << 16).map(|part| {
                let mut others = Extremes::NONE;
                for &sample in part.iter().filter(|&&sample| sample != value) {
                    others.low = others.low.min(sample);
                    others.high = others.high.max(sample);
                }
                others
            });
            for part in parts {
                others.join(part);
            }
            // Farther from all others than they are from each other, and than any step of a cliff.
            let apart = (value - others.high).max(others.low - value);
            if others.low <= others.high
                && apart > (others.high - others.low).max(100.0)
                && let Some(([column, row], count)) = find(&|s| s == value)
            {
                return Err(ElevationError::LooksLikeNoData {
                    file: self.file.to_owned(),
                    again: again(),
                    value,
                    column,
                    row,
                    count,
                    low: others.low,
                    high: others.high,
                });
            }
        }
        Ok(())
    }
}

/// Whether people write this number where there is no data: runs of nines, the ends of integers, the largest
/// floats.
fn is_customary(value: f32) -> bool {
    let size = value.abs();
    let nines = [9999.0, 99_999.0, 999_999.0, 9_999_999.0];
    let ends = [
        32_767.0,
        32_768.0,
        65_535.0,
        2_147_483_647.0,
        4_294_967_295.0,
        100_000.0,
    ];
    nines.contains(&size) || ends.contains(&size) || size >= 1e19
}

/// The numbers that stand for no data, as they compare with samples.
struct Marks(Vec<f32>);

impl Marks {
    fn new(nodata: &[f64]) -> Self {
        Self(nodata.iter().map(|&n| n as f32).collect())
    }

    fn any(&self) -> bool {
        !self.0.is_empty()
    }

    /// Makes them NaN.
    fn mark(&self, samples: &mut [f32]) {
        for &nodata in self.0.iter().filter(|n| !n.is_nan()) {
            for sample in samples.iter_mut() {
                *sample = if *sample == nodata { f32::NAN } else { *sample };
            }
        }
    }
}

/// Lowest and highest number, and how many are NaN.
#[derive(Clone, Copy, Debug)]
struct Extremes {
    low: f32,
    high: f32,
    nan: u64,
}

impl Extremes {
    const NONE: Self = Self {
        low: f32::INFINITY,
        high: f32::NEG_INFINITY,
        nan: 0,
    };

    fn of(samples: &[f32]) -> Self {
        let mut all = Self::NONE;
        for part in samples.chunks(1 << 12) {
            // Eight lanes, so that it runs in vectors.
            let (mut low, mut high) = ([f32::INFINITY; 8], [f32::NEG_INFINITY; 8]);
            let mut nan = [0_u32; 8];
            let (eights, rest) = part.as_chunks::<8>();
            for eight in eights {
                for k in 0..8 {
                    low[k] = if eight[k] < low[k] { eight[k] } else { low[k] };
                    high[k] = if eight[k] > high[k] {
                        eight[k]
                    } else {
                        high[k]
                    };
                    nan[k] += u32::from(eight[k].is_nan());
                }
            }
            let mut part = Self {
                low: low.into_iter().fold(f32::INFINITY, f32::min),
                high: high.into_iter().fold(f32::NEG_INFINITY, f32::max),
                nan: nan.into_iter().map(u64::from).sum(),
            };
            for &sample in rest {
                part.low = part.low.min(sample);
                part.high = part.high.max(sample);
                part.nan += u64::from(sample.is_nan());
            }
            all.join(part);
        }
        all
    }

    fn join(&mut self, other: Self) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
        self.nan += other.nan;
    }
}

/// Runs `work` over parts of the samples, each part in cache, on all cores where that pays.
pub(crate) fn in_parts<R: Send>(
    samples: &mut [f32],
    work: impl Fn(&mut [f32]) -> R + Sync,
) -> Vec<R> {
    const PART: usize = 1 << 14;
    let threads = threads(samples.len());
    let share = samples.len().div_ceil(threads).next_multiple_of(PART);
    if threads == 1 {
        return samples.chunks_mut(PART).map(&work).collect();
    }
    std::thread::scope(|scope| {
        let shares: Vec<_> = samples
            .chunks_mut(share)
            .map(|share| {
                let work = &work;
                scope.spawn(move || share.chunks_mut(PART).map(work).collect::<Vec<_>>())
            })
            .collect();
        let shares = shares.into_iter().map(|share| match share.join() {
            Ok(results) => results,
            Err(panic) => std::panic::resume_unwind(panic),
        });
        shares.flatten().collect()
    })
}

/// How many threads so many samples are worth.
pub(crate) fn threads(samples: usize) -> usize {
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get);
    // A thread costs some 50 us, a million samples a millisecond.
    (samples >> 20).clamp(1, cores.min(16))
}
