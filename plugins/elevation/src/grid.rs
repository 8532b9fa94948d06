//! Where readers put their numbers, row by row or block by block; then what holds for all kinds: no data,
//! the file's own scale, range, and numbers that cannot be heights.

use crate::about::Text64;
use crate::error::ElevationError;
use crate::extremes::Extremes;
use crate::looks::Looks;
use crate::nodata::{Marks, is_nodata, named};
use crate::options::Options;
use crate::parts::in_parts;
use crate::progress::ElevationProgress;
use crate::refuse::refuse;

/// Takes whole rows as they become complete, from north to south: columns and rows of the map, the first row's number, samples.
pub(crate) type RowSink<'a> = dyn FnMut([u32; 2], usize, &[f32]) -> Result<(), ElevationError> + 'a;

/// Where rows go that are not kept, and who is told how far reading has come.
#[derive(Default)]
pub(crate) struct Feed<'a> {
    pub progress: ElevationProgress,
    pub sink: Option<Box<RowSink<'a>>>,
    /// Most bytes of rows that are held until they are complete.
    pub most: u64,
}

/// Rows that are held until they are complete, and handed on then.
struct Band<'a> {
    sink: Box<RowSink<'a>>,
    /// The first row that is held.
    top: usize,
    /// What stands where nothing is put.
    fill: f32,
    looks: Looks,
    marks: Marks,
    scale: (f64, f64),
    failed: Option<ElevationError>,
}

/// The samples that are kept, row after row from the north.
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
    progress: ElevationProgress,
    /// The last row of which progress was told.
    told: usize,
    band: Option<Band<'a>>,
    wide: Option<Wide>,
}

/// What becomes of numbers that f32 does not hold: before they are rounded it is looked whether they stand for no data, and the
/// file's own scale counts.
struct Wide {
    nodata: Vec<f64>,
    scale: (f64, f64),
    looks: Looks,
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

/// Most samples of any map: 131 072 × 131 072.
pub(crate) const MOST_SAMPLES: u64 = 1 << 34;

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
    if samples(kept(every)) > options.max_samples.min(MOST_SAMPLES) {
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
        Self::with_rows(file, size, options, flip, kept, kept[1])
    }

    /// As [`Self::new`]; where rows are handed on, as many are held at a time as are `complete` together. `nodata` and `scale` are the
    /// file's own.
    ///
    /// # Errors
    /// Rows that do not fit into what may be held: `convert` is what else can be done.
    pub fn fed(
        file: &'a str,
        size: [u32; 2],
        options: &'a Options,
        feed: Feed<'a>,
        (nodata, scale): (&[f64], (f64, f64)),
        complete: u32,
        convert: impl Fn() -> ElevationError,
    ) -> Result<Self, ElevationError> {
        feed.progress.begin("reading", file, u64::from(size[1]));
        let Some(sink) = feed.sink else {
            let grid = Self::new(file, size, options, false)?;
            return Ok(Self {
                progress: feed.progress,
                ..grid
            });
        };
        let kept = check_size(file, size, options)?.map(|n| n as usize);
        // Some rows more than are complete together cost nothing.
        let complete = (complete.clamp(1, size[1]) as usize).max(1);
        let rows = (64_usize.div_ceil(complete) * complete).min(kept[1].next_multiple_of(complete));
        if 4 * (rows as u64) * kept[0] as u64 > feed.most {
            return Err(convert());
        }
        let mut grid = Self::with_rows(file, size, options, false, kept, rows)?;
        grid.progress = feed.progress;
        let named = named(options, nodata);
        grid.band = Some(Band {
            sink,
            top: 0,
            fill: 0.0,
            looks: Looks::default(),
            marks: Marks::new(&named),
            scale,
            failed: None,
        });
        Ok(grid)
    }

    fn with_rows(
        file: &'a str,
        size: [u32; 2],
        options: &'a Options,
        flip: bool,
        kept: [usize; 2],
        rows: usize,
    ) -> Result<Self, ElevationError> {
        let count = kept[0] * rows;
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
            progress: ElevationProgress::default(),
            told: 0,
            band: None,
            wide: None,
        })
    }

    /// Hands on the rows that are held, and holds the next ones.
    fn hand_on(&mut self) {
        let width = self.kept[0];
        let Some(band) = &mut self.band else {
            return;
        };
        let left = self.kept[1].saturating_sub(band.top);
        let rows = self.samples.len() / width;
        let held = &mut self.samples[..width * left.min(rows)];
        if band.failed.is_none() {
            band.marks.mark(held);
            for (row, samples) in held.chunks(width).enumerate() {
                band.looks.row(band.top + row, samples);
            }
            let (scale, offset) = band.scale;
            if band.scale != (1.0, 0.0) {
                for sample in &mut *held {
                    *sample = (f64::from(*sample) * scale + offset) as f32;
                }
            }
            band.failed = (band.sink)(self.kept.map(|n| n as u32), band.top, held).err();
        }
        band.top += rows;
        self.samples.fill(band.fill);
    }

    fn every(&self) -> usize {
        self.options.every.max(1) as usize
    }

    /// Makes all samples NaN, for readers that may leave some out.
    pub fn no_data(&mut self) {
        self.samples.fill(f32::NAN);
        if let Some(band) = &mut self.band {
            band.fill = f32::NAN;
        }
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
        if row > self.told {
            self.progress.add((row - self.told) as u64);
            self.told = row;
        }
        let Some(mut row) = self.row(row) else {
            return;
        };
        let held = self.samples.len() / self.kept[0];
        while let Some(band) = &self.band {
            if row < band.top {
                // It was handed on.
                return;
            }
            if row < band.top + held {
                row -= band.top;
                break;
            }
            self.hand_on();
        }
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

    /// From now on numbers come by [`Self::put_wide`]. `nodata` and `scale` are the file's own.
    pub fn wide(&mut self, nodata: &[f64], scale: (f64, f64)) {
        self.wide = Some(Wide {
            nodata: named(self.options, nodata),
            scale,
            looks: Looks::default(),
        });
        if let Some(band) = &mut self.band {
            (band.marks, band.scale) = (Marks::new(&[]), (1.0, 0.0));
        }
    }

    /// Numbers of the file's row `row` from column `column` on.
    pub fn put_row(&mut self, row: usize, column: usize, values: impl Iterator<Item = f32>) {
        self.put(row, column, 1, values);
    }

    /// The same of numbers that f32 does not hold, after [`Self::wide`].
    pub fn put_wide(&mut self, row: usize, column: usize, values: impl Iterator<Item = f64>) {
        let is_kept = self.row(row).is_some();
        let (every, columns) = (self.every(), self.size[0]);
        // The first column from here on that is kept.
        let first = column.next_multiple_of(every);
        let values = values.take(columns.saturating_sub(column));
        let values = values.skip(first - column).step_by(every);
        let Some(wide) = self.wide.as_mut().filter(|_| is_kept) else {
            return self.put(row, first, every, std::iter::empty());
        };
        let (scale, offset) = wide.scale;
        let mut numbers = Vec::new();
        let mut samples = Vec::new();
        for value in values {
            let is_nodata = wide.nodata.iter().any(|&nodata| is_nodata(value, nodata));
            let number = if is_nodata { f32::NAN } else { value as f32 };
            numbers.push(number);
            samples.push(match number.is_nan() || wide.scale == (1.0, 0.0) {
                true => number,
                false => (value * scale + offset) as f32,
            });
        }
        wide.looks.part([first, row], every, &numbers);
        self.put(row, first, every, samples.into_iter());
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
        let nodata = named(self.options, file_nodata);
        while self
            .band
            .as_ref()
            .is_some_and(|band| band.top < self.kept[1])
        {
            self.hand_on();
        }
        if let Some(band) = self.band.take() {
            if let Some(error) = band.failed {
                return Err(error);
            }
            let looks = self.wide.as_ref().map_or(&band.looks, |wide| &wide.looks);
            looks.check(gaps || !nodata.is_empty(), self.file, self.options)?;
            let is_scaled = self.wide.is_some();
            let scaled = |number: f32| match is_scaled {
                true => number,
                false => (f64::from(number) * scale + offset) as f32,
            };
            return Ok(Settled {
                size: self.kept.map(|n| n as u32),
                samples: Vec::new(),
                holes: band.looks.nan,
                range: band.looks.range().map(|range| {
                    let [a, b] = range.map(scaled);
                    [a.min(b), a.max(b)]
                }),
                nodata: nodata.into_iter().map(Text64).collect(),
            });
        }
        let is_scaled = self.wide.is_some();
        let marks = Marks::new(if is_scaled { &[] } else { &nodata });
        let parts = in_parts(&mut self.samples, |part| {
            marks.mark(part);
            Extremes::of(part)
        });
        let mut found = Extremes::NONE;
        for part in parts {
            found.join(part);
        }
        let holes = found.nan;
        match &self.wide {
            Some(wide) => {
                let marked = gaps || !nodata.is_empty();
                wide.looks.check(marked, self.file, self.options)?;
            }
            None => {
                let told = (gaps || marks.any(), &found);
                refuse(self.file, self.options, self.kept[0], &self.samples, told)?;
            }
        }
        let mut range = (found.low <= found.high).then_some([found.low, found.high]);
        if (scale, offset) != (1.0, 0.0) && !is_scaled {
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
}
