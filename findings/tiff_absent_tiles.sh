#!/usr/bin/env bash
# A sparse TIFF by the crate `tiff`: what stands in tiles that the file says are not there.
#
# Version: tiff 0.11.3 (cargo)
# Guess:   tiles with offset 0 and length 0, which GDAL writes for tiles without data, read as zeros, or are an
#          error, whether the others are compressed or not.
# Seen:    neither: the first bytes of the file. Absent tiles of a file without compression are read from offset 0, so
#          that their samples begin with the file's own header (18761 is "II") and go on through its directory. Nothing
#          says that these samples were never written.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir src
cat >Cargo.toml <<'TOML'
[package]
name = "sparse"
version = "0.0.0"
edition = "2021"
[workspace]
[dependencies]
tiff = "=0.11.3"
TOML
cat >src/main.rs <<'RUST'
use std::io::Cursor;
use tiff::decoder::{Decoder, DecodingResult};

/// A grey picture of 32 x 32 samples of 16 bits in four tiles of 16 x 16, of which the file holds the first, all
/// sevens; the others have offset 0 and length 0.
fn sparse() -> Vec<u8> {
    const TILE: u32 = 16 * 16 * 2;
    let entries: [(u16, u16, u32, u32); 10] = [
        (256, 4, 1, 32),           // width
        (257, 4, 1, 32),           // height
        (258, 3, 1, 16),           // bits a sample
        (259, 3, 1, 1),            // not compressed
        (262, 3, 1, 1),            // black is 0
        (277, 3, 1, 1),            // one sample a pixel
        (322, 4, 1, 16),           // tile width
        (323, 4, 1, 16),           // tile height
        (324, 4, 4, 134),          // offsets: behind this directory
        (325, 4, 4, 134 + 16),     // lengths: behind those
    ];
    let mut file = b"II*\0".to_vec();
    file.extend(8u32.to_le_bytes());
    file.extend((entries.len() as u16).to_le_bytes());
    for (tag, kind, count, value) in entries {
        file.extend(tag.to_le_bytes());
        file.extend(kind.to_le_bytes());
        file.extend(count.to_le_bytes());
        file.extend(value.to_le_bytes());
    }
    file.extend(0u32.to_le_bytes());
    assert_eq!(file.len(), 134);
    for word in [134 + 32, 0, 0, 0, TILE, 0, 0, 0] {
        file.extend(word.to_le_bytes());
    }
    for _ in 0..TILE / 2 {
        file.extend(7u16.to_le_bytes());
    }
    file
}

fn main() {
    let mut decoder = Decoder::new(Cursor::new(sparse())).expect("a TIFF");
    match decoder.read_image() {
        Ok(DecodingResult::U16(samples)) => {
            let there = (0..16).flat_map(|y| samples[32 * y..32 * y + 16].to_vec());
            println!("the tile that is there: {}", if there.clone().all(|s| s == 7) { "as written" } else { "not" });
            let absent: Vec<u16> = samples[16..32].to_vec();
            println!("first row of one that is not: {absent:?}");
        }
        other => println!("{other:?}"),
    }
}
RUST
seen=$(CARGO_TARGET_DIR=$folder/target cargo run --quiet)
echo "$seen"
[[ $seen == "the tile that is there: as written
first row of one that is not: [18761, 42, 8, 0, 10, 256, 4, 1, 0, 32, 0, 257, 4, 1, 0, 32]" ]]
