//! Where readers put their numbers, row by row or block by block; then what holds for all kinds: no data,
//! the file's own scale, range, and numbers that cannot be heights.

mod put;
mod settle;

use crate::about::Text64;
use crate::error::ElevationError;
use crate::gaps::{Gaps, MaskBeside};
use crate::looks::Looks;
use crate::nodata::{Marks, named};
use crate::options::Options;
use crate::progress::ElevationProgress;

/// Takes whole rows as they become complete, from north to south: columns and rows of the map, the first row's number, samples.
pub(crate) type RowSink<'a> = dyn FnMut([u32; 2], usize, &[f32]) -> Result<(), ElevationError> + 'a;

/// Where rows go that are not kept, and who is told how far reading has come.
#[derive(Default)]
pub(crate) struct Feed<'a> {
    pub progress: ElevationProgress,
    pub sink: Option<Box<RowSink<'a>>>,
    /// Most bytes of rows that are held until they are complete.
    pub most: u64,
    /// A mask beside the map, if one counts.
    pub mask: Option<MaskBeside>,
}

/// Bytes of a mask that are held at most where the samples are all kept.
const MOST_OF_MASK: u64 = 1 << 30;

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
    /// What a mask beside the map takes away.
    gaps: Option<Gaps>,
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
    /// What one should know, a sentence each.
    pub notes: Vec<String>,
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
        let kept = check_size(file, size, options)?.map(|n| n as usize);
        let most = feed.sink.as_ref().map_or(MOST_OF_MASK, |_| feed.most);
        let open = |mask: &MaskBeside| Gaps::open(mask, file, size, complete, most);
        let gaps = feed.mask.as_ref().map(open).transpose()?;
        let Some(sink) = feed.sink else {
            let grid = Self::new(file, size, options, false)?;
            return Ok(Self {
                progress: feed.progress,
                gaps,
                ..grid
            });
        };
        // Some rows more than are complete together cost nothing.
        let complete = (complete.clamp(1, size[1]) as usize).max(1);
        let rows = (64_usize.div_ceil(complete) * complete).min(kept[1].next_multiple_of(complete));
        if 4 * (rows as u64) * kept[0] as u64 > feed.most {
            return Err(convert());
        }
        let mut grid = Self::with_rows(file, size, options, false, kept, rows)?;
        grid.progress = feed.progress;
        grid.gaps = gaps;
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
            gaps: None,
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

    /// Columns that are kept, and all samples, for a reader that fills them itself.
    pub fn parts(&mut self) -> (usize, &mut [f32]) {
        (self.kept[0], &mut self.samples)
    }
}
