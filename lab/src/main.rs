//! `dolomite_lab`: see [`dolomite_lab`].

use dolomite_lab::cli;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = cli::parse_from(std::env::args_os()).unwrap_or_else(|error| error.exit());
    match cli::run(&arguments) {
        Ok(objects) => {
            for object in objects {
                println!("{object:#}");
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
