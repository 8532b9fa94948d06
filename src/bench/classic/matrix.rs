//! The bench over all ways to make the triangles of the classic scene: every mode, filled, as lines,
//! and both.

use std::fmt::Write;
use std::path::Path as FilePath;

use bevy::prelude::*;
use serde::Serialize;

use super::methods::{Methods, Mode};
use crate::bench::path::Path;
use crate::bench::{self, BenchError, Spread, Summary};
use crate::play::Switches;
use crate::run::Setup;
use crate::run::offscreen::Offscreen;

/// What is drawn of the triangles: their name, fill, lines.
pub const SHOWN: [(&str, bool, bool); 3] = [
    ("fill", true, false),
    ("lines", false, true),
    ("both", true, true),
];

/// A mode, drawn in one way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The mode.
    pub mode: &'static str,
    /// What is drawn, as in [`SHOWN`].
    pub shown: &'static str,
    /// All of its frames in one view.
    pub summary: Summary,
}

/// Flies `frames` of `path` in every mode and way of drawing, each after it has settled at the start.
/// Writes the rows to `file` if there is one. Progress goes to standard error.
///
/// # Errors
/// [`BenchError`]: no device, a wrong size, no frames, a file that cannot be written.
pub fn matrix(
    setup: Setup,
    path: Path,
    size: UVec2,
    frames: u32,
    file: Option<&FilePath>,
) -> Result<Vec<Row>, BenchError> {
    if frames == 0 {
        return Err(BenchError::NoFrames);
    }
    if let Some(file) = file {
        bench::write(file, "[]")?;
    }
    let scene = setup.scene.clone();
    let mut offscreen = Offscreen::new(setup, size)?;
    let methods = *offscreen.app.world().resource::<Methods>();
    let mut rows = Vec::new();
    for mode in Mode::ALL {
        for (shown, fill, lines) in SHOWN {
            let world = offscreen.app.world_mut();
            world.insert_resource(Methods { mode, ..methods });
            let switches = *world.resource::<Switches>();
            world.insert_resource(Switches {
                fill,
                lines,
                ..switches
            });
            let flown = bench::fly(&mut offscreen, path, &scene, frames)?;
            let row = Row {
                mode: mode.name(),
                shown,
                summary: bench::summary(&flown, &offscreen, path, &scene, size),
            };
            let Spread { median, p99 } = row.summary.frame_ms;
            eprintln!(
                "dolomite: {} {shown}: median {median:.1} ms, p99 {p99:.1} ms",
                row.mode
            );
            rows.push(row);
        }
    }
    if let Some(file) = file {
        let text = serde_json::to_string_pretty(&rows)
            .expect("numbers, strings and maps with string keys always become JSON");
        bench::write(file, &text)?;
    }
    Ok(rows)
}

/// The rows as a table in Markdown. Bytes kept are those of vertices and indices in the last frame;
/// uploads and dispatches are means over the frames.
pub fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "| mode | shown | median ms | p99 ms | triangles | vertices | MB kept | MB uploaded a frame | \
         dispatches a frame |\n|---|---|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    for Row {
        mode,
        shown,
        summary,
    } in rows
    {
        let frames = f64::from(summary.frames.max(1));
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {mode} | {shown} | {:.1} | {:.1} | {} | {} | {:.1} | {:.1} | {:.1} |",
            summary.frame_ms.median,
            summary.frame_ms.p99,
            summary.triangles,
            summary.vertices,
            summary.bytes as f64 / 1e6,
            summary.uploaded as f64 / 1e6 / frames,
            summary.dispatches as f64 / frames,
        );
    }
    text
}
