//! The command `dolomite`: play, shot, bench, bot, settings, fbx2gltf, heights.

mod command;

use std::process::ExitCode;

use bevy::app::AppExit;
use clap::Parser;
use dolomite_game::bench::classic::matrix;
use dolomite_game::bench::path::Path;
use dolomite_game::bench::{self, BenchError, parts, start};
use dolomite_game::run::ended::end;
use dolomite_game::run::{began, shot, window};
use dolomite_game::settings;

use command::{Command, Line};

fn main() -> ExitCode {
    began::note();
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
    if let Some(Command::Heights(heights)) = &line.command {
        return match heights.run() {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("dolomite: {error}");
                ExitCode::FAILURE
            }
        };
    }
    // From here on a device may have been opened.
    match run(line) {
        Ok(AppExit::Success) => end(0),
        Ok(AppExit::Error(code)) => end(code.get()),
        Err(error) => {
            eprintln!("dolomite: {error}");
            end(1)
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
            let file = bench.json.as_deref();
            if bench.matrix {
                let rows = match setup.scene.city {
                    Some(_) => bench::city::matrix(setup, path, size, frames, file)?,
                    None => matrix::matrix(setup, path, size, frames, file)?,
                };
                print!("{}", matrix::table(&rows));
            } else if path == Path::Start {
                let report = start::start(setup, size, bench.window, file)?;
                eprintln!("dolomite: {report}");
            } else {
                let report = bench::bench(setup, path, size, frames, bench.turns(), file)?;
                if !report.parts.is_empty() {
                    eprint!("{}", parts::table(&report.parts));
                }
                let time = report.summary.frame_ms;
                eprintln!(
                    "dolomite: median {:.2} ms, p99 {:.2} ms, {}",
                    time.median, time.p99, report.summary.device,
                );
            }
            Ok(AppExit::Success)
        }
        Command::Bot(bot) => Ok(match bot.run()? {
            true => AppExit::Success,
            false => AppExit::error(),
        }),
        // Done before: they need neither game nor Bevy.
        Command::Fbx2gltf(_) | Command::Heights(_) => Ok(AppExit::Success),
        Command::Settings => {
            print!("{}", settings::DEFAULT_SETTINGS);
            Ok(AppExit::Success)
        }
    }
}
