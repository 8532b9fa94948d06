//! What GDAL keeps beside a map of its numbers: no data, scale, unit; and statistics, which change none.

use crate::sidecars::{Folder, band, notes, options, pam, read};
use crate::{ground, same};
use dolomite_elevation::{Elevation, NoData, Options};

#[test]
fn no_data_scale_and_unit_from_gdals_own() {
    let folder = Folder::new("numbers");
    // Numbers of f32, of text and of 32 bits, which are compared before they are rounded and scaled.
    for (from, ground_of) in [
        ("u16-gdal.png", "u16"),
        ("u8-pypng-interlaced.png", "u8"),
        ("i16-gdal.asc", "i16"),
        ("i16-numpy.raw", "i16"),
        ("u32-numpy-big.raw", "u32"),
        ("i16-gdal-strips.tif", "i16"),
        ("u32-gdal-strips.tif", "u32"),
    ] {
        let path = folder.copy(from, &from.replace('.', "-"));
        let name = path
            .file_name()
            .expect("a file")
            .to_string_lossy()
            .into_owned();
        let options = options(from);
        let bare = read(&path, &options);
        let heights = ground(ground_of);
        // f32 does not hold that one of u32.
        let nodata = match ground_of {
            "u32" => 125_430_615.0,
            _ => f64::from(heights[7]),
        };
        let inner = format!(
            "<NoDataValue>{nodata:.14E}</NoDataValue><Offset>-100</Offset><Scale>0.25</Scale><UnitType>ft</UnitType>"
        );
        folder.write(&format!("{name}.aux.xml"), band(&inner));
        let map = read(&path, &options);
        let wanted: Vec<f32> = heights
            .iter()
            .map(|&height| match height == heights[7] {
                true => f32::NAN,
                false => (f64::from(height) * 0.25 - 100.0) as f32,
            })
            .collect();
        // Numbers of 32 bits are rounded once, after they were scaled: not as those of the ground.
        let near =
            |(a, b): (&f32, &f32)| a == b || a.is_nan() && b.is_nan() || (a / b - 1.0).abs() < 2e-7;
        if ground_of == "u32" {
            assert!(map.samples.iter().zip(&wanted).all(near), "{from}");
        } else {
            assert!(same(&map.samples, &wanted), "{from}");
        }
        let about = &map.about;
        assert_eq!((about.scale, about.offset), (0.25, -100.0), "{from}");
        assert_eq!(about.unit_metres, Some(0.3048));
        assert_eq!(about.nodata[0].0, nodata);
        assert_eq!(
            about.holes,
            wanted.iter().filter(|s| s.is_nan()).count() as u64
        );
        for words in [
            "which number stands for no data",
            "scale and offset",
            "unit of its heights",
        ] {
            assert!(notes(&map).contains(words), "{from}: {}", notes(&map));
        }
        let head = Elevation::head(&path, &options).expect("valid");
        assert_eq!(
            (head.unit_metres, head.number),
            (Some(0.3048), bare.about.number)
        );
        // Who says that every number is a height means it.
        let all = Options {
            nodata: NoData::None,
            ..options
        };
        assert_eq!(read(&path, &all).about.holes, 0, "{from}");
    }
}

#[test]
fn what_stands_beside_a_tiff_goes_before_what_it_says_of_its_numbers() {
    let folder = Folder::new("first");
    let path = folder.copy("h16-gdal-nodata.tif", "a");
    let bare = read(&path, &Options::default());
    let own = bare.about.nodata[0].0;
    folder.write("a.tif.aux.xml", band("<NoDataValue>7777.5</NoDataValue>"));
    // Its own number is a height then, which it cannot be; who says so gets it.
    assert!(Elevation::read(&path, &Options::default()).is_err());
    let all = Options {
        nodata: NoData::Value(own),
        ..Options::default()
    };
    let map = read(&path, &all);
    assert!(same(&map.samples, &bare.samples));
    assert!(map.about.nodata.iter().any(|nodata| nodata.0 == 7777.5));
    let path = folder.copy("i16-gdal-scaled.tif", "b");
    let bare = read(&path, &Options::default());
    assert_ne!(bare.about.scale, 1.0);
    // Scale and offset are a pair: of one that is told alone the other is none.
    for (inner, pair) in [
        ("<Offset>5</Offset><Scale>7</Scale>", (7.0, 5.0)),
        ("<Scale>7</Scale>", (7.0, 0.0)),
        ("<Offset>5</Offset>", (1.0, 5.0)),
    ] {
        folder.write(
            "b.tif.aux.xml",
            band(&format!("{inner}<UnitType>ft</UnitType>")),
        );
        let map = read(&path, &Options::default());
        let about = &map.about;
        assert_eq!((about.scale, about.offset), pair);
        assert_eq!(about.unit_metres, Some(0.3048));
        let stored = (f64::from(bare.samples[0]) - bare.about.offset) / bare.about.scale;
        let wanted = (stored * pair.0 + pair.1) as f32;
        assert!((map.samples[0] / wanted - 1.0).abs() < 1e-5, "{inner}");
    }
    // Of several bands that counts which is read.
    let path = folder.copy("u16-gdal-bands-band.tif", "c");
    folder.write(
        "c.tif.aux.xml",
        pam("<PAMRasterBand band=\"2\"><Scale>2</Scale></PAMRasterBand>"),
    );
    for (number, scale) in [(1, 1.0), (2, 2.0), (3, 1.0)] {
        let options = Options {
            band: Some(number),
            ..Options::default()
        };
        assert_eq!(read(&path, &options).about.scale, scale, "band {number}");
    }
}

#[test]
fn statistics_and_what_others_keep_change_nothing() {
    let folder = Folder::new("statistics");
    let statistics = band(
        "<Histograms><HistItem><HistMin>1</HistMin></HistItem></Histograms><Metadata><MDI key=\"STATISTICS_MAXIMUM\">255</MDI><MDI key=\"STATISTICS_VALID_PERCENT\">100</MDI></Metadata>",
    );
    let unchanged = band("<Offset>0</Offset><Scale>1</Scale><NoDataValue></NoDataValue>");
    for from in [
        "u16-gdal.png",
        "i16-numpy.raw",
        "i16-gdal.asc",
        "i16-gdal-strips.tif",
        "h16-gdal-nodata.tif",
        "f64-gdal-strips.tif",
    ] {
        let path = folder.copy(from, &from.replace('.', "-"));
        let name = path
            .file_name()
            .expect("a file")
            .to_string_lossy()
            .into_owned();
        let bare = read(&path, &options(from));
        for text in [&statistics, &unchanged] {
            folder.write(&format!("{name}.AUX.XML"), text);
            let map = read(&path, &options(from));
            assert!(same(&map.samples, &bare.samples), "{from}");
            // What stands for no data may be NaN.
            assert_eq!(format!("{:?}", map.about), format!("{:?}", bare.about));
        }
    }
    // Another program's.
    let path = folder.copy("u16-gdal.png", "other");
    folder.write("other.png.aux.xml", "<metadata><Scale>7</Scale></metadata>");
    let map = read(&path, &Options::default());
    assert_eq!((map.about.scale, map.georeference.is_none()), (1.0, true));
    assert!(
        notes(&map).contains("its root is <metadata>"),
        "{}",
        notes(&map)
    );
}
