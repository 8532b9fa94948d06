//! From what the player asked for to a scene that can be drawn: names, scene files, height maps.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use dolomite_terrain::{Ground, HeightMapError, RawFormat, Terrain, TerrainError};
use dolomite_classic::{ClassicHeights, ClassicHeightsError, heights};
use thiserror::Error;

use super::camera::Pose;
use super::paths;
use super::scene_build;
use super::scene_file::{BandsFile, SceneFile, SunFile};
use super::settings::ron_options;

/// The scenes that can be named, with the text of their files as built in.
pub const BUILT_IN: &[(&str, &str)] = &[
    ("mountain", include_str!("../../assets/scenes/mountain.ron")),
    (
        "jacksboro",
        include_str!("../../assets/scenes/jacksboro.ron"),
    ),
];

/// The scene to compare methods on; its heights lie among the shared data.
pub const CLASSIC: &str = "classic";

/// What the player asked for.
#[derive(Resource, Clone, Debug, PartialEq)]
pub struct SceneRequest {
    /// A name of [`BUILT_IN`], a scene file (`.ron`), or a height map.
    pub scene: String,
    /// How to read it where it is a height map.
    pub map: MapOptions,
    /// Amplitude of the detail below the sample spacing, metres; `None`: the scene's own.
    pub detail: Option<f32>,
    /// The folder of shared data, for the scene [`CLASSIC`]; `None`: where [`paths::shared_dir`] looks.
    pub data: Option<PathBuf>,
}

/// How a height map that is named on the command line is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapOptions {
    /// Metres between samples.
    pub spacing: f64,
    /// Columns and rows; needed for all but PNG.
    pub size: Option<(u32, u32)>,
    /// The numbers of a raw file; `None`: by the ending.
    pub raw: Option<RawFormat>,
    /// Metres for one unit of a sample; `None`: 1, and 0.1 for PNG, so that the 65 535 steps of
    /// a sample span the heights of the Earth.
    pub scale: Option<f32>,
    /// Metres added to the scaled sample.
    pub offset: f32,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            spacing: 30.0,
            size: None,
            raw: None,
            scale: None,
            offset: 0.0,
        }
    }
}

/// A scene, ready to be drawn and walked on. Cheap to clone.
#[derive(Clone)]
pub struct LoadedScene {
    /// Name for window title, panel and reports.
    pub name: String,
    /// One line on what it shows.
    pub about: String,
    /// The ground.
    pub terrain: Terrain,
    /// Where its materials lie.
    pub bands: BandsFile,
    /// Where the sun stands.
    pub sun: SunFile,
    /// Where the camera starts.
    pub camera: Pose,
    /// Where the figure starts, (x, z), metres.
    pub figure: DVec2,
    /// Where the figure faces at the start, radians about +y; 0 is north.
    pub facing: f32,
    /// The files it was read from, with their times of change, for hot reload.
    pub files: Vec<(PathBuf, Option<SystemTime>)>,
    /// The samples, where it is the scene [`CLASSIC`].
    pub classic: Option<ClassicHeights>,
}

/// The scene that is being played. Simulation and view read it; hot reload replaces it.
#[derive(Resource, Clone, Deref)]
pub struct CurrentScene(pub LoadedScene);

/// Why a scene could not be loaded.
#[derive(Debug, Error)]
pub enum SceneError {
    /// Neither a name nor a file.
    #[error(
        "scene `{0}`: neither a scene ({scenes}), nor a scene file (.ron), nor a height map \
         (.png, .raw, .r16, .f32)",
        scenes = names()
    )]
    Unknown(String),
    /// The scene file cannot be read.
    #[error("scene file {}: {source}; check the name", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The scene file is not RON, or has a field that is none of ours.
    #[error(
        "scene file {}, {source}; assets/scenes/mountain.ron explains every field",
        .path.display()
    )]
    Parse {
        /// The file.
        path: PathBuf,
        /// Line, column and reason.
        source: Box<ron::error::SpannedError>,
    },
    /// A value of the scene file makes no sense.
    #[error("scene file {}: {reason}", .path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The value, why it was refused, what to write.
        reason: String,
    },
    /// A raw height map without a size.
    #[error(
        "height map {}: raw files do not tell their size; add `--size-of-raw COLUMNSxROWS`",
        .0.display()
    )]
    NoSize(PathBuf),
    /// A height map was refused.
    #[error("{}{source}", .scene.as_ref().map_or(String::new(), |path| format!("scene file {}: ", path.display())))]
    Map {
        /// The scene file that names the map, if one does.
        scene: Option<PathBuf>,
        /// The map's file, the reason, and what to do.
        source: HeightMapError,
    },
    /// The heights of the scene [`CLASSIC`] were refused.
    #[error(transparent)]
    Classic(#[from] ClassicHeightsError),
    /// The layers make no ground.
    #[error("scene file {}: {source}", .path.display())]
    Terrain {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: Box<TerrainError>,
    },
}

/// Loads what was asked for. `assets` is the assets folder.
///
/// A built-in scene is read from its file in the assets folder where there is one, so that
/// changes to it count, and from the text in the program otherwise.
///
/// # Errors
/// [`SceneError`], naming the file, the reason, and what to do.
pub fn load(request: &SceneRequest, assets: &Path) -> Result<LoadedScene, SceneError> {
    if let Some((name, text)) = BUILT_IN.iter().find(|(name, _)| *name == request.scene) {
        let path = assets.join("scenes").join(format!("{name}.ron"));
        return if path.is_file() {
            load_file(&path, name, request)
        } else {
            load_text(text, &path, name, request)
        };
    }
    if request.scene == CLASSIC {
        let folder = paths::shared_dir(request.data.as_deref());
        return scene_build::classic(&folder.join(heights::FILE));
    }
    let path = Path::new(&request.scene);
    let ending = ending(path);
    if ending == "ron" {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        load_file(path, &name, request)
    } else if ending == "png" || request.map.raw.is_some() || raw_format_of(path).is_some() {
        scene_build::from_map(path, &request.map)
    } else {
        Err(SceneError::Unknown(request.scene.clone()))
    }
}

fn load_file(path: &Path, name: &str, request: &SceneRequest) -> Result<LoadedScene, SceneError> {
    let text = std::fs::read_to_string(path).map_err(|source| SceneError::Read {
        path: path.to_owned(),
        source,
    })?;
    load_text(&text, path, name, request)
}

fn load_text(
    text: &str,
    path: &Path,
    name: &str,
    request: &SceneRequest,
) -> Result<LoadedScene, SceneError> {
    let file: SceneFile = ron_options()
        .from_str(text)
        .map_err(|source| SceneError::Parse {
            path: path.to_owned(),
            source: Box::new(source),
        })?;
    scene_build::from_file(&file, path, name, request.detail)
}

/// The names of the built-in scenes, for messages.
fn names() -> String {
    let built_in = BUILT_IN.iter().map(|(name, _)| *name);
    let names: Vec<&str> = built_in.chain([CLASSIC]).collect();
    names.join(", ")
}

/// The ending of a file name, in lower case.
fn ending(path: &Path) -> String {
    path.extension()
        .map(|ending| ending.to_string_lossy().to_lowercase())
        .unwrap_or_default()
}

/// The numbers of a raw height map, by the ending of its name; `None` for other files.
pub(super) fn raw_format_of(path: &Path) -> Option<RawFormat> {
    match ending(path).as_str() {
        "raw" => Some(RawFormat::I16),
        "r16" => Some(RawFormat::U16),
        "f32" => Some(RawFormat::F32),
        _ => None,
    }
}

/// When a file was changed last; `None` where that cannot be told.
pub(super) fn changed(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path)
        .and_then(|data| data.modified())
        .ok()
}

/// Where camera and figure start when a scene does not say: a fifth of the extent south of the
/// middle, an eighth of the extent above the ground there, looking over the middle; the figure in
/// the middle, facing the same way.
pub(super) fn default_start(terrain: &Terrain) -> (Pose, DVec2, f32) {
    let extent = terrain.extent();
    let size = extent.max - extent.min;
    let middle = (extent.min + extent.max) * 0.5;
    let south = middle + DVec2::new(0.0, size.y * 0.2);
    let height = |place: DVec2| {
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
        SceneRequest {
            scene: scene.to_owned(),
            map: MapOptions::default(),
            detail: None,
            data: None,
        }
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

    #[test]
    fn a_wrong_scene_is_an_error_that_names_it() {
        for (scene, words) in [
            ("nowhere", ["nowhere", "mountain"]),
            ("classical", ["classical", "classic)"]),
            ("no/such.ron", ["no/such.ron", "scene file"]),
            ("no/such.png", ["no/such.png", "check"]),
            ("no/such.raw", ["no/such.raw", "--size-of-raw"]),
        ] {
            let error = load(&request(scene), &assets()).err().unwrap().to_string();
            for word in words {
                assert!(error.contains(word), "{error} does not say {word}");
            }
        }
    }

    #[test]
    fn missing_shared_data_are_named() {
        let request = SceneRequest {
            data: Some(PathBuf::from("no/such/folder")),
            ..request(CLASSIC)
        };
        let error = load(&request, &assets()).err().unwrap().to_string();
        for word in ["no/such/folder/data/classic", "shared", "--data"] {
            assert!(error.contains(word), "{error} does not say {word}");
        }
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
