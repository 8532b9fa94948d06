//! What a study is, and how its results are written.

use crate::csv::{Row, to_csv};
use crate::measured::Measurement;
use crate::page::Page;
use crate::plot::{Chart, PlotError, to_svg};
use clap::ValueEnum;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// What the study `lod` is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Part {
    /// Is any error above the tolerance?
    Guarantee,
    /// The same of the triangles that the adapter drew.
    Drawn,
    /// Are there gaps in the meshes?
    Cracks,
    /// Are the errors the same far from the origin?
    Precision,
    /// Time on the CPU.
    Time,
    /// Time of each pass on the adapter.
    Passes,
    /// How far do drawn vertices move from frame to frame?
    Pops,
    /// Vertices beside those of other methods.
    Vertices,
}

/// What every study is told.
#[derive(Debug, Clone)]
pub struct Options {
    /// Of the inputs; same seed, same inputs.
    pub seed: u32,
    /// Samples of each measurement.
    pub samples: usize,
    /// Sweeps of a kind, rays, receivers, or scenes; `None`: as many as the study says.
    pub count: Option<usize>,
    /// Timed runs of each measurement; the median counts.
    pub repeats: usize,
    /// Triangles of a timed tessellation.
    pub triangles: u32,
    /// Frames in which background pixels are counted.
    pub frames: usize,
    /// Cameras of `lod`.
    pub cameras: usize,
    /// Errors that methods of `lod` are tuned to, pixels.
    pub errors: Vec<f64>,
    /// Most vertices that the others of `lod` may draw, as a multiple of ours; `None`: as memory holds.
    pub most: Option<f64>,
    /// Pixels of a frame of `light`, `occlusion`, `scaling` and `far`, width and height.
    pub size: [u32; 2],
    /// Point and spot lights of `light` and `far`.
    pub lights: usize,
    /// What of `lod` is run; nothing named is all of it.
    pub parts: Vec<Part>,
    /// Walkers of `agents`, soldiers of `sight`.
    pub agents: usize,
    /// Where `fbx` looks for files; `None` is the shared data. Of `replay`: the recording; `None` makes one.
    pub folder: Option<PathBuf>,
    /// The program that moves balls by avian's `MoveAndSlide` for `bodies`; `None` leaves it out.
    pub avian: Option<PathBuf>,
    /// Where results besides tables and charts go; `None` keeps none.
    pub out: Option<PathBuf>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            seed: 1,
            samples: 1 << 16,
            count: None,
            repeats: 9,
            triangles: 1_000_000,
            frames: 1000,
            cameras: 100,
            errors: vec![16.0, 8.0],
            most: None,
            size: [320, 180],
            lights: 100,
            agents: 100_000,
            parts: Vec::new(),
            folder: None,
            avian: None,
            out: None,
        }
    }
}

/// A method against its oracle over a sweep of its knob.
#[derive(Clone, Copy)]
pub struct Study {
    /// As it is named on the command line and in file names.
    pub name: &'static str,
    /// One line on what is asked.
    pub about: &'static str,
    /// Runs it; progress goes to standard error.
    pub run: fn(&Options) -> Report,
    /// What its measured table has a row for.
    pub asked: &'static [Asked],
}

/// A number of a study's summary that has a row in a measured table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Asked {
    /// What is measured.
    pub what: &'static str,
    /// What is asked for; empty where nothing is.
    pub asked: &'static str,
    /// Where the number stands in the summary: a JSON pointer (RFC 6901).
    pub at: &'static str,
    /// Its unit.
    pub unit: &'static str,
}

/// A chart and the name of its file, without the ending.
#[derive(Debug, Clone)]
pub struct Figure {
    /// File name without `.svg`.
    pub name: String,
    /// One paragraph below it.
    pub caption: String,
    /// What is drawn.
    pub chart: Chart,
}

/// What came out.
#[derive(Debug, Clone)]
pub struct Report {
    /// The study's name.
    pub study: &'static str,
    /// Every measurement.
    pub rows: Vec<Row>,
    /// What is drawn of them.
    pub figures: Vec<Figure>,
    /// Methods that are left out, or have no error, and why; and what else a reader must know.
    pub notes: Vec<String>,
    /// The figures that the study was made for: ratios, largest errors.
    pub summary: Value,
}

/// Why nothing was written.
#[derive(Debug, Error)]
pub enum LabError {
    /// A file or folder could not be written.
    #[error("{}: {source}; choose another folder by --out", path.display())]
    Write {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A chart could not be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
}

impl Report {
    /// The whole report as one JSON object.
    pub fn to_json(&self) -> Value {
        json!({
            "study": self.study,
            "summary": self.summary,
            "notes": self.notes,
            "rows": self.rows,
        })
    }

    /// A row for each number of `asked` that the run has.
    #[must_use]
    pub fn measurements(&self, asked: &[Asked], command: &str) -> Vec<Measurement> {
        let numbers = asked.iter().filter_map(|asked| {
            let number = self.summary.pointer(asked.at)?;
            number.is_number().then(|| (asked, rounded(number)))
        });
        numbers
            .map(|(asked, reached)| Measurement {
                what: asked.what.into(),
                asked: asked.asked.into(),
                reached,
                unit: asked.unit.into(),
                command: command.into(),
            })
            .collect()
    }

    /// Writes `<study>.csv` and the figures into `folder`, which is made if need be, and gives the
    /// paths.
    ///
    /// # Errors
    /// [`LabError`].
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, LabError> {
        let mut files = vec![(format!("{}.csv", self.study), to_csv(&self.rows))];
        for figure in &self.figures {
            files.push((format!("{}.svg", figure.name), to_svg(&figure.chart)?));
        }
        files
            .into_iter()
            .map(|(name, text)| write_file(folder, &name, &text))
            .collect()
    }
}

/// Writes the page that shows the figures of `reports` into `folder`: charts, notes and numbers, all within it. `about`
/// says what a study is, `device` and `date` are those of the run.
///
/// # Errors
/// [`LabError`].
pub fn write_index(
    folder: &Path,
    reports: &[Report],
    about: impl Fn(&str) -> String,
    device: &str,
    date: &str,
) -> Result<PathBuf, LabError> {
    let mut page = Page::new(
        "Dolomite lab",
        "Run time against error, methods beside their baselines on the same inputs in one run.",
    );
    page.weak(&format!("Measured on {date}: {device}."));
    for report in reports {
        page.section(report.study, report.study);
        page.words(&about(report.study));
        for figure in &report.figures {
            page.figure(&to_svg(&figure.chart)?, &figure.caption);
        }
        page.list(report.notes.iter().map(String::as_str));
        page.weak(&format!("All rows: {}.csv beside this page.", report.study));
    }
    write_file(folder, "index.html", &page.finish())
}

/// Three digits: more are not the same in the next run.
fn rounded(number: &Value) -> Value {
    match number.as_f64() {
        Some(x) if !number.is_u64() && !number.is_i64() => format!("{x:.2e}")
            .parse::<f64>()
            .map_or(number.clone(), Value::from),
        _ => number.clone(),
    }
}

fn write_file(folder: &Path, name: &str, text: &str) -> Result<PathBuf, LabError> {
    let path = folder.join(name);
    std::fs::create_dir_all(folder)
        .and_then(|()| std::fs::write(&path, text))
        .map_err(|source| LabError::Write {
            path: path.clone(),
            source,
        })?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{Axes, Curve};

    fn report() -> Report {
        Report {
            study: "example",
            rows: Vec::new(),
            figures: vec![Figure {
                name: "example_time_error".into(),
                caption: "time < error".into(),
                chart: Chart {
                    title: "t".into(),
                    x_label: "x".into(),
                    y_label: "y".into(),
                    axes: Axes::Logarithmic,
                    curves: vec![Curve {
                        name: "a".into(),
                        colour: 0,
                        points: vec![(1.0, 2.0)],
                    }],
                },
            }],
            notes: vec!["a & b".into()],
            summary: json!({ "ratio": 2.0 }),
        }
    }

    fn scratch(name: &str) -> PathBuf {
        std::env::temp_dir().join(format!("dolomite_lab_{}_{name}", std::process::id()))
    }

    #[test]
    fn everything_is_written_and_the_page_shows_it() {
        let folder = scratch("write");
        let files = report().write(&folder).unwrap();
        assert_eq!(
            files,
            [
                folder.join("example.csv"),
                folder.join("example_time_error.svg")
            ]
        );
        let page = std::fs::read_to_string(
            write_index(
                &folder,
                &[report()],
                |_| "about it".into(),
                "a device",
                "2026-01-31",
            )
            .unwrap(),
        )
        .unwrap();
        assert!(page.contains("<svg") && page.contains("a &amp; b"));
        assert!(page.contains("about it"));
        assert!(page.contains("2026-01-31: a device"));
        assert!(page.contains("time &lt; error"));
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let file = scratch("file");
        std::fs::write(&file, "").unwrap();
        let refusal = report().write(&file.join("below")).unwrap_err().to_string();
        assert!(
            refusal.contains("below") && refusal.contains("--out"),
            "{refusal}"
        );
        std::fs::remove_file(file).unwrap();
    }

    #[test]
    fn what_a_run_has_becomes_a_row_and_what_it_lacks_none() {
        let asked = |at| Asked {
            what: "ratio",
            asked: "≤ 3",
            at,
            unit: "",
        };
        let report = Report {
            summary: json!({ "ratio": 2.012_345, "count": 1234 }),
            ..report()
        };
        let rows = report.measurements(
            &[asked("/ratio"), asked("/count"), asked("/none")],
            "dolomite_lab example",
        );
        let reached: Vec<_> = rows.iter().map(|row| row.reached.clone()).collect();
        assert_eq!(reached, [json!(2.01), json!(1234)]);
    }

    #[test]
    fn json_holds_the_summary() {
        assert_eq!(report().to_json()["summary"]["ratio"], 2.0);
    }
}
