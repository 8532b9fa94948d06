#!/usr/bin/env bash
# obvhs, which builds BVHs by merging neighbours: boxes of one size in a straight row, as fence posts or steps are.
#
# Version: obvhs 0.4.0 (crates.io), Rust 1.95, release build, Linux x86_64
# Guess:   time grows as it does for boxes at random places: four times as many boxes take about four to five times as
#          long, since the neighbours that are merged in a round are a fixed share of all.
# Seen:    `random: less than 9 times, row: more than 9 times, uneven row: less than 9 times`. In a row of equal boxes
#          the two neighbours of each are equally good, all take the one on the same side, and a round merges a single
#          pair: time goes with the square of the number (about 15 times for four times as many; 16 000 boxes took 890
#          times as long as random ones). Boxes that lie within each other, and equal ones in one place, do the same.
#          Sizes that differ by up to 3 % mend it.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir src
cat >Cargo.toml <<'TOML'
[package]
name = "finding"
version = "0.0.0"
edition = "2024"

[dependencies]
obvhs = { version = "=0.4.0", default-features = false }

[workspace]
TOML
cat >src/main.rs <<'RUST'
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{Boundable, BvhBuildParams};
use std::time::{Duration, Instant};

struct Bounds(Aabb);

impl Boundable for Bounds {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// 0 to 1.
fn chance(k: u32) -> f32 {
    let mut bits = k.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    bits = ((bits >> ((bits >> 28) + 4)) ^ bits).wrapping_mul(277_803_737);
    ((bits >> 22) ^ bits) as f32 / u32::MAX as f32
}

fn cube(x: f32, y: f32, z: f32, out: f32) -> Bounds {
    let low = [x - out, y - out, z - out];
    let high = [x + 1.0 + out, y + 1.0 + out, z + 1.0 + out];
    Bounds(Aabb::new(low.into(), high.into()))
}

/// The least time of three builds over `count` boxes.
fn time(count: u32, place: fn(u32) -> Bounds) -> f64 {
    let boxes: Vec<Bounds> = (0..count).map(place).collect();
    let build = |_| {
        let began = Instant::now();
        let mut core = Duration::ZERO;
        let tree = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut core);
        assert!(!tree.nodes.is_empty());
        began.elapsed().as_secs_f64()
    };
    (0..3).map(build).fold(f64::INFINITY, f64::min)
}

fn growth(place: fn(u32) -> Bounds) -> &'static str {
    let times = time(6000, place) / time(1500, place);
    eprintln!("{times:.1} times as long for four times as many");
    if times < 9.0 { "less" } else { "more" }
}

fn main() {
    let random = |k| cube(300.0 * chance(3 * k), 300.0 * chance(3 * k + 1), 300.0 * chance(3 * k + 2), 0.0);
    let random = growth(random);
    let row = growth(|k| cube(k as f32, 0.0, 0.0, 0.0));
    let uneven = growth(|k| cube(k as f32, 0.0, 0.0, 0.03 * chance(k)));
    println!("random: {random} than 9 times, row: {row} than 9 times, uneven row: {uneven} than 9 times");
}
RUST
seen=$(cargo run --quiet --release)
echo "$seen"
[[ $seen == 'random: less than 9 times, row: more than 9 times, uneven row: less than 9 times' ]]
