//! What is said of one file.

use super::baselines::{Baseline, Baselines};
use super::file::FbxFile;
use super::time::timed;
use crate::study::Options as LabOptions;
use dolomite_fbx::check::{FileCheck, check_file};
use dolomite_fbx::{Options, Weights};
use serde_json::{Value, json};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

/// One file's result. Lengths are in the file's own unit, which `unit` says in metres.
#[derive(Debug, Clone, Default)]
pub struct Line {
    /// Below the folder.
    pub file: String,
    /// Why it was refused.
    pub error: Option<String>,
    /// The conversion panicked.
    pub panicked: bool,
    /// Reference frames that it was held against; 0: against ufbx.
    pub frames: usize,
    /// Largest error.
    pub max_error: f64,
    /// The same over the diagonal of the model.
    pub max_error_over_size: f64,
    /// Largest error over its frame's tolerance.
    pub over_tolerance: f64,
    /// Animation stacks.
    pub clips: usize,
    /// Of the .glb.
    pub bytes: usize,
    /// Bytes of keys and times.
    pub animation_bytes: usize,
    /// Of the first conversion, milliseconds.
    pub ms: f64,
    /// The least of several conversions, and of as many times that ufbx alone loads the file.
    pub timed_ms: f64,
    /// See [`Line::timed_ms`].
    pub load_ms: f64,
    /// Error that the conversion states of its keys and weights, metres.
    pub stated_error: f64,
    /// Metres.
    pub unit: f64,
    /// What is lost, by kind.
    pub lost: Vec<String>,
    /// What others make of the file.
    pub baselines: Vec<Baseline>,
}

impl Line {
    /// Converts a file and looks at what came out; writes the .glb into the lab's folder.
    pub fn of(file: &FbxFile, baselines: &Baselines, lab: &LabOptions, poses: usize) -> Self {
        let began = Instant::now();
        let options = Options {
            weights: Weights::Four,
            ..Options::default()
        };
        let result = catch_unwind(AssertUnwindSafe(|| {
            check_file(&file.path, &file.frames, poses, &options)
        }));
        let mut line = Self {
            file: file.name.clone(),
            ..Self::default()
        };
        match result {
            Ok(Ok(check)) => {
                line.fill(&check);
                line.write(&check.glb, lab);
                (line.timed_ms, line.load_ms) = timed(&file.path, lab.repeats);
                line.baselines = baselines.of(file, &check, poses);
            }
            Ok(Err(error)) => line.error = Some(error.to_string()),
            Err(_) => {
                line.panicked = true;
                line.error = Some(format!("{}: a panic", file.name));
            }
        }
        if line.error.is_some() {
            line.ms = began.elapsed().as_secs_f64() * 1e3;
        }
        line
    }

    fn fill(&mut self, check: &FileCheck) {
        let report = &check.conversion.report;
        self.frames = check.frames;
        self.max_error = check.max_error;
        self.max_error_over_size = check.max_error_over_size;
        self.over_tolerance = check.over_tolerance;
        self.clips = report.clips.len();
        self.bytes = check.glb.len();
        self.animation_bytes = report.animation_bytes;
        self.ms = check.ms;
        self.stated_error = report.error();
        self.unit = report.unit;
        self.lost = report
            .lost
            .iter()
            .map(|lost| lost.what.to_owned())
            .collect();
        self.lost.dedup();
    }

    fn write(&mut self, glb: &[u8], lab: &LabOptions) {
        let Some(out) = &lab.out else { return };
        let path = out
            .join("fbx")
            .join(format!("{}.glb", self.file.replace('/', "__")));
        let folder = path.parent().map_or(Ok(()), std::fs::create_dir_all);
        if let Err(error) = folder.and_then(|()| std::fs::write(&path, glb)) {
            eprintln!("fbx: {}: {error}", path.display());
        }
    }

    /// The line that is printed.
    pub fn to_json(&self) -> Value {
        if let Some(error) = &self.error {
            return json!({ "file": self.file, "ok": false, "error": error, "ms": self.ms, "panicked": self.panicked });
        }
        json!({
            "file": self.file,
            "ok": true,
            "against": if self.frames > 0 { "frames" } else { "ufbx" },
            "frames": self.frames,
            "max_error": self.max_error,
            "max_error_over_size": self.max_error_over_size,
            "over_tolerance": self.over_tolerance,
            "clips": self.clips,
            "bytes": self.bytes,
            "animation_bytes": self.animation_bytes,
            "ms": self.ms,
            "least_ms": self.timed_ms,
            "load_ms": self.load_ms,
            "stated_error_m": self.stated_error,
            "unit_m": self.unit,
            "lost": self.lost,
            "baselines": self.baselines.iter().map(Baseline::to_json).collect::<Vec<_>>(),
        })
    }
}
