//! What stands beside a map: its place from world files, what GDAL keeps in `.aux.xml`, and which of it goes first.

use crate::{folder, same};
use dolomite_elevation::{
    Crs, Elevation, ElevationError, NumberType, Options, Registration, metres_per_degree,
    place_by_georeference,
};
use std::path::{Path, PathBuf};

/// A folder that is deleted when the test ends.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let folder = format!("dolomite-beside-{name}-{}", std::process::id());
        let folder = std::env::temp_dir().join(folder);
        std::fs::create_dir_all(&folder).expect("the folder for temporary files is there");
        Self(folder)
    }

    /// A copy of one of our files under another name; the ending is kept.
    pub fn copy(&self, from: &str, stem: &str) -> PathBuf {
        let ending = Path::new(from).extension().expect("it has one");
        let to = self.0.join(stem).with_extension(ending);
        std::fs::copy(folder().join(from), &to).expect("room for it");
        to
    }

    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, text).expect("room for it");
        path
    }

    pub fn remove(&self, name: &str) {
        std::fs::remove_file(self.0.join(name)).expect("it is ours");
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).ok();
    }
}

pub fn read(path: &Path, options: &Options) -> Elevation {
    Elevation::read(path, options).unwrap_or_else(|error| panic!("{error}"))
}

/// How one of our files is read.
pub fn options(name: &str) -> Options {
    crate::kinds::options(name)
}

/// A `.prj` as ESRI writes it, of a plane in metres.
pub const PLANE: &str = "PROJCS[\"UTM_33\",GEOGCS[\"WGS_1984\",UNIT[\"Degree\",0.0174]],PROJECTION[\"Transverse_Mercator\"],UNIT[\"Meter\",1.0]]";
/// Six numbers: 30 m to the east, 25 m to the south.
pub const WORLD: &str = "30.0\n0.0\n0.0\n-25.0\n412355.0\n5123447.5\n";

/// All that one should know of a map.
pub fn notes(map: &Elevation) -> String {
    map.about.notes.join("; ")
}

/// What GDAL writes about a map.
pub fn pam(inner: &str) -> String {
    format!("<PAMDataset>\n  {inner}\n</PAMDataset>\n")
}

/// The same about the first band.
pub fn band(inner: &str) -> String {
    pam(&format!(
        "<PAMRasterBand band=\"1\">{inner}</PAMRasterBand>"
    ))
}

const TRANSFORM: &str = "<GeoTransform> 4.1000000000000000e+05,  1.0000000000000000e+01,  0.0000000000000000e+00,  5.1000000000000000e+06,  0.0000000000000000e+00, -2.0000000000000000e+01</GeoTransform>";

#[test]
fn world_files_tell_the_place_of_what_has_none_itself() {
    let folder = Folder::new("world");
    for (from, endings) in [
        ("u16-gdal.png", ["pgw", "pngw", "wld"]),
        ("i16-numpy.raw", ["rww", "raww", "wld"]),
        ("u16-numpy.r16", ["r6w", "r16w", "WLD"]),
        ("u16-tifffile.tif", ["tfw", "TIFW", "Wld"]),
    ] {
        for (k, ending) in endings.into_iter().enumerate() {
            let stem = format!("{}-{k}", from.replace('.', "-"));
            let path = folder.copy(from, &stem);
            let options = options(from);
            let bare = read(&path, &options);
            assert_eq!(bare.georeference, None, "{from}");
            let name = format!("{stem}.{ending}");
            folder.write(&name, WORLD);
            folder.write(&format!("{stem}.PRJ"), PLANE);
            let map = read(&path, &options);
            assert!(same(&map.samples, &bare.samples), "{from}");
            let place = map.georeference.clone().expect("it is told");
            assert_eq!(place.first, [412_355.0, 5_123_447.5], "{name}");
            assert_eq!(place.step, [30.0, 25.0]);
            assert_eq!(place.registration, Registration::Area);
            assert_eq!(map.spacing(), Some([30.0, 25.0]));
            assert_eq!(place.crs.name(), "metres (UTM_33)");
            let said = notes(&map);
            assert!(
                said.contains(&format!("{name} beside it says where it lies")),
                "{said}"
            );
            assert!(
                said.contains("PRJ beside it names its coordinate system"),
                "{said}"
            );
            // Of every second sample the distance is twice as large.
            let fewer = Options {
                every: 2,
                ..options
            };
            assert_eq!(read(&path, &fewer).spacing(), Some([60.0, 50.0]));
        }
    }
}

#[test]
fn without_a_prj_places_are_taken_for_degrees_or_metres() {
    let folder = Folder::new("guess");
    let path = folder.copy("u16-gdal.png", "a");
    folder.write("a.pgw", WORLD);
    let map = read(&path, &Options::default());
    assert_eq!(map.spacing(), Some([30.0, 25.0]));
    assert!(notes(&map).contains("taken for metres"), "{}", notes(&map));
    folder.write("a.pgw", "0.001\n0\n0\n-0.001\n15.5\n46.5\n");
    let map = read(&path, &Options::default());
    assert!(notes(&map).contains("taken for degrees"), "{}", notes(&map));
    let [x, z] = map.spacing().expect("degrees are metres");
    let [east, north] = metres_per_degree(46.5 - 18.0 * 0.001).map(|metres| metres * 0.001);
    assert!(
        (x / east - 1.0).abs() < 1e-9 && (z / north - 1.0).abs() < 1e-9,
        "{x} {z}"
    );
    // One whose unit is not known.
    let any = Options {
        any_projection: true,
        ..Options::default()
    };
    folder.write("a.prj", "LOCAL_CS[\"x\"]");
    let map = read(&path, &any);
    let place = map.georeference.clone().expect("it is told");
    assert_eq!((place.crs, map.spacing()), (Crs::Unknown, None));
    let error = Elevation::read(&path, &Options::default()).expect_err("its unit is not known");
    let error = error.to_string();
    assert!(
        error.contains("a.prj beside it") && error.contains("--spacing 30"),
        "{error}"
    );
}

/// As transformations in a GeoTIFF are.
#[test]
fn what_is_rotated_or_stands_on_its_head_is_refused() {
    let folder = Folder::new("rotated");
    let path = folder.copy("u16-gdal.png", "a");
    let refused = |words: &[&str]| {
        let error = Elevation::read(&path, &Options::default()).expect_err("not north-up");
        let georeference = matches!(error, ElevationError::Georeference { .. });
        let text = error.to_string();
        assert!(
            georeference && words.iter().all(|word| text.contains(word)),
            "{text}"
        );
    };
    for text in [
        "30\n1\n0\n-25\n5\n6",
        "30\n0\n1\n-25\n5\n6",
        "0\n30\n25\n0\n5\n6",
    ] {
        folder.write("a.pgw", text);
        refused(&["a.pgw", "west to east", "gdalwarp"]);
    }
    for text in [
        "30\n0\n0\n25\n5\n6",
        "-30\n0\n0\n-25\n5\n6",
        "0\n0\n0\n-25\n5\n6",
    ] {
        folder.write("a.pgw", text);
        refused(&["a.pgw", "rows to the south", "gdalwarp"]);
    }
    // Metres that are said to be degrees.
    folder.write("a.pgw", WORLD);
    folder.write("a.prj", "GEOGCS[\"WGS 84\",UNIT[\"degree\",0.0174]]");
    refused(&["no place in degrees"]);
    folder.remove("a.pgw");
    folder.remove("a.prj");
    folder.write(
        "a.png.aux.xml",
        pam("<GeoTransform>0,30,1,0,0,-25</GeoTransform>"),
    );
    refused(&[
        "<GeoTransform> in a.png.aux.xml",
        "west to east",
        "gdalwarp",
    ]);
    folder.write(
        "a.png.aux.xml",
        pam("<GeoTransform>0,30,0,0,0,25</GeoTransform>"),
    );
    refused(&["<GeoTransform> in a.png.aux.xml", "rows to the south"]);
    folder.write(
        "a.png.aux.xml",
        pam("<GCPList><GCP Id=\"1\"/><GCP Id=\"2\"/></GCPList>"),
    );
    refused(&["<GCPList> in a.png.aux.xml", "2 points", "gdalwarp -tps"]);
}

#[test]
fn gdals_own_goes_before_the_file_and_the_file_before_a_world_file() {
    let folder = Folder::new("order");
    let path = folder.copy("i16-gdal-strips.tif", "a");
    let bare = read(&path, &Options::default());
    let own = bare.georeference.clone().expect("a GeoTIFF");
    // Not asked for, so not even looked into.
    folder.write("a.tfw", "this is no world file");
    folder.write("a.prj", "nor is this a projection");
    let map = read(&path, &Options::default());
    assert_eq!(map.about, bare.about);
    folder.write("a.tfw", WORLD.replace("412355", "7"));
    assert_eq!(read(&path, &Options::default()).about, bare.about);
    // Its place, and the file's own coordinate system.
    folder.write("a.tif.aux.xml", pam(TRANSFORM));
    let map = read(&path, &Options::default());
    let place = map.georeference.clone().expect("it is told");
    assert_eq!(place.first, [410_005.0, 5_099_990.0]);
    assert_eq!((place.step, &place.crs), ([10.0, 20.0], &own.crs));
    assert!(notes(&map).contains("a.tif.aux.xml beside it says where it lies"));
    // The other way round.
    let feet =
        "<SRS>PROJCS[&quot;feet&quot;,GEOGCS[&quot;x&quot;],UNIT[&quot;foot&quot;,0.3048]]</SRS>";
    folder.write("a.tif.aux.xml", pam(feet));
    let map = read(&path, &Options::default());
    let place = map.georeference.clone().expect("it is told");
    assert_eq!((place.first, place.step), (own.first, own.step));
    assert_eq!(place.crs.name(), "feet (feet)");
    assert_eq!(map.spacing(), Some([30.0 * 0.3048, 25.0 * 0.3048]));
    // One that the file has in a way that is refused does not matter then.
    let path = folder.copy("i16-gdal-rotated.tif", "r");
    assert!(Elevation::read(&path, &Options::default()).is_err());
    folder.write("r.tif.aux.xml", pam(TRANSFORM));
    let map = read(&path, &Options::default());
    assert_eq!(map.georeference.expect("it is told").step, [10.0, 20.0]);
    // With points the place is a corner's all the same.
    let path = folder.copy("u16-gdal.png", "p");
    let metadata = "<Metadata><MDI key=\"AREA_OR_POINT\">Point</MDI></Metadata>";
    folder.write("p.png.aux.xml", pam(&format!("{TRANSFORM}{metadata}")));
    let place = read(&path, &Options::default())
        .georeference
        .expect("it is told");
    assert_eq!(place.first, [410_005.0, 5_099_990.0]);
    assert_eq!(place.registration, Registration::Point);
}

/// What GDAL 3.9.3 says of both: an ESRI ASCII grid and an HGT file keep their own place and no data.
#[test]
fn a_grid_of_text_and_an_hgt_file_go_before_gdals_own() {
    let folder = Folder::new("own-order");
    let inner =
        "<PAMRasterBand band=\"1\"><NoDataValue>7</NoDataValue><Scale>2</Scale></PAMRasterBand>";
    let grid = "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 180\ncellsize 10\nNODATA_value -9999\n1 2 7\n4 5 -9999\n";
    let path = folder.write("t.asc", grid);
    folder.write("t.asc.aux.xml", pam(&format!("{TRANSFORM}{inner}")));
    let map = read(&path, &Options::default());
    let place = map.georeference.as_ref().expect("it says so itself");
    assert_eq!((place.first, place.step), ([105.0, 195.0], [10.0, 10.0]));
    assert_eq!(
        (map.about.nodata.len(), map.about.nodata[0].0),
        (1, -9999.0)
    );
    // Of scale neither kind says anything itself.
    assert!(crate::same(
        &map.samples,
        &[2.0, 4.0, 14.0, 8.0, 10.0, f32::NAN]
    ));
    // Its coordinate system is that of the `.prj`, and without one that of GDAL's own.
    let feet =
        "<SRS>PROJCS[&quot;feet&quot;,GEOGCS[&quot;x&quot;],UNIT[&quot;foot&quot;,0.3048]]</SRS>";
    folder.write("t.asc.aux.xml", pam(feet));
    let name = |path: &Path| {
        let map = read(path, &Options::default());
        map.georeference.expect("it is told").crs.name().to_owned()
    };
    assert_eq!(name(&path), "feet (feet)");
    folder.write("t.prj", PLANE);
    assert_ne!(name(&path), "feet (feet)");
    let path = folder.write("N46E015.hgt", vec![0_u8; 2 * 1201 * 1201]);
    folder.write(
        "N46E015.hgt.aux.xml",
        pam(&format!("{TRANSFORM}{inner}{feet}")),
    );
    let map = read(&path, &Options::default());
    let place = map.georeference.expect("its name says so");
    assert_eq!(place.first, [15.0, 47.0]);
    assert!(matches!(place.crs, Crs::Degrees { .. }));
    assert_eq!((map.about.scale, map.about.unit_metres), (2.0, Some(1.0)));
}

/// Tiles of a game's editor, each with its world file, are one map.
#[test]
fn tiles_lie_where_their_world_files_say() {
    let folder = Folder::new("mosaic");
    let options = options("i16-numpy.raw");
    let mut tiles = Vec::new();
    for (name, east) in [("west", 0.0), ("east", 40.0 * 30.0)] {
        let path = folder.copy("i16-numpy.raw", name);
        let first = 412_355.0 + east;
        folder.write(
            &format!("{name}.rww"),
            WORLD.replace("412355.0", &first.to_string()),
        );
        tiles.push(read(&path, &options));
    }
    let placed: Vec<_> = tiles
        .iter()
        .map(|tile| {
            let place = tile.georeference.as_ref().expect("it is told");
            (tile.about.file.as_str(), place, tile.size)
        })
        .collect();
    let at = place_by_georeference(&placed).expect("on one grid");
    assert_eq!(at, [[0, 0], [40, 0]]);
}

/// Of an HGT file whose name is no degree's.
#[test]
fn an_hgt_file_may_be_told_its_place() {
    let folder = Folder::new("hgt");
    let path = folder.write("place.hgt", vec![0_u8; 2 * 1201 * 1201]);
    assert_eq!(read(&path, &Options::default()).georeference, None);
    let step = 1.0 / 1200.0;
    folder.write("place.htw", format!("{step}\n0\n0\n-{step}\n15\n47\n"));
    let map = read(&path, &Options::default());
    let place = map.georeference.expect("it is told");
    assert_eq!((place.first, place.step), ([15.0, 47.0], [step; 2]));
    assert!(matches!(
        place.crs,
        Crs::Degrees {
            epsg: Some(4326),
            ..
        }
    ));
    assert_eq!(map.about.number, NumberType::I16);
}

#[test]
fn a_grid_of_text_may_begin_with_blanks() {
    let text = "ncols 2\nnrows 1\n1 2\n";
    for blanks in [0, 1, 500, 507, 510, 511, 512, 513, 600, 5_000, 60_000] {
        for mark in ["", "\u{feff}"] {
            let file = format!("{mark}{}{text}", "\r\n \t".repeat(blanks / 4 + 1));
            let map = Elevation::decode("a.txt", file.as_bytes(), &Options::default());
            let map = map.unwrap_or_else(|error| panic!("{blanks}: {error}"));
            assert_eq!(map.samples, [1.0, 2.0]);
        }
        let file = format!("{}{text}", " ".repeat(blanks));
        let map = Elevation::decode("a.txt", file.as_bytes(), &Options::default());
        assert_eq!(map.expect("valid").samples, [1.0, 2.0], "{blanks}");
    }
    let endless = " ".repeat(1 << 20);
    let error = Elevation::decode("a.txt", endless.as_bytes(), &Options::default());
    let error = error.expect_err("nothing stands in it");
    assert!(matches!(error, ElevationError::Kind { .. }), "{error}");
}
