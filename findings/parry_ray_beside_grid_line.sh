#!/usr/bin/env bash
# Vertical rays onto a height field of parry: whether each one hits.
#
# Version: parry3d 0.30.2-glamx0.2-b (crates.io)
# Guess:   a ray straight down, inside the field's rectangle, hits it wherever it stands: the field has no holes.
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
opt-level = 2
TOML
cat >src/main.rs <<'RUST'
RUST
seen=$(CARGO_TARGET_DIR=$folder/target cargo run --quiet)
echo "$seen"
[[ $seen == 'EXPECTED' ]]
