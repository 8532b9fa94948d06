//! From a map to its file of tiles: whether there is one of it, and if not, one that is whole or none.

use super::base::Direct;
use super::build::{Part, lock, pyramid, unchanged};
use super::form::{Form, HEAD, MARK, NOTE};
use super::note;
use super::place::Placed;
use super::sum::{Sum, sum};
use super::{Base, Extremes, TileSettings, decode};
use crate::about::{About, FileKind};
use crate::error::{ElevationError, read_error};
use crate::extremes::is_customary;
use crate::grid::Feed;
use crate::input::Input;
use crate::lattice::{First, Nowhere};
use crate::looks::Looks;
use crate::nodata::{Marks, named};
use crate::options::{Options, Raw};
use crate::progress::ElevationProgress;
use crate::read::{Found, found, with_input};
use crate::samples::Elevation;
use crate::sidecars::{Numbers, Sidecars};
use crate::{grid, raw};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// The map's own file as level 0, where it holds plain numbers and nothing beside it makes others of them.
pub(super) fn direct(
    path: &Path,
    options: &Options,
    settings: &TileSettings,
) -> Result<Option<Direct>, ElevationError> {
    let plan = with_input(path, options, Feed::default(), |mut input: Input<'_>| {
        let Found::Raw(told) = found(&mut input)? else {
            return Ok(None);
        };
        if input.feed.mask.is_some() || input.sidecars.changes(1) {
            return Ok(None);
        }
        let (number, size) = raw::told(input.file, input.bytes, &told)?;
        raw::Plan::new(input.file, input.bytes, options, &told, number, size).map(Some)
    })?;
    let Some(plan) = plan else {
        return Ok(None);
    };
    let name = path.display().to_string();
    let failed = |error: std::io::Error| read_error(&name, &error);
    let file = Placed::open(path).map_err(failed)?;
    let stamp = file.stamp().map_err(failed)?;
    Ok(Some(Direct {
        file,
        plan,
        stamp,
        nodata: Marks::new(&named(options, &[])),
        hole: settings.hole.unwrap_or(f32::NAN),
        name,
    }))
}

/// What a file of tiles is made of, in a number.
pub(super) fn key(
    path: &Path,
    options: &Options,
    settings: &TileSettings,
) -> Result<u64, ElevationError> {
    let mut all = looked_at(path, Sum::default())?;
    let sidecars = Sidecars::of(path)?;
    for trace in sidecars.traces() {
        all = all.add(&trace);
    }
    if let Some(mask) = sidecars.mask() {
        all = looked_at(mask, all)?;
    }
    let how = format!(
        "{options:?} {} {:?}",
        settings.smooth,
        settings.hole.map(f32::to_bits)
    );
    Ok(all.add(how.as_bytes()).done())
}

/// Adds the length of a file, its time and some of its content to a sum.
fn looked_at(path: &Path, mut all: Sum) -> Result<Sum, ElevationError> {
    /// Bytes that are looked at in each of some places of the file.
    const PIECE: u64 = 1 << 12;
    const PIECES: u64 = 64;
    let name = path.display().to_string();
    let failed = |error: std::io::Error| read_error(&name, &error);
    let file = Placed::open(path).map_err(failed)?;
    let stamp = file.stamp().map_err(failed)?;
    all = all.add(&stamp.bytes.to_le_bytes());
    let since = stamp
        .changed
        .and_then(|time| time.duration_since(std::time::UNIX_EPOCH).ok());
    all = all.add(&since.map_or(0, |since| since.as_nanos()).to_le_bytes());
    let mut piece = vec![0; PIECE.min(stamp.bytes) as usize];
    let room = stamp.bytes - piece.len() as u64;
    for k in 0..PIECES {
        // From the first to the last byte.
        let at = (u128::from(room) * u128::from(k) / u128::from(PIECES - 1)) as u64;
        file.read(at, &mut piece).map_err(failed)?;
        all = all.add(&piece);
    }
    Ok(all)
}

/// The user's folder for caches.
pub(super) fn cache_folder() -> Option<PathBuf> {
    let named = |name: &str| {
        std::env::var_os(name)
            .filter(|value| !value.is_empty())
            .map(PathBuf::from)
    };
    let folder = named("XDG_CACHE_HOME")
        .or_else(|| named("LOCALAPPDATA"))
        .or_else(|| named("HOME").map(|home| home.join(".cache")))
        .unwrap_or_else(std::env::temp_dir);
    Some(folder.join("dolomite"))
}

/// The file of tiles of a map: beside it, or in a folder under a name that no other map has.
pub(super) fn tiles_path(path: &Path, folder: Option<&Path>) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    match folder {
        None => {
            name.push(".tiles");
            path.with_file_name(name)
        }
        Some(folder) => {
            let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
            let number = sum(whole.as_os_str().as_encoded_bytes());
            name.push(format!(".{number:016x}.tiles"));
            folder.join(name)
        }
    }
}

/// Extremes of tiles, and sums.
pub(super) type Tables = (Vec<Extremes>, Vec<u64>);

/// What stands before the tiles of a file, if it is whole and of this key.
pub(super) fn known(path: &Path, key: u64, name: &str) -> Option<(Form, About, Tables)> {
    let file = Placed::open(path).ok()?;
    let bytes = file.stamp().ok()?.bytes;
    let mut head = [0; HEAD];
    file.read(0, &mut head).ok()?;
    let word = |at: usize| {
        let word = head.get(at..)?.first_chunk::<8>()?;
        Some(u64::from_le_bytes(*word))
    };
    if head[..8] != MARK || word(8)? != key || word(48)? != sum(&head[..48]) {
        return None;
    }
    let size = word(16)?;
    let size = [size as u32, (size >> 32) as u32];
    if size.contains(&0) {
        return None;
    }
    let form = Form::new(size, word(24)? == 1);
    if bytes != form.all() {
        return None;
    }
    let mut rest = vec![0; (form.before() - HEAD as u64) as usize];
    file.read(HEAD as u64, &mut rest).ok()?;
    if sum(&rest) != word(40)? {
        return None;
    }
    let (note, rest) = rest.split_at(NOTE as usize);
    let about = note::decode(note.get(..word(32)? as usize)?, name)?;
    let (extremes, sums) = rest.split_at(form.extremes() as usize);
    let (numbers, _) = extremes.as_chunks::<4>();
    let (tiles, _) = numbers.as_chunks::<3>();
    let extremes = tiles.iter().map(|tile| {
        let [low, high, step] = tile.map(f32::from_le_bytes);
        Extremes {
            low,
            high,
            step,
            holes: false,
        }
    });
    let (sums, _) = sums.as_chunks::<8>();
    let sums = sums.iter().map(|sum| u64::from_le_bytes(*sum));
    Some((form, about, (extremes.collect(), sums.collect())))
}

/// Makes the file of tiles.
pub(super) fn make(
    path: &Path,
    to: &Path,
    options: &Options,
    settings: &TileSettings,
    (direct, key_before): (Option<&Direct>, u64),
    progress: &ElevationProgress,
) -> Result<(), ElevationError> {
    let failed = |error: std::io::Error| ElevationError::Write {
        file: to.display().to_string(),
        reason: error.to_string(),
    };
    if let Some(folder) = to.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(failed)?;
    }
    static NUMBER: AtomicU64 = AtomicU64::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let mut beside = to.as_os_str().to_owned();
    beside.push(format!(".{}-{number}.part", std::process::id()));
    let beside = PathBuf::from(beside);
    let made = whole(
        path,
        &beside,
        options,
        settings,
        (direct, key_before),
        progress,
    );
    let made = made.and_then(|()| std::fs::rename(&beside, to).map_err(failed));
    if made.is_err() {
        // Perhaps it was never made.
        let _ = std::fs::remove_file(&beside);
    }
    made
}

/// Makes it whole, not yet under its name.
fn whole(
    path: &Path,
    beside: &Path,
    options: &Options,
    settings: &TileSettings,
    (direct, key_before): (Option<&Direct>, u64),
    progress: &ElevationProgress,
) -> Result<(), ElevationError> {
    let name = path.display().to_string();
    let failed = |error: std::io::Error| ElevationError::Write {
        file: beside.display().to_string(),
        reason: error.to_string(),
    };
    let open = || {
        let mut how = std::fs::OpenOptions::new();
        how.read(true).write(true).create(true).truncate(true);
        how.open(beside).map(Placed::new)
    };
    let hole = settings.hole.unwrap_or(f32::NAN);
    let (part, about) = match direct {
        Some(direct) => {
            let form = Form::new(direct.plan.size, false);
            let part = Part::new(open().map_err(failed)?, beside, form).map_err(failed)?;
            (part, None)
        }
        None => {
            let (part, about) = streamed(path, (options, settings, hole), progress, &|size| {
                let form = Form::new(size, true);
                Part::new(open().map_err(failed)?, beside, form).map_err(failed)
            })?;
            (part, Some(about))
        }
    };
    let stored = |at: [u32; 2]| {
        let mut bytes = vec![0; Form::bytes(0) as usize];
        let place = part.form.tile(0, at);
        part.file.read(place, &mut bytes).map_err(failed)?;
        Ok(decode(&bytes, true))
    };
    let base = match direct {
        Some(direct) => Base::Direct(direct),
        None => Base::Stored(&stored),
    };
    let how = (&*name, options, settings.memory, settings.smooth);
    let extremes = pyramid(&part, &base, how, progress)?;
    let mut all = Extremes::NONE;
    extremes.iter().for_each(|tile| all.join(tile));
    let about = match about {
        Some(about) => about,
        None => {
            let direct = direct.ok_or_else(|| ElevationError::Changed { file: name.clone() })?;
            raw_about(direct, options, &all, &name)?
        }
    };
    if about.holes > 0 && settings.hole.is_none() {
        return Err(ElevationError::TiledHoles {
            file: name,
            count: about.holes,
        });
    }
    unchanged(direct)?;
    if key(path, options, settings)? != key_before {
        return Err(ElevationError::Changed { file: name });
    }
    part.close(&about, &extremes, key_before)
}

/// Lets all rows of a map stream into tiles of level 0.
fn streamed<'p>(
    path: &Path,
    (options, settings, hole): (&Options, &TileSettings, f32),
    progress: &ElevationProgress,
    open: &dyn Fn([u32; 2]) -> Result<Part<'p>, ElevationError>,
) -> Result<(Part<'p>, About), ElevationError> {
    let name = path.display().to_string();
    let part: Mutex<Option<Part<'p>>> = Mutex::new(None);
    let mut waiting = Vec::new();
    let feed = Feed {
        progress: progress.clone(),
        most: settings.memory,
        sink: Some(Box::new(|size, first, samples: &[f32]| {
            let mut part = lock(&part);
            if part.is_none() {
                *part = Some(open(size)?);
            }
            match part.as_ref() {
                Some(part) => part.rows(&mut waiting, first, samples, (hole, &name)),
                None => Ok(()),
            }
        })),
        ..Feed::default()
    };
    let read = Elevation::fed(path, options, feed)?;
    let part = part
        .into_inner()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    let part = part.ok_or(ElevationError::Changed { file: name })?;
    Ok((part, read.about))
}

/// What a raw file is, once its extremes are known.
fn raw_about(
    direct: &Direct,
    options: &Options,
    all: &Extremes,
    name: &str,
) -> Result<About, ElevationError> {
    let told = options.raw.unwrap_or_default();
    let (number, size) = raw::told(
        name,
        direct.stamp.bytes,
        &Raw {
            size: Some(direct.plan.size),
            ..told
        },
    )?;
    let mut looks = Looks::default();
    let suspicious = [all.low, all.high]
        .iter()
        .any(|&end| !end.is_finite() || is_customary(end));
    if all.holes || suspicious || direct.nodata.any() {
        // Each number once more, as it stands in the file.
        let columns = size[0] as usize;
        let mut line = vec![0.0; columns];
        let plain = Direct {
            file: Placed::open(Path::new(name)).map_err(|error| read_error(name, &error))?,
            name: name.to_owned(),
            plan: direct.plan,
            stamp: direct.stamp,
            nodata: direct.nodata.clone(),
            hole: f32::NAN,
        };
        for row in 0..size[1] {
            plain.read([0, row.into()], columns, &mut line)?;
            looks.row(row as usize, &line);
        }
        looks.check(direct.nodata.any(), name, options)?;
    }
    let nodata = named(options, &[]).into_iter().map(crate::about::Text64);
    let range = (all.low <= all.high).then_some([all.low, all.high]);
    let settled = grid::Settled {
        samples: Vec::new(),
        size,
        holes: looks.nan,
        range: looks.range().or(range),
        nodata: nodata.collect(),
        notes: Vec::new(),
    };
    let mut map = Elevation::new(name, settled, (FileKind::Raw, size, number));
    map.about.packing = raw::packing(told.order);
    let sidecars = Sidecars::of(Path::new(name))?;
    let numbers = sidecars.numbers(1, Numbers::default(), First::Beside);
    numbers.tell(&mut map.about);
    sidecars.place(&mut map, (name, options), &Nowhere)?;
    Ok(map.about)
}
