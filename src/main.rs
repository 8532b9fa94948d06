//! The command `dolomite`: play, shot, bench, settings, fbx2gltf.

mod command;

use std::process::ExitCode;

use bevy::app::AppExit;
use clap::Parser;
use dolomite_game::bench::classic::matrix;
use dolomite_game::bench::{self, BenchError};
use dolomite_game::run::{shot, window};
use dolomite_game::settings;

use command::{Command, Line};

fn main() -> ExitCode {
    let line = match Line::try_parse() {
        Ok(line) => line,
        Err(message) => {
            // Help and version are no errors. Nothing better can be done if printing fails.
            let _ = message.print();
            return ExitCode::from(u8::from(message.use_stderr()));
        }
    };
    if let Some(Command::Fbx2gltf(convert)) = &line.command {
        return match convert.run() {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("dolomite: {error}");
                ExitCode::FAILURE
            }
        };
    }
    match run(line) {
        Ok(AppExit::Success) => ExitCode::SUCCESS,
        Ok(AppExit::Error(code)) => ExitCode::from(code.get()),
        Err(error) => {
            eprintln!("dolomite: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(line: Line) -> Result<AppExit, BenchError> {
    match line.command.unwrap_or(Command::Play(line.play)) {
        Command::Play(play) => Ok(window::play(play.setup()?)?),
        Command::Shot(shot) => {
            let device = shot::shot(
                shot.setup()?,
                shot.size.0,
                shot.frames,
                shot.walk.map(f32::to_radians),
                &shot.out,
            )?;
            eprintln!("dolomite: wrote {} (drawn by {device})", shot.out.display());
            Ok(AppExit::Success)
        }
        Command::Bench(bench) => {
            let (setup, size) = (bench.setup()?, bench.size());
            let (path, frames) = (bench.path(), bench.frames());
            let file = match &bench.json {
                Some(file) if !bench.matrix => file,
                file => {
                    let rows = matrix::matrix(setup, path, size, frames, file.as_deref())?;
                    print!("{}", matrix::table(&rows));
                    return Ok(AppExit::Success);
                }
            };
            let report = bench::bench(setup, path, size, frames, file)?;
            let time = report.summary.frame_ms;
            eprintln!(
                "dolomite: wrote {} (median {:.2} ms, p99 {:.2} ms, {})",
                file.display(),
                time.median,
                time.p99,
                report.summary.device,
            );
            Ok(AppExit::Success)
        }
        // Done before: it needs neither game nor Bevy.
        Command::Fbx2gltf(_) => Ok(AppExit::Success),
        Command::Settings => {
            print!("{}", settings::DEFAULT_SETTINGS);
            Ok(AppExit::Success)
        }
    }
}
