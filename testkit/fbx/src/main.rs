//! `dolomite_fbx_search [--files N] [--first SEED] [--each N] [--out FOLDER] [--resume FILE] [--property beside]`: makes random FBX files,
//! holds what becomes of them (or, with `--property beside`, the truth against ufbx) and prints one JSON object; what fails is written to the
//! folder, small. With `--resume` it works in pieces, says how far it is, and goes on from the file when it was ended before.
//! The exit code is 1 when anything failed.

use dolomite_fbx_search::{Seen, Total, beside, hold, run_by, run_in_pieces};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let mut property: dolomite_fbx_search::run::Property = hold;
    let mut resume: Option<PathBuf> = None;
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
            ("--resume", _) if !value.is_empty() => resume = Some(PathBuf::from(value)),
            _ => {
                eprintln!(
                    "{word} {value}: give --files N, --first SEED, --each N, --out FOLDER or --resume FILE"
                );
                return ExitCode::FAILURE;
            }
        }
    }
    // Panics of the conversion are counted; their messages would bury all else.
    std::panic::set_hook(Box::new(|_| {}));
    let total = match &resume {
        None => {
            let mut total = Total::default();
            total.add(&run_by(property, first, files, each, &out));
            Ok(total)
        }
        Some(state) => {
            let (begun, mut before) = (Instant::now(), None);
            run_in_pieces(
                property,
                (first, files, each),
                &out,
                state,
                &build(),
                |total| {
                    let piece = *before.get_or_insert(total.files);
                    let seconds = begun.elapsed().as_secs_f64();
                    let done = total.files - piece;
                    let left = match done {
                        0 => "some time".to_owned(),
                        done => format!(
                            "{:.0} min",
                            seconds / 60.0 * (files - total.files) as f64 / done as f64
                        ),
                    };
                    eprintln!(
                        "{} of {files} files, {} failed, {} refused; {left} left",
                        total.files,
                        total.failed.len(),
                        total.refused.len()
                    );
                },
            )
        }
    };
    let total = match total {
        Ok(total) => total,
        Err(error) => {
            let name = resume.unwrap_or_default();
            eprintln!("{}: {error}", name.display());
            return ExitCode::FAILURE;
        }
    };
    total.failed.values().for_each(|line| eprintln!("{line}"));
    println!("{:#}", total.summary(first));
    match total.kinds.is_empty() {
        true => ExitCode::SUCCESS,
        false => ExitCode::FAILURE,
    }
}

/// Tells this program from those of other sources: what others found says nothing of it.
fn build() -> String {
    let bytes = std::env::current_exe().and_then(std::fs::read);
    // Fowler, Noll and Vo, 1a.
    let hash = bytes
        .unwrap_or_default()
        .iter()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3)
        });
    format!("{hash:016x}")
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
