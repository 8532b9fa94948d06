#!/usr/bin/env bash
# Vertical rays onto a height field of parry: whether each one hits.
#
# Version: parry3d 0.30.2-glamx0.2-b (crates.io)
# Guess:   a ray straight down, well inside the field's rectangle, hits it wherever it stands: the field has no holes.
# Seen:    SEEN
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir src
cat >Cargo.toml <<'TOML'
[package]
name = "rays"
version = "0.0.0"
edition = "2021"
[workspace]
[dependencies]
parry3d = "=0.30.2-glamx0.2-b"
[profile.dev]
opt-level = 1
debug = false
TOML
cat >src/main.rs <<'RUST'
use parry3d::math::Vector;
use parry3d::query::{Ray, RayCast};
use parry3d::shape::HeightField;
use parry3d::utils::Array2;

/// Rays that miss, of so many at places of a fixed sequence, on flat ground of `side` metres with `samples` squared.
fn missed(samples: usize, side: f32, rays: u32) -> u32 {
    let heights = Array2::new(samples, samples, vec![0.0; samples * samples]);
    let field = HeightField::new(heights, Vector::new(side, 1.0, side));
    let mut state = 1u64;
    let mut place = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((state >> 40) as f32 / (1u32 << 24) as f32 - 0.5) * 0.99 * side
    };
    let misses = (0..rays).filter(|_| {
        let ray = Ray::new(Vector::new(place(), 10.0, place()), Vector::new(0.0, -1.0, 0.0));
        field.cast_local_ray(&ray, 100.0, true).is_none()
    });
    misses.count() as u32
}

fn main() {
    println!("12 000 m, 2049 samples: {} miss", missed(2049, 12_000.0, 2_000_000));
    println!("8 192 m, 2049 samples: {} miss", missed(2049, 8_192.0, 2_000_000));
}
RUST
seen=$(CARGO_TARGET_DIR=$folder/target cargo run --quiet)
echo "$seen"
[[ $seen == 'EXPECTED' ]]
