//! Maps that are larger than memory, read by tiles.
//!
//! [`TiledMap::open`] makes a file of tiles beside the map, once, and reads from it what is asked for: each tile of [`TILE`] × [`TILE`]
//! samples of each level by itself, the coarsest of which is a single one. A raw file is its own level 0 and is read in place, unless a mask or a scale stands beside it; other
//! kinds stream through once, a few rows at a time. Coarser levels hold samples of the map, the same bits, with slopes and with a bound of what lies
//! between them (`derive.rs`).
//!
//! The file of tiles carries sums over everything, and a key of what it was made of: the map's length, time and some of its content, what counts of
//! the files beside it, and how it is read. Where the key differs it is made anew: written under another name and renamed when it is whole. Two programs may do so at once.
//!
//! What is here blocks until the disk has answered; nothing but [`TiledMap::bounds`], which looks into memory, belongs into a frame.

mod base;
mod build;
mod derive;
mod form;
mod make;
mod note;
mod place;
mod sum;

pub use derive::{TILE, TILE_COUNT, TileSamples, pack_slope, unpack_slope};

use crate::about::About;
use crate::error::ElevationError;
use crate::georeference::Georeference;
use crate::grid;
use crate::options::Options;
use crate::progress::ElevationProgress;
use base::{Direct, copy};
use derive::{region_side, tile_of};
use form::Form;
use make::{cache_folder, direct, key, known, make, tiles_path};
use place::Placed;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use sum::sum;

/// How a map is cut into tiles.
#[derive(Clone, Debug, PartialEq)]
pub struct TileSettings {
    /// Where files of tiles stand. `None`: beside the map, or where nobody may write there, in the user's folder for caches.
    pub folder: Option<PathBuf>,
    /// Most bytes of memory that cutting takes; what has been cut takes 12 bytes for each tile of level 0.
    pub memory: u64,
    /// Whether slopes are those of Catmull-Rom through the finest samples, else of the cells between them.
    pub smooth: bool,
    /// What stands where there is no data, in the file's unit after its own scale. `None`: holes are refused.
    pub hole: Option<f32>,
}

impl TileSettings {
    /// Bytes of [`Self::memory`] if nothing else is said.
    pub const MEMORY: u64 = 1 << 30;
}

impl Default for TileSettings {
    fn default() -> Self {
        Self {
            folder: None,
            memory: Self::MEMORY,
            smooth: true,
            hole: None,
        }
    }
}

/// Lowest and highest sample of a part of a map, and the largest difference to a neighbour in a row or column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremes {
    /// Lowest sample.
    pub low: f32,
    /// Highest sample.
    pub high: f32,
    /// Largest difference to the next sample.
    pub step: f32,
    /// Whether a sample has no data.
    pub(crate) holes: bool,
}

impl Extremes {
    const NONE: Self = Self {
        low: f32::INFINITY,
        high: f32::NEG_INFINITY,
        step: 0.0,
        holes: false,
    };

    /// Of a part with these ends and this largest difference.
    #[must_use]
    pub const fn new([low, high]: [f32; 2], step: f32) -> Self {
        Self {
            low,
            high,
            step,
            holes: false,
        }
    }

    fn join(&mut self, other: &Self) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
        self.step = self.step.max(other.step);
        self.holes |= other.holes;
    }
}

/// Reads a tile of level 0.
type ReadTile<'a> = dyn Fn([u32; 2]) -> Result<TileSamples, ElevationError> + Sync + 'a;

/// Level 0.
enum Base<'a> {
    Direct(&'a Direct),
    Stored(&'a ReadTile<'a>),
}

impl Base<'_> {
    /// Whether numbers of a raw file stand for no data: NaN is nothing else then.
    fn marks(&self) -> bool {
        matches!(self, Self::Direct(direct) if direct.nodata.any())
    }

    /// Samples from a place on, `width` a row; beyond the map its border goes on.
    fn read(
        &self,
        form: &Form,
        begin: [i64; 2],
        width: usize,
        to: &mut [f32],
    ) -> Result<(), ElevationError> {
        match self {
            Self::Direct(direct) => direct.read(begin, width, to),
            Self::Stored(tile) => {
                let height = to.len() / width;
                let range = |k: usize, count: usize| {
                    let most = i64::from(form.size[k]) - 1;
                    let ends = [begin[k], begin[k] + count as i64 - 1];
                    let [a, b] = ends.map(|n| (n.clamp(0, most) / TILE as i64) as u32);
                    a..=b
                };
                for row in range(1, height) {
                    for column in range(0, width) {
                        let at = [column, row];
                        copy(&tile(at)?.heights, at, (begin, width), form.size, to);
                    }
                }
                Ok(())
            }
        }
    }
}

/// A map on disk that is read by tiles. Threads may share it.
#[derive(Debug)]
pub struct TiledMap {
    about: About,
    form: Form,
    tiles: Placed,
    path: PathBuf,
    direct: Option<Direct>,
    sums: Vec<u64>,
    extremes: Vec<Extremes>,
    smooth: bool,
    made: bool,
    reads: AtomicU64,
}

impl TiledMap {
    /// Opens a map, and cuts it into tiles first where that has not been done or the map was changed since.
    ///
    /// # Errors
    /// [`ElevationError`] as [`Elevation::read`](crate::Elevation::read), and: a file of tiles that cannot be written; holes without
    /// [`TileSettings::hole`]; more memory than [`TileSettings::memory`]; a map that is changed meanwhile.
    pub fn open(
        path: &Path,
        options: &Options,
        settings: &TileSettings,
        progress: &ElevationProgress,
    ) -> Result<Self, ElevationError> {
        let name = path.display().to_string();
        if options.every > 1 {
            return Err(ElevationError::Unsupported {
                file: name.clone(),
                what: "a part of the samples by tiles".to_owned(),
                convert: format!("{} --every {}", options.command(&name), options.every),
            });
        }
        let options = &Options {
            max_samples: grid::MOST_SAMPLES,
            ..*options
        };
        let direct = direct(path, options, settings)?;
        let key = key(path, options, settings)?;
        let mut places = vec![settings.folder.clone()];
        if settings.folder.is_none() {
            places.push(cache_folder());
        }
        let beside: Vec<PathBuf> = places
            .iter()
            .map(|folder| tiles_path(path, folder.as_deref()))
            .collect();
        for at in &beside {
            if let Some((form, about, tables)) = known(at, key, &name)
                && let Ok(tiles) = Placed::open(at)
            {
                return Ok(Self::with(about, form, tiles, at, direct, tables, settings));
            }
        }
        let mut refused = None;
        for at in &beside {
            match make(
                path,
                at,
                options,
                settings,
                (direct.as_ref(), key),
                progress,
            ) {
                Ok(()) => {
                    let found = known(at, key, &name).zip(Placed::open(at).ok());
                    let Some(((form, about, tables), tiles)) = found else {
                        return Err(ElevationError::Changed { file: name });
                    };
                    let mut map = Self::with(about, form, tiles, at, direct, tables, settings);
                    map.made = true;
                    return Ok(map);
                }
                Err(error @ ElevationError::Write { .. }) => {
                    // The first place is the one that people know.
                    refused.get_or_insert(error);
                }
                Err(error) => return Err(error),
            }
        }
        Err(refused.unwrap_or(ElevationError::Changed { file: name }))
    }

    fn with(
        about: About,
        form: Form,
        tiles: Placed,
        path: &Path,
        direct: Option<Direct>,
        (extremes, sums): (Vec<Extremes>, Vec<u64>),
        settings: &TileSettings,
    ) -> Self {
        Self {
            about,
            form,
            tiles,
            path: path.to_owned(),
            direct,
            sums,
            extremes,
            smooth: settings.smooth,
            made: false,
            reads: AtomicU64::new(0),
        }
    }

    /// What the file says of itself.
    #[must_use]
    pub const fn about(&self) -> &About {
        &self.about
    }

    /// Columns and rows.
    #[must_use]
    pub const fn size(&self) -> [u32; 2] {
        self.form.size
    }

    /// Where the samples lie, where the file tells it.
    #[must_use]
    pub const fn georeference(&self) -> Option<&Georeference> {
        self.about.georeference.as_ref()
    }

    /// Distance of the samples, metres; `None` where the file does not tell it.
    #[must_use]
    pub fn spacing(&self) -> Option<[f64; 2]> {
        self.georeference()?.spacing(self.size())
    }

    /// The coarsest level: a single tile. Level k keeps every 2ᵏth column and row.
    #[must_use]
    pub const fn top(&self) -> u32 {
        self.form.top
    }

    /// Columns and rows of a level; the last ones stand beyond the border where steps do not come out even.
    #[must_use]
    pub fn samples(&self, level: u32) -> [u32; 2] {
        self.form.samples(level)
    }

    /// Columns and rows of a level's tiles.
    #[must_use]
    pub fn tiles(&self, level: u32) -> [u32; 2] {
        self.form.tiles(level)
    }

    /// Whether it was cut into tiles just now, and not found so.
    #[must_use]
    pub const fn was_made(&self) -> bool {
        self.made
    }

    /// The file of tiles.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Tiles that were read so far.
    #[must_use]
    pub fn reads(&self) -> u64 {
        self.reads.load(Ordering::Relaxed)
    }

    /// Bytes of memory that it takes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        (size_of_val(&self.extremes[..]) + size_of_val(&self.sums[..])) as u64
    }

    /// Extremes of all cells that touch a rectangle of samples, or of more: of the tiles of level 0 that do. From memory.
    #[must_use]
    pub fn bounds(&self, low: [u32; 2], high: [u32; 2]) -> Extremes {
        let [columns, rows] = self.form.tiles(0);
        let tile = |n: u32, count: u32| (n / TILE as u32).min(count - 1);
        let mut all = Extremes::NONE;
        for row in tile(low[1], rows)..=tile(high[1], rows) {
            let line = row as usize * columns as usize;
            let [a, b] = [low[0], high[0]].map(|n| line + tile(n, columns) as usize);
            for tile in &self.extremes[a..=b.max(a)] {
                all.join(tile);
            }
        }
        all
    }

    /// Reads a tile of a level. Waits for the disk.
    ///
    /// # Errors
    /// A map or a file of tiles that was changed, damaged or taken away. Tiles and levels that there are not:
    /// [`ElevationError::DamagedTile`].
    pub fn tile(&self, level: u32, at: [u32; 2]) -> Result<TileSamples, ElevationError> {
        let [columns, rows] = if level <= self.form.top {
            self.form.tiles(level)
        } else {
            [0; 2]
        };
        if at[0] >= columns || at[1] >= rows {
            return Err(self.damaged(level, at));
        }
        self.reads.fetch_add(1, Ordering::Relaxed);
        if self.form.is_stored(level) {
            return self.stored(level, at);
        }
        let step = 1_usize << level;
        let (begin, side) = if level == 0 {
            (at.map(|n| i64::from(n) * TILE as i64), TILE)
        } else {
            let begin = at.map(|n| i64::from(n) * (TILE * step) as i64 - 1);
            (begin, region_side(step))
        };
        let mut region = vec![0.0; side * side];
        let stored = |at: [u32; 2]| self.stored(0, at);
        let base = match &self.direct {
            Some(direct) => Base::Direct(direct),
            None => Base::Stored(&stored),
        };
        base.read(&self.form, begin, side, &mut region)?;
        Ok(if level == 0 {
            TileSamples {
                heights: region,
                ..TileSamples::default()
            }
        } else {
            tile_of(&region, step, self.smooth)
        })
    }

    fn damaged(&self, level: u32, [column, row]: [u32; 2]) -> ElevationError {
        ElevationError::DamagedTile {
            file: self.path.display().to_string(),
            level,
            column,
            row,
        }
    }

    fn stored(&self, level: u32, at: [u32; 2]) -> Result<TileSamples, ElevationError> {
        let mut bytes = vec![0; Form::bytes(level) as usize];
        let place = self.form.tile(level, at);
        let read = self.tiles.read(place, &mut bytes);
        let sum_there = self.sums.get(self.form.sum(level, at) as usize);
        if read.is_err() || sum_there != Some(&sum(&bytes)) {
            return Err(self.damaged(level, at));
        }
        Ok(decode(&bytes, level == 0))
    }

    /// Hands on all rows of level 0, from north to south; `sink` gets the first one's number and samples.
    ///
    /// # Errors
    /// As [`Self::tile`], and what `sink` returns.
    pub fn rows(
        &self,
        progress: &ElevationProgress,
        mut sink: impl FnMut(u32, &[f32]) -> Result<(), ElevationError>,
    ) -> Result<(), ElevationError> {
        let [columns, rows] = self.size().map(|n| n as usize);
        let stored = |at: [u32; 2]| self.stored(0, at);
        let base = match &self.direct {
            Some(direct) => Base::Direct(direct),
            None => Base::Stored(&stored),
        };
        progress.begin("reading", &self.about.file, rows as u64);
        let mut band = vec![0.0; columns * TILE.min(rows)];
        for row in (0..rows).step_by(TILE) {
            let count = TILE.min(rows - row);
            let band = &mut band[..columns * count];
            base.read(&self.form, [0, row as i64], columns, band)?;
            sink(row as u32, band)?;
            progress.add(count as u64);
        }
        Ok(())
    }
}

/// The planes of a tile.
fn decode(bytes: &[u8], heights_only: bool) -> TileSamples {
    let (words, _) = bytes.as_chunks::<4>();
    let real = |words: &[[u8; 4]]| words.iter().map(|word| f32::from_le_bytes(*word)).collect();
    let (heights, rest) = words.split_at(TILE_COUNT.min(words.len()));
    if heights_only {
        return TileSamples {
            heights: real(heights),
            ..TileSamples::default()
        };
    }
    let (slopes, deviations) = rest.split_at(TILE_COUNT.min(rest.len()));
    TileSamples {
        heights: real(heights),
        slopes: slopes
            .iter()
            .map(|word| u32::from_le_bytes(*word))
            .collect(),
        deviations: real(deviations),
    }
}
