//! The command line of `dolomite_lab`.

use crate::studies::STUDIES;
use crate::study::{LabError, Options, Report, Study, write_index};
use clap::Parser;
use std::path::PathBuf;

/// Measures run time against error: Dolomite's methods against f64 oracles, beside other libraries.
#[derive(Debug, Parser)]
#[command(name = "dolomite_lab", version, after_help = study_list())]
pub struct Arguments {
    /// Name of a study, or `all`: every study, and a page that shows every figure
    #[arg(value_parser = known_study)]
    pub study: String,
    /// Seed of the inputs; same seed, same inputs
    #[arg(long, default_value_t = Options::default().seed)]
    pub seed: u32,
    /// Folder for the CSV, SVG and HTML files; made if need be
    #[arg(long, default_value = "target/lab")]
    pub out: PathBuf,
    /// Samples of each measurement
    #[arg(long, default_value_t = Options::default().samples, value_parser = sample_count)]
    pub samples: usize,
    /// Timed runs of each measurement, of which the median counts
    #[arg(long, default_value_t = Options::default().repeats)]
    pub repeats: usize,
}

/// Fewest and most samples: a percentile needs some hundreds, and 2^23 positions of 16 bytes are
/// 128 MiB, the largest buffer that WebGPU promises.
const SAMPLES: std::ops::RangeInclusive<usize> = 256..=1 << 23;

fn sample_count(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if SAMPLES.contains(&count) => Ok(count),
        _ => Err(format!(
            "a number from {} to {} is needed",
            SAMPLES.start(),
            SAMPLES.end()
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
        text += &format!("  {:<10} {}\n", study.name, study.about);
    }
    text += "\nA JSON object per study goes to standard output, progress to standard error.";
    text
}

/// Runs what was asked for and writes the files; gives one report a study.
///
/// # Errors
/// [`LabError`].
pub fn run(arguments: &Arguments) -> Result<Vec<Report>, LabError> {
    let options = Options {
        seed: arguments.seed,
        samples: arguments.samples,
        repeats: arguments.repeats,
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
            write_index(&arguments.out, &reports)?.display()
        );
    }
    Ok(reports)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_holds_together() {
        Arguments::command().debug_assert();
        let parsed =
            Arguments::try_parse_from(["lab", "noise", "--seed", "7", "--out", "x"]).unwrap();
        assert_eq!((parsed.seed, parsed.out), (7, PathBuf::from("x")));
        assert!(Arguments::try_parse_from(["lab", "all"]).is_ok());
    }

    #[test]
    fn what_does_not_exist_is_refused() {
        let refusal = Arguments::try_parse_from(["lab", "nothing"])
            .unwrap_err()
            .to_string();
        assert!(refusal.contains("noise, all"), "{refusal}");
        assert!(Arguments::try_parse_from(["lab", "noise", "--samples", "3"]).is_err());
        assert!(Arguments::try_parse_from(["lab"]).is_err());
    }

    #[test]
    fn help_names_every_study() {
        let help = Arguments::command().render_help().to_string();
        for study in STUDIES {
            assert!(help.contains(study.name), "{help}");
        }
    }
}
