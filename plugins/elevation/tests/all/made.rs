//! Files made here, byte by byte: what other software writes now and then, and what most of it does not.

use crate::{ground, read, same};
use dolomite_elevation::{
    ByteOrder, Elevation, ElevationError, ElevationProgress, NoData, NumberType, Options, Raw,
    convert,
};

/// Values of a tag.
#[derive(Clone)]
enum Field {
    Short(Vec<u16>),
    Long(Vec<u32>),
    Text(&'static str),
}
use Field::{Long, Short, Text};

/// A picture: columns, rows, bits a sample, tags besides, and its strips.
struct Picture {
    size: [u32; 2],
    bits: u16,
    tags: Vec<(u16, Field)>,
    strips: Vec<Vec<u8>>,
}

const FORMAT: u16 = 339;
const PLANAR: u16 = 284;
const BANDS: u16 = 277;
const EXTRA: u16 = 338;
const PHOTOMETRIC: u16 = 262;
const ROWS: u16 = 278;
const NODATA: u16 = 42_113;
const XML: u16 = 42_112;

fn picture(size: [u32; 2], bits: u16, tags: &[(u16, Field)], strip: Vec<u8>) -> Picture {
    Picture {
        size,
        bits,
        tags: tags.to_vec(),
        strips: vec![strip],
    }
}

/// A TIFF with the least bytes first.
fn tiff(pictures: &[Picture]) -> Vec<u8> {
    let mut file = b"II\x2a\0\0\0\0\0".to_vec();
    // Where the place of the next directory is to be written.
    let mut link = 4;
    for picture in pictures {
        let mut offsets = Vec::new();
        for strip in &picture.strips {
            offsets.push(file.len() as u32);
            file.extend(strip);
        }
        let counts = picture.strips.iter().map(|strip| strip.len() as u32);
        let mut tags = vec![
            (256, Long(vec![picture.size[0]])),
            (257, Long(vec![picture.size[1]])),
            (258, Short(vec![picture.bits])),
        ];
        if !picture.strips.is_empty() {
            tags.push((273, Long(offsets)));
            tags.push((279, Long(counts.collect())));
        }
        if !picture.tags.iter().any(|(tag, _)| *tag == PHOTOMETRIC) {
            tags.push((PHOTOMETRIC, Short(vec![1])));
        }
        tags.extend(picture.tags.iter().cloned());
        tags.sort_by_key(|(tag, _)| *tag);
        let mut directory = (tags.len() as u16).to_le_bytes().to_vec();
        for (tag, field) in &tags {
            let (kind, count, mut bytes) = match field {
                Short(v) => (
                    3_u16,
                    v.len(),
                    v.iter().flat_map(|n| n.to_le_bytes()).collect(),
                ),
                Long(v) => (4, v.len(), v.iter().flat_map(|n| n.to_le_bytes()).collect()),
                Text(text) => (2, text.len() + 1, [text.as_bytes(), &[0]].concat()),
            };
            if bytes.len() > 4 {
                let place = file.len() as u32;
                file.extend(&bytes);
                bytes = place.to_le_bytes().to_vec();
            }
            bytes.resize(4, 0);
            directory.extend(tag.to_le_bytes());
            directory.extend(kind.to_le_bytes());
            directory.extend((count as u32).to_le_bytes());
            directory.extend(bytes);
        }
        let place = (file.len() as u32).to_le_bytes();
        file[link..link + 4].copy_from_slice(&place);
        file.extend(directory);
        link = file.len();
        file.extend([0; 4]);
    }
    file
}

fn decode(bytes: &[u8]) -> Elevation {
    decode_with(bytes, &Options::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn decode_with(bytes: &[u8], options: &Options) -> Result<Elevation, ElevationError> {
    Elevation::decode("made.tif", bytes, options)
}

fn all_heights() -> Options {
    Options {
        nodata: NoData::None,
        ..Options::default()
    }
}

/// Numbers of so many bits, the highest first, rows to whole bytes.
fn packed(numbers: &[u32], columns: usize, bits: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    for row in numbers.chunks(columns) {
        let mut all = Vec::new();
        for number in row {
            all.extend((0..bits).rev().map(|bit| number >> bit & 1 == 1));
        }
        let byte = |bits: &[bool]| {
            let places = bits.iter().enumerate();
            places.fold(0, |byte, (k, &bit)| byte | u8::from(bit) << (7 - k))
        };
        bytes.extend(all.chunks(8).map(byte));
    }
    bytes
}

#[test]
fn numbers_of_any_bits() {
    for bits in [1, 2, 3, 4, 7, 9, 12, 15, 20, 24, 31] {
        let numbers: Vec<u32> = (0..35_u32)
            .map(|k| k.wrapping_mul(2_654_435_761) >> (32 - bits))
            .collect();
        let strip = packed(&numbers, 7, bits);
        let file = tiff(&[picture([7, 5], bits as u16, &[], strip)]);
        let map = decode_with(&file, &all_heights()).unwrap_or_else(|error| panic!("{error}"));
        let wanted: Vec<f32> = numbers.iter().map(|&n| n as f32).collect();
        assert_eq!(map.samples, wanted, "{bits}");
    }
}

#[test]
fn colours_change_no_number() {
    let bytes: Vec<u8> = (0..12).map(|k| k * 20).collect();
    let wanted: Vec<f32> = bytes.iter().map(|&b| f32::from(b)).collect();
    for (photometric, more) in [(0, None), (1, None), (3, Some((320, Short(vec![9; 768]))))] {
        let mut tags = vec![(PHOTOMETRIC, Short(vec![photometric]))];
        tags.extend(more);
        let file = tiff(&[picture([4, 3], 8, &tags, bytes.clone())]);
        assert_eq!(decode(&file).samples, wanted, "{photometric}");
    }
    let floats = [1.5_f32, -2.0, 0.1, 3e4];
    let strip = floats.iter().flat_map(|n| n.to_le_bytes()).collect();
    let tags = [(PHOTOMETRIC, Short(vec![0])), (FORMAT, Short(vec![3]))];
    let file = tiff(&[picture([2, 2], 32, &tags, strip)]);
    assert_eq!(decode(&file).samples, floats);
}

#[test]
fn bits_that_begin_with_the_lowest() {
    let numbers = [1_u8, 2, 128, 200, 77, 0];
    let strip = numbers.iter().map(|n| n.reverse_bits()).collect();
    let file = tiff(&[picture([3, 2], 8, &[(266, Short(vec![2]))], strip)]);
    assert_eq!(decode(&file).samples, numbers.map(f32::from));
}

#[test]
fn a_band_of_alpha_tells_where_there_is_no_data() {
    let heights = [10_u8, 20, 30, 40];
    let alpha = [255_u8, 0, 1, 255];
    let tags = |planar: u16| {
        let tags = [
            (BANDS, Short(vec![2])),
            (EXTRA, Short(vec![2])),
            (PLANAR, Short(vec![planar])),
            (ROWS, Long(vec![2])),
        ];
        tags.to_vec()
    };
    let together = heights
        .iter()
        .zip(alpha)
        .flat_map(|(h, a)| [*h, a])
        .collect();
    let apart = Picture {
        strips: vec![heights.to_vec(), alpha.to_vec()],
        ..picture([2, 2], 8, &tags(2), Vec::new())
    };
    let wanted = [10.0, f32::NAN, 30.0, 40.0];
    for file in [
        tiff(&[picture([2, 2], 8, &tags(1), together)]),
        tiff(&[apart]),
    ] {
        let map = decode(&file);
        assert!(same(&map.samples, &wanted), "{:?}", map.samples);
        assert_eq!(map.about.holes, 1);
        let every = decode_with(&file, &all_heights()).expect("heights");
        assert_eq!(every.samples, heights.map(f32::from));
        // Who asks for it gets it.
        let second = Options {
            band: Some(2),
            ..Options::default()
        };
        let second = decode_with(&file, &second).expect("there are two");
        assert_eq!(second.samples, alpha.map(f32::from));
    }
}

/// A mask of 1 bit in strips of its own, behind an overview with another.
#[test]
fn a_mask_is_read_whatever_its_strips() {
    let columns = 11;
    let heights: Vec<u8> = (0..66).map(|k| 50 + k).collect();
    let there: Vec<u32> = (0..66).map(|k| u32::from(k % 7 != 2)).collect();
    let one = |purpose: u32, rows: u32| {
        let tags = [
            (254, Long(vec![purpose])),
            (PHOTOMETRIC, Short(vec![4])),
            (ROWS, Long(vec![rows])),
        ];
        tags.to_vec()
    };
    let bytes = packed(&there, columns, 1);
    let strips = |rows: usize| bytes.chunks(2 * rows).map(<[u8]>::to_vec).collect();
    let wanted: Vec<f32> = (0..66)
        .map(|k| {
            if there[k] == 1 {
                f32::from(heights[k])
            } else {
                f32::NAN
            }
        })
        .collect();
    for (own, of_mask) in [(1, 6), (6, 1), (2, 4), (4, 3)] {
        let map = Picture {
            strips: heights.chunks(columns * own).map(<[u8]>::to_vec).collect(),
            ..picture([11, 6], 8, &[(ROWS, Long(vec![own as u32]))], Vec::new())
        };
        let mask = Picture {
            strips: strips(of_mask),
            ..picture([11, 6], 1, &one(4, of_mask as u32), Vec::new())
        };
        let overview = picture([6, 3], 8, &[(254, Long(vec![1]))], vec![0; 18]);
        let other = picture([6, 3], 1, &one(4, 3), vec![0; 3]);
        let file = tiff(&[map, overview, other, mask]);
        let read = decode(&file);
        assert!(same(&read.samples, &wanted), "{own} {of_mask}");
        assert_eq!(
            read.about.holes as usize,
            there.iter().filter(|&&t| t == 0).count()
        );
        assert!(read.about.notes.iter().any(|note| note.contains("mask")));
        for cut in 0..file.len() {
            // The mask's directory is the last: without it nobody knows which samples count.
            let error = decode_with(&file[..cut], &Options::default()).expect_err("cut off");
            assert!(error.to_string().contains("made.tif"), "{error}");
        }
    }
}

/// What GDAL and others write for no data.
#[test]
fn no_data_in_all_its_spellings() {
    let floats = |hole: f32| [100.0, hole, 250.5, 99.0_f32];
    let file = |hole: f32, text: &'static str| {
        let strip = floats(hole).iter().flat_map(|n| n.to_le_bytes()).collect();
        let tags = [(FORMAT, Short(vec![3])), (NODATA, Text(text))];
        tiff(&[picture([2, 2], 32, &tags, strip)])
    };
    for (hole, text) in [
        (-9999.0, "-9999"),
        (-9999.0, " -9999.000 "),
        (-9999.0, "-9.999e+03\n"),
        (-9999.0, "-9999,0"),
        (-9999.0, "-9999 "),
        (-9999.9, "-9999.9"),
        (-9999.9, "-9999.900390625"),
        (f32::NAN, "nan"),
        (f32::NAN, "-nan"),
        (f32::NAN, "-1.#QNAN"),
        (f32::NAN, "1.#IND"),
        (f32::MIN, "-3.4028234663852886e+38"),
        (f32::MIN, "-3.40282e+38"),
        (f32::MAX, "3.402823e+038"),
        (f32::NEG_INFINITY, "-inf"),
        (f32::INFINITY, "1.#INF"),
        (1e20, "1e+20"),
    ] {
        let map = decode(&file(hole, text));
        let wanted = floats(f32::NAN);
        assert!(same(&map.samples, &wanted), "{text}: {:?}", map.samples);
        assert_eq!(map.about.range, Some([99.0, 250.5]), "{text}");
    }
    let told = file(-9999.0, "no data");
    let error = decode_with(&told, &Options::default()).expect_err("no number");
    let text = error.to_string();
    for words in [
        "made.tif",
        "GDAL_NODATA",
        "\"no data\"",
        "--nodata none`",
        "--nodata -9999`",
    ] {
        assert!(text.contains(words), "{text} does not say {words}");
    }
    for nodata in [NoData::Value(-9999.0), NoData::None] {
        let options = Options {
            nodata,
            ..Options::default()
        };
        let map = decode_with(&told, &options).expect("a setting says it");
        assert_eq!(map.samples[1].is_nan(), nodata != NoData::None);
    }
}

/// Numbers that f32 does not hold: compared and scaled before they are rounded.
#[test]
fn numbers_are_rounded_once_and_last() {
    let words = [u32::MAX, u32::MAX - 1, 3_000_000_017, 5];
    let strip: Vec<u8> = words.iter().flat_map(|n| n.to_le_bytes()).collect();
    let xml = "<GDALMetadata><Item name=\"SCALE\" sample=\"0\" role=\"scale\">0.001</Item>\
               <Item name=\"OFFSET\" sample=\"0\" role=\"offset\">-2999000</Item></GDALMetadata>";
    let scaled = |n: u32| (f64::from(n) * 0.001 - 2_999_000.0) as f32;
    let plain = tiff(&[picture(
        [2, 2],
        32,
        &[(NODATA, Text("4294967295"))],
        strip.clone(),
    )]);
    let map = decode(&plain);
    let wanted = [
        f32::NAN,
        (u32::MAX - 1) as f32,
        3_000_000_017_u32 as f32,
        5.0,
    ];
    assert!(same(&map.samples, &wanted), "{:?}", map.samples);
    assert_eq!(map.about.holes, 1);
    let tags = [(NODATA, Text("4294967295")), (XML, Text(xml))];
    let map = decode(&tiff(&[picture([2, 2], 32, &tags, strip)]));
    let wanted = [f32::NAN, scaled(words[1]), scaled(words[2]), scaled(5)];
    assert!(same(&map.samples, &wanted), "{:?} {wanted:?}", map.samples);
    assert_eq!(map.about.range, Some([scaled(5), scaled(words[1])]));
    let doubles = [-9999.0, -9_998.999_999_999, -9000.0, 0.1_f64];
    let strip: Vec<u8> = doubles.iter().flat_map(|n| n.to_le_bytes()).collect();
    let tags = [(FORMAT, Short(vec![3])), (NODATA, Text("-9999"))];
    let file = tiff(&[picture([2, 2], 64, &tags, strip)]);
    let map = decode(&file);
    let wanted = [f32::NAN, -9999.0, -9000.0, 0.1];
    assert!(same(&map.samples, &wanted), "{:?}", map.samples);
    // The same row by row.
    let folder = std::env::temp_dir().join(format!("dolomite-once-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let [from, to] = ["a.tif", "a.f32"].map(|name| folder.join(name));
    std::fs::write(&from, &file).expect("room");
    let quiet = ElevationProgress::default();
    let about = convert(&from, Some(&to), &Options::default(), None, &quiet).expect("valid");
    assert_eq!(
        (about.holes, about.range),
        (map.about.holes, map.about.range)
    );
    let written = std::fs::read(&to).expect("written");
    let (quads, _) = written.as_chunks::<4>();
    let samples: Vec<f32> = quads.iter().map(|b| f32::from_le_bytes(*b)).collect();
    assert!(same(&samples, &wanted));
    std::fs::remove_dir_all(&folder).expect("it is ours");
    let bytes: Vec<u8> = words.iter().flat_map(|n| n.to_be_bytes()).collect();
    let raw = Raw {
        size: Some([2, 2]),
        number: Some(NumberType::U32),
        order: ByteOrder::Big,
        ..Raw::default()
    };
    let options = Options {
        raw: Some(raw),
        nodata: NoData::Value(f64::from(u32::MAX)),
        ..Options::default()
    };
    let map = Elevation::decode("a.raw", &bytes, &options).expect("valid");
    let wanted = [
        f32::NAN,
        (u32::MAX - 1) as f32,
        3_000_000_017_u32 as f32,
        5.0,
    ];
    assert!(same(&map.samples, &wanted), "{:?}", map.samples);
    // Infinity, where a number is beyond f32: named once, either sign.
    let strip = [1e300, -1e300, 7.0, f64::INFINITY]
        .iter()
        .flat_map(|n: &f64| n.to_le_bytes());
    let tags = [(FORMAT, Short(vec![3]))];
    let file = tiff(&[picture([2, 2], 64, &tags, strip.collect())]);
    let error = decode_with(&file, &Options::default()).expect_err("not finite");
    assert!(error.to_string().contains("--nodata inf`"), "{error}");
    let options = Options {
        nodata: NoData::Value(f64::INFINITY),
        ..Options::default()
    };
    let map = decode_with(&file, &options).expect("the advice works");
    assert!(same(&map.samples, &[f32::NAN, f32::NAN, 7.0, f32::NAN]));
}

#[test]
fn zstd_is_read() {
    let map = read("i16-gdal-zstd.tif", &Options::default()).expect("valid");
    assert!(same(&map.samples, &ground("i16")));
    let bytes = std::fs::read(crate::folder().join("i16-gdal-zstd.tif")).expect("it is there");
    for cut in 0..bytes.len() {
        let _ = decode_with(&bytes[..cut], &Options::default());
    }
    for at in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[at] ^= 0x55;
        let _ = decode_with(&changed, &Options::default());
    }
}

/// A tile a hundred thousand times as large as the map, packed well.
#[test]
fn a_tile_far_larger_than_the_map_is_refused() {
    let tags = [
        (322, Long(vec![1 << 20])),
        (323, Long(vec![1 << 20])),
        (324, Long(vec![8])),
        (325, Long(vec![1 << 18])),
        (259, Short(vec![8])),
    ];
    let mut file = tiff(&[Picture {
        strips: Vec::new(),
        ..picture([3, 3], 8, &tags, Vec::new())
    }]);
    file.resize(1 << 19, 0);
    let error = decode_with(&file, &Options::default()).expect_err("refused");
    assert!(error.to_string().contains("far more"), "{error}");
}

fn png(kind: png::ColorType, clear: &[u8], palette: &[u8], data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
    encoder.set_color(kind);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_trns(clear.to_vec());
    if !palette.is_empty() {
        encoder.set_palette(palette.to_vec());
    }
    let mut writer = encoder.write_header().expect("a valid header");
    writer.write_image_data(data).expect("four pixels");
    writer.finish().expect("an end");
    bytes
}

#[test]
fn colours_of_a_png_that_stand_for_no_data() {
    let second = |nodata| Options {
        band: Some(2),
        nodata,
        ..Options::default()
    };
    let pixels = [1, 2, 3, 9, 20, 9, 7, 40, 7, 1, 2, 4];
    let colour = png(png::ColorType::Rgb, &[0, 9, 0, 20, 0, 9], &[], &pixels);
    let palette = [5, 11, 5, 6, 22, 6, 7, 33, 7];
    let indexed = png(png::ColorType::Indexed, &[255, 0], &palette, &[0, 1, 2, 0]);
    for (bytes, heights) in [
        (colour, [2.0, 20.0, 40.0, 2.0]),
        (indexed, [11.0, 22.0, 33.0, 11.0]),
    ] {
        let map = Elevation::decode("a.png", &bytes, &second(NoData::File)).expect("valid");
        let mut wanted = heights;
        wanted[1] = f32::NAN;
        assert!(same(&map.samples, &wanted), "{:?}", map.samples);
        let map = Elevation::decode("a.png", &bytes, &second(NoData::None)).expect("valid");
        assert_eq!(map.samples, heights);
    }
}

#[test]
fn ascii_that_ends_and_places_itself_as_others_write_it() {
    // The mark of DOS for the end of a text, zeros, and what is no number by Microsoft's C.
    let text = "ncols 3\nnrows 1\nnodata_value -1.#QNAN\n1 -1.#QNAN 1.5D+02\x1a\0";
    let map = Elevation::decode("a.asc", text.as_bytes(), &Options::default()).expect("valid");
    assert!(same(&map.samples, &[1.0, f32::NAN, 150.0]));
    for wrong in ["++1", "+-1", "1m"] {
        let text = format!("ncols 2\nnrows 1\n3 {wrong}");
        let error = Elevation::decode("a.asc", text.as_bytes(), &Options::default());
        let error = error.expect_err("no number").to_string();
        assert!(
            error.contains("column 1, row 0") && error.contains(wrong),
            "{error}"
        );
    }
    let folder = std::env::temp_dir().join(format!("dolomite-prj-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join("a.asc");
    let text = "ncols 2\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 10\n1 2 3 4\n";
    std::fs::write(&file, text).expect("room");
    let foot = 1200.0 / 3937.0;
    let plane = "PROJCS[\"N.Y. (east)\",GEOGCS[\"NAD83\",UNIT[\"degree\",0.017]],UNIT[\"US survey foot\",0.304800609601219]]";
    for (prj, wanted) in [
        (plane.to_owned(), Some(foot)),
        // Heights in metres over a plane in feet.
        (
            format!("COMPD_CS[\"both\",{plane},VERT_CS[\"NAVD88\",UNIT[\"metre\",1]]]"),
            Some(foot),
        ),
        (
            "COMPOUNDCRS[\"both\",PROJCRS[\"UTM\",BASEGEOGCRS[\"WGS 84\",ANGLEUNIT[\"degree\",0.017]],CS[Cartesian,2],LENGTHUNIT[\"metre\",1]],VERTCRS[\"v\",LENGTHUNIT[\"foot\",0.3048]]]".to_owned(),
            Some(1.0),
        ),
        (
            "PROJCS [\"spaces\", GEOGCS [\"x\", UNIT [\"degree\", 0.017]], UNIT [\"kilometre\", 1000.0 ]]".to_owned(),
            Some(1000.0),
        ),
        ("GEODCRS[\"WGS 84\",ANGLEUNIT[\"degree\",0.017]]".to_owned(), None),
        ("Projection GEOGRAPHIC\nUnits DD\n".to_owned(), None),
    ] {
        std::fs::write(folder.join("a.prj"), &prj).expect("room");
        let map = Elevation::read(&file, &Options::default()).unwrap_or_else(|e| panic!("{e}"));
        let spacing = map.spacing().expect("it has a unit")[0];
        match wanted {
            Some(unit) => assert!((spacing / (10.0 * unit) - 1.0).abs() < 1e-9, "{prj}: {spacing}"),
            None => assert!(spacing > 1e5, "{prj}: {spacing}"),
        }
    }
    for prj in ["Projection GEOGRAPHIC\nUnits DS\n", "LOCAL_CS[\"x\"]"] {
        std::fs::write(folder.join("a.prj"), prj).expect("room");
        let error = Elevation::read(&file, &Options::default()).expect_err("not known");
        assert!(
            matches!(error, ElevationError::Projection { .. }),
            "{error}"
        );
    }
    std::fs::remove_dir_all(&folder).expect("it is ours");
}

/// Both infinities in a raw file, and the advice for them.
#[test]
fn infinities_are_named_together() {
    let numbers = [1.0_f32, f32::INFINITY, f32::NEG_INFINITY, 4.0];
    let bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
    let raw = Raw {
        size: Some([2, 2]),
        ..Raw::default()
    };
    let with = |nodata| Options {
        raw: Some(raw),
        nodata,
        ..Options::default()
    };
    let error = Elevation::decode("a.f32", &bytes, &with(NoData::File)).expect_err("not finite");
    assert!(error.to_string().contains("--nodata inf`"), "{error}");
    for value in [f64::INFINITY, f64::NEG_INFINITY] {
        let map = Elevation::decode("a.f32", &bytes, &with(NoData::Value(value))).expect("valid");
        assert!(same(&map.samples, &[1.0, f32::NAN, f32::NAN, 4.0]));
    }
}
