//! Files as people bring them: cases from the field, from the shared data where it is there, and tiles.

use dolomite_terrain::elevation::{ByteOrder, Elevation, ElevationError, NoData, Options};
use dolomite_terrain::{HeightMap, HeightMapError, HeightMapFile, MapFormat, RawFormat};
use std::path::PathBuf;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/files")
}

fn file(path: &str, format: MapFormat) -> HeightMapFile {
    HeightMapFile {
        path: path.to_owned(),
        format,
        spacing: Some([10.0, 10.0]),
        ..HeightMapFile::default()
    }
}

fn raw(format: RawFormat, order: ByteOrder) -> MapFormat {
    MapFormat::Raw {
        format,
        width: 96,
        height: 64,
        order,
        header: 0,
        row_padding: 0,
        flip: false,
    }
}

fn load(file: &HeightMapFile) -> Result<HeightMap, HeightMapError> {
    file.load(&folder())
}

#[test]
fn the_same_ground_in_every_file() {
    let plain = load(&file("plain.png", MapFormat::Auto)).expect("valid");
    let big = raw(RawFormat::U16, ByteOrder::Big);
    let mac = load(&file("mac_be_u16.raw", big)).expect("valid");
    assert_eq!(plain.samples(), mac.samples());
    let wrong = raw(RawFormat::U16, ByteOrder::Little);
    let wrong = load(&file("mac_be_u16.raw", wrong)).expect("any bytes are numbers");
    assert_ne!(plain.samples(), wrong.samples());
}

/// What GDAL writes where a band has a number for no data, whether or not a sample is it.
#[test]
fn a_number_for_no_data_leaves_the_samples_whole() {
    let plain = load(&file("plain.png", MapFormat::Auto)).expect("valid");
    let map = load(&file("nodata_trns.png", MapFormat::Auto)).expect("valid");
    assert_eq!(plain.samples(), map.samples());
    let read =
        Elevation::read(&folder().join("nodata_trns.png"), &Options::default()).expect("valid");
    let nodata: Vec<f64> = read.about.nodata.iter().map(|n| n.0).collect();
    assert_eq!(nodata, [0.0]);
}

#[test]
fn a_pit_of_ten_kilometres_is_refused_or_filled() {
    let nodata = file("nodata_9999.raw", raw(RawFormat::I16, ByteOrder::Little));
    let error = load(&nodata).expect_err("nobody said what -9999 is");
    let HeightMapError::File(ElevationError::LooksLikeNoData {
        column, row, value, ..
    }) = &error
    else {
        panic!("{error}");
    };
    assert_eq!(*value, -9999.0);
    let bytes = std::fs::read(folder().join("nodata_9999.raw")).expect("it is there");
    let at = bytes
        .as_chunks::<2>()
        .0
        .iter()
        .position(|b| i16::from_le_bytes(*b) == -9999);
    assert_eq!(at, Some((row * 96 + column) as usize));
    let told = HeightMapFile {
        nodata: NoData::Value(-9999.0),
        ..nodata
    };
    let map = load(&told).expect("filled");
    assert!(map.samples().iter().all(|s| *s > -1000.0));
}

#[test]
fn eight_bits_and_four_thousand_a_side_are_read() {
    let grey = load(&file("grey8.png", MapFormat::Auto)).expect("valid");
    assert_eq!((grey.width(), grey.height()), (96, 64));
    let zero = load(&file("zero4097.png", MapFormat::Png)).expect("Unity's usual size");
    assert_eq!((zero.width(), zero.height()), (4097, 4097));
    let least = HeightMapFile {
        every: 64,
        ..file("zero4097.png", MapFormat::Auto)
    };
    assert_eq!(load(&least).expect("valid").width(), 65);
}

/// Sixteen GeoTIFFs that GDAL cut from one, in any order, are that one to the bit, in its very place.
#[test]
fn tiles_of_gdal_are_one_map() {
    let whole = HeightMapFile {
        path: "tiles/whole.tif".to_owned(),
        ..HeightMapFile::default()
    };
    let whole = load(&whole).expect("valid");
    let names = (0..16)
        .map(|k| 7 * k % 16)
        .map(|k: u32| format!("tiles/{}{}.tif", k / 4, k % 4));
    let tiles = HeightMapFile {
        tiles: vec![names.collect()],
        ..HeightMapFile::default()
    };
    let tiles = load(&tiles).expect("they agree");
    assert_eq!(whole.samples(), tiles.samples());
    assert_eq!(
        (whole.origin(), whole.spacing()),
        (tiles.origin(), tiles.spacing())
    );
    assert_eq!(whole.georeference(), tiles.georeference());
    let place = whole.georeference().expect("UTM");
    assert_eq!(place.first, [412_345.0, 5_123_455.0]);
}

#[test]
fn tiles_that_do_not_fit_say_which() {
    let tiles = |tiles: &[&[&str]], overlap| {
        let row = |row: &&[&str]| row.iter().map(|&name| name.to_owned()).collect();
        let file = HeightMapFile {
            tiles: tiles.iter().map(row).collect(),
            overlap,
            ..file("", MapFormat::Auto)
        };
        load(&file).map(|map| [map.width(), map.height()])
    };
    let error = |made: Result<[u32; 2], HeightMapError>| made.expect_err("refused").to_string();
    let disagree = error(tiles(&[&["plain.png", "plain.png"]], 1));
    assert!(
        disagree.contains("share a border but disagree: column 95, row 0"),
        "{disagree}"
    );
    assert_eq!(
        tiles(&[&["plain.png", "plain.png"]], 0).expect("side by side"),
        [192, 64]
    );
    assert_eq!(
        tiles(&[&["plain.png"], &["plain.png"]], 0).expect("one above the other"),
        [96, 128]
    );
    let other = error(tiles(&[&["plain.png"], &["tiles/00.tif"]], 0));
    assert!(
        other.contains("plain.png and") && other.contains("cut them alike"),
        "{other}"
    );
    let missing = error(tiles(&[&["plain.png", "away.png"]], 0));
    assert!(missing.contains("away.png: cannot be read"), "{missing}");
}
