//! Reference frames: meshes that other programs deformed, as OBJ files, and a list of them.

use super::distance::{hausdorff, vertex_error};
use super::played::{Played, PlayedError};
use super::truth::Truth;
use crate::conversion::Conversion;
use crate::convert::convert;
use crate::error::FbxError;
use crate::options::{Options, Origin};
use glam::DVec3;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// One line of a `frames.json`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Frame {
    /// The FBX file, relative to the list.
    pub fbx: String,
    /// The mesh, relative to the FBX file's folder or to the list.
    pub obj: String,
    /// Part of the animation stack's name; `None` is the first stack.
    pub clip: Option<String>,
    /// On the file's clock.
    pub seconds: f64,
    /// What the mesh may be off by, in the file's unit.
    pub tolerance: f64,
}

/// Why a file could not be held against its frames.
#[derive(Debug, thiserror::Error)]
pub enum CheckError {
    /// Something could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// What.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The list is none.
    #[error("{}: no list of frames: {source}", path.display())]
    List {
        /// Which.
        path: PathBuf,
        /// Why.
        source: serde_json::Error,
    },
    /// The FBX file was refused.
    #[error(transparent)]
    Fbx(#[from] FbxError),
    /// Our own .glb was refused.
    #[error(transparent)]
    Played(#[from] PlayedError),
    /// A frame names a clip that is not there.
    #[error("there is no clip {0:?}")]
    NoClip(String),
}

/// How a file came out.
#[derive(Debug, Clone, PartialEq)]
pub struct FileCheck {
    /// The conversion.
    pub conversion: Conversion,
    /// Its bytes.
    pub glb: Vec<u8>,
    /// Reference frames that it was held against; without any, poses by ufbx.
    pub frames: usize,
    /// The largest error against reference frames, or else against ufbx at the file's frames, in the
    /// file's unit.
    pub max_error: f64,
    /// The same over the diagonal of the box around the mesh.
    pub max_error_over_size: f64,
    /// Errors over the tolerances of frames: at most 1 is good; 0 without frames.
    pub over_tolerance: f64,
    /// Conversion from bytes to bytes, milliseconds.
    pub ms: f64,
}

/// Reads a `frames.json`.
///
/// # Errors
/// [`CheckError::Read`] and [`CheckError::List`].
pub fn read_frames(path: &Path) -> Result<Vec<Frame>, CheckError> {
    let text = read(path)?;
    serde_json::from_slice(&text).map_err(|source| CheckError::List {
        path: path.to_owned(),
        source,
    })
}

/// The vertices of an OBJ file.
///
/// # Errors
/// [`CheckError::Read`].
pub fn read_obj(path: &Path) -> Result<Vec<DVec3>, CheckError> {
    let bytes = read(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let vertex = |line: &str| {
        let mut numbers = line.strip_prefix("v ")?.split_whitespace().map(str::parse);
        let mut next = || numbers.next()?.ok();
        Some(DVec3::new(next()?, next()?, next()?))
    };
    Ok(text
        .lines()
        .filter_map(|line| vertex(line.trim_start()))
        .collect())
}

fn read(path: &Path) -> Result<Vec<u8>, CheckError> {
    std::fs::read(path).map_err(|source| CheckError::Read {
        path: path.to_owned(),
        source,
    })
}

/// Diagonal of the box around points.
pub fn box_size(points: &[DVec3]) -> f64 {
    let low = points.iter().fold(DVec3::INFINITY, |a, b| a.min(*b));
    let high = points.iter().fold(DVec3::NEG_INFINITY, |a, b| a.max(*b));
    if points.is_empty() {
        0.0
    } else {
        (high - low).length()
    }
}

/// Converts `path`, reads the result back and holds it against those of `frames` that are its own;
/// without any, against ufbx at up to `poses` of the file's frames in each clip.
///
/// # Errors
/// [`CheckError`].
pub fn check_file(
    path: &Path,
    frames: &[(PathBuf, Frame)],
    poses: usize,
    options: &Options,
) -> Result<FileCheck, CheckError> {
    let bytes = read(path)?;
    let origin = Origin {
        name: path.display().to_string(),
        folder: path.parent().map(Path::to_owned),
        ..Origin::default()
    };
    let began = Instant::now();
    let conversion = convert(&bytes, &origin, options)?;
    let glb = conversion.to_glb()?;
    let ms = began.elapsed().as_secs_f64() * 1e3;
    let played = Played::read(&glb)?;
    let truth = Truth::load(&bytes, &origin)?;
    let mut check = FileCheck {
        conversion,
        glb,
        frames: 0,
        max_error: 0.0,
        max_error_over_size: 0.0,
        over_tolerance: 0.0,
        ms,
    };
    for (obj, frame) in frames {
        check.frame(obj, frame, &played, &truth)?;
    }
    if check.frames == 0 {
        check.against_ufbx(poses, &played, &truth)?;
    }
    Ok(check)
}

impl FileCheck {
    fn frame(
        &mut self,
        obj: &Path,
        frame: &Frame,
        played: &Played,
        truth: &Truth,
    ) -> Result<(), CheckError> {
        let clips = &self.conversion.model.clips;
        let number = match &frame.clip {
            None => (!clips.is_empty()).then_some(0),
            Some(part) => {
                let found = clips.iter().position(|clip| clip.name.contains(&**part));
                Some(found.ok_or_else(|| CheckError::NoClip(part.clone()))?)
            }
        };
        let begin = number.map_or(0.0, |number| clips[number].begin);
        let (shapes, _) = played.at(number, frame.seconds - begin);
        let space = truth.space();
        let points = shapes.iter().flat_map(|shape| &shape.points);
        let points: Vec<DVec3> = points.map(|p| space.from_gltf(*p)).collect();
        let wanted = read_obj(obj)?;
        let error = hausdorff(&points, &wanted);
        self.frames += 1;
        self.max_error = self.max_error.max(error);
        self.max_error_over_size = self.max_error_over_size.max(error / box_size(&wanted));
        self.over_tolerance = self.over_tolerance.max(error / frame.tolerance);
        Ok(())
    }

    /// Vertex by vertex.
    fn against_ufbx(
        &mut self,
        poses: usize,
        played: &Played,
        truth: &Truth,
    ) -> Result<(), CheckError> {
        let (sources, space) = (self.conversion.sources(), truth.space());
        let mut hold =
            |clip: Option<usize>, time: f64, on_the_clock: f64| -> Result<(), CheckError> {
                let (shapes, _) = played.at(clip, time);
                let (bodies, _) = truth.at(clip, on_the_clock)?;
                let error = vertex_error(&shapes, &bodies, &space, &sources) / space.unit;
                let all: Vec<DVec3> = bodies
                    .iter()
                    .flat_map(|body| body.points.iter().copied())
                    .collect();
                self.max_error = self.max_error.max(error);
                if error > 0.0 {
                    self.max_error_over_size = self.max_error_over_size.max(error / box_size(&all));
                }
                Ok(())
            };
        hold(None, 0.0, 0.0)?;
        for (number, clip) in self.conversion.model.clips.iter().enumerate() {
            let frames = (clip.duration * truth.frames_per_second()).round().max(1.0);
            let step = (frames / poses.max(1) as f64).ceil().max(1.0);
            let mut frame = 0.0;
            while frame <= frames {
                let time = (frame / truth.frames_per_second()).min(clip.duration);
                hold(Some(number), time, clip.begin + time)?;
                frame += step;
            }
        }
        Ok(())
    }
}
