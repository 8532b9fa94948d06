//! From what the player asked for to a scene that can be drawn: names, scene files, height maps.
//!
//! | file | concern |
//! |---|---|
//! | `request` | what was asked for |
//! | `file`, `build` | what a scene file holds, and how it becomes a [`LoadedScene`] |
//! | `kind` | scenes that draw themselves |
//! | [`things`] | what stands and lies on the ground |
//! | [`lamps`] | lamps on the ground |
//! | [`city`] | a city on it |
//! | `pose` | where a camera stands and looks |
//! | `reload` | taking over changes while the game runs |

mod build;
pub mod city;
mod error;
pub mod file;
mod kind;
pub mod lamps;
mod pose;
pub mod reload;
mod request;
pub mod things;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use dolomite::ground::{GroundMaterial, MaterialBands, Sea};
use dolomite::sky::Sun;
use dolomite::terrain::{Ground, Terrain, editing};
use dolomite::vegetation::Kinds;

use city::CityScene;
pub use error::SceneError;
use file::SceneFile;
pub use kind::{NamedScene, OwnView};
use lamps::Lamps;
pub use pose::{CLEARANCE, PITCH_LIMIT, Pose};
pub use request::{MapOptions, SceneRequest};

use crate::settings::ron_options;
use things::Thing;

/// The scenes that can be named, with the text of their files as built in.
pub const BUILT_IN: &[(&str, &str)] = &[
    ("mountain", include_str!("../../assets/scenes/mountain.ron")),
    (
        "jacksboro",
        include_str!("../../assets/scenes/jacksboro.ron"),
    ),
    (
        "playground",
        include_str!("../../assets/scenes/playground.ron"),
    ),
    ("night", include_str!("../../assets/scenes/night.ron")),
    ("city", include_str!("../../assets/scenes/city.ron")),
];

/// A scene, ready to be drawn and walked on. Cheap to clone.
#[derive(Clone)]
pub struct LoadedScene {
    /// Name for window title, panel and reports.
    pub name: String,
    /// One line on what it shows.
    pub about: String,
    /// The ground.
    pub terrain: Terrain,
    /// Where the usual materials lie.
    pub bands: MaterialBands,
    /// Materials of its own, in place of these.
    pub material: Option<GroundMaterial>,
    /// How its sea looks, if it has one.
    pub sea: Sea,
    /// Where the sun stands.
    pub sun: Sun,
    /// Its lamps, if it has some.
    pub lamps: Option<Lamps>,
    /// Its city, if it has one.
    pub city: Option<CityScene>,
    /// What grows, if anything does.
    pub vegetation: Option<Arc<Kinds>>,
    /// Where the camera starts.
    pub camera: Pose,
    /// Where the figure starts, (x, z), metres.
    pub figure: DVec2,
    /// Where the figure faces at the start, radians about +y; 0 is north.
    pub facing: f32,
    /// What stands and lies on the ground.
    pub things: Vec<Thing>,
    /// The files it was read from, for hot reload.
    pub files: Files,
    /// What draws it, where that is not the game's own view.
    pub own: Option<Arc<dyn OwnView>>,
}

impl LoadedScene {
    /// `pose` where a camera may be: above ground and sea, unless the scene is no landscape.
    pub fn lifted(&self, pose: Pose) -> Pose {
        match self.own {
            None => pose.above(&self.terrain, self.terrain.sea_level()),
            Some(_) => pose,
        }
    }
}

/// The scene that is being played. Simulation and view read it; hot reload replaces it.
#[derive(Resource, Clone, Deref)]
pub struct CurrentScene(pub LoadedScene);

/// Files that a scene is made of, each with its time of change; `None`: it is not there.
pub type Files = Vec<(PathBuf, Option<SystemTime>)>;

/// Loads what was asked for. `assets` is the assets folder.
///
/// A built-in scene is read from its file in the assets folder where there is one, so that
/// changes to it count, and from the text in the program otherwise.
///
/// # Errors
/// [`SceneError`], naming the file, the reason, and what to do.
pub fn load(request: &SceneRequest, assets: &Path) -> Result<LoadedScene, SceneError> {
    load_watched(request, assets, &mut Files::new())
}

/// Puts up as many lamps as were asked for.
fn with_lamps(mut scene: LoadedScene, request: &SceneRequest) -> Result<LoadedScene, SceneError> {
    let Some(count) = request.lights else {
        return Ok(scene);
    };
    let refused = |reason: String| SceneError::Lamps {
        scene: scene.name.clone(),
        reason,
    };
    let lamps = scene
        .lamps
        .ok_or_else(|| refused("the scene has no lamps; `--scene night` has".to_owned()))?;
    let lamps = Lamps { count, ..lamps };
    lamps.check().map_err(refused)?;
    scene.lamps = Some(lamps);
    Ok(scene)
}

/// As [`load`]. `files` receives every file that was looked for, before it is read: where the scene is
/// refused, a change of one of them may mend it.
///
/// # Errors
/// As [`load`].
pub fn load_watched(
    request: &SceneRequest,
    assets: &Path,
    files: &mut Files,
) -> Result<LoadedScene, SceneError> {
    with_edits(with_lamps(read(request, assets, files)?, request)?)
}

/// The file of what was edited of a scene: in its folder, by its name. `None` for a scene that is no file.
#[must_use]
pub fn edits_file(files: &Files) -> Option<PathBuf> {
    let (path, _) = files.first()?;
    let mut name = std::ffi::OsString::from("edits.");
    name.push(path.file_stem()?);
    name.push(".dolomite");
    Some(path.with_file_name(name))
}

/// Puts on what was edited, if that was saved. A change of that file is no change of the scene: the game writes it itself.
fn with_edits(mut scene: LoadedScene) -> Result<LoadedScene, SceneError> {
    let saved = edits_file(&scene.files).filter(|path| scene.own.is_none() && path.is_file());
    if let Some(path) = saved {
        let lattice = editing::lattice_of(&scene.terrain)?;
        let edits = editing::load(&path, &lattice)?;
        scene.terrain = scene.terrain.with_edits(Some(edits));
    }
    Ok(scene)
}

fn read(
    request: &SceneRequest,
    assets: &Path,
    files: &mut Files,
) -> Result<LoadedScene, SceneError> {
    if let Some((name, text)) = BUILT_IN.iter().find(|(name, _)| *name == request.scene) {
        let path = assets.join("scenes").join(format!("{name}.ron"));
        return if path.is_file() {
            load_file(&path, name, request, files)
        } else {
            load_text(text, &path, name, request, files)
        };
    }
    let named = |named: &&NamedScene| named.name == request.scene;
    if let Some(named) = request.named.iter().find(named) {
        return Ok((named.load)()?);
    }
    let path = Path::new(&request.scene);
    let ending = ending(path);
    if ending == "ron" {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        load_file(path, &name, request, files)
    } else if is_map(&ending) || path.is_file() {
        watch(files, path);
        build::from_map(path, &request.map, files)
    } else {
        Err(SceneError::Unknown {
            scene: request.scene.clone(),
            names: names(request),
        })
    }
}

fn load_file(
    path: &Path,
    name: &str,
    request: &SceneRequest,
    files: &mut Files,
) -> Result<LoadedScene, SceneError> {
    watch(files, path);
    let text = std::fs::read_to_string(path).map_err(|source| SceneError::Read {
        path: path.to_owned(),
        source,
    })?;
    load_text(&text, path, name, request, files)
}

fn load_text(
    text: &str,
    path: &Path,
    name: &str,
    request: &SceneRequest,
    files: &mut Files,
) -> Result<LoadedScene, SceneError> {
    let file: SceneFile = ron_options()
        .from_str(text)
        .map_err(|source| SceneError::Parse {
            path: path.to_owned(),
            source: Box::new(source),
        })?;
    build::from_file(&file, path, name, request.detail, files)
}

/// Notes a file before it is read: a change while it is read is then seen later.
fn watch(files: &mut Files, path: &Path) {
    files.push((path.to_owned(), changed(path)));
}

/// The scenes that have names, for messages.
fn names(request: &SceneRequest) -> Vec<&'static str> {
    let built_in = BUILT_IN.iter().map(|(name, _)| *name);
    built_in
        .chain(request.named.iter().map(|named| named.name))
        .collect()
}

/// The ending of a file name, in lower case.
fn ending(path: &Path) -> String {
    path.extension()
        .map(|ending| ending.to_string_lossy().to_lowercase())
        .unwrap_or_default()
}

/// Whether files with this ending hold elevation.
fn is_map(ending: &str) -> bool {
    let endings = [
        "png", "tif", "tiff", "asc", "hgt", "raw", "r16", "r32", "f32",
    ];
    endings.contains(&ending)
}

/// When a file was changed last; `None` where that cannot be told.
pub fn changed(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path)
        .and_then(|data| data.modified())
        .ok()
}

/// Reads the ground under a place where somebody is about to be put, if it is read by tiles: they stand on the true ground, not
/// on a coarse one. Waits for the disk.
pub fn read_about(terrain: &Terrain, place: DVec2) {
    if let Err(error) = terrain.read_about(place) {
        // Coarse ground is there.
        warn!("{error}");
    }
}

/// Where camera and figure start when a scene does not say: a fifth of the extent south of the
/// middle, an eighth of the extent above the ground there, looking over the middle; the figure in
/// the middle, facing the same way.
fn default_start(terrain: &Terrain) -> (Pose, DVec2, f32) {
    let extent = terrain.extent();
    let size = extent.max - extent.min;
    let middle = (extent.min + extent.max) * 0.5;
    let south = middle + DVec2::new(0.0, size.y * 0.2);
    let height = |place: DVec2| {
        read_about(terrain, place);
        terrain
            .height(place)
            .max(terrain.sea_level().map_or(f64::NEG_INFINITY, f64::from))
    };
    let eye = DVec3::new(south.x, height(south) + size.y * 0.125, south.y);
    let target = DVec3::new(middle.x, height(middle), middle.y);
    let camera = Pose::looking_at(eye, target);
    (camera, middle, camera.yaw)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(scene: &str) -> SceneRequest {
        SceneRequest::new(scene)
    }

    fn assets() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("assets")
    }

    #[test]
    fn the_mountain_reaches_from_the_sea_to_the_snow() {
        let scene = load(&request("mountain"), &assets()).unwrap();
        let extent = scene.terrain.extent();
        let size = extent.max - extent.min;
        assert!(size.x >= 4000.0 && size.y >= 4000.0);
        let sea = f64::from(scene.terrain.sea_level().unwrap());
        let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
        // 64 m apart: finer than the ridges, which are hundreds of metres wide.
        for x in 0..=128 {
            for z in 0..=128 {
                let share = DVec2::new(f64::from(x), f64::from(z)) / 128.0;
                let height = scene.terrain.height(extent.min + size * share);
                lowest = lowest.min(height);
                highest = highest.max(height);
                // An island: the sea reaches all around.
                if x % 128 == 0 || z % 128 == 0 {
                    assert!(height < sea, "{share} is at {height}");
                }
            }
        }
        assert!(lowest < sea - 10.0, "{lowest}");
        let snow = f64::from(scene.bands.snow_line + scene.bands.blend);
        assert!((snow..2200.0).contains(&highest), "{highest}");
    }

    #[test]
    fn jacksboro_has_its_true_size_and_heights() {
        let mut request = request("jacksboro");
        request.detail = Some(0.0);
        let scene = load(&request, &assets()).unwrap();
        let size = scene.terrain.extent().max - scene.terrain.extent().min;
        // 402 and 343 steps of the spacings that assets/dem/README.md derives.
        assert!(
            size.distance(DVec2::new(402.0 * 74.574, 343.0 * 92.475)) < 1.0,
            "{size}"
        );
        // The north-west corner is the first sample of the file, the south-east one the last.
        let bytes = std::fs::read(assets().join("dem/jacksboro.raw")).unwrap();
        let sample = |k: usize| f64::from(i16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]]));
        let extent = scene.terrain.extent();
        // The map's origin is fixed point, 2^-32 m; slopes here are far below 1000.
        let close = |place, wanted: f64| (scene.terrain.height(place) - wanted).abs() < 1e-6;
        assert!(close(extent.min, sample(0)));
        assert!(close(extent.max, sample(403 * 344 - 1)));
    }

    #[test]
    fn detail_changes_the_ground_by_its_amplitude() {
        let mut with = request("jacksboro");
        let mut without = request("jacksboro");
        (with.detail, without.detail) = (Some(20.0), Some(0.0));
        let with = load(&with, &assets()).unwrap();
        let without = load(&without, &assets()).unwrap();
        let mut most: f64 = 0.0;
        for k in 0..1000 {
            let place = DVec2::new(f64::from(k) * 7.3, f64::from(k) * -3.1);
            let difference = with.terrain.height(place) - without.terrain.height(place);
            most = most.max(difference.abs());
        }
        assert!((2.0..60.0).contains(&most), "{most}");
    }

    /// Where files as people bring them lie.
    fn brought(name: &str) -> String {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("plugins");
        let folder = folder.join(if name.contains('-') {
            "elevation"
        } else {
            "terrain"
        });
        folder.join("tests/files").join(name).display().to_string()
    }

    #[test]
    fn maps_that_share_a_column_are_one_ground() {
        let [whole, tiles] = ["whole.ron", "tiles.ron"].map(|name| {
            load(&request(&brought(name)), &assets()).unwrap_or_else(|error| panic!("{error}"))
        });
        assert_eq!(tiles.terrain.data().layers.len(), 1);
        for k in 0..20_000 {
            let place = DVec2::new(f64::from(k % 163) * 6.1, f64::from(k / 163) * 5.3)
                - DVec2::new(490.0, 320.0);
            let [a, b] = [&whole, &tiles].map(|scene| scene.terrain.height(place));
            assert_eq!(a.to_bits(), b.to_bits(), "{place}: {a} {b}");
        }
    }

    #[test]
    fn a_file_with_a_place_has_its_own_spacing_and_says_where_it_is() {
        let scene = load(&request(&brought("h16-gdal-nodata.tif")), &assets()).unwrap();
        let extent = scene.terrain.extent();
        // 40 steps of 30 m, 36 of 25 m.
        assert_eq!(extent.max - extent.min, DVec2::new(1200.0, 900.0));
        assert!(
            scene
                .about
                .contains("412955, 5122997.5 in metres (EPSG:32633"),
            "{}",
            scene.about
        );
        let mut wider = request(&brought("h16-gdal-nodata.tif"));
        wider.map.spacing = Some(2.0);
        wider.map.sea = Some(100.0);
        let scene = load(&wider, &assets()).unwrap();
        let extent = scene.terrain.extent();
        assert_eq!(extent.max - extent.min, DVec2::new(80.0, 72.0));
        assert_eq!(scene.terrain.sea_level(), Some(100.0));
        // Column 10, row 8 is in a hole.
        let hole = extent.min + DVec2::new(20.0, 16.0);
        assert!((scene.terrain.height(hole) - 90.0).abs() < 1e-9);
        let error = load(&request(&brought("h16-gdal-untold.tif")), &assets())
            .err()
            .unwrap();
        assert!(error.to_string().contains("column 7, row 5"), "{error}");
    }

    #[test]
    fn a_wrong_scene_is_an_error_that_names_it() {
        for (scene, words) in [
            ("nowhere", ["nowhere", "mountain"]),
            ("mountains", ["mountains", "city)"]),
            ("no/such.ron", ["no/such.ron", "scene file"]),
            ("no/such.png", ["no/such.png", "check"]),
            ("no/such.raw", ["no/such.raw", "check"]),
        ] {
            let error = load(&request(scene), &assets()).err().unwrap().to_string();
            for word in words {
                assert!(error.contains(word), "{error} does not say {word}");
            }
        }
    }

    #[test]
    fn a_scene_can_be_registered_under_a_name() {
        let flat = load(&request("mountain"), &assets()).unwrap();
        let named = |load: Result<LoadedScene, &'static str>| SceneRequest {
            named: vec![NamedScene {
                name: "flat",
                load: Arc::new(move || load.clone().map_err(Into::into)),
            }],
            ..request("flat")
        };
        assert_eq!(load(&named(Ok(flat)), &assets()).unwrap().name, "mountain");
        let error = load(&named(Err("it is away")), &assets()).err().unwrap();
        assert_eq!(error.to_string(), "it is away");
        let unknown = SceneRequest {
            scene: "nowhere".to_owned(),
            ..named(Err("it is away"))
        };
        let error = load(&unknown, &assets()).err().unwrap().to_string();
        assert!(error.contains("city, flat"), "{error}");
    }

    #[test]
    fn an_unknown_field_is_named_with_file_line_and_column() {
        let folder = std::env::temp_dir().join(format!("dolomite-scene-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("typo.ron");
        std::fs::write(&path, "(\n    layers: [],\n    see_level: 0.0,\n)").unwrap();
        let error = load(&request(&path.to_string_lossy()), &assets())
            .err()
            .unwrap()
            .to_string();
        std::fs::remove_dir_all(&folder).unwrap();
        for word in ["typo.ron", "3:", "see_level"] {
            assert!(error.contains(word), "{error} does not say {word}");
        }
    }
}
