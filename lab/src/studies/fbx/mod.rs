//! Study `fbx`: every FBX file below a folder, converted, read back, played and held against what it
//! should be.
//!
//! One JSON object a line and file goes to standard output. A file with reference frames (a
//! `frames.json` in the folder; meshes that the programs deformed which made the file) is held against
//! them, others against ufbx, vertex by vertex at the file's frames. Where FBX2glTF (`FBX2GLTF` names
//! its binary) or Assimp (`assimp` on the path) are installed, their results are held against the same.
//!
//! The cases of `data/field/fbx` in the shared data are held against the values that are right for them, a line each.

mod baselines;
mod compared;
mod field;
mod file;
mod line;
mod time;

pub use file::{FbxFile, files_below};
pub use line::Line;

use crate::csv::{ErrorNumbers, Row};
use crate::study::{Asked, Options, Report, Study};
use serde_json::json;
use std::path::{Path, PathBuf};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "fbx",
    about: "FBX files to glTF: error against reference frames and ufbx, beside FBX2glTF and Assimp",
    run,
    asked: &ASKED,
};

/// What its measured table says.
const ASKED: [Asked; 2] = [
    Asked {
        what: "Files of the folder that make a conversion panic",
        asked: "0",
        at: "/panics",
        unit: "files",
    },
    Asked {
        what: "Cases from the field that are not right",
        asked: "0",
        at: "/field_wrong",
        unit: "files",
    },
];

/// Poses of a clip that a file without reference frames is held at.
const POSES: usize = 24;

/// The folder that is taken where none is named.
fn shared() -> PathBuf {
    std::env::var_os("DOLOMITE_SHARED")
        .map_or_else(|| PathBuf::from("../shared"), PathBuf::from)
        .join("data/fbx")
}

fn run(options: &Options) -> Report {
    let folder = options.folder.clone().unwrap_or_else(shared);
    let mut notes = Vec::new();
    let files = match files_below(&folder) {
        Ok(files) => files,
        Err(reason) => {
            notes.push(reason);
            Vec::new()
        }
    };
    let baselines = baselines::Baselines::find(&mut notes);
    let mut lines = Vec::with_capacity(files.len());
    for file in &files {
        let line = Line::of(file, &baselines, options, POSES);
        // The lines are the study's result as they come; the table is written at the end.
        println!("{}", line.to_json());
        lines.push(line);
    }
    let field = field::held(&mut notes);
    report(&lines, &field, notes, &folder)
}

/// The middle of some numbers; 0 of none.
fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(0.0)
}

fn report(lines: &[Line], field: &[field::Held], notes: Vec<String>, folder: &Path) -> Report {
    let good: Vec<&Line> = lines.iter().filter(|line| line.error.is_none()).collect();
    let framed: Vec<&&Line> = good.iter().filter(|line| line.frames > 0).collect();
    let dual = |line: &Line| line.lost.iter().any(|lost| lost == "dual-quaternion");
    let ratio = |pick: fn(&Line) -> (f64, f64)| {
        let (a, b) = good
            .iter()
            .map(|line| pick(line))
            .fold((0.0, 0.0), |s, p| (s.0 + p.0, s.1 + p.1));
        if b > 0.0 { a / b } else { 0.0 }
    };
    let summary = json!({
        "folder": folder.display().to_string(),
        "files": lines.len(),
        "converted": good.len(),
        "panics": lines.iter().filter(|line| line.panicked).count(),
        "files_with_frames": framed.len(),
        "frames_within_tolerance": framed.iter().all(|line| dual(line) || line.over_tolerance <= 1.0),
        "median_error_over_size": median(framed.iter().map(|line| line.max_error_over_size).collect()),
        "conversion_over_load": ratio(|line| (line.timed_ms, line.load_ms)),
        "median_conversion_over_load": median(
            good.iter().filter(|line| line.load_ms > 0.0).map(|line| line.timed_ms / line.load_ms).collect()
        ),
        "baselines": compared::compared(&good),
        "field_cases": field.len(),
        "field_wrong": field.iter().filter(|held| held.wrong.is_some()).count(),
    });
    eprintln!("fbx: {summary:#}");
    Report {
        study: STUDY.name,
        rows: lines.iter().flat_map(rows).collect(),
        figures: Vec::new(),
        notes,
        summary,
    }
}

fn rows(line: &Line) -> Vec<Row> {
    let row = |method: &str, error: Option<f64>, ms: Option<f64>, bytes: Option<usize>| Row {
        sweep: line.file.clone(),
        method: method.into(),
        parameter: String::new(),
        parameter_value: 0.0,
        quantity: "position over size".into(),
        error: error.map(|max| ErrorNumbers {
            max,
            rms: f64::NAN,
            p99: f64::NAN,
        }),
        error_unit: "diagonal of the model".into(),
        time_ns: ms.map(|ms| ms * 1e6),
        bytes,
        vertices: None,
        hash: None,
        device: "CPU".into(),
    };
    if line.error.is_some() {
        return vec![row("refused", None, None, None)];
    }
    let mut rows = vec![row(
        "dolomite_fbx",
        Some(line.max_error_over_size),
        Some(line.timed_ms),
        Some(line.bytes),
    )];
    rows.extend(line.baselines.iter().map(|baseline| {
        row(
            baseline.name,
            baseline.error_over_size,
            None,
            baseline.bytes,
        )
    }));
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_that_is_not_there_is_a_note() {
        let options = Options {
            folder: Some("no/such/folder".into()),
            ..Options::default()
        };
        let report = run(&options);
        assert!(report.rows.is_empty());
        assert!(
            report
                .notes
                .iter()
                .any(|note| note.contains("no/such/folder")),
            "{:?}",
            report.notes
        );
    }

    #[test]
    fn a_broken_file_is_a_line_with_an_error() {
        let folder = std::env::temp_dir().join(format!("dolomite_lab_fbx_{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("broken.fbx"), "no FBX").unwrap();
        let files = files_below(&folder).unwrap();
        let line = Line::of(
            &files[0],
            &baselines::Baselines::default(),
            &Options::default(),
            1,
        );
        assert_eq!(line.file, "broken.fbx");
        assert!(
            line.error
                .as_ref()
                .is_some_and(|error| error.contains("broken.fbx")),
            "{line:?}"
        );
        assert_eq!(line.to_json()["ok"], false);
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn medians() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![]), 0.0);
    }
}
