//! A file of tiles, made once: level 0 as rows stream by, then in one look at it everything coarser.

use super::base::{Direct, spread};
use super::derive::{
    TILE, TILE_COUNT, deviations_of, off_bilinear, region_side, strip_rows, tile_of,
};
use super::form::{Form, HEAD, MARK, NOTE, STORED};
use super::place::Placed;
use super::sum::sum;
use super::{Base, Extremes, note};
use crate::about::About;
use crate::error::ElevationError;
use crate::options::Options;
use crate::progress::ElevationProgress;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Samples of the map between those of the first stored level.
const STEP: usize = 1 << STORED;
/// Tiles of level 0 along a side of one of the first stored level.
const UNDER: usize = STEP;

/// The part that grows beside the file of tiles until it is whole.
pub(super) struct Part<'a> {
    pub file: Placed,
    pub path: &'a Path,
    pub form: Form,
    pub sums: Mutex<Vec<u64>>,
    /// What went wrong first; whoever writes after that does nothing.
    failed: Mutex<Option<ElevationError>>,
}

impl<'a> Part<'a> {
    pub fn new(file: Placed, path: &'a Path, form: Form) -> std::io::Result<Self> {
        file.set_bytes(form.all())?;
        let sums = vec![0; form.sums() as usize];
        Ok(Self {
            file,
            path,
            form,
            sums: Mutex::new(sums),
            failed: Mutex::new(None),
        })
    }

    fn error(&self, error: &std::io::Error) -> ElevationError {
        ElevationError::Write {
            file: self.path.display().to_string(),
            reason: error.to_string(),
        }
    }

    fn put(&self, level: u32, at: [u32; 2], bytes: &[u8]) -> Result<(), ElevationError> {
        let place = self.form.tile(level, at);
        self.file
            .write(place, bytes)
            .map_err(|error| self.error(&error))?;
        let number = self.form.sum(level, at) as usize;
        lock(&self.sums)[number] = sum(bytes);
        Ok(())
    }

    /// Takes rows of the map and puts tiles of level 0; `rows` are those that wait for their tiles.
    pub fn rows(
        &self,
        waiting: &mut Vec<f32>,
        first: usize,
        samples: &[f32],
        (hole, name): (f32, &str),
    ) -> Result<(), ElevationError> {
        let [columns, rows] = self.form.size.map(|n| n as usize);
        refuse_holes(samples, hole, name)?;
        for (k, line) in samples.chunks(columns).enumerate() {
            let row = first + k;
            waiting.extend(line.iter().map(|&s| if s.is_nan() { hole } else { s }));
            if row % TILE != TILE - 1 && row + 1 != rows {
                continue;
            }
            let mut tile = vec![0.0; TILE_COUNT];
            let held = waiting.len() / columns;
            for column in 0..self.form.tiles(0)[0] {
                let begin = column as usize * TILE;
                for (z, to) in tile.chunks_mut(TILE).enumerate() {
                    let line = &waiting[z.min(held - 1) * columns..][..columns];
                    spread(&line[begin.min(columns - 1)..], 0, to);
                }
                self.put(0, [column, (row / TILE) as u32], &bytes_of(&[&tile]))?;
            }
            waiting.clear();
        }
        Ok(())
    }

    /// Writes what stands before the tiles.
    pub fn close(
        &self,
        about: &About,
        extremes: &[Extremes],
        key: u64,
    ) -> Result<(), ElevationError> {
        let head = self.head(about, extremes, key);
        let sync = || -> std::io::Result<()> {
            self.file.write(0, &head)?;
            self.file.sync()
        };
        sync().map_err(|error| self.error(&error))
    }

    fn head(&self, about: &About, extremes: &[Extremes], key: u64) -> Vec<u8> {
        let note = note::encode(about);
        let mut rest = note.clone();
        rest.resize(NOTE as usize, 0);
        for tile in extremes {
            for number in [tile.low, tile.high, tile.step] {
                rest.extend(number.to_le_bytes());
            }
        }
        for sum in lock(&self.sums).iter() {
            rest.extend(sum.to_le_bytes());
        }
        let mut head = MARK.to_vec();
        head.extend(key.to_le_bytes());
        head.extend(self.form.size.iter().flat_map(|n| n.to_le_bytes()));
        head.extend(u64::from(self.form.base).to_le_bytes());
        head.extend((note.len() as u64).to_le_bytes());
        head.extend(sum(&rest).to_le_bytes());
        let own = sum(&head);
        head.extend(own.to_le_bytes());
        head.resize(HEAD, 0);
        head.extend(rest);
        head
    }
}

/// The bytes of planes, one after the other.
pub(super) fn bytes_of(planes: &[&[f32]]) -> Vec<u8> {
    let all = planes.iter().flat_map(|plane| plane.iter());
    all.flat_map(|number| number.to_le_bytes()).collect()
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    // What stands in it is whole whenever somebody panics.
    mutex
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// The samples of the first stored level, and how far the map is from what they interpolate: held while coarser levels are made.
struct Coarse {
    size: [usize; 2],
    heights: Vec<f32>,
    off: Vec<f32>,
}

impl Coarse {
    fn bytes([columns, rows]: [u32; 2]) -> u64 {
        8 * u64::from(columns) * u64::from(rows)
    }

    /// Rows about a row of samples of a level, so many of ours apart, for the tiles of a column.
    fn strip(&self, column: u32, row: usize, step: usize, to: &mut Vec<f32>) {
        let side = region_side(step) as i64;
        let begin = (column as usize * TILE * step) as i64 - 1;
        let first = (row * step) as i64 - 1;
        let [columns, rows] = self.size.map(|n| n as i64);
        to.clear();
        for z in first..first + strip_rows(step) as i64 {
            let z = z.clamp(0, rows - 1) as usize;
            let line = &self.heights[z * self.size[0]..][..self.size[0]];
            let samples = begin..begin + side;
            to.extend(samples.map(|x| line[x.clamp(0, columns - 1) as usize]));
        }
    }

    /// The largest distance of the map from what is interpolated here, in the window of a sample of a level.
    fn off(&self, [column, row]: [usize; 2], step: usize) -> f32 {
        let range = |n: usize, count: usize| {
            let begin = (n * step).saturating_sub(1).min(count - 1);
            begin..(n * step + 2 * step + 1).clamp(begin + 1, count)
        };
        let mut most = 0.0_f32;
        for z in range(row, self.size[1]) {
            for &off in &self.off[z * self.size[0]..][range(column, self.size[0])] {
                most = if off > most { off } else { most };
            }
        }
        most
    }
}

/// Runs `work` for each of so many tiles on all cores; the first error ends it.
fn each(
    part: &Part<'_>,
    [columns, rows]: [u32; 2],
    work: impl Fn([u32; 2]) -> Result<(), ElevationError> + Sync,
) -> Result<(), ElevationError> {
    let next = AtomicUsize::new(0);
    let count = columns as usize * rows as usize;
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get);
    std::thread::scope(|scope| {
        for _ in 0..cores.min(count).min(16) {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    if k >= count || lock(&part.failed).is_some() {
                        return;
                    }
                    let at = [k as u32 % columns, k as u32 / columns];
                    if let Err(error) = work(at) {
                        lock(&part.failed).get_or_insert(error);
                        return;
                    }
                }
            });
        }
    });
    lock(&part.failed).take().map_or(Ok(()), Err)
}

/// Makes everything coarser than level 0; returns the extremes of its tiles.
pub(super) fn pyramid(
    part: &Part<'_>,
    base: &Base<'_>,
    (name, options, memory, smooth): (&str, &Options, u64, bool),
    progress: &ElevationProgress,
) -> Result<Vec<Extremes>, ElevationError> {
    let form = &part.form;
    let coarse_size = form.samples(STORED);
    let stored = form.top >= STORED;
    let needed = 12 * u64::from(form.tiles(0)[0]) * u64::from(form.tiles(0)[1])
        + if stored {
            Coarse::bytes(coarse_size)
        } else {
            0
        };
    if needed > memory {
        return Err(ElevationError::TileMemory {
            file: name.to_owned(),
            again: options.command(name),
            columns: form.size[0],
            rows: form.size[1],
            needed,
            most: memory,
        });
    }
    let [across, down] = form.tiles(0);
    let extremes = Mutex::new(vec![Extremes::NONE; across as usize * down as usize]);
    let count = if stored {
        coarse_size[0] as usize * coarse_size[1] as usize
    } else {
        0
    };
    let coarse = Mutex::new(Coarse {
        size: coarse_size.map(|n| n as usize),
        heights: vec![0.0; count],
        off: vec![0.0; count],
    });
    // The last sample of a level may stand beyond the border, in a tile under which there is none of level 0: a map of 1024
    // samples has eight tiles, and 129 samples on the eighth part of that.
    let least = if stored { form.tiles(STORED) } else { [1; 2] };
    let blocks = [across.div_ceil(UNDER as u32), down.div_ceil(UNDER as u32)];
    let blocks = [blocks[0].max(least[0]), blocks[1].max(least[1])];
    progress.begin("making tiles", name, u64::from(form.size[1]));
    let done = AtomicUsize::new(0);
    each(part, blocks, |at| {
        let side = region_side(STEP);
        let begin = at.map(|n| i64::from(n) * (TILE * STEP) as i64 - 1);
        let mut region = vec![0.0; side * side];
        base.read(form, begin, side, &mut region)?;
        if base.marks() {
            refuse_holes(&region, f32::NAN, name)?;
        }
        for row in 0..UNDER as u32 {
            for column in 0..UNDER as u32 {
                let tile = [at[0] * UNDER as u32 + column, at[1] * UNDER as u32 + row];
                if tile[0] < across && tile[1] < down {
                    let first = (row as usize * TILE + 1) * side + column as usize * TILE + 1;
                    let found = Extremes::of(&region[first..], side);
                    lock(&extremes)[form.number(0, tile) as usize] = found;
                }
            }
        }
        if stored && at[0] < form.tiles(STORED)[0] && at[1] < form.tiles(STORED)[1] {
            let tile = tile_of(&region, STEP, smooth);
            let mut off = Vec::new();
            off_bilinear(&region, STEP, &mut off);
            let mut coarse = lock(&coarse);
            let Coarse {
                size: [columns, rows],
                heights,
                off: all,
            } = &mut *coarse;
            let [x, z] = at.map(|n| n as usize * TILE);
            let wide = TILE.min(*columns - x);
            for k in 0..TILE.min(*rows - z) {
                let to = (z + k) * *columns + x;
                heights[to..to + wide].copy_from_slice(&tile.heights[k * TILE..][..wide]);
                all[to..to + wide].copy_from_slice(&off[k * TILE..][..wide]);
            }
            drop(coarse);
            part.put(STORED, at, &tile_bytes(&tile))?;
        }
        // Rows of the whole map, a share for each tile.
        let all = blocks[0] as usize;
        let before = done.fetch_add(1, Ordering::Relaxed);
        let rows = |tiles: usize| tiles * UNDER * TILE / all;
        progress.add((rows(before + 1) - rows(before)) as u64);
        Ok(())
    })?;
    let coarse = coarse
        .into_inner()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    for level in STORED + 1..=form.top {
        let step = 1_usize << (level - STORED);
        each(part, form.tiles(level), |at| {
            let mut tile = decimated(part, level, at)?;
            let mut strip = Vec::new();
            let [columns, rows] = form.samples(level).map(|n| n as usize);
            let [first, top] = at.map(|n| n as usize * TILE);
            let wide = TILE.min(columns - first);
            for row in 0..TILE.min(rows - top) {
                coarse.strip(at[0], top + row, step, &mut strip);
                deviations_of(&strip, step, wide, &mut tile.deviations);
                for column in 0..wide {
                    let deviation = &mut tile.deviations[row * TILE + column];
                    let off = coarse.off([first + column, top + row], step);
                    // Rounded up.
                    *deviation = (*deviation + off) * (1.0 + 2.4e-7);
                }
                // Beyond the level nobody reads.
                tile.deviations.resize((row + 1) * TILE, 0.0);
            }
            tile.deviations.resize(TILE_COUNT, 0.0);
            part.put(level, at, &tile_bytes(&tile))
        })?;
    }
    Ok(extremes
        .into_inner()
        .unwrap_or_else(std::sync::PoisonError::into_inner))
}

/// Heights and slopes of a tile: every second of the level below.
fn decimated(
    part: &Part<'_>,
    level: u32,
    at: [u32; 2],
) -> Result<super::TileSamples, ElevationError> {
    let mut tile = super::TileSamples {
        heights: vec![0.0; TILE_COUNT],
        slopes: vec![0; TILE_COUNT],
        deviations: Vec::new(),
    };
    let most = part.form.tiles(level - 1);
    const HALF: usize = TILE / 2;
    for quarter in 0..4_usize {
        let [right, below] = [quarter % 2, quarter / 2];
        let wanted = [2 * at[0] + right as u32, 2 * at[1] + below as u32];
        // Beyond the map its border goes on, which the last tile holds to its own end.
        let there = [0, 1].map(|k| wanted[k].min(most[k] - 1));
        let mut bytes = vec![0; Form::bytes(level - 1) as usize];
        let place = part.form.tile(level - 1, there);
        part.file
            .read(place, &mut bytes)
            .map_err(|error| part.error(&error))?;
        let below_tile = super::decode(&bytes, false);
        let from = |k: usize, axis: usize| {
            if there[axis] == wanted[axis] {
                2 * k
            } else {
                TILE - 1
            }
        };
        for z in 0..HALF {
            for x in 0..HALF {
                let to = (below * HALF + z) * TILE + right * HALF + x;
                let at = from(z, 1) * TILE + from(x, 0);
                tile.heights[to] = below_tile.heights[at];
                tile.slopes[to] = below_tile.slopes[at];
            }
        }
    }
    Ok(tile)
}

fn tile_bytes(tile: &super::TileSamples) -> Vec<u8> {
    let mut bytes = bytes_of(&[&tile.heights]);
    bytes.extend(tile.slopes.iter().flat_map(|slope| slope.to_le_bytes()));
    bytes.extend(bytes_of(&[&tile.deviations]));
    bytes
}

impl Extremes {
    /// Of the cells of a tile of level 0, whose first sample is the region's first: their corners, so one more to the east and south.
    pub(super) fn of(region: &[f32], width: usize) -> Self {
        let mut all = Self::NONE;
        for z in 0..=TILE {
            let row = &region[z * width..][..=TILE];
            for &sample in row {
                all.low = if sample < all.low { sample } else { all.low };
                all.high = if sample > all.high { sample } else { all.high };
                all.holes |= sample.is_nan();
            }
            let next = if z < TILE {
                &region[(z + 1) * width..][..=TILE]
            } else {
                row
            };
            for x in 0..=TILE {
                let east = row[(x + 1).min(TILE)] - row[x];
                let south = next[x] - row[x];
                let step = east.abs().max(south.abs());
                all.step = if step > all.step { step } else { all.step };
            }
        }
        all
    }
}

/// Refuses the first samples without data at once where nothing stands in their place.
fn refuse_holes(samples: &[f32], hole: f32, name: &str) -> Result<(), ElevationError> {
    if !hole.is_nan() {
        return Ok(());
    }
    match samples.iter().filter(|sample| sample.is_nan()).count() {
        0 => Ok(()),
        count => Err(ElevationError::TiledHoles {
            file: name.to_owned(),
            count: count as u64,
        }),
    }
}

/// The source of a raw file has not been changed.
pub(super) fn unchanged(direct: Option<&Direct>) -> Result<(), ElevationError> {
    direct.map_or(Ok(()), Direct::check)
}
