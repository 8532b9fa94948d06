//! Height maps from files: what is read, and what is refused with which words.

use bevy::math::DVec2;
use dolomite_terrain::elevation::{ElevationError, NoData};
use dolomite_terrain::{
    Filter, Ground, GroundRect, HeightMap, HeightMapError, HeightMapFile, Holes, Layer, MapFormat,
    RawFormat, Source, Terrain, TerrainData, metres_per_degree,
};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use noise::{NoiseFn, Perlin};
use std::path::Path;

fn raw(format: RawFormat, width: u32, height: u32) -> HeightMapFile {
    HeightMapFile {
        path: "map.raw".into(),
        format: MapFormat::raw(format, width, height),
        scale: 2.0,
        offset: -10.0,
        spacing: Some([5.0, 4.0]),
        centre: [100.0, -50.0],
        filter: Filter::Bilinear,
        ..HeightMapFile::default()
    }
}

fn png(bytes: &[u8], width: u32, height: u32, kind: ExtendedColorType) -> Vec<u8> {
    let mut out = Vec::new();
    PngEncoder::new(&mut out)
        .write_image(bytes, width, height, kind)
        .expect("encodes");
    out
}

fn png_file() -> HeightMapFile {
    HeightMapFile {
        format: MapFormat::Png,
        path: "map.png".into(),
        ..raw(RawFormat::U16, 0, 0)
    }
}

#[test]
fn every_format_gives_the_same_map() {
    let numbers: [u16; 6] = [0, 1, 2, 300, 400, 60_000];
    let little: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
    let native: Vec<u8> = numbers.iter().flat_map(|n| n.to_ne_bytes()).collect();
    let floats: Vec<u8> = numbers
        .iter()
        .flat_map(|n| f32::from(*n).to_le_bytes())
        .collect();
    let signed: Vec<u8> = [0_i16, 1, 2, 300, 400, -1]
        .iter()
        .flat_map(|n| n.to_le_bytes())
        .collect();
    let from_png = png_file()
        .decode("a", &png(&native, 3, 2, ExtendedColorType::L16))
        .expect("valid");
    let from_u16 = raw(RawFormat::U16, 3, 2)
        .decode("b", &little)
        .expect("valid");
    let from_f32 = raw(RawFormat::F32, 3, 2)
        .decode("c", &floats)
        .expect("valid");
    let from_i16 = raw(RawFormat::I16, 3, 2)
        .decode("d", &signed)
        .expect("valid");
    let expected = [-10.0, -8.0, -6.0, 590.0, 790.0, 119_990.0];
    for map in [&from_png, &from_u16, &from_f32] {
        assert_eq!(map.samples(), expected);
        assert_eq!((map.width(), map.height()), (3, 2));
        // Centred on (100, -50): 2 × 5 m and 1 × 4 m across.
        assert_eq!(
            map.rect(),
            GroundRect::new(DVec2::new(95.0, -52.0), DVec2::new(105.0, -48.0))
        );
    }
    assert_eq!(from_i16.samples()[5], -12.0);
}

/// The error's words must say the file and what is wrong.
fn assert_says(result: Result<HeightMap, HeightMapError>, words: &[&str]) {
    let text = result.map(|_| ()).expect_err("refused").to_string();
    for word in words {
        assert!(text.contains(word), "{text:?} does not say {word:?}");
    }
}

#[test]
fn bad_files_are_refused_with_reasons() {
    let missing = png_file().load(Path::new("/nowhere"));
    assert!(matches!(
        missing,
        Err(HeightMapError::File(ElevationError::Read { .. }))
    ));
    assert_says(missing, &["/nowhere/map.png", "cannot be read"]);

    let whole = png(&[0; 32 * 32 * 2], 32, 32, ExtendedColorType::L16);
    for cut in [8, 20, whole.len() / 2, whole.len() - 13] {
        let truncated = png_file().decode("cut.png", &whole[..cut]);
        assert_says(truncated, &["cut.png", "not a complete PNG"]);
    }
    for not_one in [&whole[..0], &whole[..7], b"not a picture at all"] {
        assert_says(png_file().decode("x.png", not_one), &["x.png", "PNG"]);
    }

    for (kind, bytes, name) in [
        (ExtendedColorType::Rgb8, 3, "8-bit colour"),
        (ExtendedColorType::Rgba8, 4, "8-bit colour with alpha"),
        (ExtendedColorType::Rgb16, 6, "16-bit colour"),
    ] {
        let picture = png(&vec![1; 4 * bytes], 2, 2, kind);
        assert_says(
            png_file().decode("deep.png", &picture),
            &["deep.png", name, "`dolomite heights deep.png --band 1`"],
        );
        let band = HeightMapFile {
            band: 1,
            ..png_file()
        };
        assert!(band.decode("deep.png", &picture).is_ok());
    }
    // Eight bits are few, but heights.
    let grey = png(&[0, 1, 2, 255], 2, 2, ExtendedColorType::L8);
    let map = png_file().decode("grey.png", &grey).expect("valid");
    assert_eq!(map.samples(), [-10.0, -8.0, -6.0, 500.0]);

    for (length, found) in [(0, "0"), (11, "11"), (13, "13")] {
        let result = raw(RawFormat::U16, 3, 2).decode("short.raw", &vec![0; length]);
        assert_says(result, &["short.raw", "12 bytes", found, "check width"]);
    }

    let nothing: Vec<u8> = [f32::NAN; 6].iter().flat_map(|n| n.to_le_bytes()).collect();
    let file = HeightMapFile {
        nodata: NoData::Value(f64::NAN),
        ..raw(RawFormat::F32, 3, 2)
    };
    let error = file.decode("void.raw", &nothing);
    assert!(matches!(error, Err(HeightMapError::AllHoles { .. })));
    let file = HeightMapFile {
        spacing: None,
        ..raw(RawFormat::U16, 3, 2)
    };
    assert_says(
        file.decode("where.raw", &[0; 12]),
        &["where.raw", "--spacing 30"],
    );

    let mut gap: Vec<u8> = [0.0_f32; 6].iter().flat_map(|n| n.to_le_bytes()).collect();
    for hole in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        gap[16..20].copy_from_slice(&hole.to_le_bytes());
        let result = raw(RawFormat::F32, 3, 2).decode("gap.raw", &gap);
        assert_says(
            result,
            &["gap.raw", "column 1, row 1", "finite", "--nodata"],
        );
        // Named as no data it is filled from around: 0, scaled.
        let named = HeightMapFile {
            nodata: NoData::Value(hole.into()),
            ..raw(RawFormat::F32, 3, 2)
        };
        assert_eq!(
            named.decode("gap.raw", &gap).expect("filled").samples(),
            [-10.0; 6]
        );
        let sea = HeightMapFile {
            holes: Holes::Sea(3.0),
            ..named
        };
        assert_eq!(
            sea.decode("gap.raw", &gap).expect("under water").samples()[4],
            -7.0
        );
    }
    gap[16..20].copy_from_slice(&1e7_f32.to_le_bytes());
    let result = raw(RawFormat::F32, 3, 2).decode("gap.raw", &gap);
    assert_says(result, &["gap.raw", "column 1, row 1", "1e6"]);
}

#[test]
fn impossible_sizes_are_refused_before_anything_is_read() {
    for (width, height) in [(0, 5), (5, 0)] {
        let result = raw(RawFormat::U16, width, height).decode("none.raw", &[]);
        assert_says(result, &["none.raw", "at least one row"]);
    }
    for (width, height) in [
        (u32::MAX, u32::MAX),
        (1_000_000_000, 1_000_000_000),
        (16_385, 16_386),
    ] {
        let result = raw(RawFormat::F32, width, height).decode("big.raw", &[]);
        assert_says(result, &["big.raw", "268468225", "--every"]);
    }
    let long = HeightMap::new(
        65_538,
        1,
        vec![0.0; 65_538],
        DVec2::ZERO,
        DVec2::ONE,
        Filter::Bilinear,
    );
    assert!(matches!(long, Err(HeightMapError::TooLarge { .. })));
    // A PNG whose header promises a size that it does not have.
    let mut huge = png(&[0; 2], 1, 1, ExtendedColorType::L16);
    huge[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
    assert!(png_file().decode("huge.png", &huge).is_err());
}

#[test]
fn unusable_placements_are_refused() {
    let bytes = [0; 12];
    for spacing in [
        [0.0, 1.0],
        [1.0, -1.0],
        [f64::NAN, 1.0],
        [0.01, 1.0],
        [1.0, 1e9],
    ] {
        let file = HeightMapFile {
            spacing: Some(spacing),
            ..raw(RawFormat::U16, 3, 2)
        };
        assert!(
            matches!(
                file.decode("s", &bytes),
                Err(HeightMapError::Spacing { .. })
            ),
            "{spacing:?}"
        );
    }
    for centre in [[f64::NAN, 0.0], [1e12, 0.0]] {
        let file = HeightMapFile {
            centre,
            ..raw(RawFormat::U16, 3, 2)
        };
        assert!(
            matches!(file.decode("o", &bytes), Err(HeightMapError::Origin { .. })),
            "{centre:?}"
        );
    }
    let wrong = HeightMap::new(
        2,
        2,
        vec![0.0; 3],
        DVec2::ZERO,
        DVec2::ONE,
        Filter::Bilinear,
    );
    assert!(matches!(
        wrong,
        Err(HeightMapError::SampleCount {
            expected: 4,
            found: 3,
            ..
        })
    ));
}

#[test]
fn the_real_elevation_has_its_true_size() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dem");
    let latitude = (36.44625 + 36.73292) / 2.0;
    let step = 0.000_833_33;
    let spacing = metres_per_degree(latitude) * step;
    let file = HeightMapFile {
        path: "jacksboro.png".into(),
        format: MapFormat::Png,
        scale: 0.012_817_578,
        offset: 236.0,
        spacing: Some(spacing.to_array()),
        ..HeightMapFile::default()
    };
    let map = file
        .load(&folder)
        .expect("the elevation is part of the repository");
    assert_eq!((map.width(), map.height()), (403, 344));
    let size = map.rect().size();
    // 0.335 degrees at 89.5 km and 0.286 degrees at 111.0 km a degree.
    assert!(
        (size.x - 29_970.0).abs() < 50.0 && (size.y - 31_720.0).abs() < 50.0,
        "{size}"
    );
    let low = map.samples().iter().copied().fold(f32::INFINITY, f32::min);
    let high = map
        .samples()
        .iter()
        .copied()
        .fold(f32::NEG_INFINITY, f32::max);
    assert!(
        (low - 236.0).abs() < 0.01 && (high - 1076.0).abs() < 0.1,
        "{low} {high}"
    );

    // The raw file holds the same heights; the PNG's step is 1.3 cm.
    let file = HeightMapFile {
        path: "jacksboro_344x403_i16le_metres.raw".into(),
        format: MapFormat::raw(RawFormat::I16, 403, 344),
        scale: 1.0,
        offset: 0.0,
        ..file
    };
    let raw = file
        .load(&folder)
        .expect("the elevation is part of the repository");
    for (a, b) in map.samples().iter().zip(raw.samples()) {
        assert!((a - b).abs() < 0.0066, "{a} {b}");
    }
}

#[test]
fn any_noise_function_can_be_a_source() {
    let function = Perlin::new(3);
    let rect = GroundRect::square(DVec2::new(500.0, 0.0), 200.0);
    let map = HeightMap::from_noise_fn(&function, &rect, 1.0, 80.0, 25.0).expect("valid");
    let terrain = Terrain::new(TerrainData {
        extent: rect,
        layers: vec![Layer {
            source: Source::Map(map),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
    });
    let terrain = terrain.expect("valid");
    for k in 0..400 {
        let xz =
            rect.min + DVec2::new(f64::from(k % 20) * 9.3 + 5.0, f64::from(k / 20) * 9.1 + 5.0);
        let expected = 25.0 * function.get([xz.x / 80.0, xz.y / 80.0]);
        // Catmull-Rom between samples 1/80 of a cell apart: (1/80)³ × third derivative (60) / 16
        // × 25 m = 2e-4, and f32 samples.
        assert!((terrain.height(xz) - expected).abs() < 1e-3);
    }
    let broken = |_: [f64; 2]| f64::NAN;
    struct Function<F>(F);
    impl<F: Fn([f64; 2]) -> f64> NoiseFn<f64, 2> for Function<F> {
        fn get(&self, point: [f64; 2]) -> f64 {
            self.0(point)
        }
    }
    let error = HeightMap::from_noise_fn(&Function(broken), &rect, 1.0, 80.0, 25.0);
    assert!(matches!(
        error,
        Err(HeightMapError::NotAHeight {
            column: 0,
            row: 0,
            ..
        })
    ));
    let endless = HeightMap::from_noise_fn(&function, &rect, 0.0, 80.0, 25.0);
    assert!(matches!(endless, Err(HeightMapError::TooLarge { .. })));
}
