#!/usr/bin/env bash
# Vertical rays onto a height field of parry: whether each one hits.
#
# Version: parry3d 0.30.2-glamx0.2-b (cargo)
# Guess:   a ray straight down, well inside the field's rectangle, hits it wherever it stands: the field has no holes.
# Seen:    `214 of 2000000 miss, at most 8e-5 of a cell from a line of the grid`. Rays that fall through stand beside a
#          line of the grid, not on it: cell and triangle are found by roundings of their own, which may disagree.
#          Beneath a wheel or a foot that is a hole now and then.
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

const SAMPLES: usize = 2049;
const SIDE: f32 = 12_000.0;
const RAYS: u32 = 2_000_000;

fn main() {
    // Flat ground, and places of a fixed sequence, none of them near the field's border.
    let heights = Array2::new(SAMPLES, SAMPLES, vec![0.0; SAMPLES * SAMPLES]);
    let field = HeightField::new(heights, Vector::new(SIDE, 1.0, SIDE));
    let mut state = 1u64;
    let mut place = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((state >> 40) as f32 / (1u32 << 24) as f32 - 0.5) * 0.99 * SIDE
    };
    // From the nearest line of the grid, in cells.
    let from_line = |x: f32| {
        let cells = f64::from(x) / f64::from(SIDE) * (SAMPLES - 1) as f64;
        (cells - cells.round()).abs()
    };
    let (mut missed, mut farthest) = (0, 0.0_f64);
    for _ in 0..RAYS {
        let (x, z) = (place(), place());
        let ray = Ray::new(Vector::new(x, 10.0, z), Vector::new(0.0, -1.0, 0.0));
        if field.cast_local_ray(&ray, 100.0, true).is_none() {
            missed += 1;
            farthest = farthest.max(from_line(x).min(from_line(z)));
        }
    }
    println!("{missed} of {RAYS} miss, at most {farthest:.0e} of a cell from a line of the grid");
}
RUST
seen=$(CARGO_TARGET_DIR=$folder/target cargo run --quiet)
echo "$seen"
[[ $seen == '214 of 2000000 miss, at most 8e-5 of a cell from a line of the grid' ]]
