//! Maps by tiles: the same bits as in memory, of every kind; made once; never garbage.

use dolomite_elevation::{
    Elevation, ElevationError, ElevationProgress, NumberType, Options, Raw, TILE, TileSettings,
    TiledMap, unpack_slope, write,
};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// A folder that is deleted when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = format!("dolomite-tiled-{name}-{}", std::process::id());
        let folder = std::env::temp_dir().join(folder);
        std::fs::create_dir_all(&folder).expect("the folder for temporary files is there");
        Self(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).ok();
    }
}

fn height(x: u32, z: u32) -> u16 {
    let wave = |n: u32| {
        let n = n % 900;
        n.min(900 - n)
    };
    let rough = (x.wrapping_mul(0x9e37_79b9) ^ z.wrapping_mul(0x85eb_ca6b)) >> 28;
    (3000 + 5 * wave(x) + 7 * wave(z + x / 3) + rough) as u16
}

/// A raw file of so many columns and rows, and how it is read.
fn raw(folder: &Folder, size: [u32; 2]) -> (PathBuf, Options) {
    let path = folder.0.join("map.raw");
    let bytes: Vec<u8> = (0..size[1])
        .flat_map(|z| (0..size[0]).flat_map(move |x| height(x, z).to_be_bytes()))
        .collect();
    std::fs::write(&path, bytes).expect("room for some megabytes");
    let raw = Raw {
        size: Some(size),
        number: Some(NumberType::U16),
        order: dolomite_elevation::ByteOrder::Big,
        ..Raw::default()
    };
    let options = Options {
        raw: Some(raw),
        ..Options::default()
    };
    (path, options)
}

fn open(path: &Path, options: &Options) -> Result<TiledMap, ElevationError> {
    let settings = TileSettings::default();
    TiledMap::open(path, options, &settings, &ElevationProgress::default())
}

#[test]
fn every_kind_has_the_same_bits_by_tiles_as_in_memory() {
    let folder = Folder::new("kinds");
    let files = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files");
    let mut count = 0;
    for entry in std::fs::read_dir(files).expect("it is there") {
        let path = entry.expect("readable").path();
        let here = folder.0.join(path.file_name().expect("a file"));
        std::fs::copy(&path, &here).expect("room for it");
        let options =
            crate::kinds::options(&path.file_name().unwrap_or_default().to_string_lossy());
        let Ok(whole) = Elevation::read(&here, &options) else {
            continue;
        };
        let settings = TileSettings {
            hole: (whole.about.holes > 0).then_some(-77.5),
            ..TileSettings::default()
        };
        let tiled = TiledMap::open(&here, &options, &settings, &ElevationProgress::default());
        let tiled = tiled.unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(tiled.size(), whole.size, "{here:?}");
        // NaN may stand for no data, and is no number.
        let [a, b] = [tiled.about(), &whole.about].map(|about| format!("{about:?}"));
        let noted = |about: String| about.split("notes").next().map(str::to_owned);
        assert_eq!(noted(a), noted(b), "{here:?}");
        let mut samples = Vec::new();
        tiled
            .rows(&ElevationProgress::default(), |_, rows| {
                samples.extend_from_slice(rows);
                Ok(())
            })
            .expect("just written");
        let expected = whole
            .samples
            .iter()
            .map(|s| if s.is_nan() { -77.5 } else { *s });
        assert!(
            samples
                .iter()
                .map(|s| s.to_bits())
                .eq(expected.map(f32::to_bits)),
            "{here:?}"
        );
        count += 1;
    }
    assert!(count > 30, "{count} files were read");
}

#[test]
fn levels_hold_samples_of_the_map_their_slopes_and_a_true_bound() {
    let folder = Folder::new("levels");
    let size = [2601, 1490];
    let (path, options) = raw(&folder, size);
    let map = open(&path, &options).expect("valid");
    assert!(map.was_made() && map.top() == 5);
    let at = |x: i64, z: i64| {
        let [x, z] =
            [(x, size[0]), (z, size[1])].map(|(n, count)| n.clamp(0, i64::from(count) - 1));
        f32::from(height(x as u32, z as u32))
    };
    let mut tightest = [0.0_f32; 6];
    for level in 0..=map.top() {
        let step = 1_i64 << level;
        let [columns, rows] = map.tiles(level);
        for tile_at in (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row])) {
            let tile = map.tile(level, tile_at).expect("just made");
            for k in (0..tile.heights.len()).step_by(if level == 0 { 1 } else { 61 }) {
                let place = [k % TILE, k / TILE];
                let own = [0, 1].map(|k| (tile_at[k] as usize * TILE + place[k]) as i64);
                let [x, z] = own.map(|n| n * step);
                assert_eq!(tile.heights[k], at(x, z), "level {level}, {x}, {z}");
                // Beyond the level's last samples nobody reads.
                let samples = map.samples(level).map(i64::from);
                if level == 0 || own[0] >= samples[0] || own[1] >= samples[1] {
                    continue;
                }
                // Beyond the border slopes count nothing.
                if x < i64::from(size[0]) && z < i64::from(size[1]) {
                    let slope = unpack_slope(tile.slopes[k]);
                    let fine = [at(x + 1, z) - at(x - 1, z), at(x, z + 1) - at(x, z - 1)];
                    for (found, fine) in slope.iter().zip(fine) {
                        assert!((found - 0.5 * fine).abs() <= fine.abs() / 4096.0);
                    }
                }
                let bound = 2.0 * tile.deviations[k];
                let corner = |i: i64, j: i64| at(x + i * step, z + j * step);
                for n in 0..40 {
                    let [i, j] = [n * 7 % (step + 1), n * 13 % (step + 1)];
                    let [u, v] = [i, j].map(|n| n as f32 / step as f32);
                    let north = corner(0, 0) * (1.0 - u) + corner(1, 0) * u;
                    let south = corner(0, 1) * (1.0 - u) + corner(1, 1) * u;
                    let off = (at(x + i, z + j) - (north * (1.0 - v) + south * v)).abs();
                    assert!(off <= bound + 1e-2, "level {level}: {off} > {bound}");
                    tightest[level as usize] = tightest[level as usize].max(off / bound);
                }
            }
        }
    }
    assert!(
        tightest[1..].iter().all(|ratio| *ratio > 0.3),
        "{tightest:?}"
    );
    // Bounds of parts.
    for k in 0..200_u32 {
        let low = [k * 37 % 2500, k * 53 % 1400];
        let high = [low[0] + k % 90, low[1] + k % 70];
        let bounds = map.bounds(low, high);
        for x in low[0]..=high[0] {
            for z in low[1]..=high[1] {
                let sample = f32::from(height(x, z));
                assert!((bounds.low..=bounds.high).contains(&sample));
                let next = at(i64::from(x) + 1, z.into());
                assert!((next - sample).abs() <= bounds.step);
            }
        }
    }
}

/// The last sample of a level may stand beyond the border, in a tile under which there is none of level 0: as with every side that
/// is a power of two from 1024 on.
#[test]
fn tiles_of_all_levels_are_there_whatever_the_size() {
    for size in [
        [1024, 1018],
        [1025, 1026],
        [2048, 600],
        [600, 2048],
        [3, 1024],
    ] {
        let folder = Folder::new("sizes");
        let (path, options) = raw(&folder, size);
        let map = open(&path, &options).expect("valid");
        let mut beyond = 0;
        for level in 0..=map.top() {
            let [columns, rows] = map.tiles(level);
            let under = map.tiles(0).map(|n| n.div_ceil(1 << level.min(3)));
            beyond += usize::from(columns > under[0] || rows > under[1]);
            for at in (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row])) {
                let tile = map.tile(level, at);
                let tile = tile.unwrap_or_else(|error| panic!("{size:?}: {error}"));
                assert!(
                    tile.heights.iter().all(|height| *height >= 3000.0),
                    "{at:?}"
                );
            }
        }
        assert_eq!(beyond > 0, size != [1025, 1026], "{size:?}");
    }
}

#[test]
fn tiles_are_made_once_and_anew_when_the_map_was_changed() {
    let folder = Folder::new("once");
    let (path, options) = raw(&folder, [1200, 1100]);
    let first = open(&path, &options).expect("valid");
    assert!(first.was_made());
    assert!(
        !open(&path, &options).expect("valid").was_made(),
        "it is there"
    );
    // Read in another way it is another map.
    let other = TileSettings {
        smooth: false,
        ..TileSettings::default()
    };
    let progress = ElevationProgress::default();
    let flat = TiledMap::open(&path, &options, &other, &progress).expect("valid");
    assert!(flat.was_made());
    assert_eq!(progress.step().share, 1.0);
    assert!(open(&path, &options).expect("valid").was_made());
    // Another number in the middle, at another time.
    let mut bytes = std::fs::read(&path).expect("it is there");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&path, &bytes).expect("writable");
    let later = SystemTime::now() + Duration::from_secs(5);
    let file = std::fs::File::options()
        .write(true)
        .open(&path)
        .expect("writable");
    file.set_modified(later).expect("files have times");
    let error = first.tile(0, [3, 4]).expect_err("it was changed");
    assert!(matches!(error, ElevationError::Changed { .. }), "{error}");
    let again = open(&path, &options).expect("valid");
    assert!(again.was_made());
    // Cut short while it is open.
    file.set_len(bytes.len() as u64 / 2).expect("writable");
    let error = again.tile(0, [0, 8]).expect_err("cut short");
    assert!(matches!(error, ElevationError::Changed { .. }), "{error}");
    assert!(
        again.tile(3, [0, 0]).is_ok(),
        "what was cut into tiles is still there"
    );
    let left = std::fs::read_dir(&folder.0).expect("it is there").count();
    assert_eq!(left, 2, "nothing stays behind");
}

#[test]
fn a_damaged_file_of_tiles_is_made_anew_or_refused_by_the_tile() {
    let folder = Folder::new("damage");
    let (path, options) = raw(&folder, [1200, 1100]);
    let map = open(&path, &options).expect("valid");
    let whole = std::fs::read(map.path()).expect("it is there");
    let expected = map.tile(4, [0, 0]).expect("just made");
    let before = 64 + (1 << 16) + 12 * 10 * 9;
    let mut caught = 0;
    for at in (0..64).chain((64..whole.len()).step_by(whole.len() / 300)) {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x10;
        std::fs::write(map.path(), &bytes).expect("writable");
        let again = open(&path, &options).expect("made anew where it must be");
        match again.tile(4, [0, 0]) {
            Ok(tile) => assert_eq!(tile, expected, "byte {at}"),
            Err(error) => {
                assert!(
                    at > before && error.to_string().contains("delete the file"),
                    "{error}"
                );
                caught += 1;
            }
        }
        assert!(again.was_made() || at >= 56, "byte {at} of the head");
    }
    assert!(caught > 10, "{caught}");
    for length in [0, 63, 64, 70_000, whole.len() - 1] {
        std::fs::write(map.path(), &whole[..length]).expect("writable");
        assert!(
            open(&path, &options).expect("made anew").was_made(),
            "{length}"
        );
    }
    let none = map.tile(9, [0, 0]).expect_err("there is no such level");
    assert!(matches!(none, ElevationError::DamagedTile { level: 9, .. }));
}

#[test]
fn holes_places_and_memory_that_cannot_be_are_refused_with_a_way_out() {
    let folder = Folder::new("refused");
    let (path, mut options) = raw(&folder, [600, 300]);
    options.nodata = dolomite_elevation::NoData::Value(f64::from(height(5, 7)));
    let error = open(&path, &options).expect_err("it has holes").to_string();
    assert!(error.contains("holes: Sea(0.0)"), "{error}");
    let sea = TileSettings {
        hole: Some(-10.0),
        ..TileSettings::default()
    };
    let map = TiledMap::open(&path, &options, &sea, &ElevationProgress::default());
    let map = map.expect("holes are told");
    assert!(map.about().holes > 0);
    assert_eq!(
        map.tile(0, [0, 0]).expect("readable").heights[7 * TILE + 5],
        -10.0
    );
    options.nodata = dolomite_elevation::NoData::File;
    // A folder that is a file.
    let nowhere = TileSettings {
        folder: Some(path.clone()),
        ..TileSettings::default()
    };
    let error = TiledMap::open(&path, &options, &nowhere, &ElevationProgress::default());
    assert!(
        matches!(error, Err(ElevationError::Write { .. })),
        "{error:?}"
    );
    let little = TileSettings {
        memory: 10,
        ..TileSettings::default()
    };
    let error = TiledMap::open(&path, &options, &little, &ElevationProgress::default());
    assert!(
        matches!(error, Err(ElevationError::TileMemory { .. })),
        "{error:?}"
    );
    let every = Options {
        every: 2,
        ..options
    };
    assert!(open(&path, &every).is_err());
    // A number that can only be no data, with its place.
    let mut bytes = std::fs::read(&path).expect("it is there");
    bytes[2 * (600 * 20 + 11)..][..2].copy_from_slice(&65_535_u16.to_be_bytes());
    std::fs::write(&path, bytes).expect("writable");
    let error = open(&path, &options).expect_err("65535 alone");
    assert!(
        matches!(
            error,
            ElevationError::LooksLikeNoData {
                column: 11,
                row: 20,
                count: 1,
                ..
            }
        ),
        "{error}"
    );
    let left = std::fs::read_dir(&folder.0).expect("it is there").count();
    assert_eq!(left, 2, "nothing half made stays behind");
}

/// A strip for all rows, which is unpacked whole, and its conversion.
#[test]
fn rows_that_are_complete_only_together_need_room() {
    let folder = Folder::new("strip");
    let (path, options) = raw(&folder, [900, 700]);
    let whole = Elevation::read(&path, &options).expect("valid");
    let tif = folder.0.join("map.tif");
    write(&tif, &whole, None).expect("writable");
    let map = open(&tif, &Options::default()).expect("it has strips");
    let tile = map.tile(0, [6, 5]).expect("readable");
    assert_eq!(
        tile.heights[3 * TILE + 2],
        f32::from(height(6 * 128 + 2, 5 * 128 + 3))
    );
}
