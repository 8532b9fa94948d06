//! The image of a random scene as a PNG file, and how long it took:
//!
//! ```sh
//! cargo run -p dolomite_light_oracle --example picture -- SEED [LIGHTS] [OBJECTS] [FILE]
//! ```

use std::time::Instant;

use dolomite_light_oracle::occlusion::Occlusion;
use dolomite_light_oracle::{Options, Recipe, generate, render};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let mut number = |default: u64| -> Result<u64, std::num::ParseIntError> {
        words.next().map_or(Ok(default), |word| word.parse())
    };
    let (seed, lights, objects) = (number(1)?, number(16)?, number(24)?);
    let file = words.next().unwrap_or_else(|| "picture.png".to_owned());
    let scene = generate(&Recipe {
        seed,
        lights: lights as usize,
        objects: objects as usize,
        blinn_phong: 0.3,
        ..Recipe::default()
    });
    let options = Options {
        occlusion: Some(Occlusion {
            rays: 16,
            ..Occlusion::default()
        }),
        ..Options::default()
    };
    let start = Instant::now();
    let image = render(&scene, &options);
    println!(
        "{} triangles, {} lights: {:?}",
        scene.triangles(),
        scene.lamps.len(),
        start.elapsed()
    );
    let bytes = image.to_srgb8(1.0).concat();
    let picture = image::RgbImage::from_raw(image.width, image.height, bytes);
    picture.ok_or("no pixels")?.save(&file)?;
    Ok(())
}
