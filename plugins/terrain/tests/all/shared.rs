//! A map that is read by tiles under several terrains, at the place where somebody begins, and with holes that are a sea.

use crate::tiled::{Raw, on_ground};
use bevy::app::App;
use bevy::math::DVec2;
use dolomite_terrain::elevation::{Elevation, NoData, Options};
use dolomite_terrain::{
    Filter, HeightMapFile, Holes, MapFocus, MapStreamingStats, Terrain, TerrainPlugin,
};
use std::path::Path;
use std::time::{Duration, Instant};

const LITTLE: u64 = 12 << 20;

/// The data that a terrain laid out, brought up to date frame by frame, as a renderer does.
struct Kept {
    data: Vec<u32>,
    first: usize,
    now: u64,
}

impl Kept {
    fn of(terrain: &Terrain) -> Self {
        let data = terrain.gpu().data;
        let stream = terrain.streamed().and_then(|map| map.stream());
        Self {
            data,
            first: terrain.streamed_at().expect("by tiles") as usize,
            now: stream.expect("by tiles").laid_out(),
        }
    }

    fn update(&mut self, terrain: &Terrain) {
        let stream = terrain.streamed().and_then(|map| map.stream());
        let news = stream.expect("by tiles").news(self.now);
        self.now = news.now;
        for write in news.list {
            let at = self.first + write.at as usize;
            self.data[at..at + write.words.len()].copy_from_slice(&write.words);
        }
    }
}

#[test]
fn terrains_that_share_a_map_are_all_served() {
    let raw = Raw::new("shared");
    let map = raw.map(Filter::Bicubic, LITTLE);
    let [one, other] = [(); 2].map(|()| on_ground(&map).expect("valid"));
    let mut app = App::new();
    app.add_plugins((bevy::MinimalPlugins, TerrainPlugin));
    let entities = [&one, &other].map(|terrain| app.world_mut().spawn(terrain.clone()).id());
    let mut first = Kept::of(&one);
    let mut second = None;
    let place = DVec2::new(900.0, 200.0);
    app.insert_resource(MapFocus(Some(place)));
    let end = Instant::now() + Duration::from_secs(20);
    for frame in 0.. {
        app.update();
        first.update(&one);
        // The other one comes later, and looks now and then.
        if frame == 3 {
            second = Some(Kept::of(&other));
        } else if let Some(second) = second.as_mut().filter(|_| frame % 5 == 0) {
            second.update(&other);
        }
        let stats = app.world().resource::<MapStreamingStats>();
        if frame > 3 && stats.missing == 0 || Instant::now() > end {
            break;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    let stats = *app.world().resource::<MapStreamingStats>();
    let stream = map.stream().expect("by tiles");
    assert_eq!(stats.missing, 0);
    let tiles = stream.missing(false).len();
    assert_eq!(tiles, 0, "each is wanted once");
    let mut second = second.expect("it was made in the fourth frame");
    first.update(&one);
    second.update(&other);
    let now = one.gpu().data;
    assert!(first.data == now, "the first has what is there");
    assert!(second.data == now, "the second too");
    // Both are told where the ground has become finer.
    app.update();
    for entity in entities {
        let terrain = app.world().get::<Terrain>(entity).expect("it was spawned");
        assert!(terrain.same_arrived(&one.with_arrived()));
    }
    assert_eq!(map.error_at(place), 0.0);
}

#[test]
fn who_begins_somewhere_stands_on_the_true_ground_there() {
    let raw = Raw::new("begin");
    for filter in [Filter::Bilinear, Filter::Bicubic] {
        let whole = raw.map(filter, 1 << 40);
        let tiled = raw.map(filter, LITTLE);
        let terrain = on_ground(&tiled).expect("valid");
        let mut coarse = 0;
        // One after the other, near and far; beside the borders of tiles, at that of the map and beyond it.
        for [column, row] in [
            [1500.0, 1000.0],
            [127.5, 127.5],
            [128.0, 255.9],
            [700.3, 255.9],
            [2999.0, 1999.0],
            [2900.0, 10.0],
            [-40.0, 900.0],
            [383.2, 1023.8],
        ] {
            let place = whole.origin() + DVec2::new(column, row) * whole.spacing();
            coarse += u32::from(tiled.error_at(place) > 0.0);
            terrain.read_about(place).expect("the file is there");
            assert_eq!(tiled.error_at(place), 0.0, "{place}");
            assert_eq!(tiled.sample_f64(place), whole.sample_f64(place), "{place}");
            let reads = tiled.stream().expect("by tiles").tiles().reads();
            terrain.read_about(place).expect("nothing to read");
            let again = tiled.stream().expect("by tiles").tiles().reads();
            assert_eq!(again, reads, "it is there already");
        }
        assert!(coarse >= 5, "{coarse}");
        assert!(
            on_ground(&whole)
                .expect("valid")
                .read_about(DVec2::ZERO)
                .is_ok()
        );
    }
}

/// A file whose heights are in feet, with a scale and an offset of its own: whatever of it has no data lies below the same sea.
#[test]
fn holes_of_a_map_by_tiles_lie_below_the_sea_in_metres() {
    let files = Path::new(env!("CARGO_MANIFEST_DIR")).join("../elevation/tests/files");
    let name = "i16-gdal-scaled.tif";
    let plain = Elevation::read(&files.join(name), &Options::default()).expect("valid");
    assert_eq!(plain.about.unit_metres, Some(0.3048));
    // The number of some sample stands for no data, as the file has it before its scale.
    let at = 17 * plain.size[0] as usize + 11;
    let number = (f64::from(plain.samples[at]) - plain.about.offset) / plain.about.scale;
    let folder = std::env::temp_dir().join(format!("dolomite-holes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::copy(files.join(name), folder.join(name)).expect("room");
    let file = |budget| HeightMapFile {
        path: name.to_owned(),
        spacing: Some([2.0; 2]),
        scale: 3.0,
        offset: 40.0,
        filter: Filter::Bilinear,
        nodata: NoData::Value(number),
        holes: Holes::Sea(25.0),
        budget,
        ..HeightMapFile::default()
    };
    let whole = file(None).load(&folder).expect("valid");
    let tiled = file(Some(1)).load(&folder).expect("valid");
    assert!(whole.stream().is_none() && tiled.stream().is_some());
    let place = whole.origin() + DVec2::new(11.0, 17.0) * 2.0;
    tiled.read_about(place).expect("the file is there");
    let [a, b] = [&whole, &tiled].map(|map| map.sample_f64(place).height);
    assert!((a - 15.0).abs() < 1e-6, "{a}");
    // A number of the file and back: a rounding of its scale and offset each.
    assert!((b - 15.0).abs() < 1e-4, "{b}");
    std::fs::remove_dir_all(&folder).expect("it is ours");
}
