//! Files beside a map that are cut off, changed or far too large, and files of tiles made before they were there.

use crate::same;
use crate::sidecars::{Folder, PLANE, WORLD, options, read};
use dolomite_elevation::{
    Elevation, ElevationError, ElevationProgress, NumberType, Options, Raw, TileSettings, TiledMap,
};
use std::io::Cursor;
use std::path::Path;
use std::time::{Duration, SystemTime};
use tiff::encoder::{TiffEncoder, colortype};

const PAM: &str = r#"<PAMDataset>
  <SRS>PROJCS["a &amp; b",GEOGCS["x",UNIT["degree",0.017]],UNIT["metre",1]]</SRS>
  <GeoTransform> 4.1e+05, 1.0e+01, 0.0, 5.1e+06, 0.0, -2.0e+01</GeoTransform>
  <PAMRasterBand band="1"><NoDataValue>3</NoDataValue><Scale>0.5</Scale></PAMRasterBand>
</PAMDataset>
"#;

fn small(size: [u32; 2]) -> Options {
    Options {
        raw: Some(Raw {
            size: Some(size),
            number: Some(NumberType::U8),
            ..Raw::default()
        }),
        ..Options::default()
    }
}

/// The mask of a map of 4 x 3.
fn mask() -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = TiffEncoder::new(Cursor::new(&mut file)).expect("an empty file");
    encoder
        .write_image::<colortype::Gray8>(4, 3, &[255, 0, 255, 255, 0, 1, 2, 3, 255, 255, 255, 0])
        .expect("as many as it has");
    file
}

/// A map of 4 x 3 and what stands beside it.
fn all(folder: &Folder) -> std::path::PathBuf {
    let path = folder.write("a.raw", [1_u8, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]);
    folder.write("a.rww", WORLD);
    folder.write("a.prj", PLANE);
    folder.write("a.raw.aux.xml", PAM);
    folder.write("a.raw.msk", mask());
    path
}

/// Reads with one of the files changed; what is refused names it, or the map. What is read.
fn with(path: &Path, name: &str, bytes: &[u8]) -> Option<Elevation> {
    let beside = path.with_file_name(name);
    std::fs::write(&beside, bytes).expect("room");
    match Elevation::read(path, &small([4, 3])) {
        Ok(map) => {
            assert_eq!(map.samples.len(), 12);
            Some(map)
        }
        Err(error) => {
            let text = error.to_string();
            assert!(text.contains(name), "{name}: {text}");
            None
        }
    }
}

#[test]
fn every_cut_is_refused_or_changes_nothing() {
    let folder = Folder::new("cut");
    let path = all(&folder);
    let whole = read(&path, &small([4, 3]));
    let nan = f32::NAN;
    let wanted = [0.5, nan, nan, 2.0, nan, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, nan];
    assert!(same(&whole.samples, &wanted), "{:?}", whole.samples);
    assert_eq!(
        whole.georeference.as_ref().expect("it is told").first,
        [410_005.0, 5_099_990.0]
    );
    for (name, bytes) in [
        ("a.raw.aux.xml", PAM.as_bytes().to_vec()),
        ("a.raw.msk", mask()),
    ] {
        let mut refused = 0;
        for cut in 0..bytes.len() {
            match with(&path, name, &bytes[..cut]) {
                None => refused += 1,
                // What stands behind its end is not needed.
                Some(map) => {
                    assert!(same(&map.samples, &whole.samples), "{name} cut at {cut}");
                    assert_eq!(map.georeference, whole.georeference, "{name} cut at {cut}");
                }
            }
        }
        assert!(
            refused + 8 > bytes.len(),
            "{name}: {refused} of {} cuts",
            bytes.len()
        );
        with(&path, name, &bytes).expect("whole again");
    }
    // Without GDAL's own the world file and the projection are asked for.
    folder.remove("a.raw.aux.xml");
    let placed = read(&path, &small([4, 3])).georeference;
    for (name, text) in [("a.rww", WORLD), ("a.prj", PLANE)] {
        let trimmed = text.trim_end();
        for cut in 0..trimmed.len() {
            let map = with(&path, name, &text.as_bytes()[..cut]);
            // Of the last number the end may be missing, nothing tells.
            let last = trimmed.rfind('\n').unwrap_or(trimmed.len());
            assert!(map.is_none() || cut > last, "{name} cut at {cut}");
        }
        let map = with(&path, name, trimmed.as_bytes()).expect("it is whole");
        assert_eq!(map.georeference, placed, "{name}");
    }
}

#[test]
fn changed_bytes_never_panic() {
    let folder = Folder::new("changed");
    let path = all(&folder);
    let mut read = [0, 0];
    for (name, bytes) in [
        ("a.raw.aux.xml", PAM.as_bytes().to_vec()),
        ("a.raw.msk", mask()),
        ("a.rww", WORLD.as_bytes().to_vec()),
        ("a.prj", PLANE.as_bytes().to_vec()),
    ] {
        if name == "a.rww" {
            folder.remove("a.raw.aux.xml");
        }
        for at in 0..bytes.len() {
            for flip in [0xff, 0x01, 0x10] {
                let mut changed = bytes.clone();
                changed[at] ^= flip;
                let beside = path.with_file_name(name);
                std::fs::write(&beside, &changed).expect("room");
                // The number that stands for no data may be another, so that the error is of the map alone.
                let map = Elevation::read(&path, &small([4, 3]));
                let map = map.map_err(|error| error.to_string());
                if let Err(text) = &map {
                    assert!(text.contains("a.r"), "{name}: {text}");
                }
                read[usize::from(map.is_ok())] += 1;
            }
        }
        std::fs::write(path.with_file_name(name), &bytes).expect("room");
    }
    assert!(read[0] > 300 && read[1] > 300, "{read:?}");
}

#[test]
fn what_is_far_too_large_is_refused() {
    let folder = Folder::new("large");
    let path = folder.copy("u16-gdal.png", "a");
    let long = |begin: &str, length: usize| format!("{begin}{}", " ".repeat(length));
    for (name, text) in [
        ("a.png.aux.xml", long("<PAMDataset/>", 1 << 22)),
        ("a.pgw", long(WORLD, 1 << 12)),
    ] {
        folder.write(name, text);
        let error = Elevation::read(&path, &Options::default()).expect_err("too large");
        let sidecar = matches!(error, ElevationError::Sidecar { .. });
        let text = error.to_string();
        assert!(
            sidecar && text.contains(name) && text.contains("its length"),
            "{text}"
        );
        folder.remove(name);
    }
    folder.write("a.pgw", WORLD);
    folder.write("a.prj", long(PLANE, 1 << 16));
    let error = Elevation::read(&path, &Options::default()).expect_err("too large");
    assert!(error.to_string().contains("a.prj"), "{error}");
}

fn tiled(path: &Path, options: &Options) -> TiledMap {
    let settings = TileSettings {
        hole: Some(-1.0),
        ..TileSettings::default()
    };
    let map = TiledMap::open(path, options, &settings, &ElevationProgress::default());
    map.unwrap_or_else(|error| panic!("{error}"))
}

/// Opens it twice: whether it was made the first time; it is not the second time.
fn made(path: &Path, options: &Options) -> (bool, TiledMap) {
    let first = tiled(path, options).was_made();
    let map = tiled(path, options);
    assert!(!map.was_made(), "{}", path.display());
    (first, map)
}

#[test]
fn tiles_are_made_anew_when_what_stands_beside_the_map_was_changed() {
    for from in ["i16-numpy.raw", "u16-gdal.png", "i16-gdal.asc"] {
        let folder = Folder::new(&format!("tiles-{}", from.replace('.', "-")));
        let options = options(from);
        let path = folder.copy(from, "a");
        let name = path
            .file_name()
            .expect("a file")
            .to_string_lossy()
            .into_owned();
        let (first, bare) = made(&path, &options);
        assert!(first);
        let height = bare.tile(0, [0, 0]).expect("just made").heights[1];
        // What a viewer leaves behind.
        let pam = format!("{name}.aux.xml");
        folder.write(
            &pam,
            "<PAMDataset><PAMRasterBand band=\"1\"><Metadata><MDI key=\"STATISTICS_MEAN\">1</MDI></Metadata></PAMRasterBand></PAMDataset>",
        );
        assert!(!made(&path, &options).0, "{from}: statistics");
        // Place.
        folder.write("a.wld", WORLD);
        let (anew, map) = made(&path, &options);
        assert!(anew, "{from}: a world file");
        // A grid of text tells its place itself.
        if !from.ends_with(".asc") {
            assert_eq!(map.spacing(), Some([30.0, 25.0]), "{from}");
            let said = map.about().notes.join("; ");
            assert!(
                said.contains("a.wld beside it says where it lies"),
                "{said}"
            );
        }
        folder.write("a.wld", WORLD.replace("30.0", "31.0"));
        assert!(made(&path, &options).0, "{from}: another world file");
        folder.write("a.prj", PLANE);
        assert!(made(&path, &options).0, "{from}: a projection");
        // Numbers.
        folder.write(
            &pam,
            PAM.replace("<NoDataValue>3</NoDataValue>", "<UnitType>ft</UnitType>"),
        );
        let (anew, map) = made(&path, &options);
        assert!(anew, "{from}: another scale");
        let halved = map.tile(0, [0, 0]).expect("just made").heights[1];
        assert_eq!(halved, 0.5 * height, "{from}");
        assert_eq!(map.about().unit_metres, Some(0.3048));
        if !from.ends_with(".asc") {
            assert_eq!(map.spacing(), Some([10.0, 20.0]), "{from}");
        }
        // A mask, and another one of the same length at another time.
        let mut bytes = Vec::new();
        let mut encoder = TiffEncoder::new(Cursor::new(&mut bytes)).expect("an empty file");
        encoder
            .write_image::<colortype::Gray8>(41, 37, &[255; 41 * 37])
            .expect("as many as it has");
        let mask = folder.write(&format!("{name}.msk"), &bytes);
        assert!(made(&path, &options).0, "{from}: a mask");
        // The first strip lies behind the head.
        let one = bytes.windows(4).position(|four| four == [255; 4]);
        bytes[one.expect("it is not packed") + 1] = 0;
        std::fs::write(&mask, &bytes).expect("room");
        let later = SystemTime::now() + Duration::from_secs(5);
        let file = std::fs::File::options().write(true).open(&mask);
        let file = file.expect("writable");
        file.set_modified(later).expect("files have times");
        let (anew, map) = made(&path, &options);
        assert!(anew, "{from}: another mask");
        assert_eq!(map.about().holes, 1);
        assert_eq!(
            map.tile(0, [0, 0]).expect("just made").heights[1],
            -1.0,
            "{from}"
        );
        // All of it gone, it is as it was.
        for name in [pam.as_str(), "a.wld", "a.prj", &format!("{name}.msk")] {
            folder.remove(name);
        }
        let (anew, map) = made(&path, &options);
        assert!(anew, "{from}: nothing");
        assert_eq!(map.about(), bare.about(), "{from}");
        // One that cannot be understood is no reason to take tiles of another map.
        folder.write(&pam, "<PAMDataset>");
        let settings = TileSettings::default();
        let error = TiledMap::open(&path, &options, &settings, &ElevationProgress::default());
        let error = error.expect_err("it is cut off").to_string();
        assert!(error.contains(&pam), "{error}");
    }
}
