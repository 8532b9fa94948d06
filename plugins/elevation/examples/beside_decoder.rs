//! How long reading takes beside the decoder alone: PNG of 16 bits against the `png` crate, raw u16 against reading the bytes
//! and making numbers of them on one core.
//!
//! `cargo run --release -p dolomite_elevation --example beside_decoder -- [SIDE_OF_PNG SIDE_OF_RAW]`

use dolomite_elevation::{Elevation, NumberType, Options, Raw};
use std::error::Error;
use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Write};
use std::path::Path;
use std::time::Instant;

/// Rounds; the median counts.
const ROUNDS: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let mut sides = std::env::args().skip(1).map(|side| side.parse::<u32>());
    let png_side = sides.next().transpose()?.unwrap_or(8193);
    let raw_side = sides.next().transpose()?.unwrap_or(16_385);
    let folder = std::env::temp_dir().join(format!("dolomite-beside-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let [png, raw] = ["a.png", "a.raw"].map(|name| folder.join(name));
    write_png(&png, png_side)?;
    compare(
        "PNG",
        png_side,
        || png_alone(&png),
        || Elevation::read(&png, &Options::default()).map(|map| map.samples.len()),
    )?;
    let mut to = BufWriter::with_capacity(1 << 20, File::create(&raw)?);
    for row in 0..raw_side {
        to.write_all(&line(row, raw_side).concat())?;
    }
    drop(to);
    let options = Options {
        raw: Some(Raw {
            size: Some([raw_side; 2]),
            number: Some(NumberType::U16),
            ..Raw::default()
        }),
        ..Options::default()
    };
    compare(
        "raw u16",
        raw_side,
        || raw_alone(&raw),
        || Elevation::read(&raw, &options).map(|map| map.samples.len()),
    )?;
    std::fs::remove_dir_all(&folder)?;
    Ok(())
}

/// Hills with some roughness.
fn line(row: u32, side: u32) -> Vec<[u8; 2]> {
    let height = |column: u32| {
        let wave = |n: u32| {
            let n = n % 2000;
            n.min(2000 - n)
        };
        let rough = (column.wrapping_mul(0x9e37_79b9) ^ row.wrapping_mul(0x85eb_ca6b)) >> 29;
        (9000 + 7 * wave(column) + 5 * wave(row + column / 3) + rough) as u16
    };
    (0..side)
        .map(|column| height(column).to_le_bytes())
        .collect()
}

fn write_png(path: &Path, side: u32) -> Result<(), Box<dyn Error>> {
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), side, side);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    let mut rows = writer.stream_writer()?;
    for row in 0..side {
        let big: Vec<u8> = line(row, side)
            .into_iter()
            .flat_map(|[low, high]| [high, low])
            .collect();
        rows.write_all(&big)?;
    }
    rows.finish()?;
    Ok(())
}

fn png_alone(path: &Path) -> Result<usize, Box<dyn Error>> {
    let mut decoder = png::Decoder::new(BufReader::new(File::open(path)?));
    decoder.set_transformations(png::Transformations::IDENTITY);
    let mut reader = decoder.read_info()?;
    let mut bytes = vec![0; reader.output_buffer_size().ok_or("too large")?];
    reader.next_frame(&mut bytes)?;
    Ok(bytes.len() / 2)
}

fn raw_alone(path: &Path) -> Result<usize, Box<dyn Error>> {
    let mut file = File::open(path)?;
    let count = file.metadata()?.len() as usize / 2;
    let mut samples = Vec::with_capacity(count);
    let mut piece = vec![0; 1 << 17];
    loop {
        let read = file.read(&mut piece)?;
        if read == 0 {
            return Ok(samples.len());
        }
        let (pairs, _) = piece[..read].as_chunks::<2>();
        samples.extend(pairs.iter().map(|b| f32::from(u16::from_le_bytes(*b))));
    }
}

/// Both by turns.
fn compare<A: Into<Box<dyn Error>>, B: Into<Box<dyn Error>>>(
    name: &str,
    side: u32,
    alone: impl Fn() -> Result<usize, A>,
    ours: impl Fn() -> Result<usize, B>,
) -> Result<(), Box<dyn Error>> {
    let mut seconds = [Vec::new(), Vec::new()];
    for _ in 0..ROUNDS {
        let began = Instant::now();
        let a = alone().map_err(Into::into)?;
        seconds[0].push(began.elapsed().as_secs_f64());
        let began = Instant::now();
        let b = ours().map_err(Into::into)?;
        seconds[1].push(began.elapsed().as_secs_f64());
        assert_eq!(a, b, "both read all samples");
    }
    let [alone, ours] = seconds.map(|mut seconds| {
        seconds.sort_by(f64::total_cmp);
        seconds[ROUNDS / 2]
    });
    println!(
        "{name} {side} x {side}: decoder alone {alone:.3} s, read {ours:.3} s, {:.2} times",
        ours / alone
    );
    Ok(())
}
