//! `dolomite_fbx_search [--files N] [--first SEED] [--each N] [--out FOLDER] [--property beside]`: makes random FBX files, holds what becomes of
//! them (or, with `--property beside`, the truth against ufbx) and prints one JSON object; what fails is written to the folder, small. The exit code is 1 when anything failed.

use dolomite_fbx_search::{Seen, beside, hold, run_by};
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut property: dolomite_fbx_search::run::Property = hold;
    let (mut files, mut first, mut each, mut out) =
        (1000, 0, 3, std::env::temp_dir().join("dolomite_fbx_search"));
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().unwrap_or_default();
        let number = value.parse::<u64>();
        match (&*word, number) {
            ("--files", Ok(number)) => files = number,
            ("--first", Ok(number)) => first = number,
            ("--each", Ok(number)) => each = number,
            // One file of somebody's: converted, with the words of a panic.
            ("--convert", _) if !value.is_empty() => return one(&value),
            ("--property", _) if value == "beside" => {
                property = |scene, seed| beside(scene, seed).map(|()| Seen::default())
            }
            ("--out", _) if !value.is_empty() => out = PathBuf::from(value),
            _ => {
                eprintln!("{word} {value}: give --files N, --first SEED, --each N or --out FOLDER");
                return ExitCode::FAILURE;
            }
        }
    }
    // Panics of the conversion are counted; their messages would bury all else.
    std::panic::set_hook(Box::new(|_| {}));
    let outcome = run_by(property, first, files, each, &out);
    let failures: Vec<String> = outcome.failures.iter().map(ToString::to_string).collect();
    failures.iter().for_each(|line| eprintln!("{line}"));
    let summary = json!({
        "failed": outcome.kinds,
        "files": outcome.files,
        "first": first,
        "poses": outcome.poses,
        "refused": outcome.refused,
        "slowest": outcome.slowest,
        "stated_over_true": {
            "median": outcome.stated_over_true(0.5),
            "95 %": outcome.stated_over_true(0.95),
        },
        "true_error_over_stated": outcome.worst,
    });
    println!("{summary:#}");
    match outcome.kinds.is_empty() {
        true => ExitCode::SUCCESS,
        false => ExitCode::FAILURE,
    }
}

/// Converts a file and says what came of it.
fn one(path: &str) -> ExitCode {
    let bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) => {
            eprintln!("{path}: {error}");
            return ExitCode::FAILURE;
        }
    };
    match dolomite_fbx::convert(
        &bytes,
        &dolomite_fbx::Origin::default(),
        &dolomite_fbx::Options::default(),
    ) {
        Ok(made) => {
            println!("{:#?}", made.report);
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
