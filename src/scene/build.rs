//! From the fields of a scene file to a terrain.

use std::path::Path;
use std::sync::Arc;

use bevy::log::warn;
use bevy::math::{DVec2, DVec3};
use dolomite::ground::{MaterialBands, Sea};
use dolomite::sky::Sun;
use dolomite::terrain::elevation::{Elevation, ElevationProgress, FileKind, Head, NumberType};
use dolomite::terrain::{
    Fractal, GroundRect, HeightMap, HeightMapError, HeightMapFile, Holes, Layer, Mask, Source,
    Terrain, TerrainData,
};
use dolomite::vegetation::Kinds;

use super::file::{LayerFile, SceneFile, SourceFile, StartFile};
use super::things::Thing;
use super::{Files, LoadedScene, MapOptions, PITCH_LIMIT, Pose, SceneError, default_start, watch};

/// Metres for one unit of a 16-bit PNG sample when `--height-scale` is left out.
const PNG_SCALE: f32 = 0.1;

/// Metres between samples where neither the file nor `--spacing` tells them.
const SPACING: f64 = 30.0;

/// Builds the scene of a scene file. `detail` replaces the amplitude of its detail, metres; `files`
/// receives the files that it names.
///
/// # Errors
/// [`SceneError`], naming the file and the value.
pub(super) fn from_file(
    file: &SceneFile,
    path: &Path,
    name: &str,
    detail: Option<f32>,
    files: &mut Files,
) -> Result<LoadedScene, SceneError> {
    let value = |reason: String| SceneError::Value {
        path: path.to_owned(),
        reason,
    };
    if file.layers.is_empty() {
        return Err(value("`layers` is empty: add a source".to_owned()));
    }
    let mut layers = Layers::default();
    let is_map = |layer: &&LayerFile| matches!(layer.source, SourceFile::Map(_));
    // One map is read by tiles, and the ground is as large as it is: else what memory can hold is read into it.
    let whole = file.extent.is_some() || file.layers.iter().filter(is_map).count() > 1;
    for layer in &file.layers {
        let source = source(&layer.source, whole, path, files)?;
        let name = match &layer.source {
            SourceFile::Map(map) => map.paths().next().unwrap_or_default(),
            _ => "",
        };
        layers.push(name, source, layer.mask, path)?;
    }
    let mut layers = layers.done(path)?;
    let first_map = layers.iter().find_map(|layer| match &layer.source {
        Source::Map(map) => Some(map.rect()),
        _ => None,
    });
    layers.extend(detail_layer(file.detail, detail));
    let extent = match (file.extent, first_map) {
        (Some((min, max)), _) => GroundRect::new(DVec2::from(min), DVec2::from(max)),
        (None, Some(extent)) => extent,
        (None, None) => {
            return Err(value(
                "`extent` is left out, but no layer is a height map: write \
                 `extent: ((-2048.0, -2048.0), (2048.0, 2048.0))`"
                    .to_owned(),
            ));
        }
    };
    let terrain = Terrain::new(TerrainData {
        extent,
        layers,
        base: file.base,
        sea_level: file.sea_level,
    })
    .map_err(|source| SceneError::Terrain {
        path: path.to_owned(),
        source: Box::new(source),
    })?;
    check_numbers(file).map_err(value)?;
    let city = file.city.as_ref().map(|city| city.on(&terrain));
    let city = city.transpose().map_err(value)?;
    let vegetation = kinds(file, path, files)?;
    let (camera, figure, facing) = match file.start {
        Some(start) => start_of(start),
        None => default_start(&terrain),
    };
    Ok(LoadedScene {
        name: name.to_owned(),
        about: file.about.clone(),
        terrain,
        bands: file.bands,
        material: file.material.clone(),
        sea: file.sea,
        sun: file.sun,
        lamps: file.lamps,
        city,
        vegetation,
        camera,
        figure,
        facing,
        things: file.things.clone(),
        files: files.clone(),
        own: None,
    })
}

/// What grows. A file that is not there leaves the ground bare, and says so: the scene is built into the program, the
/// files of its plants are not.
fn kinds(
    file: &SceneFile,
    path: &Path,
    files: &mut Files,
) -> Result<Option<Arc<Kinds>>, SceneError> {
    let Some(name) = &file.vegetation else {
        return Ok(None);
    };
    let path = path.parent().unwrap_or(Path::new("")).join(name);
    watch(files, &path);
    if !path.exists() {
        warn!("{}: no such file; nothing grows", path.display());
        return Ok(None);
    }
    Ok(Some(Arc::new(Kinds::read(&path)?)))
}

/// Builds a scene from a height map alone: no sea, materials by the share of its own heights.
///
/// # Errors
/// [`SceneError`], naming the file.
pub(super) fn from_map(
    path: &Path,
    options: &MapOptions,
    files: &Files,
) -> Result<LoadedScene, SceneError> {
    let refused = |source: HeightMapError| SceneError::Map {
        scene: None,
        source: Box::new(source),
    };
    let progress = ElevationProgress::on_stderr();
    // What a sample of a hole is depends on it, so it is known before the file is cut into tiles.
    let head = Elevation::head(path, &options.read).ok();
    let is_deep = |head: Head| head.kind == FileKind::Png && head.number == NumberType::U16;
    let deep = head.is_some_and(is_deep);
    let mut file = HeightMapFile {
        scale: options.scale.unwrap_or(if deep { PNG_SCALE } else { 1.0 }),
        offset: options.offset,
        holes: options.sea.map_or(Holes::Fill, Holes::Sea),
        budget: options.budget,
        ..HeightMapFile::default()
    };
    // The path is the player's own, relative to where they stand.
    let tiles = file
        .open_tiles(path, &options.read, &progress)
        .map_err(refused)?;
    let read = match tiles {
        Some(tiles) => Ok(tiles),
        None => {
            let read = Elevation::read_telling(path, &options.read, &progress);
            Err(read.map_err(|error| refused(error.into()))?)
        }
    };
    let (about, size, told) = match &read {
        Ok(tiles) => (tiles.about(), tiles.size(), tiles.spacing().is_some()),
        Err(read) => (&read.about, read.size, read.spacing().is_some()),
    };
    for note in &about.notes {
        warn!("{}: {note}", path.display());
    }
    file.spacing = match options.spacing {
        Some(metres) => Some([metres; 2]),
        None => (!told).then_some([SPACING; 2]),
    };
    let place = match &read {
        Ok(tiles) => tiles.georeference(),
        Err(read) => read.georeference.as_ref(),
    };
    let place = place.map(|place| {
        let [east, north] = place.middle(size);
        format!(", its middle at {east}, {north} in {}", place.crs.name())
    });
    let map = match read {
        Ok(tiles) => file.make_by_tiles(tiles),
        Err(read) => file.make(read),
    };
    let map = map.map_err(refused)?;
    let [low, high] = map.extremes();
    let terrain = Terrain::new(TerrainData {
        extent: map.rect(),
        layers: vec![Layer {
            source: Source::Map(map),
            mask: None,
        }],
        base: 0.0,
        sea_level: options.sea,
    })
    .map_err(|source| SceneError::Terrain {
        path: path.to_owned(),
        source: Box::new(source),
    })?;
    let (camera, figure, facing) = default_start(&terrain);
    // Nothing tells at which latitude the map lies; its own range gives the bands.
    let at = |share: f32| low + (high - low) * share;
    Ok(LoadedScene {
        name: path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned(),
        about: format!("height map {}{}", path.display(), place.unwrap_or_default()),
        terrain,
        bands: MaterialBands {
            sand_top: low,
            tree_line: at(0.6),
            snow_line: at(0.85),
            blend: ((high - low) * 0.1).max(1.0),
            ..MaterialBands::default()
        },
        material: None,
        sea: Sea::default(),
        sun: Sun::default(),
        lamps: None,
        city: None,
        vegetation: None,
        camera,
        figure,
        facing,
        things: Vec::new(),
        files: files.clone(),
        own: None,
    })
}

/// Layers in the making. Maps that follow each other and go on where one before them ends are one ground; others are added up.
#[derive(Default)]
struct Layers {
    done: Vec<Layer>,
    /// Maps without a mask that are one ground so far.
    beside: Vec<(String, HeightMap)>,
}

impl Layers {
    fn push(
        &mut self,
        name: &str,
        source: Source,
        mask: Option<Mask>,
        path: &Path,
    ) -> Result<(), SceneError> {
        match source {
            // What is read by tiles is not put together with others.
            Source::Map(map) if mask.is_none() && map.stream().is_none() => {
                if !self.beside.iter().any(|(_, other)| other.goes_on_in(&map)) {
                    self.join(path)?;
                }
                self.beside.push((name.to_owned(), map));
            }
            source => {
                self.join(path)?;
                self.done.push(Layer { source, mask });
            }
        }
        Ok(())
    }

    /// Makes one layer of the maps beside each other.
    fn join(&mut self, path: &Path) -> Result<(), SceneError> {
        let beside = std::mem::take(&mut self.beside);
        let map = match &beside[..] {
            [] => return Ok(()),
            [(_, map)] => map.clone(),
            _ => {
                let maps = beside
                    .iter()
                    .map(|(name, map)| (name.as_str(), map.clone()));
                let maps: Vec<_> = maps.collect();
                HeightMap::joined(&maps).map_err(|source| SceneError::Map {
                    scene: Some(path.to_owned()),
                    source: Box::new(source),
                })?
            }
        };
        self.done.push(Layer {
            source: Source::Map(map),
            mask: None,
        });
        Ok(())
    }

    fn done(mut self, path: &Path) -> Result<Vec<Layer>, SceneError> {
        self.join(path)?;
        Ok(self.done)
    }
}

/// The detail below the sample spacing as a layer, if there is any.
fn detail_layer(detail: Option<Fractal>, amplitude: Option<f32>) -> Option<Layer> {
    let detail = detail?;
    let amplitude = amplitude.unwrap_or(detail.amplitude);
    (amplitude != 0.0).then_some(Layer {
        source: Source::Fractal(Fractal {
            amplitude,
            ..detail
        }),
        mask: None,
    })
}

fn source(
    source: &SourceFile,
    whole: bool,
    path: &Path,
    files: &mut Files,
) -> Result<Source, SceneError> {
    Ok(match source {
        SourceFile::Fractal(fractal) => Source::Fractal(*fractal),
        SourceFile::Permutation(classic) => Source::Permutation(*classic),
        SourceFile::Hill(hill) => Source::Hill(*hill),
        SourceFile::Map(map) => {
            let folder = path.parent().unwrap_or(Path::new(""));
            for path in map.paths() {
                watch(files, &folder.join(path));
            }
            let progress = ElevationProgress::on_stderr();
            let mut map = map.clone();
            if whole {
                map.budget = map.budget.map(|bytes| bytes.max(HeightMapFile::WHOLE));
            }
            let map = map.load_telling(folder, &progress);
            let map = map.map_err(|source| SceneError::Map {
                scene: Some(path.to_owned()),
                source: Box::new(source),
            })?;
            Source::Map(map)
        }
    })
}

/// What the terrain does not check, because only the view uses it.
fn check_numbers(file: &SceneFile) -> Result<(), String> {
    let MaterialBands {
        sand_top,
        tree_line,
        snow_line,
        blend,
        rock_slope,
        snow_slope,
    } = file.bands;
    for (name, value) in [
        ("sand_top", sand_top),
        ("tree_line", tree_line),
        ("snow_line", snow_line),
    ] {
        if !value.is_finite() {
            return Err(format!(
                "`bands.{name}` is {value}, but must be a height in metres"
            ));
        }
    }
    for (name, value) in [
        ("blend", blend),
        ("rock_slope", rock_slope),
        ("snow_slope", snow_slope),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(format!("`bands.{name}` is {value}, but must be above 0"));
        }
    }
    file.things.iter().try_for_each(Thing::check)?;
    let Sun { azimuth, elevation } = file.sun;
    if !azimuth.is_finite() || !(-90.0..=90.0).contains(&elevation) {
        return Err(format!(
            "`sun` is (azimuth: {azimuth}, elevation: {elevation}), but must be degrees, \
             elevation -90 to 90"
        ));
    }
    if let Some(lamps) = file.lamps {
        lamps.check()?;
    }
    if let Some(StartFile { camera, figure }) = file.start {
        let (x, y, z, yaw, pitch) = camera;
        let numbers = [
            x,
            y,
            z,
            f64::from(yaw),
            f64::from(pitch),
            figure.0,
            figure.1,
            f64::from(figure.2),
        ];
        if numbers.iter().any(|number| !number.is_finite()) {
            return Err("`start` holds a number that is not finite".to_owned());
        }
    }
    Ok(())
}

fn start_of(start: StartFile) -> (Pose, DVec2, f32) {
    let (x, y, z, yaw, pitch) = start.camera;
    let pose = Pose {
        position: DVec3::new(x, y, z),
        yaw: yaw.to_radians(),
        pitch: pitch.to_radians().clamp(-PITCH_LIMIT, PITCH_LIMIT),
    };
    let (x, z, facing) = start.figure;
    (pose, DVec2::new(x, z), facing.to_radians())
}
