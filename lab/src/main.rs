//! `dolomite_lab`: see [`dolomite_lab`].

use clap::Parser;
use dolomite_lab::{capsule::command, cli, figures, tables};
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut words = std::env::args_os();
    match std::env::args_os().nth(1) {
        Some(word) if word == "tables" => {
            words.next();
            return make_tables(&tables::Arguments::parse_from(words));
        }
        Some(word) if word == "figures" => {
            words.next();
            return make_figures(&figures::Arguments::parse_from(words));
        }
        Some(word) if word == "capsule" => {
            words.next();
            return write_capsules(&command::Arguments::parse_from(words));
        }
        _ => {}
    }
    let arguments = cli::parse_from(words).unwrap_or_else(|error| error.exit());
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

fn make_tables(arguments: &tables::Arguments) -> ExitCode {
    match tables::run(arguments) {
        Ok(written) => {
            for name in written {
                println!("written: {name}");
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn make_figures(arguments: &figures::Arguments) -> ExitCode {
    match figures::run(arguments) {
        Ok(written) => {
            if written {
                println!("written: {}", arguments.out.display());
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn write_capsules(arguments: &command::Arguments) -> ExitCode {
    match command::run(arguments) {
        Ok(lines) => {
            for line in lines {
                println!("{line}");
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
