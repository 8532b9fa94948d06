//! Command line of the texture maker.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use dolomite_textures::atlas::Atlas;
use dolomite_textures::error::TextureError;
use dolomite_textures::layers::Layer;
use dolomite_textures::{SEED, SIZE, generate, preview};

/// Makes the terrain's ground textures.
#[derive(Parser)]
struct Arguments {
    /// Folder the two images are written to.
    #[arg(long, default_value = "assets/textures")]
    out: PathBuf,
    /// Side of a layer in texels: a power of two from 64 to 2048.
    #[arg(long, default_value_t = SIZE)]
    size: usize,
    /// Seed of all random choices.
    #[arg(long, default_value_t = SEED)]
    seed: u32,
    /// Also writes a picture of every layer in sunlight, near and far.
    #[arg(long)]
    preview: Option<PathBuf>,
    /// Makes this layer only, for its preview, and leaves the images alone.
    #[arg(long, requires = "preview", value_parser = layer)]
    only: Option<Layer>,
}

fn layer(name: &str) -> Result<Layer, String> {
    let found = Layer::ALL.into_iter().find(|layer| layer.name() == name);
    found.ok_or_else(|| format!("one of {}", Layer::ALL.map(Layer::name).join(", ")))
}

fn run(arguments: &Arguments) -> Result<(), TextureError> {
    let mut tiles = Vec::with_capacity(Layer::ALL.len());
    for layer in Layer::ALL {
        if arguments.only.is_some_and(|only| only != layer) {
            continue;
        }
        let fields = generate(layer, arguments.size, arguments.seed)?;
        let [r, g, b] = fields.mean_albedo();
        println!(
            "{:<6} mean linear albedo {r:.3} {g:.3} {b:.3}",
            layer.name()
        );
        tiles.push(fields.to_tile());
    }
    if let Some(path) = &arguments.preview {
        preview::write(path, &tiles)?;
    }
    if let Ok(tiles) = <&[_; Layer::ALL.len()]>::try_from(tiles.as_slice()) {
        let atlas = Atlas::stack(tiles);
        atlas.write(&arguments.out)?;
        println!(
            "hash {:016x}, written to {}",
            atlas.hash(),
            arguments.out.display()
        );
    }
    Ok(())
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            let mut cause = std::error::Error::source(&error);
            while let Some(inner) = cause {
                eprintln!("  because: {inner}");
                cause = inner.source();
            }
            ExitCode::FAILURE
        }
    }
}
