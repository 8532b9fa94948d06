//! From the fields of a scene file to a terrain.

use std::path::Path;

use bevy::math::{DVec2, DVec3};
use dolomite::ground::{MaterialBands, Sea};
use dolomite::sky::Sun;
use dolomite::terrain::{
    Filter, Fractal, GroundRect, HeightMapFile, Layer, MapFormat, Source, Terrain, TerrainData,
};

use super::file::{SceneFile, SourceFile, StartFile};
use super::{
    Files, LoadedScene, MapOptions, PITCH_LIMIT, Pose, SceneError, default_start, raw_format_of,
    watch,
};

/// Metres for one unit of a 16-bit PNG sample when `--height-scale` is left out.
const PNG_SCALE: f32 = 0.1;

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
    let mut first_map = None;
    let mut layers = Vec::with_capacity(file.layers.len() + 1);
    for layer in &file.layers {
        let source = source(&layer.source, path, files)?;
        if let Source::Map(map) = &source
            && first_map.is_none()
        {
            first_map = Some(map.rect());
        }
        layers.push(Layer {
            source,
            mask: layer.mask,
        });
    }
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
        camera,
        figure,
        facing,
        files: files.clone(),
        own: None,
    })
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
    let file = map_file(path, options)?;
    // The path is the player's own, relative to where they stand.
    let map = file.load(Path::new("")).map_err(|source| SceneError::Map {
        scene: None,
        source,
    })?;
    let (low, high) = map
        .samples()
        .iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), sample| {
            (low.min(*sample), high.max(*sample))
        });
    let terrain = Terrain::new(TerrainData {
        extent: map.rect(),
        layers: vec![Layer {
            source: Source::Map(map),
            mask: None,
        }],
        base: 0.0,
        sea_level: None,
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
        about: format!("height map {}", path.display()),
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
        camera,
        figure,
        facing,
        files: files.clone(),
        own: None,
    })
}

/// What the command line says of a height map.
fn map_file(path: &Path, options: &MapOptions) -> Result<HeightMapFile, SceneError> {
    let raw = options.raw.or_else(|| raw_format_of(path));
    let format = match (raw, options.size) {
        (None, _) => MapFormat::Png,
        (Some(format), Some((width, height))) => MapFormat::Raw {
            format,
            width,
            height,
        },
        (Some(_), None) => return Err(SceneError::NoSize(path.to_owned())),
    };
    let scale = if format == MapFormat::Png {
        PNG_SCALE
    } else {
        1.0
    };
    Ok(HeightMapFile {
        path: path.to_string_lossy().into_owned(),
        format,
        scale: options.scale.unwrap_or(scale),
        offset: options.offset,
        spacing: [options.spacing; 2],
        centre: [0.0; 2],
        filter: Filter::Bicubic,
    })
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

fn source(source: &SourceFile, path: &Path, files: &mut Files) -> Result<Source, SceneError> {
    Ok(match source {
        SourceFile::Fractal(fractal) => Source::Fractal(*fractal),
        SourceFile::Permutation(classic) => Source::Permutation(*classic),
        SourceFile::Hill(hill) => Source::Hill(*hill),
        SourceFile::Map(map) => {
            let folder = path.parent().unwrap_or(Path::new(""));
            watch(files, &folder.join(&map.path));
            let map = map.load(folder).map_err(|source| SceneError::Map {
                scene: Some(path.to_owned()),
                source,
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
    let Sun { azimuth, elevation } = file.sun;
    if !azimuth.is_finite() || !(-90.0..=90.0).contains(&elevation) {
        return Err(format!(
            "`sun` is (azimuth: {azimuth}, elevation: {elevation}), but must be degrees, \
             elevation -90 to 90"
        ));
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
