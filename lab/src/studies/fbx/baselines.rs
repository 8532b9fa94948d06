//! What other converters make of the same files.

use super::file::FbxFile;
use dolomite_fbx::Origin;
use dolomite_fbx::check::{FileCheck, Played, Truth, box_size, hausdorff, read_obj};
use glam::DVec3;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Converters that are installed.
#[derive(Debug, Default)]
pub struct Baselines {
    fbx2gltf: Option<PathBuf>,
    assimp: Option<PathBuf>,
}

/// A baseline's result.
#[derive(Debug, Clone, PartialEq)]
pub struct Baseline {
    /// Who.
    pub name: &'static str,
    /// The largest distance to the nearest vertex, both ways, over the diagonal of the model, and ours
    /// by the same measure; `None` where nothing came out that can be played.
    pub error_over_size: Option<f64>,
    /// See [`Baseline::error_over_size`].
    pub ours_over_size: f64,
    /// Of the result's keys and times.
    pub bytes: Option<usize>,
}

impl Baseline {
    /// For the line.
    pub fn to_json(&self) -> Value {
        json!({
            "name": self.name,
            "error_over_size": self.error_over_size,
            "ours_over_size": self.ours_over_size,
            "animation_bytes": self.bytes,
        })
    }
}

/// A pose to hold results at: clip, seconds from its start, and the vertices in glTF's world.
struct Pose {
    clip: Option<usize>,
    name: String,
    time: f64,
    points: Vec<DVec3>,
}

impl Baselines {
    /// Looks for the baselines; says what is missing.
    pub fn find(notes: &mut Vec<String>) -> Self {
        let fbx2gltf = std::env::var_os("FBX2GLTF")
            .map(PathBuf::from)
            .filter(|path| path.is_file());
        if fbx2gltf.is_none() {
            notes.push("FBX2glTF is left out: FBX2GLTF names no file (npm: fbx2gltf)".into());
        }
        let on_path = std::env::var_os("PATH").unwrap_or_default();
        let assimp = std::env::split_paths(&on_path)
            .map(|folder| folder.join("assimp"))
            .find(|path| path.is_file());
        if assimp.is_none() {
            notes.push("Assimp is left out: no `assimp` on the path (Debian: assimp-utils)".into());
        }
        Self { fbx2gltf, assimp }
    }

    /// What they make of a file.
    pub fn of(&self, file: &FbxFile, ours: &FileCheck, poses: usize) -> Vec<Baseline> {
        if self.fbx2gltf.is_none() && self.assimp.is_none() {
            return Vec::new();
        }
        let Some(poses) = self::poses(file, ours, poses) else {
            return Vec::new();
        };
        let Ok(played) = Played::read(&ours.glb) else {
            return Vec::new();
        };
        let ours_over_size = farthest(&played, &poses, 1.0).unwrap_or(f64::INFINITY);
        let unit = ours.conversion.report.unit;
        let out =
            std::env::temp_dir().join(format!("dolomite_baseline_{}.glb", std::process::id()));
        let mut results = Vec::new();
        let mut run = |name: &'static str, command: &mut Command| {
            // A file that is left from the one before would be taken for the result.
            let _ = std::fs::remove_file(&out);
            let ran = command
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .status();
            let glb = ran
                .ok()
                .filter(std::process::ExitStatus::success)
                .and_then(|_| std::fs::read(&out).ok());
            let played = glb.as_deref().and_then(|glb| Played::read(glb).ok());
            results.push(Baseline {
                name,
                error_over_size: played.as_ref().and_then(|played| {
                    // A result in the file's own unit is forgiven: it is held as one in metres.
                    let (a, b) = (
                        farthest(played, &poses, 1.0)?,
                        farthest(played, &poses, unit)?,
                    );
                    Some(a.min(b))
                }),
                ours_over_size,
                bytes: played.as_ref().map(Played::animation_bytes),
            });
        };
        let limited = |program: &Path| {
            let mut command = Command::new("timeout");
            command.arg("60").arg(program);
            command
        };
        if let Some(program) = &self.fbx2gltf {
            run(
                "FBX2glTF",
                limited(program)
                    .arg("-b")
                    .arg("-i")
                    .arg(&file.path)
                    .arg("-o")
                    .arg(&out),
            );
        }
        if let Some(program) = &self.assimp {
            run(
                "Assimp",
                limited(program)
                    .arg("export")
                    .arg(&file.path)
                    .arg(&out)
                    .arg("-fglb2"),
            );
        }
        let _ = std::fs::remove_file(&out);
        results
    }
}

/// Reference frames, or ufbx's poses at the file's frames.
fn poses(file: &FbxFile, ours: &FileCheck, count: usize) -> Option<Vec<Pose>> {
    let bytes = std::fs::read(&file.path).ok()?;
    let truth = Truth::load(
        &bytes,
        &Origin {
            name: file.name.clone(),
            ..Origin::default()
        },
    )
    .ok()?;
    let space = truth.space();
    let clips = &ours.conversion.model.clips;
    let mut out = Vec::new();
    for (obj, frame) in &file.frames {
        let clip = match &frame.clip {
            None => (!clips.is_empty()).then_some(0),
            Some(part) => clips.iter().position(|clip| clip.name.contains(&**part)),
        };
        out.push(Pose {
            clip,
            name: clip.map_or_else(String::new, |clip| clips[clip].name.clone()),
            time: frame.seconds - clip.map_or(0.0, |clip| clips[clip].begin),
            points: read_obj(obj)
                .ok()?
                .into_iter()
                .map(|p| space.to_gltf(p))
                .collect(),
        });
    }
    if out.is_empty() {
        let fps = truth.frames_per_second();
        for (number, clip) in clips.iter().enumerate() {
            let frames = (clip.duration * fps).round().max(1.0);
            let step = (frames / count as f64).ceil().max(1.0);
            let mut frame = 0.0;
            while frame <= frames {
                let time = (frame / fps).min(clip.duration);
                out.push(pose(&truth, Some(number), &clip.name, time, clip.begin)?);
                frame += step;
            }
        }
        if clips.is_empty() {
            out.push(pose(&truth, None, "", 0.0, 0.0)?);
        }
    }
    out.retain(|pose| !pose.points.is_empty());
    Some(out)
}

fn pose(truth: &Truth, clip: Option<usize>, name: &str, time: f64, begin: f64) -> Option<Pose> {
    let space = truth.space();
    let (bodies, _) = truth.at(clip, begin + time).ok()?;
    let points = bodies
        .iter()
        .flat_map(|body| &body.points)
        .map(|p| space.to_gltf(*p))
        .collect();
    Some(Pose {
        clip,
        name: name.to_owned(),
        time,
        points,
    })
}

/// The largest error over all poses, over the size of the model, of a result that is `scale` times too
/// large. Clips are found by their names.
fn farthest(played: &Played, poses: &[Pose], scale: f64) -> Option<f64> {
    let names = played.clips();
    let mut worst: Option<f64> = None;
    for pose in poses {
        let clip = match pose.clip {
            None => None,
            Some(_) if names.is_empty() => None,
            Some(number) => {
                let same = |(name, _): &(String, f64)| *name == pose.name;
                Some(
                    names
                        .iter()
                        .position(same)
                        .unwrap_or(number.min(names.len() - 1)),
                )
            }
        };
        let (shapes, _) = played.at(clip, pose.time);
        let points = shapes.into_iter().flat_map(|shape| shape.points);
        let points: Vec<DVec3> = points.map(|point| point * scale).collect();
        if points.is_empty() {
            return None;
        }
        let error = hausdorff(&points, &pose.points) / box_size(&pose.points).max(1e-12);
        worst = Some(worst.map_or(error, |worst| worst.max(error)));
    }
    worst
}
