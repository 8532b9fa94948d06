//! How long a map takes to be cut into tiles, to be opened again, and a tile to be read; and how much memory that takes.
//!
//! `cargo run --release -p dolomite_elevation --example by_tiles -- [SIDE]`
//!
//! The map is a raw file of u16 in the folder for temporary files: 2 · SIDE² bytes, and as its tiles an eighth of that. Both are
//! deleted.

use dolomite_elevation::{ElevationProgress, NumberType, Options, Raw, TileSettings, TiledMap};
use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let side: u32 = std::env::args()
        .nth(1)
        .map_or(Ok(16_385), |side| side.parse())?;
    let folder = std::env::temp_dir().join(format!("dolomite-by-tiles-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let path = folder.join("map.raw");
    let mut to = BufWriter::with_capacity(1 << 20, File::create(&path)?);
    let mut line = vec![0; 2 * side as usize];
    for row in 0..side {
        for (column, bytes) in (0..side).zip(line.as_chunks_mut::<2>().0) {
            *bytes = height(column, row).to_le_bytes();
        }
        to.write_all(&line)?;
    }
    to.into_inner()?.sync_all()?;
    let options = Options {
        raw: Some(Raw {
            size: Some([side; 2]),
            number: Some(NumberType::U16),
            ..Raw::default()
        }),
        ..Options::default()
    };
    let settings = TileSettings::default();
    for what in ["cut into tiles", "opened again"] {
        let began = Instant::now();
        let map = TiledMap::open(&path, &options, &settings, &ElevationProgress::on_stderr())?;
        println!(
            "{side} x {side}: {what} in {:.3} s; {} bytes in memory, {} on disk, {} MiB at most so far",
            began.elapsed().as_secs_f64(),
            map.bytes(),
            std::fs::metadata(map.path())?.len(),
            peak().unwrap_or(0) >> 20
        );
        for level in 0..=map.top().min(4) {
            let [columns, rows] = map.tiles(level);
            let count = 64;
            let began = Instant::now();
            for k in 0..count {
                let tile = map.tile(level, [k * 7919 % columns, k * 104_729 % rows])?;
                assert!(tile.heights[0] >= 0.0, "u16");
            }
            let each = began.elapsed().as_secs_f64() / f64::from(count);
            println!("level {level}: {:.3} ms a tile", 1e3 * each);
        }
    }
    std::fs::remove_dir_all(&folder)?;
    Ok(())
}

/// Hills with some roughness.
fn height(column: u32, row: u32) -> u16 {
    let wave = |n: u32| {
        let n = n % 2000;
        n.min(2000 - n)
    };
    let rough = (column.wrapping_mul(0x9e37_79b9) ^ row.wrapping_mul(0x85eb_ca6b)) >> 29;
    (9000 + 7 * wave(column) + 5 * wave(row + column / 3) + rough) as u16
}

/// Most bytes that the process had in memory, where the system tells it.
fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}
