//! The command line of `dolomite_lab`.

use crate::measured::{Topic, TopicError, commit, today};
use crate::studies::STUDIES;
use crate::studies::bodies::messages::ProgramError;
use crate::studies::bodies::program;
use crate::studies::sweep::case::{CaseError, run_case};
use crate::studies::tessellation::captures::{CaptureError, compare};
use crate::study::{LabError, Options, Part, Report, Study, write_index};
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};
use dolomite_testkit::gpu::Gpu;
use serde_json::Value;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Measures run time against error: Dolomite's methods against f64 oracles, beside other libraries.
#[derive(Debug, Parser)]
#[command(name = "dolomite_lab", version, after_help = study_list())]
pub struct Arguments {
    /// Name of a study, or `all`: every study, and a page that shows every figure
    #[arg(value_parser = known_study)]
    pub study: String,
    /// Of `fbx`: the folder whose FBX files are converted [default: those of the shared data]; of `replay`: the
    /// recording that is played [default: one that the seed makes]
    #[arg(value_name = "PATH")]
    pub folder: Option<PathBuf>,
    /// Seed of the inputs; same seed, same inputs
    #[arg(long, default_value_t = Options::default().seed)]
    pub seed: u32,
    /// Folder for the CSV, SVG and HTML files; made if need be
    #[arg(long, default_value = "target/lab")]
    pub out: PathBuf,
    /// Samples of each measurement; of `tessellation-stage`: pairs of patches
    #[arg(long, default_value_t = Options::default().samples, value_parser = sample_count)]
    pub samples: usize,
    /// Of studies of collision: sweeps of each kind, rays, crossings of triggers, rides on platforms, moves in
    /// rooms, movers beside Rapier's controller [default: 20000, 1000000, 20000, 20000, 100000 and 1000]; of `city`:
    /// points on sides, and samples of each tolerance; of `agents`, `sight` and `replay`: ticks [default: 640, 96 and
    /// 640]; of `paths`: ways [default: 10000]; of `shadow`: receivers [default: 200]; of `occlusion`: scenes [default: 2];
    /// of `scaling`: most objects and most lights [default: 4096 and 2048]
    #[arg(long)]
    pub count: Option<usize>,
    /// Of `sweep` alone: moves one ellipsoid through one list of triangles in place of the study, and prints what it
    /// touches. The file is one JSON object, metres: {"center": [x, y, z], "radii": [x, y, z], "way": [x, y, z],
    /// "triangles": [[[x, y, z], [x, y, z], [x, y, z]], ...]}, and, if it is to slide, "slide": true. Printed are
    /// "contacts" (time, triangle, feature, point, normal, depth) and "end"; without "slide" there is at most one
    /// contact, and "end" is where it stops
    #[arg(long, value_name = "FILE.json")]
    pub case: Option<PathBuf>,
    /// Of `bodies` alone: a program that moves balls by avian's `MoveAndSlide`, to be compared as well. It is built by
    /// `cargo build --release --manifest-path lab/avian/Cargo.toml` as lab/avian/target/release/dolomite_avian
    #[arg(long, value_name = "PROGRAM")]
    pub avian: Option<PathBuf>,
    /// Timed runs of each measurement, of which the median counts
    #[arg(long, default_value_t = Options::default().repeats)]
    pub repeats: usize,
    /// Triangles of a timed tessellation
    #[arg(
        long,
        default_value_t = Options::default().triangles,
        value_parser = clap::value_parser!(u32).range(1..=16_000_000)
    )]
    pub triangles: u32,
    /// Frames in which background pixels behind closed surfaces are counted
    #[arg(long, default_value_t = Options::default().frames, value_parser = frame_count)]
    pub frames: usize,
    /// Cameras over which `lod` looks for errors above the tolerance, at four tolerances and `--samples`
    /// places each
    #[arg(
        long,
        default_value_t = Options::default().cameras,
        value_parser = camera_count
    )]
    pub cameras: usize,
    /// Errors that the methods of `lod` are tuned to, pixels, from 1 to 16, separated by commas; 8 takes
    /// minutes, 1 half an hour and more a view
    #[arg(
        long = "error",
        value_delimiter = ',',
        value_name = "PIXELS",
        default_values_t = Options::default().errors,
        value_parser = wanted_error
    )]
    pub errors: Vec<f64>,
    /// Most vertices that the other methods of `lod` may draw, as a multiple of ours: who needs more is said
    /// to need more, sooner [default: as memory holds]
    #[arg(long, value_name = "TIMES", value_parser = multiple)]
    pub most: Option<f64>,
    /// Of `light`, `occlusion`, `scaling` and `far`: pixels of their frames [default: 320x180]
    #[arg(long, value_name = "WxH", default_value = "320x180", hide_default_value = true, value_parser = frame_size)]
    pub size: [u32; 2],
    /// Of `light` and `far`: point and spot lights
    #[arg(long, default_value_t = Options::default().lights, value_parser = light_count)]
    pub lights: usize,
    /// Walkers of `agents`; soldiers of `sight`, there 10000 if left out
    #[arg(long, default_value_t = Options::default().agents, value_parser = agent_count)]
    pub agents: usize,
    /// Of `lod` alone: run this part of it; may be given more than once [default: all parts]
    #[arg(long = "part", value_enum, value_name = "PART")]
    pub parts: Vec<Part>,
    /// Of `tessellation` alone: compare the captured patches of this file, one JSON object a line,
    /// in place of the study; prints one JSON object and writes no files
    #[arg(long, value_name = "FILE.jsonl")]
    pub cases: Option<PathBuf>,
    /// Of one study: writes what was asked of it and what it reached as data of a measured table; topic and
    /// notes of a table that is there already are kept
    #[arg(long, value_name = "FILE.json")]
    pub json_out: Option<PathBuf>,
    /// The words that were parsed, for the command that a table names.
    #[arg(skip)]
    pub words: Vec<String>,
}

/// Why nothing was printed.
#[derive(Debug, Error)]
pub enum CliError {
    /// A study's files.
    #[error(transparent)]
    Lab(#[from] LabError),
    /// Captures could not be compared.
    #[error(transparent)]
    Captures(#[from] CaptureError),
    /// A case of `sweep`.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The program that `bodies` compares.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// The data of a table.
    #[error(transparent)]
    Topic(#[from] TopicError),
    /// A conversion panicked.
    #[error("a conversion panicked; the lines above say which")]
    Panicked,
}

/// The study that `--cases` goes with.
const OF_CASES: &str = "tessellation";

/// The study that `--case` goes with.
const OF_CASE: &str = "sweep";

/// The study that `--avian` goes with.
const OF_AVIAN: &str = "bodies";

/// The study that takes a folder, and prints a line for each of its files in place of one object.
const OF_FOLDER: &str = "fbx";

/// The study that takes a file.
const OF_FILE: &str = "replay";

/// The study that has parts.
const OF_PARTS: &str = "lod";

/// Reads a command line, its first word the program's name.
///
/// # Errors
/// What clap says to the user: a mistake, or the help that was asked for.
pub fn parse_from<I>(words: I) -> Result<Arguments, clap::Error>
where
    I: IntoIterator<Item: Into<OsString> + Clone>,
{
    let words: Vec<OsString> = words.into_iter().map(Into::into).collect();
    let mut arguments = Arguments::try_parse_from(&words)?;
    arguments.words = words
        .iter()
        .map(|word| word.to_string_lossy().into_owned())
        .collect();
    if arguments.json_out.is_some() && arguments.study == "all" {
        return Err(Arguments::command().error(
            ErrorKind::ArgumentConflict,
            "--json-out goes with one study, not with all",
        ));
    }
    if arguments.cases.is_some() && arguments.study != OF_CASES {
        return Err(Arguments::command().error(
            ErrorKind::ArgumentConflict,
            format!(
                "--cases goes with the study {OF_CASES} alone, not with {}",
                arguments.study
            ),
        ));
    }
    if arguments.case.is_some() && arguments.study != OF_CASE {
        return Err(Arguments::command().error(
            ErrorKind::ArgumentConflict,
            format!(
                "--case goes with the study {OF_CASE} alone, not with {}",
                arguments.study
            ),
        ));
    }
    if arguments.avian.is_some() && arguments.study != OF_AVIAN {
        return Err(Arguments::command().error(
            ErrorKind::ArgumentConflict,
            format!(
                "--avian goes with the study {OF_AVIAN} alone, not with {}",
                arguments.study
            ),
        ));
    }
    if arguments.folder.is_some() && ![OF_FOLDER, OF_FILE].contains(&arguments.study.as_str()) {
        return Err(Arguments::command().error(
            ErrorKind::ArgumentConflict,
            format!(
                "a path goes with the studies {OF_FOLDER} and {OF_FILE} alone, not with {}",
                arguments.study
            ),
        ));
    }
    if !arguments.parts.is_empty() && arguments.study != OF_PARTS {
        return Err(Arguments::command().error(
            ErrorKind::ArgumentConflict,
            format!(
                "--part goes with the study {OF_PARTS} alone, not with {}",
                arguments.study
            ),
        ));
    }
    Ok(arguments)
}

/// Fewest and most samples: a percentile needs some hundreds, and 2^23 positions of 16 bytes are
/// 128 MiB, the largest buffer that WebGPU promises.
const SAMPLES: std::ops::RangeInclusive<usize> = 256..=1 << 23;

fn sample_count(text: &str) -> Result<usize, String> {
    in_range(text, &SAMPLES)
}

/// Most frames: each is a row of the table.
const FRAMES: std::ops::RangeInclusive<usize> = 12..=100_000;

fn frame_count(text: &str) -> Result<usize, String> {
    in_range(text, &FRAMES)
}

/// Most cameras: a day's run.
const CAMERAS: std::ops::RangeInclusive<usize> = 1..=1_000_000;

fn camera_count(text: &str) -> Result<usize, String> {
    in_range(text, &CAMERAS)
}

/// Most lights of a frame.
const LIGHTS: std::ops::RangeInclusive<usize> = 0..=100_000;

fn light_count(text: &str) -> Result<usize, String> {
    in_range(text, &LIGHTS)
}

/// Most walkers of a crowd.
const AGENTS: std::ops::RangeInclusive<usize> = 1..=1_000_000;

fn agent_count(text: &str) -> Result<usize, String> {
    in_range(text, &AGENTS)
}

/// Two numbers of pixels, such as 320x180, of at most 8192.
fn frame_size(text: &str) -> Result<[u32; 2], String> {
    let pixels = |text: &str| text.parse().ok().filter(|n| (1..=8192).contains(n));
    text.split_once('x')
        .and_then(|(width, height)| Some([pixels(width)?, pixels(height)?]))
        .ok_or_else(|| "two numbers from 1 to 8192 are needed, such as 320x180".into())
}

fn wanted_error(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(pixels) if (1.0..=16.0).contains(&pixels) => Ok(pixels),
        _ => Err("a number of pixels from 1 to 16 is needed".into()),
    }
}

fn multiple(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(times) if (1.0..=1e6).contains(&times) => Ok(times),
        _ => Err("a number from 1 to a million is needed".into()),
    }
}

fn in_range(text: &str, range: &std::ops::RangeInclusive<usize>) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if range.contains(&count) => Ok(count),
        _ => Err(format!(
            "a number from {} to {} is needed",
            range.start(),
            range.end()
        )),
    }
}

fn known_study(text: &str) -> Result<String, String> {
    if text == "all" || STUDIES.iter().any(|study| study.name == text) {
        return Ok(text.to_owned());
    }
    let names: Vec<&str> = STUDIES.iter().map(|study| study.name).collect();
    Err(format!("there are: {}, all", names.join(", ")))
}

fn study_list() -> String {
    let mut text = String::from("Studies:\n");
    for study in STUDIES {
        text += &format!("  {:<18} {}\n", study.name, study.about);
    }
    text += "\n`dolomite_lab capsule` writes runs of compute passes for other implementations of WebGPU: see `capsule --help`.";
    text += "\n`dolomite_lab tables` makes the pages of docs/measured of their data, `dolomite_lab figures` the page of figures.";
    text += "\nA JSON object per study goes to standard output, progress to standard error.";
    text
}

/// Runs what was asked for and writes the files; gives the JSON objects to print, one a study.
///
/// # Errors
/// [`CliError`].
pub fn run(arguments: &Arguments) -> Result<Vec<Value>, CliError> {
    if let Some(cases) = &arguments.cases {
        return Ok(vec![compare(cases)?]);
    }
    if let Some(case) = &arguments.case {
        return Ok(vec![run_case(case)?]);
    }
    if let Some(path) = &arguments.avian {
        // Before the minutes that the study takes.
        eprintln!("{}: {}", path.display(), program(path)?);
    }
    let options = Options {
        seed: arguments.seed,
        count: arguments.count,
        samples: arguments.samples,
        repeats: arguments.repeats,
        triangles: arguments.triangles,
        frames: arguments.frames,
        cameras: arguments.cameras,
        errors: arguments.errors.clone(),
        most: arguments.most,
        size: arguments.size,
        lights: arguments.lights,
        agents: arguments.agents,
        parts: arguments.parts.clone(),
        folder: arguments.folder.clone(),
        avian: arguments.avian.clone(),
        out: Some(arguments.out.clone()),
    };
    let all = arguments.study == "all";
    let chosen = |study: &&Study| all || study.name == arguments.study;
    let mut reports = Vec::new();
    for study in STUDIES.iter().filter(chosen) {
        eprintln!("{}: {}", study.name, study.about);
        let report = (study.run)(&options);
        for path in report.write(&arguments.out)? {
            eprintln!("written: {}", path.display());
        }
        reports.push(report);
    }
    if all {
        eprintln!(
            "written: {}",
            write_index(&arguments.out, &reports, about, &device(), &today())?.display()
        );
    }
    if let (Some(path), [report]) = (&arguments.json_out, reports.as_slice()) {
        write_topic(path, report, &arguments.words)?;
    }
    if arguments.study == OF_FOLDER {
        return match reports.iter().any(|report| report.summary["panics"] != 0) {
            true => Err(CliError::Panicked),
            false => Ok(Vec::new()),
        };
    }
    Ok(reports.iter().map(Report::to_json).collect())
}

/// What a study is.
fn about(name: &str) -> String {
    let study = STUDIES.iter().find(|study| study.name == name);
    study
        .map(|study| study.about.to_owned())
        .unwrap_or_default()
}

/// What this run measures on.
fn device() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let adapter = Gpu::new().map_or_else(|_| "no adapter".to_owned(), |gpu| gpu.name);
    let profile = if cfg!(debug_assertions) {
        "dev"
    } else {
        "release"
    };
    format!("{adapter}, {cores} cores, {profile} profile")
}

/// Writes what a study was asked and what it reached.
fn write_topic(path: &Path, report: &Report, words: &[String]) -> Result<(), CliError> {
    let known = path.exists().then(|| Topic::read(path)).transpose()?;
    let (topic, notes) = known.map_or_else(
        || (report.study.to_owned(), Vec::new()),
        |known| (known.topic, known.notes),
    );
    let asked = STUDIES
        .iter()
        .find(|study| study.name == report.study)
        .map(|study| study.asked)
        .unwrap_or_default();
    let topic = Topic {
        topic,
        device: device(),
        date: today(),
        commit: commit(),
        rows: report.measurements(asked, &command_of(words)),
        notes,
    };
    let text = serde_json::to_string_pretty(&topic).unwrap_or_else(|error| error.to_string());
    std::fs::write(path, text + "\n").map_err(|source| TopicError::File {
        path: path.to_owned(),
        source,
    })?;
    eprintln!("written: {}", path.display());
    Ok(())
}

/// The command that measures the same again: without the places that results go to.
fn command_of(words: &[String]) -> String {
    let mut kept = vec!["dolomite_lab"];
    let mut words = words.iter().skip(1);
    while let Some(word) = words.next() {
        let name = word.split('=').next().unwrap_or(word);
        if ["--out", "--json-out"].contains(&name) {
            if !word.contains('=') {
                words.next();
            }
            continue;
        }
        kept.push(word);
    }
    kept.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(words: &str) -> Result<Arguments, clap::Error> {
        parse_from(["lab"].into_iter().chain(words.split_whitespace()))
    }

    #[test]
    fn the_command_line_holds_together() {
        Arguments::command().debug_assert();
        let parsed = parse("noise --seed 7 --out x").unwrap();
        assert_eq!((parsed.seed, parsed.out), (7, PathBuf::from("x")));
        assert!(parse("all").is_ok());
    }

    #[test]
    fn a_table_names_the_command_without_where_results_go() {
        let parsed = parse("noise --out a --samples 300 --json-out=b.json --seed=2").unwrap();
        assert_eq!(
            command_of(&parsed.words),
            "dolomite_lab noise --samples 300 --seed=2"
        );
        assert!(parse("all --json-out b.json").is_err());
    }

    #[test]
    fn every_study_that_is_asked_something_names_numbers_by_pointers() {
        for study in STUDIES {
            for asked in study.asked {
                assert!(asked.at.starts_with('/'), "{}: {}", study.name, asked.at);
                assert!(!asked.what.is_empty());
            }
        }
    }

    #[test]
    fn what_does_not_exist_is_refused() {
        let refusal = parse("nothing").unwrap_err().to_string();
        for study in STUDIES {
            assert!(refusal.contains(study.name), "{refusal}");
        }
        assert!(refusal.contains(", all"), "{refusal}");
        assert!(parse("noise --samples 3").is_err());
        assert!(parse("").is_err());
    }

    #[test]
    fn cases_go_with_tessellation_alone() {
        let parsed = parse("tessellation --cases x.jsonl").unwrap();
        assert_eq!(parsed.cases, Some(PathBuf::from("x.jsonl")));
        for study in ["noise", "all"] {
            let refusal = parse(&format!("{study} --cases x.jsonl")).unwrap_err();
            assert_eq!(refusal.kind(), ErrorKind::ArgumentConflict);
            assert!(refusal.to_string().contains(study), "{refusal}");
        }
    }

    #[test]
    fn a_folder_goes_with_fbx_alone() {
        let parsed = parse("fbx some/folder --out x").unwrap();
        assert_eq!(parsed.folder, Some(PathBuf::from("some/folder")));
        assert!(parse("noise some/folder").is_err());
        assert!(parse("replay some/file.json").is_ok());
    }

    #[test]
    fn parts_go_with_lod_alone() {
        let parsed = parse("lod --part guarantee --part pops").unwrap();
        assert_eq!(parsed.parts, [Part::Guarantee, Part::Pops]);
        assert!(parse("lod --part nothing").is_err());
        let refusal = parse("noise --part pops").unwrap_err();
        assert_eq!(refusal.kind(), ErrorKind::ArgumentConflict);
    }

    #[test]
    fn cases_that_cannot_be_read_are_an_error() {
        let parsed = parse("tessellation --cases no/such/file.jsonl").unwrap();
        let error = run(&parsed).unwrap_err();
        assert!(matches!(error, CliError::Captures(_)));
        assert!(error.to_string().contains("file.jsonl"), "{error}");
    }

    #[test]
    fn a_program_of_avian_goes_with_bodies_alone_and_has_to_be_there() {
        let refusal = parse("noise --avian x").unwrap_err();
        assert_eq!(refusal.kind(), ErrorKind::ArgumentConflict);
        let parsed = parse("bodies --avian no/such/program --count 1").unwrap();
        let error = run(&parsed).unwrap_err();
        assert!(matches!(error, CliError::Program(_)), "{error}");
        let said = error.to_string();
        assert!(
            said.contains("no/such/program") && said.contains("lab/avian/Cargo.toml"),
            "{said}"
        );
    }

    #[test]
    fn triangles_have_a_range() {
        assert_eq!(parse("noise").unwrap().triangles, 1_000_000);
        assert_eq!(parse("noise --triangles 1").unwrap().triangles, 1);
        for wrong in ["0", "16000001", "-1", "many"] {
            assert!(
                parse(&format!("noise --triangles={wrong}")).is_err(),
                "{wrong}"
            );
        }
    }

    #[test]
    fn frames_have_a_range() {
        assert_eq!(parse("noise").unwrap().frames, 1000);
        assert_eq!(parse("noise --frames 12").unwrap().frames, 12);
        for wrong in ["0", "11", "100001", "-1", "many"] {
            assert!(
                parse(&format!("noise --frames={wrong}")).is_err(),
                "{wrong}"
            );
        }
    }

    #[test]
    fn cameras_and_errors_have_ranges() {
        assert_eq!(parse("lod --cameras 7").unwrap().cameras, 7);
        assert_eq!(parse("lod --error 1").unwrap().errors, [1.0]);
        assert_eq!(parse("lod --error 16,2").unwrap().errors, [16.0, 2.0]);
        let light = parse("light --size 64x36 --lights 7").unwrap();
        assert_eq!((light.size, light.lights), ([64, 36], 7));
        for words in [
            "light --size 64",
            "light --size 0x9",
            "light --size 9x9999",
            "light --lights 200000",
        ] {
            assert!(parse(words).is_err(), "{words}");
        }
        assert_eq!(parse("lod --most 2.5").unwrap().most, Some(2.5));
        assert_eq!(parse("lod").unwrap().most, None);
        for wrong in [
            "--cameras=0",
            "--cameras=many",
            "--error=0",
            "--error=NaN",
            "--error=17",
            "--error=1,0",
            "--most=0.5",
        ] {
            assert!(parse(&format!("lod {wrong}")).is_err(), "{wrong}");
        }
    }

    #[test]
    fn help_names_every_study() {
        let help = Arguments::command().render_help().to_string();
        for study in STUDIES {
            assert!(help.contains(study.name), "{help}");
        }
    }
}
