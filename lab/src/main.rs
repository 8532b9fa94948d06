//! `dolomite_lab`: see [`dolomite_lab`].

use clap::Parser;
use dolomite_lab::cli;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = cli::Arguments::parse();
    match cli::run(&arguments) {
        Ok(reports) => {
            for report in reports {
                println!("{:#}", report.to_json());
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
