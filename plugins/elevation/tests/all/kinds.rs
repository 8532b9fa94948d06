//! Every kind, written by GDAL, tifffile, NumPy and pypng: samples equal to the bit.

use crate::{folder, ground, read, same};
use dolomite_elevation::{
    ByteOrder, Elevation, ElevationError, FileKind, NoData, NumberType, Options, Raw,
};

const SIZE: [u32; 2] = [41, 37];

/// Options that a file needs because it does not say it itself.
pub fn options(name: &str) -> Options {
    let mut options = Options::default();
    if name.ends_with(".raw") || name.ends_with(".r16") {
        let number = match name.split('-').next() {
            Some("u8") => NumberType::U8,
            Some("u16") => NumberType::U16,
            Some("u32") => NumberType::U32,
            Some("f32") => NumberType::F32,
            _ => NumberType::I16,
        };
        options.raw = Some(Raw {
            size: Some(SIZE),
            number: Some(number),
            order: if name.contains("-big") {
                ByteOrder::Big
            } else {
                ByteOrder::Little
            },
            ..Raw::default()
        });
    }
    if name.contains("-padding-flip") {
        options.raw = Some(Raw {
            size: Some(SIZE),
            number: Some(NumberType::F32),
            header: 11,
            row_padding: 12,
            flip: true,
            ..Raw::default()
        });
    }
    if name.contains("-bands-") || name.contains("-colour") {
        options.band = Some(2);
    }
    if name.contains("-untold") {
        options.nodata = NoData::Value(if name.starts_with("hf") {
            f64::NAN
        } else {
            -9999.0
        });
    }
    options
}

/// Every file there is, but those that are refused or whose ground is not whole.
fn names() -> Vec<String> {
    let files = std::fs::read_dir(folder()).expect("the files are there");
    let names = files.map(|file| {
        file.expect("an entry")
            .file_name()
            .to_string_lossy()
            .into_owned()
    });
    let other = ["-rotated", "-sparse", "-scaled"];
    let mut names: Vec<_> = names
        .filter(|name| {
            !name.ends_with(".f32")
                && !name.ends_with(".py")
                && !name.ends_with(".prj")
                && !other.iter().any(|other| name.contains(other))
        })
        .collect();
    names.sort();
    names
}

#[test]
fn samples_are_equal_to_the_bit() {
    let names = names();
    assert!(names.len() >= 57, "{names:?}");
    for name in names {
        let map = read(&name, &options(&name)).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(map.size, SIZE, "{name}");
        let wanted = ground(name.split(['-', '.']).next().expect("a ground"));
        let off = map
            .samples
            .iter()
            .zip(&wanted)
            .position(|(a, b)| a.to_bits() != b.to_bits() && !(a.is_nan() && b.is_nan()));
        assert!(same(&map.samples, &wanted), "{name}: {off:?}");
        let holes = wanted.iter().filter(|s| s.is_nan()).count() as u64;
        assert_eq!(map.about.holes, holes, "{name}");
        let low = wanted.iter().copied().fold(f32::INFINITY, f32::min);
        let high = wanted.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        assert_eq!(map.about.range, Some([low, high]), "{name}");
    }
}

/// Every third column and row, of every kind.
#[test]
fn fewer_samples_are_those_of_the_whole() {
    for name in names() {
        let options = Options {
            every: 3,
            ..options(&name)
        };
        let map = read(&name, &options).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(map.size, [14, 13], "{name}");
        let whole = ground(name.split(['-', '.']).next().expect("a ground"));
        let wanted: Vec<f32> = (0..14 * 13)
            .map(|k| whole[(k / 14) * 3 * 41 + (k % 14) * 3])
            .collect();
        assert!(same(&map.samples, &wanted), "{name}");
    }
}

/// What is absent of a sparse file has no data, whatever lies at the beginning of the file.
#[test]
fn absent_tiles_are_no_data() {
    for pack in ["none", "deflate"] {
        let map = read(&format!("i16-gdal-sparse-{pack}.tif"), &Options::default()).expect("valid");
        let mut wanted = ground("i16");
        wanted[16 * 41..].fill(f32::NAN);
        assert!(same(&map.samples, &wanted), "{pack}");
        assert_eq!(map.about.holes, 21 * 41);
        assert!(
            map.about.notes[0].contains("absent"),
            "{:?}",
            map.about.notes
        );
    }
}

#[test]
fn the_files_own_scale_counts() {
    let map = read("i16-gdal-scaled.tif", &Options::default()).expect("valid");
    let wanted: Vec<f32> = ground("i16").iter().map(|n| n * 0.25 - 100.0).collect();
    assert!(same(&map.samples, &wanted));
    assert_eq!((map.about.scale, map.about.offset), (0.25, -100.0));
    assert_eq!(map.about.unit_metres, Some(0.3048));
}

#[test]
fn kinds_are_told_by_content() {
    for (name, kind) in [
        ("u16-gdal.png", FileKind::Png),
        ("i16-gdal.asc", FileKind::Ascii),
        ("i16-gdal-lzw-p1.tif", FileKind::Tiff),
        ("f32-gdal-bigtiff-big-tiles.tif", FileKind::BigTiff),
    ] {
        let bytes = std::fs::read(folder().join(name)).expect("it is there");
        let map = Elevation::decode("unknown.dat", &bytes, &Options::default()).expect("valid");
        assert_eq!(map.about.kind, kind);
        let error = Elevation::decode("a.tif", &bytes[1..], &Options::default()).expect_err("cut");
        assert!(matches!(error, ElevationError::Kind { .. }), "{error}");
    }
}

#[test]
fn what_is_not_read_says_what_to_do() {
    let refused = |name: &str| {
        let error = read(name, &Options::default()).expect_err("refused");
        (error.to_string(), error)
    };
    for (name, words) in [
        (
            "i16-gdal-rotated.tif",
            &["ModelTransformation", "gdalwarp"][..],
        ),
        (
            "u16-gdal-bands-band.tif",
            &["3 numbers a sample", "--band 1"],
        ),
        ("u16-pypng-colour.png", &["16-bit colour", "--band 1"]),
        (
            "hf-gdal-nan-untold.tif",
            &["column 7, row 5", "--nodata NaN", "107 samples"],
        ),
        (
            "h16-gdal-untold.tif",
            &[
                "-9999",
                "column 7, row 5",
                "107 samples",
                "--nodata -9999",
                "--nodata none",
            ],
        ),
    ] {
        let (text, _) = refused(name);
        for word in words {
            assert!(text.contains(word), "{text} does not say {word}");
        }
        assert!(text.contains(name), "{text}");
    }
    let none = Options {
        nodata: NoData::None,
        ..Options::default()
    };
    let map = read("h16-gdal-untold.tif", &none).expect("they are heights, then");
    assert_eq!(map.about.range.expect("a range")[0], -9999.0);
    let band = Options {
        band: Some(4),
        ..Options::default()
    };
    let error = read("u16-gdal-bands-band.tif", &band).expect_err("there are three");
    assert!(matches!(error, ElevationError::NoBand { bands: 3, .. }));
}

/// SRTM's own files: written here, as they are megabytes.
#[test]
fn hgt_of_both_sizes() {
    for side in [1201_u32, 3601] {
        let number = |k: u32| {
            if k % 7919 == 5 {
                -32_768
            } else {
                ((k * 31) % 3000) as i16 - 200
            }
        };
        let bytes: Vec<u8> = (0..side * side)
            .flat_map(|k| number(k).to_be_bytes())
            .collect();
        let map = Elevation::decode("N36W085.hgt", &bytes, &Options::default()).expect("valid");
        assert_eq!((map.size, map.about.kind), ([side; 2], FileKind::Hgt));
        for (k, sample) in (0..).zip(&map.samples) {
            let wanted = number(k);
            let right = if wanted == -32_768 {
                sample.is_nan()
            } else {
                *sample == f32::from(wanted)
            };
            assert!(right, "{k}: {sample}");
        }
        let place = map.georeference.as_ref().expect("its name tells");
        // The first sample stands on the degree.
        assert_eq!(place.first, [-85.0, 37.0]);
        assert_eq!(place.step, [1.0 / f64::from(side - 1); 2]);
        let error = Elevation::decode("N36W085.hgt", &bytes[2..], &Options::default());
        assert!(error.expect_err("cut").to_string().contains("its length"));
        let error = Elevation::decode("tile.hgt", &bytes, &Options::default()).expect("valid");
        assert!(error.georeference.is_none() && error.about.notes[0].contains("N36W085.hgt"));
    }
}

#[test]
fn ascii_as_people_write_it() {
    let numbers = [1.5, -2.0, 300.0, 4e2, 5.0, 6.0];
    let (x, y) = (1000.0, 2000.0);
    for text in [
        "ncols 3\nnrows 2\nxllcorner 995\nyllcorner 1995\ncellsize 10\n1.5 -2 300\n4e2 5 6\n",
        // Any order and case, centre, rows that wrap anywhere, no blank at the end.
        "CELLSIZE 10\r\nXLLCENTER 1000\r\nNROWS 2\r\nYllCenter 2000\r\nNCols 3\r\n1.5\r\n-2 300 4e2\r\n5\r\n\r\n6",
        "\u{feff}NODATA_value -1\nncols 3\nnrows 2\nyllcorner 1995 xllcenter 1000 dx 10 dy 10\n+1.5 -2.0 300 4E2 5 6\n",
        "ncols 3.0\nnrows 2\nxllcorner 995,0\nyllcorner 1995\ncellsize 10,0\n1,5 -2 300 4e2 5 6",
    ] {
        let map = Elevation::decode("a.asc", text.as_bytes(), &Options::default());
        let map = map.unwrap_or_else(|error| panic!("{error}: {text}"));
        assert_eq!(map.samples, numbers, "{text}");
        let place = map.georeference.expect("it says where");
        assert_eq!(
            (place.first, place.step),
            ([x, y + 10.0], [10.0, 10.0]),
            "{text}"
        );
    }
    for (text, words) in [
        ("ncols 3\nnrows 2\n1 2 3 4 5", "column 2, row 1"),
        ("ncols 3\nnrows 2\n1 2 3 4 5 6 7", "more numbers"),
        (
            "ncols 3\nnrows 2\n1 2 3 four 5 6",
            "column 0, row 1: \"four\"",
        ),
        ("ncols 3\n1 2 3", "nrows"),
        ("ncols x\nnrows 2\n1", "key ncols"),
        ("ncols 3\nnrows -2\n1", "key nrows"),
        ("ncols 3\nnrows 2\ncellsize 0\n1", "key cellsize"),
        ("ncols 16000\nnrows 16000\n1 2 3", "cannot be in"),
        ("ncols 1000000000\nnrows 1000000000\n1 2 3", "--every"),
        ("ncols 0\nnrows 2\n", "at least one"),
    ] {
        let error = Elevation::decode("a.asc", text.as_bytes(), &Options::default());
        let error = error.expect_err("refused").to_string();
        assert!(
            error.contains(words) && error.contains("a.asc"),
            "{error} does not say {words}"
        );
    }
}

#[test]
fn raw_files_say_what_is_missing() {
    let refused = |raw: Raw, bytes: usize| {
        let options = Options {
            raw: Some(raw),
            ..Options::default()
        };
        let made = Elevation::decode("m.raw", &vec![0; bytes], &options);
        made.expect_err("refused").to_string()
    };
    let error = refused(Raw::default(), 2 * 513 * 513);
    assert!(
        error.contains("`dolomite heights m.raw --raw-size 513x513`"),
        "{error}"
    );
    assert!(!refused(Raw::default(), 2 * 513 * 512).contains("perhaps"));
    let sized = |size| Raw {
        size: Some(size),
        ..Raw::default()
    };
    assert!(refused(sized([3, 2]), 13).contains("12 bytes, but the file has 13"));
    assert!(refused(sized([0, 2]), 0).contains("at least one"));
    let huge = refused(sized([1_000_000_000; 2]), 10);
    assert!(
        huge.contains("--every") && huge.contains("1000000000 x 1000000000"),
        "{huge}"
    );
    let header = Raw {
        header: u64::MAX,
        row_padding: u64::MAX,
        ..sized([3, 2])
    };
    assert!(refused(header, 12).contains("--raw-header"));
    let unknown = Elevation::decode("m.dat", &[7; 18], &Options::default());
    let unknown = unknown.expect_err("refused").to_string();
    assert!(
        unknown.contains("--raw-size 3x3 --raw-type i16"),
        "{unknown}"
    );
    // Both byte orders of the same hills: the wrong one is noticed.
    let swapped = Options {
        raw: Some(Raw {
            size: Some(SIZE),
            number: Some(NumberType::U16),
            ..Raw::default()
        }),
        ..Options::default()
    };
    let map = read("u16-numpy-big.raw", &swapped).expect("any bytes are numbers");
    assert!(
        map.about.notes[0].contains("--raw-order big"),
        "{:?}",
        map.about.notes
    );
    let right = read("u16-numpy-big.raw", &self::options("u16-numpy-big.raw")).expect("valid");
    assert!(right.about.notes.is_empty(), "{:?}", right.about.notes);
}

/// Large enough that several threads read it, with and without gaps.
#[test]
fn threads_read_what_one_reads() {
    let side = 1500_u32;
    let mut bytes = vec![9; 5];
    for k in 0..side * side {
        bytes.extend((k.wrapping_mul(2_654_435_761) >> 8).to_be_bytes());
    }
    let path = std::env::temp_dir().join(format!("dolomite-threads-{}.raw", std::process::id()));
    std::fs::write(&path, &bytes).expect("written");
    for (flip, every) in [(false, 1), (true, 1), (false, 3), (true, 4)] {
        let options = Options {
            raw: Some(Raw {
                size: Some([side; 2]),
                number: Some(NumberType::U32),
                order: ByteOrder::Big,
                header: 5,
                flip,
                ..Raw::default()
            }),
            every,
            ..Options::default()
        };
        let map = Elevation::read(&path, &options).expect("valid");
        let kept = side.div_ceil(every);
        assert_eq!(map.size, [kept; 2]);
        for (k, sample) in (0..).zip(&map.samples) {
            let (row, column) = (k / kept * every, k % kept * every);
            let row = if flip { side - 1 - row } else { row };
            let wanted = ((row * side + column).wrapping_mul(2_654_435_761) >> 8) as f32;
            assert!(*sample == wanted, "{flip} {every} {k}: {sample} {wanted}");
        }
    }
    std::fs::remove_file(&path).expect("removed");
}
