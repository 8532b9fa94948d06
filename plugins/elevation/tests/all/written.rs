//! What is written can be read again, to the bit.

use crate::{ground, read, same};
use dolomite_elevation::{Elevation, NoData, NumberType, Options, Raw, write};

fn path(name: &str) -> std::path::PathBuf {
    std::env::temp_dir().join(format!("dolomite-written-{}-{name}", std::process::id()))
}

#[test]
fn conversions_keep_the_samples() {
    for (from, to) in [
        ("hf-gdal-nodata.tif", "a.tif"),
        ("hf-gdal-nodata.tif", "a.asc"),
        ("hf-gdal-nodata.tif", "a.f32"),
        ("i16-gdal-degrees-point.tif", "b.tif"),
        ("i16-gdal-feet.tif", "c.tif"),
        ("f32-gdal-bigtiff-big-tiles.tif", "d.asc"),
        ("u16-gdal-strips.tif", "e.r16"),
        ("i16-gdal-strips.tif", "f.raw"),
    ] {
        let map = read(from, &Options::default()).expect("valid");
        let path = path(to);
        write(&path, &map, None).unwrap_or_else(|error| panic!("{error}"));
        let number = match to.rsplit_once('.') {
            Some((_, "f32")) => Some(NumberType::F32),
            Some((_, "r16")) => Some(NumberType::U16),
            Some((_, "raw")) => Some(NumberType::I16),
            _ => None,
        };
        let options = Options {
            raw: number.map(|number| Raw {
                size: Some(map.size),
                number: Some(number),
                ..Raw::default()
            }),
            nodata: if number.is_some() {
                NoData::Value(f64::NAN)
            } else {
                NoData::File
            },
            ..Options::default()
        };
        let again = Elevation::read(&path, &options).unwrap_or_else(|error| panic!("{error}"));
        assert!(same(&map.samples, &again.samples), "{from} to {to}");
        assert_eq!(again.about.holes, map.about.holes);
        if number.is_none() {
            let (a, b) = (
                map.georeference.expect("it has one"),
                again.georeference.expect("it is kept"),
            );
            let close = |a: f64, b: f64| (a - b).abs() <= 1e-14 * a.abs().max(1.0);
            assert!(
                close(a.first[0], b.first[0]) && close(a.first[1], b.first[1]),
                "{to}"
            );
            assert_eq!(a.step, b.step);
        }
        std::fs::remove_file(&path).expect("removed");
    }
}

#[test]
fn what_cannot_be_written_leaves_nothing_behind() {
    let map = read("hf-gdal-nodata.tif", &Options::default()).expect("valid");
    for (name, words) in [
        ("a.r16", "column 0, row 0"),
        ("a.xyz", "nothing is written as .xyz"),
        ("no/such/folder.f32", "cannot be written"),
    ] {
        let path = path(name);
        let error = write(&path, &map, None).expect_err("refused").to_string();
        assert!(error.contains(words), "{error}");
        assert!(!path.exists());
    }
}

#[test]
fn the_hillshade_is_a_picture_with_holes() {
    let map = read("hf-gdal-nodata.tif", &Options::default()).expect("valid");
    let path = path("shade.png");
    write(&path, &map, None).expect("written");
    let shade = Elevation::read(&path, &Options::default()).expect("it is grey with alpha");
    std::fs::remove_file(&path).expect("removed");
    let holes = |samples: &[f32]| samples.iter().map(|s| s.is_nan()).collect::<Vec<_>>();
    assert_eq!(holes(&shade.samples), holes(&ground("hf")));
    let [low, high] = shade.about.range.expect("shades");
    assert!(low < 120.0 && high > 200.0, "{low} {high}");
}
