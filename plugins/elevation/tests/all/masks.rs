//! Masks beside maps (`NAME.EXT.msk`): of every kind, in memory, row by row and by tiles.

use crate::sidecars::{Folder, options, read};
use crate::{folder, same};
use dolomite_elevation::{
    Elevation, ElevationError, ElevationProgress, NoData, Options, TileSettings, TiledMap, convert,
};
use std::io::Cursor;
use std::path::Path;
use tiff::encoder::{Compression, DeflateLevel, TiffEncoder, colortype};
use tiff::tags::Tag;

/// Whether the mask of our tests has data there.
fn there(column: u32, row: u32) -> bool {
    !(column * 5 + row * 3).is_multiple_of(7) && row != 11
}

/// A mask of so many columns and rows, in pieces of so many rows.
fn mask([columns, rows]: [u32; 2], high: u32, packed: bool) -> Vec<u8> {
    let bytes: Vec<u8> = (0..rows)
        .flat_map(|row| (0..columns).map(move |column| 255 * u8::from(there(column, row))))
        .collect();
    let mut file = Vec::new();
    let encoder = TiffEncoder::new(Cursor::new(&mut file)).expect("an empty file");
    let compression = match packed {
        true => Compression::Deflate(DeflateLevel::Balanced),
        false => Compression::Uncompressed,
    };
    let mut encoder = encoder.with_compression(compression);
    let image = encoder.new_image::<colortype::Gray8>(columns, rows);
    let mut image = image.expect("a picture");
    image.rows_per_strip(high).expect("nothing is written yet");
    image.write_data(&bytes).expect("as many as it has");
    file
}

fn masked(map: &Elevation, every: u32) -> Vec<f32> {
    let columns = map.size[0];
    let samples = (0..).zip(&map.samples);
    let keep = |(k, &sample): (u32, &f32)| match there(k % columns * every, k / columns * every) {
        true => sample,
        false => f32::NAN,
    };
    samples.map(keep).collect()
}

#[test]
fn maps_of_every_kind_have_no_data_where_a_mask_beside_them_is_0() {
    let folder_of_ours = Folder::new("masks");
    let mut count = 0;
    for entry in std::fs::read_dir(folder()).expect("it is there") {
        let from = entry.expect("readable").file_name();
        let from = from.to_string_lossy();
        if from.ends_with(".prj") || from.ends_with(".py") {
            continue;
        }
        let path = folder_of_ours.0.join(&*from);
        std::fs::copy(folder().join(&*from), &path).expect("room");
        let options = options(&from);
        let Ok(bare) = Elevation::read(&path, &options) else {
            continue;
        };
        let fewer = Options {
            every: 3,
            ..options
        };
        // Who says that every number is a height means it.
        let all = Options {
            nodata: NoData::None,
            ..options
        };
        let all_heights = Elevation::read(&path, &all).map(|map| map.samples).ok();
        let wanted = masked(&bare, 1);
        let wanted_of_fewer = masked(&read(&path, &fewer), 3);
        for (high, packed) in [(37, false), (1, true), (5, false), (16, true)] {
            folder_of_ours.write(&format!("{from}.msk"), mask(bare.about.size, high, packed));
            let map = read(&path, &options);
            assert!(same(&map.samples, &wanted), "{from}, {high} rows");
            let holes = wanted.iter().filter(|sample| sample.is_nan()).count();
            assert_eq!(map.about.holes, holes as u64, "{from}");
            let said = map.about.notes.join("; ");
            assert!(
                said.contains(".msk beside it tells where there is no data"),
                "{said}"
            );
            let map = read(&path, &fewer);
            assert!(
                same(&map.samples, &wanted_of_fewer),
                "every third of {from}"
            );
        }
        // Row by row.
        let to = folder_of_ours.0.join("converted.f32");
        let progress = ElevationProgress::default();
        let about = convert(&path, Some(&to), &options, None, &progress);
        let about = about.unwrap_or_else(|error| panic!("{error}"));
        let bytes = std::fs::read(&to).expect("just written");
        let (quads, _) = bytes.as_chunks::<4>();
        let samples: Vec<f32> = quads.iter().map(|b| f32::from_le_bytes(*b)).collect();
        assert!(same(&samples, &wanted), "{from} row by row");
        assert_eq!(about.holes, read(&path, &options).about.holes);
        // By tiles.
        let settings = TileSettings {
            hole: Some(-77.5),
            ..TileSettings::default()
        };
        let tiled = TiledMap::open(&path, &options, &settings, &progress);
        let tiled = tiled.unwrap_or_else(|error| panic!("{error}"));
        let mut samples = Vec::new();
        let rows = tiled.rows(&progress, |_, rows| {
            samples.extend_from_slice(rows);
            Ok(())
        });
        rows.expect("just written");
        let filled = wanted.iter().map(|s| if s.is_nan() { -77.5 } else { *s });
        assert!(samples.iter().copied().eq(filled), "{from} by tiles");
        assert_eq!(tiled.about().holes, about.holes);
        if let Some(heights) = all_heights {
            assert!(same(&read(&path, &all).samples, &heights), "{from}");
        }
        count += 1;
    }
    assert!(count > 50, "{count} files were read");
}

/// Numbers under a mask are no heights, whatever they are.
#[test]
fn what_a_mask_takes_away_is_not_looked_at() {
    let folder = Folder::new("under");
    for (ending, wide) in [("f32", false), ("asc", true)] {
        let numbers: Vec<f32> = (0..41 * 37)
            .map(|k| match there(k % 41, k / 41) {
                true => k as f32,
                false => -9999.0,
            })
            .collect();
        let name = format!("a.{ending}");
        let path = if wide {
            let words: Vec<_> = numbers.iter().map(ToString::to_string).collect();
            let text = format!("ncols 41\nnrows 37\n{}", words.join(" "));
            folder.write(&name, text)
        } else {
            let bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
            folder.write(&name, bytes)
        };
        let raw = dolomite_elevation::Raw {
            size: Some([41, 37]),
            ..dolomite_elevation::Raw::default()
        };
        let options = Options {
            raw: (!wide).then_some(raw),
            ..Options::default()
        };
        let error = Elevation::read(&path, &options).expect_err("it can only be no data");
        assert!(
            matches!(error, ElevationError::LooksLikeNoData { .. }),
            "{error}"
        );
        folder.write(&format!("{name}.msk"), mask([41, 37], 37, true));
        let map = read(&path, &options);
        // The first and the last number are among those that it takes.
        assert_eq!(map.about.range, Some([1.0, 1515.0]));
    }
}

#[test]
fn a_mask_within_the_file_goes_first() {
    let folder = Folder::new("within");
    let mut bytes = Vec::new();
    let mut encoder = TiffEncoder::new(Cursor::new(&mut bytes)).expect("an empty file");
    encoder
        .write_image::<colortype::Gray16>(3, 2, &[1, 2, 3, 4, 5, 6])
        .expect("six samples");
    let second = encoder.new_image::<colortype::Gray8>(3, 2);
    let mut second = second.expect("a second one");
    // A transparency mask.
    let purpose = second.encoder().write_tag(Tag::NewSubfileType, 4_u32);
    purpose.expect("a tag");
    let pixels = second.write_data(&[255, 0, 255, 255, 255, 255]);
    pixels.expect("six pixels");
    let path = folder.write("a.tif", &bytes);
    for beside in [
        mask([3, 2], 2, false),
        mask([9, 9], 9, false),
        b"none".to_vec(),
    ] {
        folder.write("a.tif.msk", beside);
        let map = read(&path, &Options::default());
        assert!(same(&map.samples, &[1.0, f32::NAN, 3.0, 4.0, 5.0, 6.0]));
    }
}

#[test]
fn a_mask_that_is_none_is_refused_with_its_name() {
    let folder = Folder::new("none");
    let path = folder.copy("u16-gdal.png", "a");
    for (bytes, words) in [
        (
            mask([41, 36], 36, false),
            "its size: 41 x 36 samples, but the map has 41 x 37",
        ),
        (mask([42, 37], 37, false), "its size: 42 x 37"),
        (b"this is no TIFF".to_vec(), "it is not a TIFF"),
        (Vec::new(), "it is not a TIFF"),
        (coloured(), "3 bands of u8"),
        (wide(), "1 bands of u16"),
    ] {
        folder.write("a.png.MSK", &bytes);
        let error = Elevation::read(&path, &Options::default()).expect_err("it is none");
        let sidecar = matches!(error, ElevationError::Sidecar { .. });
        let text = error.to_string();
        for words in [words, "a.png.MSK", "a.png: ", "move it away"] {
            assert!(
                sidecar && text.contains(words),
                "{text} does not say {words}"
            );
        }
        // What only asks for the head does not read it.
        assert_eq!(head(&path), [41, 37]);
        let all = Options {
            nodata: NoData::None,
            ..Options::default()
        };
        read(&path, &all);
    }
}

fn head(path: &Path) -> [u32; 2] {
    let head = Elevation::head(path, &Options::default());
    head.unwrap_or_else(|error| panic!("{error}")).size
}

/// One of three bands.
fn coloured() -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = TiffEncoder::new(Cursor::new(&mut file)).expect("an empty file");
    encoder
        .write_image::<colortype::RGB8>(41, 37, &[1; 3 * 41 * 37])
        .expect("as many as it has");
    file
}

/// One of numbers of 16 bits.
fn wide() -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = TiffEncoder::new(Cursor::new(&mut file)).expect("an empty file");
    encoder
        .write_image::<colortype::Gray16>(41, 37, &[1; 41 * 37])
        .expect("as many as it has");
    file
}
