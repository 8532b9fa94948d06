//! A map of which tiles about a place are in memory, finer ones nearer: for maps larger than memory, or than a GPU binds.
//!
//! All levels of the map's tiles ([`dolomite_elevation::TiledMap`]) are there at once, small ones whole, larger ones about a **focus**.
//! Whoever asks for a height gets it from the finest level that has all samples which the filter takes. Where a place is a sample of
//! several levels, all of them give the same bits.
//!
//! The GPU has the same slots, so that it finds the same levels (`shaders/src/terrain/clip.wgsl`): whoever has such data asks what has
//! been put into memory since they looked last, in their own time. As many may ask as have data of the same map.

mod arrived;
mod clip;
mod sample;

use super::{Filter, HeightMap};
use crate::ground::GroundRect;
use arrived::Arrived;
use bevy::math::DVec2;
use clip::ClipLevel;
use dolomite_elevation::{
    ElevationError, Extremes, TILE, TILE_COUNT, TileSamples, TiledMap, pack_slope, unpack_slope,
};
use std::collections::{BTreeMap, HashMap};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard};

/// Words of a level's head in the data of the GPU: first column and row that may be read, last ones; slots along both axes; where heights
/// begin, and slopes, behind which deviations stand.
pub const LEVEL_WORDS: usize = 8;
/// Most levels: a single tile has 128 samples, a side of 2³² then 26.
pub const MOST_LEVELS: usize = 26;

/// A tile that is to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TileRequest {
    /// Its level.
    pub level: u32,
    /// Its column and row.
    pub at: [u32; 2],
}

/// Words to be written into the data of a layer on the GPU.
#[derive(Clone, Debug, PartialEq)]
pub struct MapWrite {
    /// From which word of the layer's part on.
    pub at: u64,
    /// What.
    pub words: Vec<u32>,
}

/// Samples that may be read of a level: first and last column and row. Nothing may where it is `None`.
pub type Readable = Option<[[u32; 2]; 2]>;

/// Of a number: what a file's unit becomes in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct InMetres {
    pub scale: f32,
    pub offset: f32,
}

impl InMetres {
    /// Lowest and highest of samples, from those of numbers.
    fn of(self, found: Extremes) -> [f32; 2] {
        let [a, b] = [found.low, found.high].map(|number| number * self.scale + self.offset);
        [a.min(b), a.max(b)]
    }
}

/// What is in memory of a map.
#[derive(Debug)]
pub struct Stream {
    map: TiledMap,
    metres: InMetres,
    /// How much more deviations count: 25/16 for Catmull-Rom.
    share: f32,
    /// By how much a height in metres may be off `number × scale + offset`, metres.
    rounding: f32,
    /// Lowest and highest sample, metres.
    ends: [f32; 2],
    levels: RwLock<Vec<ClipLevel>>,
    changes: Mutex<Changes>,
    /// No other has it.
    id: u64,
    arrived: Mutex<Arrived>,
    bytes: u64,
    /// The file cannot be read any more.
    given_up: AtomicBool,
}

/// What was put into memory, and when: a number that grows with each change.
#[derive(Debug, Default)]
struct Changes {
    now: u64,
    /// Level and slot, by when they were filled last.
    slots: BTreeMap<u64, (u32, u64)>,
    /// When each was.
    when: HashMap<(u32, u64), u64>,
    /// When what may be read changed last, and to what.
    windows: u64,
    readable: Vec<Readable>,
    /// When everything was laid out last.
    laid_out: u64,
}

impl Changes {
    fn fill(&mut self, level: u32, slot: u64) {
        self.now += 1;
        if let Some(before) = self.when.insert((level, slot), self.now) {
            self.slots.remove(&before);
        }
        self.slots.insert(self.now, (level, slot));
    }
}

/// What has to be written into data of the GPU that were laid out before ([`Stream::news`]).
#[derive(Clone, Debug, PartialEq)]
pub struct MapNews {
    /// Until when this is told: what to ask for next.
    pub now: u64,
    /// What has to be written before the data are looked at again.
    pub list: Vec<MapWrite>,
    /// What may be read of each level once that is done.
    pub readable: Vec<Readable>,
}

/// The next map's number.
static NEXT: AtomicU64 = AtomicU64::new(1);

fn read(levels: &RwLock<Vec<ClipLevel>>) -> RwLockReadGuard<'_, Vec<ClipLevel>> {
    // Whole whenever somebody panics: a window is set after its tiles.
    levels.read().unwrap_or_else(PoisonError::into_inner)
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Stream {
    /// Reads the levels that are whole within `budget` bytes of memory (as many on a GPU). Waits for the disk.
    pub(super) fn new(
        map: TiledMap,
        metres: InMetres,
        filter: Filter,
        budget: u64,
    ) -> Result<Self, ElevationError> {
        let count = map.top() + 1;
        let bytes = |most: u32| -> u64 {
            let levels = (0..count).map(|level| ClipLevel::bytes(map.tiles(level), most, level));
            levels.sum()
        };
        // From a third of a screen about the focus on.
        let fits = |&most: &u32| bytes(most) + map.bytes() <= budget;
        let most = (4..=512).take_while(fits).last();
        let most = most.unwrap_or(4);
        let levels: Vec<_> = (0..count)
            .map(|level| ClipLevel::new(map.samples(level), map.tiles(level), most, level))
            .collect();
        let InMetres { scale, offset } = metres;
        let all = map.bounds([0; 2], map.size().map(|n| n - 1));
        let largest = [all.low, all.high].map(|n| (n * scale).abs() + (n * scale + offset).abs());
        let stream = Self {
            // A product and a sum, each to half a unit in the last place: 2⁻²⁴ of them.
            rounding: if scale == 1.0 && offset == 0.0 {
                0.0
            } else {
                6e-8 * largest[0].max(largest[1])
            },
            ends: metres.of(all),
            share: match filter {
                Filter::Bilinear => 1.0,
                Filter::Bicubic => 25.0 / 16.0,
            },
            bytes: bytes(most) + map.bytes(),
            map,
            metres,
            levels: RwLock::new(levels),
            changes: Mutex::default(),
            id: NEXT.fetch_add(1, Ordering::Relaxed),
            arrived: Mutex::default(),
            given_up: AtomicBool::new(false),
        };
        stream.follow(None);
        for request in stream.missing(true) {
            let tile = stream.load(request)?;
            stream.put(request, &tile);
        }
        Ok(stream)
    }

    /// Bytes of memory that are taken; a GPU takes no more.
    #[must_use]
    pub const fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The map's tiles.
    #[must_use]
    pub const fn tiles(&self) -> &TiledMap {
        &self.map
    }

    /// Extremes over samples of the map, or over more, metres.
    pub(super) fn extremes(&self, low: [usize; 2], high: [usize; 2]) -> Extremes {
        let found = self
            .map
            .bounds(low.map(|n| n as u32), high.map(|n| n as u32));
        let step = found.step * self.metres.scale.abs() * (1.0 + 1e-6);
        // Both of its ends are rounded.
        Extremes::new(self.metres.of(found), step + 2.0 * self.rounding)
    }

    /// Lowest and highest sample, metres.
    pub(super) const fn ends(&self) -> [f32; 2] {
        self.ends
    }

    /// How many levels there are.
    #[must_use]
    pub fn levels(&self) -> u32 {
        self.map.top() + 1
    }

    /// What may be read of each level now.
    #[must_use]
    pub fn readable(&self) -> Vec<Readable> {
        read(&self.levels).iter().map(ClipLevel::readable).collect()
    }

    /// Wants what is about a place, in samples of the map; `None`: only what is there as a whole.
    pub(super) fn follow(&self, place: Option<[f64; 2]>) {
        let mut levels = self.levels.write().unwrap_or_else(PoisonError::into_inner);
        let mut changed = false;
        for (level, clip) in levels.iter_mut().enumerate() {
            let step = (1_u64 << level) as f64;
            if let Some(place) = place.or(clip.is_whole().then_some([0.0; 2])) {
                let before = clip.window;
                changed |= clip.follow(place.map(|n| n / step));
                let of = (level, clip.tiles);
                lock(&self.arrived).add(of, before, clip.window);
            }
        }
        if changed {
            self.tell_windows(&levels);
        }
    }

    /// Tiles that are wanted and not there, coarse ones first, the nearest of a level first. `whole`: of levels alone that fit in as a whole.
    #[must_use]
    pub fn missing(&self, whole: bool) -> Vec<TileRequest> {
        let levels = read(&self.levels);
        let levels = levels.iter().enumerate().rev();
        let levels = levels.filter(|(_, clip)| !whole || clip.is_whole());
        levels
            .flat_map(|(level, clip)| {
                let level = level as u32;
                let missing = clip.missing().into_iter();
                missing.map(move |at| TileRequest { level, at })
            })
            .collect()
    }

    /// Reads a tile, in metres. Waits for the disk: for a task in the background.
    ///
    /// # Errors
    /// [`ElevationError`], as [`TiledMap::tile`].
    pub fn load(&self, request: TileRequest) -> Result<TileSamples, ElevationError> {
        let mut tile = self.map.tile(request.level, request.at)?;
        let InMetres { scale, offset } = self.metres;
        for height in &mut tile.heights {
            *height = *height * scale + offset;
        }
        if scale != 1.0 {
            for slope in &mut tile.slopes {
                *slope = pack_slope(unpack_slope(*slope).map(|s| s * scale));
            }
        }
        let factor = self.share * scale.abs() * (1.0 + 1e-6);
        let rounding = self.share * self.rounding;
        for deviation in &mut tile.deviations {
            *deviation = *deviation * factor + rounding;
        }
        Ok(tile)
    }

    /// Takes a tile that was read, if it is still wanted.
    pub fn put(&self, request: TileRequest, tile: &TileSamples) -> bool {
        let mut levels = self.levels.write().unwrap_or_else(PoisonError::into_inner);
        let Some(clip) = levels.get_mut(request.level as usize) else {
            return false;
        };
        let before = clip.window;
        if !clip.put(request.at, tile) {
            return false;
        }
        let of = (request.level as usize, clip.tiles);
        lock(&self.arrived).add(of, before, clip.window);
        let slot = clip.slot(request.at) as u64;
        lock(&self.changes).fill(request.level, slot);
        self.tell_windows(&levels);
        true
    }

    /// What may be read, for the GPU.
    fn tell_windows(&self, levels: &[ClipLevel]) {
        let mut changes = lock(&self.changes);
        let readable: Vec<_> = levels.iter().map(ClipLevel::readable).collect();
        if changes.readable == readable {
            return;
        }
        changes.now += 1;
        changes.windows = changes.now;
        changes.readable = readable;
    }

    /// Appends everything as the GPU has it, from where [`Self::news`] go on. Words of heads, then the levels one after the other.
    pub(crate) fn lay_out(&self, data: &mut Vec<u32>) {
        let levels = read(&self.levels);
        let mut changes = lock(&self.changes);
        changes.laid_out = changes.now;
        drop(changes);
        data.extend(head(&levels));
        for clip in levels.iter() {
            data.extend(clip.heights.iter().map(|height| height.to_bits()));
            data.extend(&clip.slopes);
            data.extend(clip.deviations.iter().map(|deviation| deviation.to_bits()));
        }
    }

    /// Words of [`Self::lay_out`].
    pub(crate) fn gpu_words(&self) -> u64 {
        let levels = read(&self.levels);
        let last = levels.last().zip(starts(&levels).pop());
        last.map_or(0, |(clip, [heights, extra])| match clip.slopes.len() {
            0 => heights + clip.heights.len() as u64,
            slopes => extra + 2 * slopes as u64,
        })
    }

    /// A number that no other map which is read by tiles has, as long as the program runs.
    #[must_use]
    pub const fn id(&self) -> u64 {
        self.id
    }

    /// When [`Terrain::gpu`](crate::Terrain::gpu) laid out everything last: from when on news are to be asked for first.
    #[must_use]
    pub fn laid_out(&self) -> u64 {
        lock(&self.changes).laid_out
    }

    /// What has to be written into data that were as things stood at `since`, which is the last [`MapNews::now`]. Nothing is forgotten by
    /// telling it: terrains that share the map ask one after the other. What was changed twice is told once, as it is now.
    #[must_use]
    pub fn news(&self, since: u64) -> MapNews {
        let levels = read(&self.levels);
        let changes = lock(&self.changes);
        let starts = starts(&levels);
        let mut list = Vec::new();
        if changes.windows > since {
            list.push(MapWrite {
                at: 0,
                words: head(&levels),
            });
        }
        let later = changes.slots.range(since.saturating_add(1)..);
        for &(level, slot) in later.map(|(_, slot)| slot) {
            let clip = &levels[level as usize];
            let [heights, extra] = starts[level as usize];
            let range = slot as usize..slot as usize + TILE_COUNT;
            let bits = |numbers: &[f32]| numbers.iter().map(|n| n.to_bits()).collect();
            let mut write = |at: u64, words: Vec<u32>| {
                let at = at + slot;
                list.push(MapWrite { at, words });
            };
            write(heights, bits(&clip.heights[range.clone()]));
            if level > 0 {
                let count = clip.slopes.len() as u64;
                write(extra, clip.slopes[range.clone()].to_vec());
                write(extra + count, bits(&clip.deviations[range]));
            }
        }
        MapNews {
            now: changes.now,
            list,
            readable: levels.iter().map(ClipLevel::readable).collect(),
        }
    }

    /// How often more could be read than before.
    pub(crate) fn arrived(&self) -> u64 {
        lock(&self.arrived).count()
    }

    /// Reads no more of the file, which is not what it was: what is in memory stays.
    pub(crate) fn give_up(&self) {
        self.given_up.store(true, Ordering::Relaxed);
    }

    /// Whether it has been given up.
    pub(crate) fn is_given_up(&self) -> bool {
        self.given_up.load(Ordering::Relaxed)
    }

    /// Whether tiles are wanted that are not there, and will be.
    #[must_use]
    pub fn is_awaited(&self) -> bool {
        !self.is_given_up() && read(&self.levels).iter().any(ClipLevel::is_awaited)
    }
}

/// Where heights, and slopes and deviations, of each level begin.
fn starts(levels: &[ClipLevel]) -> Vec<[u64; 2]> {
    let mut at = (LEVEL_WORDS * levels.len()) as u64;
    levels
        .iter()
        .map(|clip| {
            let heights = at;
            let extra = heights + clip.heights.len() as u64;
            at = extra + 2 * clip.slopes.len() as u64;
            [heights, extra]
        })
        .collect()
}

/// The heads of all levels.
fn head(levels: &[ClipLevel]) -> Vec<u32> {
    let starts = starts(levels);
    levels
        .iter()
        .zip(starts)
        .flat_map(|(clip, [heights, extra])| {
            // Nothing is between a first that is behind the last.
            let [low, high] = clip.readable().unwrap_or([[1; 2], [0; 2]]);
            [
                low[0],
                low[1],
                high[0],
                high[1],
                clip.slots[0],
                clip.slots[1],
                heights as u32,
                extra as u32,
            ]
        })
        .collect()
}

impl HeightMap {
    /// What is in memory of a map that is read by tiles; `None` of one that is there as a whole.
    #[must_use]
    pub fn stream(&self) -> Option<&Stream> {
        self.0.stream.as_deref()
    }

    pub(crate) fn shared_stream(&self) -> Option<Arc<Stream>> {
        self.0.stream.clone()
    }

    /// Where heights may have changed between two states of what is in memory ([`Stream::arrived`]), metres.
    pub(crate) fn arrived_between(&self, one: u64, other: u64) -> Vec<GroundRect> {
        let Some(stream) = self.stream().filter(|_| one != other) else {
            return Vec::new();
        };
        let in_metres = |[low, high]: [[f64; 2]; 2]| {
            let place = |at: [f64; 2]| self.origin() + DVec2::from_array(at) * self.spacing();
            GroundRect::new(place(low), place(high))
        };
        let found = lock(&stream.arrived).between(one.min(other), one.max(other));
        found.map_or_else(
            || vec![GroundRect::new(DVec2::splat(-1e9), DVec2::splat(1e9))],
            |rects| rects.into_iter().map(in_metres).collect(),
        )
    }

    /// Wants fine samples about (x, z), metres, and reads those under it at once: for a place where somebody is about to
    /// be put. Waits for the disk; does nothing where they are there already, and of a map that is there as a whole.
    ///
    /// # Errors
    /// [`ElevationError`], as [`Stream::load`].
    pub fn read_about(&self, xz: DVec2) -> Result<(), ElevationError> {
        let Some(stream) = self.stream().filter(|_| xz.is_finite()) else {
            return Ok(());
        };
        if self.error_at(xz) == 0.0 {
            return Ok(());
        }
        self.follow(xz);
        let place = ((xz - self.origin()) / self.spacing()).to_array();
        let sides = stream.map.size();
        // Catmull-Rom takes samples from one before the cell to two after it; beyond the map its border goes on.
        let tiles = [0, 1].map(|k| {
            let most = f64::from(sides[k] - 1);
            let tile = |by: f64| ((place[k].floor() + by).clamp(0.0, most) / TILE as f64) as u32;
            tile(-1.0)..=tile(2.0)
        });
        let is_under = |request: &TileRequest| (0..2).all(|k| tiles[k].contains(&request.at[k]));
        let mut missing = stream.missing(false);
        missing.retain(|request| request.level == 0);
        missing.sort_by_key(|request| !is_under(request));
        for request in missing {
            // What is there is a rectangle: after a short way others than those under it may lie between.
            if self.error_at(xz) == 0.0 {
                break;
            }
            let tile = stream.load(request)?;
            stream.put(request, &tile);
        }
        Ok(())
    }

    /// Wants fine samples about (x, z), metres. Returns at once; see [`Stream::missing`].
    pub fn follow(&self, xz: DVec2) {
        if let Some(stream) = self.stream()
            && xz.is_finite()
        {
            let place = (xz - self.origin()) / self.spacing();
            stream.follow(Some(place.to_array()));
        }
    }
}

const _: () = assert!(TILE * TILE == TILE_COUNT);
