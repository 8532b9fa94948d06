//! A map that is read by tiles beside the same map in memory: the same bits where its tiles are, within the stated error elsewhere.

use crate::support::Random;
use bevy::app::App;
use bevy::math::DVec2;
use dolomite_terrain::elevation::{ElevationProgress, TileSettings, TiledMap};
use dolomite_terrain::{
    Filter, GroundPoint, GroundRect, HeightMap, HeightMapFile, Layer, MapFocus, MapFormat,
    MapStreaming, MapStreamingStats, RawFormat, Source, Terrain, TerrainData, TerrainError,
    TerrainPlugin,
};
use std::path::PathBuf;
use std::time::{Duration, Instant};

pub const SIZE: [u32; 2] = [3000, 2000];
const SPACING: f64 = 2.0;
/// Four by four tiles of each level, and what else is counted.
const LITTLE: u64 = 12 << 20;

/// A file that is deleted when the test ends, with its tiles.
pub struct Raw(pub PathBuf);

impl Raw {
    pub fn new(name: &str) -> Self {
        let name = format!("dolomite-terrain-{name}-{}.raw", std::process::id());
        let path = std::env::temp_dir().join(name);
        let height = |x: u32, z: u32| {
            let wave = |n: u32, of: u32| {
                let n = n % of;
                n.min(of - n)
            };
            let rough = (x.wrapping_mul(0x9e37_79b9) ^ z.wrapping_mul(0x85eb_ca6b)) >> 28;
            (5000 + 9 * wave(x, 1100) + 11 * wave(z + x / 3, 700) + 30 * wave(x + z, 24) + rough)
                as u16
        };
        let rows = (0..SIZE[1]).flat_map(|z| (0..SIZE[0]).map(move |x| height(x, z)));
        let bytes: Vec<u8> = rows.flat_map(u16::to_le_bytes).collect();
        std::fs::write(&path, bytes).expect("room for 12 MB");
        Self(path)
    }

    pub fn map(&self, filter: Filter, budget: u64) -> HeightMap {
        let file = HeightMapFile {
            path: self.0.display().to_string(),
            format: MapFormat::raw(RawFormat::U16, SIZE[0], SIZE[1]),
            scale: 0.1,
            offset: -20.0,
            spacing: Some([SPACING; 2]),
            centre: [500.0, -300.0],
            filter,
            budget: Some(budget),
            ..HeightMapFile::default()
        };
        file.load(std::path::Path::new("")).expect("valid")
    }
}

impl Drop for Raw {
    fn drop(&mut self) {
        let mut tiles = self.0.clone().into_os_string();
        tiles.push(".tiles");
        std::fs::remove_file(&self.0).ok();
        std::fs::remove_file(tiles).ok();
    }
}

/// Reads all that is wanted about a place.
pub fn settle(map: &HeightMap, place: DVec2) {
    map.follow(place);
    let stream = map.stream().expect("it is read by tiles");
    for request in stream.missing(false) {
        let tile = stream.load(request).expect("the file is there");
        assert!(stream.put(request, &tile));
    }
    assert!(stream.missing(false).is_empty());
}

pub fn on_ground(map: &HeightMap) -> Result<Terrain, TerrainError> {
    Terrain::new(TerrainData {
        extent: map.rect(),
        layers: vec![Layer {
            source: Source::Map(map.clone()),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
    })
}

#[test]
fn heights_are_those_of_the_whole_map_or_within_the_stated_error() {
    let raw = Raw::new("same");
    for filter in [Filter::Bilinear, Filter::Bicubic] {
        let whole = raw.map(filter, 1 << 40);
        let tiled = raw.map(filter, LITTLE);
        assert!(whole.stream().is_none() && tiled.stream().is_some());
        assert_eq!(
            (tiled.origin(), tiled.spacing()),
            (whole.origin(), whole.spacing())
        );
        assert_eq!(tiled.extremes(), whole.extremes());
        let stream = tiled.stream().expect("by tiles");
        assert!(stream.bytes() <= LITTLE, "{}", stream.bytes());
        let mut random = Random(3);
        let mut coarse = 0;
        let mut largest = 0.0_f32;
        for round in 0..6 {
            let middle = whole.origin()
                + DVec2::new(random.unit(), random.unit()) * DVec2::new(6000.0, 4000.0);
            if round > 0 {
                settle(&tiled, middle);
            }
            let mut fine = 0;
            for k in 0..4000 {
                let size = if k % 2 == 0 { 500.0 } else { 9000.0 };
                let xz = middle + (DVec2::new(random.unit(), random.unit()) - 0.5) * size;
                let (a, b) = (whole.sample_f64(xz), tiled.sample_f64(xz));
                let error = tiled.error_at(xz);
                let off = (a.height - b.height).abs() as f32;
                assert!(off <= error, "{filter:?} {xz}: {off} > {error}");
                let point = GroundPoint::new(xz);
                let (near, far) = (tiled.sample(point), whole.sample(point));
                // Rounding of 600 m to f32, some operations; the cell beside by a rounding of the place.
                assert!((f64::from(near.value) - b.height).abs() < 1e-3, "{xz}");
                if error == 0.0 {
                    fine += 1;
                    assert_eq!(
                        (a.height.to_bits(), a.gradient),
                        (b.height.to_bits(), b.gradient)
                    );
                    assert_eq!(
                        (near.value.to_bits(), near.gradient),
                        (far.value.to_bits(), far.gradient)
                    );
                } else {
                    coarse += 1;
                    largest = largest.max(off / error);
                    let slope = (near.gradient.as_dvec2() - b.gradient).length();
                    assert!(slope < 1e-3, "{slope}");
                }
            }
            assert!(fine > 1500 || round == 0, "{fine}");
        }
        assert!(coarse > 3000 && largest > 0.2, "{coarse}, {largest}");
        // Samples of every level have the bits of the map, wherever fine tiles are.
        for k in 0..2000_u32 {
            let at = [k * 37 % 46 * 64, k * 53 % 31 * 64].map(f64::from);
            let xz = whole.origin() + DVec2::from_array(at) * SPACING;
            let (a, b) = (whole.sample_f64(xz).height, tiled.sample_f64(xz).height);
            // 1/spacing is exact here, and so is the place.
            assert_eq!(a.to_bits(), b.to_bits(), "{at:?}");
        }
    }
}

#[test]
fn bounds_and_what_samples_miss_hold_for_the_whole_map() {
    let raw = Raw::new("bounds");
    for filter in [Filter::Bilinear, Filter::Bicubic] {
        let (whole, tiled) = (raw.map(filter, 1 << 40), raw.map(filter, LITTLE));
        let ground = on_ground(&tiled).expect("valid");
        let truth = on_ground(&whole).expect("valid");
        let mut random = Random(11);
        let mut looser = 0.0_f32;
        let mut steps = 0;
        for round in 0..120 {
            let near = whole.origin()
                + DVec2::new(random.unit(), random.unit()) * DVec2::new(5600.0, 3600.0);
            if round % 30 == 0 {
                settle(&tiled, near);
            }
            let side = [40.0, 150.0, 700.0][round % 3];
            let rect = GroundRect::new(near, near + side);
            let bounds = ground.bounds(&rect);
            let spacing = side / 4.0;
            let missed = tiled.missed(&rect, spacing);
            let corners = [near, near + DVec2::new(spacing, 0.0), near + spacing];
            let corners = corners.map(|xz| whole.sample_f64(xz).height);
            for _ in 0..60 {
                let (u, v) = (random.unit(), random.unit());
                let at = near + DVec2::new(u, v) * side;
                let sample = truth.sample_f64(at);
                let height = sample.height as f32;
                assert!(
                    (bounds.min..=bounds.max).contains(&height),
                    "{bounds:?} {height}"
                );
                assert!(sample.gradient.length() as f32 <= bounds.max_slope * 1.001);
                let (u, v) = (u.max(v), u.min(v));
                let plane = corners[0] * (1.0 - u) + corners[1] * (u - v) + corners[2] * v;
                let inside = whole.sample_f64(near + DVec2::new(u, v) * spacing).height;
                assert!((inside - plane).abs() as f32 <= missed + 1e-3, "{missed}");
            }
            let exact = whole.missed(&rect, spacing);
            if exact > 0.1 {
                looser += missed / exact;
                steps += 1;
            }
        }
        let looser = looser / steps as f32;
        println!(
            "{filter:?}: what is missed is bounded {looser:.3} times as high as of the whole map"
        );
        assert!(looser < 2.0, "{looser}");
    }
}

#[test]
fn one_map_is_read_by_tiles_and_the_gpu_has_its_place() {
    let raw = Raw::new("layout");
    let map = raw.map(Filter::Bicubic, LITTLE);
    settle(&map, DVec2::ZERO);
    let layer = |source| Layer { source, mask: None };
    let small = HeightMap::new(3, 2, vec![1.0; 6], DVec2::ZERO, DVec2::ONE, Filter::Bicubic);
    let layers = vec![
        layer(Source::Map(small.expect("valid"))),
        layer(Source::Fractal(dolomite_terrain::Fractal::default())),
        layer(Source::Map(map.clone())),
    ];
    let data = TerrainData {
        extent: map.rect(),
        layers: layers.clone(),
        base: 0.0,
        sea_level: None,
    };
    let terrain = Terrain::new(data.clone()).expect("valid");
    let gpu = terrain.gpu();
    let since = map.stream().expect("by tiles").laid_out();
    assert_eq!(terrain.streamed_at(), Some(gpu.layers[2].data.into()));
    assert_eq!(
        gpu.layers[2].octaves,
        map.stream().expect("by tiles").levels()
    );
    // Writes make of the old data the new ones.
    let mut before = gpu.data.clone();
    settle(&map, DVec2::new(1800.0, 900.0));
    let stream = map.stream().expect("by tiles");
    let news = stream.news(since);
    assert_eq!(news.readable, stream.readable());
    let writes = &news.list;
    let first = gpu.layers[2].data as usize;
    for write in writes {
        let at = first + write.at as usize;
        before[at..at + write.words.len()].copy_from_slice(&write.words);
    }
    assert!(
        writes.len() > 20 && before == terrain.gpu().data,
        "{}",
        writes.len()
    );
    assert!(stream.news(news.now).list.is_empty());
    // Another terrain with the same map is told the same.
    assert_eq!(stream.news(since), news);
    let twice = TerrainData {
        layers: vec![layers[2].clone(), layers[2].clone()],
        ..data
    };
    let error = Terrain::new(twice).expect_err("two of them");
    assert!(error.to_string().contains("budget"), "{error}");
    let joined = HeightMap::joined(&[("large.raw", map.clone())]);
    assert!(joined.is_err_and(|error| error.to_string().contains("large.raw")));
    // The ground goes on beyond the map, as far as the lattice needs it.
    let size = map.rect().size() / SPACING;
    assert_eq!(size, DVec2::new(3072.0, 2048.0));
}

/// A flight over the map at 200 m/s, frame by frame.
#[test]
fn no_frame_reads_a_file_and_none_takes_more_than_it_may() {
    let raw = Raw::new("flight");
    let map = raw.map(Filter::Bicubic, LITTLE);
    let terrain = on_ground(&map).expect("valid");
    let mut app = App::new();
    app.add_plugins((bevy::MinimalPlugins, TerrainPlugin));
    app.world_mut().resource_mut::<MapStreaming>().tiles_a_frame = 2;
    let entity = app.world_mut().spawn(terrain).id();
    let stream = map.stream().expect("by tiles");
    let opened = stream.tiles().reads();
    app.update();
    assert_eq!(
        stream.tiles().reads(),
        opened,
        "without a focus nothing is read"
    );
    let mut fine = 0;
    for frame in 0..1200 {
        let place = DVec2::new(-2000.0 + f64::from(frame) * 200.0 / 60.0, -300.0);
        app.insert_resource(MapFocus(Some(place)));
        app.update();
        fine += u32::from(map.error_at(place) == 0.0);
        std::thread::sleep(Duration::from_millis(1));
    }
    let end = Instant::now() + Duration::from_secs(20);
    while app.world().resource::<MapStreamingStats>().missing > 0 && Instant::now() < end {
        app.update();
        std::thread::sleep(Duration::from_millis(1));
    }
    let stats = *app.world().resource::<MapStreamingStats>();
    println!("{stats:?}, fine below the place in {fine} of 1200 frames");
    assert_eq!(stats.missing, 0);
    assert!(stats.most_a_frame <= 2 && stats.failed == 0);
    // Every read was one of a task that arrived.
    assert_eq!(stats.arrived + stats.late, stream.tiles().reads() - opened);
    assert!(stats.arrived > 40 && fine > 600);
    // The file is cut short: the last good ground stays, and nobody asks again.
    let place = DVec2::new(-1500.0, 900.0);
    let before = map.sample_f64(place);
    let file = std::fs::File::options()
        .write(true)
        .open(&raw.0)
        .expect("writable");
    file.set_len(1000).expect("writable");
    app.insert_resource(MapFocus(Some(place)));
    for _ in 0..300 {
        app.update();
        std::thread::sleep(Duration::from_millis(1));
    }
    let after = *app.world().resource::<MapStreamingStats>();
    assert!(
        after.failed >= 1 && after.failed <= 4 && after.missing > 0,
        "{after:?}"
    );
    let error = f64::from(map.error_at(place));
    assert!((map.sample_f64(place).height - before.height).abs() <= 2.0 * error);
    app.world_mut().despawn(entity);
    app.update();
}

#[test]
fn a_map_beyond_all_memory_is_refused_before_it_is_taken() {
    let raw = Raw::new("refused");
    let tiles = TiledMap::open(
        &raw.0,
        &HeightMapFile {
            format: MapFormat::raw(RawFormat::U16, SIZE[0], SIZE[1]),
            ..HeightMapFile::default()
        }
        .options(),
        &TileSettings::default(),
        &ElevationProgress::default(),
    );
    let place = (DVec2::ZERO, DVec2::splat(0.001));
    let error = HeightMap::by_tiles(
        tiles.expect("valid"),
        [1.0, 0.0],
        place,
        Filter::Bicubic,
        1 << 30,
    );
    assert!(
        error
            .expect_err("a millimetre")
            .to_string()
            .contains("spacing")
    );
}

#[test]
fn where_the_ground_has_become_finer_is_told() {
    let raw = Raw::new("told");
    let map = raw.map(Filter::Bicubic, LITTLE);
    let ground = on_ground(&map).expect("valid");
    let mut random = Random(23);
    let mut finer = 0;
    let mut untouched = 0;
    for round in 0..8 {
        let before = ground.with_arrived();
        assert!(before.changed_since(&before).is_some_and(|r| r.is_empty()));
        let middle =
            map.origin() + DVec2::new(random.unit(), random.unit()) * DVec2::new(6000.0, 4000.0);
        let places: Vec<_> = (0..4000)
            .map(|_| {
                middle
                    + (DVec2::new(random.unit(), random.unit()) - 0.5)
                        * (1000.0 * (1 + round % 5) as f64)
            })
            .collect();
        let errors: Vec<_> = places.iter().map(|&xz| map.error_at(xz)).collect();
        settle(&map, middle);
        let now = ground.with_arrived();
        assert!(now.same(&before) && !now.same_arrived(&before));
        let rects = now.changed_since(&before).expect("of the same map");
        for (xz, error) in places.iter().zip(errors) {
            let told = rects.iter().any(|rect| rect.contains(*xz));
            let is_finer = map.error_at(*xz) < error;
            assert!(told || !is_finer, "{xz} was {error}");
            finer += u32::from(is_finer);
            untouched += u32::from(!told);
        }
    }
    assert!(finer > 3000 && untouched > 3000, "{finer}, {untouched}");
    // In an app it is the component that tells, and not in every frame.
    let mut app = App::new();
    app.add_plugins((bevy::MinimalPlugins, TerrainPlugin));
    let entity = app.world_mut().spawn(ground.with_arrived()).id();
    app.insert_resource(MapFocus(Some(map.origin() + 300.0)));
    let mut told = 0;
    let mut last = ground.with_arrived();
    for _ in 0..400 {
        app.update();
        let now = app.world().get::<Terrain>(entity).expect("there");
        told += u32::from(!now.same_arrived(&last));
        last = now.clone();
        std::thread::sleep(Duration::from_millis(5));
    }
    let stats = *app.world().resource::<MapStreamingStats>();
    assert!(stats.arrived > 20 && stats.missing == 0, "{stats:?}");
    assert!((1..12).contains(&told), "{told}");
}
