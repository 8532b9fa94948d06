//! Command line of the maker of plants.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use dolomite_plants::boulder::{BOULDER, SLAB, rock};
use dolomite_plants::broadleaf::broadleaf;
use dolomite_plants::conifer::conifer;
use dolomite_plants::glb::glb;
use dolomite_plants::preview::preview;
use thiserror::Error;

/// Makes trees and rocks.
#[derive(Parser)]
struct Arguments {
    /// Folder that the files are written to.
    #[arg(long, default_value = "assets/plants")]
    out: PathBuf,
    /// Also writes a picture of all levels, 256 pixels a model.
    #[arg(long)]
    preview: Option<PathBuf>,
}

/// Why nothing was written.
#[derive(Debug, Error)]
enum PlantError {
    /// A file.
    #[error("{0}: {1}")]
    Write(PathBuf, std::io::Error),
    /// The picture.
    #[error("{0}: {1}")]
    Picture(PathBuf, image::ImageError),
    /// Levels of detail.
    #[error("levels of `{0}`: {1}")]
    Levels(&'static str, meshopt::Error),
}

fn run(arguments: &Arguments) -> Result<(), PlantError> {
    let plants = [
        ("broadleaf", broadleaf(3), 0.85),
        ("conifer", conifer(5), 0.9),
        ("boulder", rock(&BOULDER, 4), 0.95),
        ("slab", rock(&SLAB, 9), 0.95),
    ];
    let out = &arguments.out;
    std::fs::create_dir_all(out).map_err(|error| PlantError::Write(out.clone(), error))?;
    let mut rows = Vec::new();
    for (name, plant, roughness) in &plants {
        let levels = plant
            .levels()
            .map_err(|error| PlantError::Levels(name, error))?;
        let bytes = glb(name, &levels, *roughness);
        let file = out.join(name).with_extension("glb");
        let counts: Vec<_> = levels.iter().map(|level| level.indices.len() / 3).collect();
        let height = levels[0].height();
        println!(
            "{name}: {height:.2} m, triangles {counts:?}, {} bytes",
            bytes.len()
        );
        std::fs::write(&file, bytes).map_err(|error| PlantError::Write(file, error))?;
        rows.push(levels);
    }
    if let Some(path) = &arguments.preview {
        let picture = preview(&rows, 256);
        picture
            .save(path)
            .map_err(|error| PlantError::Picture(path.clone(), error))?;
    }
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
