//! `dolomite_avian`: balls that avian3d's `MoveAndSlide` moves over triangles, step by step as standard input says.
//!
//! `dolomite_lab bodies --avian PROGRAM` runs it beside other methods; README.md has the messages.

mod dialogue;
mod walkers;

use std::process::ExitCode;

const HELP: &str = "\
Usage: dolomite_avian [--help]

Moves balls over triangles by avian3d's MoveAndSlide, on one core. Reads JSON from standard input, one message a line:
a world, then the wishes of each step. Answers each by a line on standard output: where the balls are, which of them
stand, and how long the moves took. lab/avian/README.md has the messages.

It is run by: dolomite_lab bodies --avian PROGRAM
";

fn main() -> ExitCode {
    let mut words = std::env::args_os().skip(1);
    match words.next() {
        None => {}
        Some(word) if word == "--help" || word == "-h" => {
            print!("{HELP}");
            return ExitCode::SUCCESS;
        }
        Some(word) => {
            eprint!("error: {} is not known\n\n{HELP}", word.display());
            return ExitCode::from(2);
        }
    }
    match dialogue::hold(std::io::stdin().lock(), std::io::stdout().lock()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
