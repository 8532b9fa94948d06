//! What frames cost along a fixed path, and how long the first ones take, as JSON.
//!
//! | file | concern |
//! |---|---|
//! | [`mod@path`] | where the camera is at a moment |
//! | [`mod@parts`], [`mod@spans`] | what each part of a frame costs |
//! | [`mod@start`] | from the start of the process to the settled picture |
//! | [`mod@city`] | ways to make the triangles of a city |
//! | [`mod@classic`] | the scene to compare methods on |

pub mod city;
pub mod classic;
pub mod parts;
pub mod path;
pub mod spans;
pub mod start;

use std::collections::BTreeMap;
use std::path::{Path as FilePath, PathBuf};
use std::time::{Duration, Instant};

use bevy::diagnostic::DiagnosticsStore;
use bevy::prelude::*;
use dolomite::tessellation::render::GeometryStats;
use serde::Serialize;
use thiserror::Error;

use crate::play::camera::FreeCamera;
use crate::run::offscreen::{Offscreen, OffscreenError, STEP};
use crate::run::{GameError, Setup};
use crate::scene::CurrentScene;
use crate::view::passes::{Clock, pass_of};
use classic::methods::{MethodError, Methods};
use parts::Part;
use path::Path;

/// How often a flight says where it is.
const SAID: Duration = Duration::from_secs(1);

/// Why the bench failed.
#[derive(Debug, Error)]
pub enum BenchError {
    /// The game failed.
    #[error(transparent)]
    Game(#[from] GameError),
    /// A way to make triangles was refused.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// The bot did not play.
    #[error(transparent)]
    Bot(#[from] crate::bot::BotError),
    /// No frame was asked for.
    #[error("0 frames: ask for at least 1 with `--frames`")]
    NoFrames,
    /// The start cannot be measured so.
    #[error("`--path start` {0}")]
    Start(&'static str),
    /// The start was not measured to its end.
    #[error("the start was not measured to its end: {0}")]
    NotStarted(String),
    /// The report cannot be written.
    #[error("report {}: {source}; check that the folder exists", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

impl From<OffscreenError> for BenchError {
    fn from(error: OffscreenError) -> Self {
        Self::Game(error.into())
    }
}

/// What one frame cost. Times are milliseconds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Frame {
    /// Number of the frame, from 0.
    pub index: u32,
    /// Real time from the start of the frame until the device had finished it: simulation,
    /// recording and drawing one after the other, without overlap.
    pub frame_ms: f64,
    /// Triangles drawn.
    pub triangles: u32,
    /// Vertices emitted.
    pub vertices: u32,
    /// Patches in the view.
    pub patches_drawn: u32,
    /// Patches outside the view.
    pub patches_culled: u32,
    /// Compute dispatches of the tessellation.
    pub dispatches: u32,
    /// Bytes of vertices and indices.
    pub bytes: u64,
    /// Those of them that the CPU made and uploaded.
    pub uploaded: u64,
    /// GPU time of each pass whose measurement arrived in this frame (two or three frames after
    /// the pass ran).
    pub gpu_ms: BTreeMap<String, f64>,
    /// CPU time of each pass, likewise.
    pub cpu_ms: BTreeMap<String, f64>,
}

/// Median and 99th percentile (nearest rank).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Half of the values are at most this.
    pub median: f64,
    /// 99 of 100 values are at most this.
    pub p99: f64,
}

/// Times of one pass over all frames, milliseconds.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PassTimes {
    /// On the GPU; absent where the device has no timestamps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gpu_ms: Option<Spread>,
    /// On the CPU.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cpu_ms: Option<Spread>,
}

/// All frames in one view. Counts are medians over the frames, `dispatches` and `uploaded` sums.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Scene.
    pub scene: String,
    /// Path.
    pub path: String,
    /// Who tessellates, and when.
    pub mode: &'static str,
    /// By what rule.
    pub metric: &'static str,
    /// Whether patches outside of the frustum of the classic scene are left out.
    pub cull: bool,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Device that drew.
    pub device: String,
    /// Build of this program: `release` or `debug`.
    pub build: &'static str,
    /// Number of frames.
    pub frames: u32,
    /// Time of a frame, milliseconds.
    pub frame_ms: Spread,
    /// Times of the passes by name.
    pub passes: BTreeMap<String, PassTimes>,
    /// Triangles drawn.
    pub triangles: u64,
    /// Vertices emitted.
    pub vertices: u64,
    /// Bytes of vertices and indices.
    pub bytes: u64,
    /// Compute dispatches of the tessellation in all frames together; 0 for a settled still view.
    pub dispatches: u64,
    /// Bytes of vertices and indices that the CPU uploaded in all frames together.
    pub uploaded: u64,
    /// Patches in the view.
    pub patches_drawn: u64,
    /// Patches outside the view.
    pub patches_culled: u64,
}

/// What the bench writes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// All frames in one view.
    pub summary: Summary,
    /// The parts of a frame at the start of the path; none where they were not asked for.
    pub parts: Vec<Part>,
    /// A row each.
    pub frames: Vec<Frame>,
}

/// Settles at the start of `path`, flies `frames` steps of a sixtieth of a second of it, measures the parts of a
/// frame in so many `turns` off and on (0: not at all), and writes the report to `file`, or to standard output. Progress goes to standard error.
///
/// # Errors
/// [`BenchError`]: no device, a wrong size, no frames, a file that cannot be written.
pub fn bench(
    setup: Setup,
    path: Path,
    size: UVec2,
    frames: u32,
    turns: u32,
    file: Option<&FilePath>,
) -> Result<Report, BenchError> {
    if frames == 0 {
        return Err(BenchError::NoFrames);
    }
    check_file(file)?;
    let scene = setup.scene.clone();
    let mut offscreen = Offscreen::new(setup, size)?;
    if turns > 0 {
        parts::prepare(&mut offscreen.app);
    }
    let rows = fly(&mut offscreen, path, &scene, frames)?;
    let summary = summary(&rows, &offscreen, path, &scene, size);
    let parts = match turns {
        0 => Vec::new(),
        turns => parts::measure(&mut offscreen, path, &scene, turns, &summary.passes)?,
    };
    let report = Report {
        summary,
        parts,
        frames: rows,
    };
    tell(file, &report)?;
    Ok(report)
}

/// Fails before minutes of work are lost to a wrong folder.
fn check_file(file: Option<&FilePath>) -> Result<(), BenchError> {
    file.map_or(Ok(()), |file| write(file, "{}"))
}

/// Writes a report to a file, or to standard output.
fn tell(file: Option<&FilePath>, report: &impl Serialize) -> Result<(), BenchError> {
    let text = serde_json::to_string_pretty(report)
        .expect("numbers, strings and maps with string keys always become JSON");
    match file {
        Some(file) => {
            write(file, &text)?;
            eprintln!("dolomite: wrote {}", file.display());
        }
        None => println!("{text}"),
    }
    Ok(())
}

/// Settles at the start of `path` and flies `frames` steps of it.
fn fly(
    offscreen: &mut Offscreen,
    path: Path,
    scene: &CurrentScene,
    frames: u32,
) -> Result<Vec<Frame>, BenchError> {
    put_camera(&mut offscreen.app, path, scene, 0.0);
    offscreen.settle()?;
    let mut rows = Vec::with_capacity(frames as usize);
    let mut seen = BTreeMap::new();
    new_times(&offscreen.app, &mut seen);
    let mut said = Instant::now();
    for index in 0..frames {
        put_camera(
            &mut offscreen.app,
            path,
            scene,
            index as f32 * STEP.as_secs_f32(),
        );
        let start = Instant::now();
        offscreen.step(STEP)?;
        let time = start.elapsed();
        rows.push(frame(index, time, &offscreen.app, &mut seen));
        if said.elapsed() > SAID || index + 1 == frames {
            said = Instant::now();
            eprintln!(
                "dolomite: {} {}: frame {} of {frames}, {:.1} ms",
                scene.name,
                path.name(),
                index + 1,
                time.as_secs_f64() * 1e3,
            );
        }
    }
    Ok(rows)
}

/// Build of this program.
const fn build() -> &'static str {
    if cfg!(debug_assertions) {
        "debug"
    } else {
        "release"
    }
}

fn write(path: &FilePath, text: &str) -> Result<(), BenchError> {
    std::fs::write(path, text).map_err(|source| BenchError::Write {
        path: path.to_owned(),
        source,
    })
}

fn put_camera(app: &mut App, path: Path, scene: &CurrentScene, seconds: f32) {
    let pose = path.pose(scene, seconds);
    let world = app.world_mut();
    let mut cameras = world.query::<&mut FreeCamera>();
    let mut found = false;
    for mut camera in cameras.iter_mut(world) {
        found = true;
        let next = FreeCamera { pose, ..*camera };
        camera.set_if_neq(next);
    }
    // Before the first update there is no camera yet: it starts where the scene says.
    if !found {
        world.resource_mut::<CurrentScene>().0.camera = pose;
    }
}

fn frame(
    index: u32,
    time: Duration,
    app: &App,
    seen: &mut BTreeMap<String, bevy::platform::time::Instant>,
) -> Frame {
    let stats = app
        .world()
        .get_resource::<GeometryStats>()
        .cloned()
        .unwrap_or_default();
    let (gpu_ms, cpu_ms) = new_times(app, seen);
    Frame {
        index,
        frame_ms: time.as_secs_f64() * 1e3,
        triangles: stats.primitives,
        vertices: stats.vertices,
        patches_drawn: stats.seen(),
        patches_culled: stats.discarded,
        dispatches: stats.dispatches,
        bytes: stats.bytes,
        uploaded: stats.uploaded,
        gpu_ms,
        cpu_ms,
    }
}

/// Pass times, in milliseconds, that arrived since `seen` was last brought up to date.
fn new_times(
    app: &App,
    seen: &mut BTreeMap<String, bevy::platform::time::Instant>,
) -> (BTreeMap<String, f64>, BTreeMap<String, f64>) {
    let mut times = (BTreeMap::new(), BTreeMap::new());
    let Some(diagnostics) = app.world().get_resource::<DiagnosticsStore>() else {
        return times;
    };
    for diagnostic in diagnostics.iter() {
        let (Some(newest), path) = (diagnostic.measurement(), diagnostic.path().as_str()) else {
            continue;
        };
        let (into, name) = if let Some(name) = pass_of(diagnostic, Clock::Gpu) {
            (&mut times.0, name)
        } else if let Some(name) = pass_of(diagnostic, Clock::Cpu) {
            (&mut times.1, name)
        } else {
            continue;
        };
        if seen.insert(path.to_owned(), newest.time) != Some(newest.time) {
            into.insert(name.to_owned(), newest.value);
        }
    }
    times
}

fn summary(
    rows: &[Frame],
    offscreen: &Offscreen,
    path: Path,
    scene: &CurrentScene,
    size: UVec2,
) -> Summary {
    let methods = offscreen.app.world().get_resource::<Methods>();
    let methods = methods.copied().unwrap_or_default();
    let device = offscreen.device.name.clone();
    summed(rows, &scene.name, path, size, device, methods)
}

fn summed(
    rows: &[Frame],
    scene: &str,
    path: Path,
    size: UVec2,
    device: String,
    methods: Methods,
) -> Summary {
    let mut passes: BTreeMap<String, PassTimes> = BTreeMap::new();
    for name in rows
        .iter()
        .flat_map(|row| row.gpu_ms.keys().chain(row.cpu_ms.keys()))
    {
        passes.entry(name.clone()).or_default();
    }
    for (name, times) in &mut passes {
        let of = |times: fn(&Frame) -> &BTreeMap<String, f64>| {
            spread(rows.iter().filter_map(|row| times(row).get(name).copied()))
        };
        times.gpu_ms = of(|row| &row.gpu_ms);
        times.cpu_ms = of(|row| &row.cpu_ms);
    }
    let median = |count: fn(&Frame) -> u64| {
        spread(rows.iter().map(|row| count(row) as f64)).map_or(0, |spread| spread.median as u64)
    };
    Summary {
        scene: scene.to_owned(),
        path: path.name().to_owned(),
        mode: methods.mode.name(),
        metric: methods.metric.name(),
        cull: methods.settings().culls(),
        size: size.to_array(),
        device,
        build: build(),
        frames: rows.len() as u32,
        frame_ms: spread(rows.iter().map(|row| row.frame_ms)).unwrap_or(Spread {
            median: 0.0,
            p99: 0.0,
        }),
        passes,
        triangles: median(|row| row.triangles.into()),
        vertices: median(|row| row.vertices.into()),
        bytes: median(|row| row.bytes),
        dispatches: rows.iter().map(|row| u64::from(row.dispatches)).sum(),
        uploaded: rows.iter().map(|row| row.uploaded).sum(),
        patches_drawn: median(|row| row.patches_drawn.into()),
        patches_culled: median(|row| row.patches_culled.into()),
    }
}

/// Median and 99th percentile by nearest rank; `None` without values.
fn spread(values: impl Iterator<Item = f64>) -> Option<Spread> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let rank = |share: f64| {
        let rank = (share * values.len() as f64).ceil() as usize;
        values.get(rank.max(1) - 1).copied()
    };
    Some(Spread {
        median: rank(0.5)?,
        p99: rank(0.99)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(index: u32, frame_ms: f64, dispatches: u32, gpu: Option<f64>) -> Frame {
        Frame {
            index,
            frame_ms,
            triangles: 10 * index,
            vertices: 20,
            patches_drawn: 3,
            patches_culled: 4,
            dispatches,
            bytes: 5,
            uploaded: 7,
            gpu_ms: gpu.map(|ms| ("sky".to_owned(), ms)).into_iter().collect(),
            cpu_ms: BTreeMap::new(),
        }
    }

    #[test]
    fn percentiles_are_of_nearest_rank() {
        let spread = spread((1..=100).rev().map(f64::from)).unwrap();
        assert_eq!((spread.median, spread.p99), (50.0, 99.0));
        assert_eq!(super::spread([7.0].into_iter()).unwrap().p99, 7.0);
        assert_eq!(super::spread(std::iter::empty()), None);
    }

    #[test]
    fn the_summary_takes_medians_and_sums_dispatches() {
        let rows = [
            row(0, 5.0, 0, None),
            row(1, 1.0, 2, Some(0.5)),
            row(2, 3.0, 3, Some(0.7)),
        ];
        let methods = Methods::default();
        let summary = summed(
            &rows,
            "s",
            Path::Fly,
            UVec2::new(8, 9),
            "d".to_owned(),
            methods,
        );
        assert_eq!((summary.mode, summary.uploaded), ("gpu", 21));
        assert_eq!(
            summary.frame_ms,
            Spread {
                median: 3.0,
                p99: 5.0
            }
        );
        assert_eq!((summary.dispatches, summary.triangles), (5, 10));
        let sky = &summary.passes["sky"];
        assert_eq!(
            sky.gpu_ms,
            Some(Spread {
                median: 0.5,
                p99: 0.7
            })
        );
        assert_eq!(sky.cpu_ms, None);
        let json = serde_json::to_value(&summary).unwrap();
        assert_eq!(json["passes"]["sky"]["gpu_ms"]["median"], 0.5);
        assert_eq!(json["size"][1], 9);
    }
}
