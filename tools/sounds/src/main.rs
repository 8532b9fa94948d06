//! Command line of the sound maker.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use dolomite_sounds::catalogue::SOUNDS;
use dolomite_sounds::wave::wav;
use dolomite_sounds::{SEED, picture};
use thiserror::Error;

/// Makes the sounds of `dolomite_sound`.
#[derive(Parser)]
struct Arguments {
    /// Folder that the files are written to.
    #[arg(long, default_value = "plugins/sound/assets")]
    out: PathBuf,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = SEED)]
    seed: u32,
    /// Only sounds whose name contains this.
    #[arg(long, default_value = "")]
    only: String,
    /// Writes a picture of all sounds, an SVG file, and no sound.
    #[arg(long, value_name = "FILE.svg")]
    picture: Option<PathBuf>,
}

#[derive(Debug, Error)]
#[error("{}: {source}; give another place by --out or --picture", .path.display())]
struct WriteError {
    path: PathBuf,
    source: std::io::Error,
}

fn run(arguments: &Arguments) -> Result<(), WriteError> {
    let refused = |path: &PathBuf, source| WriteError {
        path: path.clone(),
        source,
    };
    if let Some(path) = &arguments.picture {
        let picture = picture::svg(arguments.seed);
        std::fs::write(path, &picture).map_err(|error| refused(path, error))?;
        println!("{} bytes in {}", picture.len(), path.display());
        return Ok(());
    }
    std::fs::create_dir_all(&arguments.out).map_err(|error| refused(&arguments.out, error))?;
    let mut all = 0;
    for sound in SOUNDS {
        if !sound.name.contains(&arguments.only) {
            continue;
        }
        let samples = sound.samples(arguments.seed);
        let square: f64 = samples.iter().map(|x| x * x).sum();
        let rms = (square / samples.len() as f64).sqrt();
        let bytes = wav(&samples, sound.rate);
        let path = arguments.out.join(sound.name).with_extension("wav");
        std::fs::write(&path, &bytes).map_err(|error| refused(&path, error))?;
        all += bytes.len();
        println!(
            "{:<13} {:5.2} s  {:6} bytes  rms {rms:.3}",
            sound.name,
            samples.len() as f64 / f64::from(sound.rate),
            bytes.len()
        );
    }
    println!("{all} bytes in {}", arguments.out.display());
    Ok(())
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
