//! What the clips of a folder's FBX files cost as glTF, property by property, and how much of the
//! error that was allowed is spent.
//!
//! `cargo run --release -p dolomite_fbx --example animation_bytes -- FOLDER [METRES] [quick|thorough] [OTHERS] [--compress]`
//!
//! With `--compress` all is written once more under `EXT_meshopt_compression`, and its bytes are counted beside
//! (needs `--features meshopt`).
//!
//! OTHERS is a folder of .glb files that another program made of the same files; the file `a/b.fbx` is
//! `a__b.fbx.glb` there. Their bytes are counted in the same way. Files that are refused are left out.

use dolomite_fbx::check::Played;
use dolomite_fbx::model::{Channel, Interpolation, Model, Property};
use dolomite_fbx::{Compression, Effort, Options, Origin, convert};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Bytes of a file's clips; what several channels share is counted once.
#[derive(Default, Clone, Copy)]
struct Bytes {
    times: usize,
    /// Translations, rotations, scales, weights.
    values: [usize; 4],
    /// Lists of times that differ.
    time_lists: usize,
    keys: usize,
    /// Of these, those of cubic channels.
    cubic: usize,
    channels: usize,
    /// Of these, those of one key.
    single: usize,
}

impl Bytes {
    fn of(model: &Model) -> Self {
        let mut out = Self::default();
        let (mut times, mut values) = (BTreeSet::new(), BTreeSet::new());
        for channel in model.clips.iter().flat_map(|clip| &clip.channels) {
            let bits = |list: &[f32]| list.iter().map(|x| x.to_bits()).collect::<Vec<u32>>();
            if times.insert(bits(&channel.times)) {
                out.times += channel.times.len() * 4;
                out.time_lists += 1;
            }
            out.keys += channel.times.len();
            out.channels += 1;
            out.single += usize::from(channel.times.len() == 1);
            if channel.interpolation == Interpolation::Cubic {
                out.cubic += channel.times.len();
            }
            if values.insert((channel.property, channel.short, bits(&channel.values))) {
                let slot = match channel.property {
                    Property::Translation => 0,
                    Property::Rotation => 1,
                    Property::Scale => 2,
                    Property::Weights => 3,
                };
                out.values[slot] += value_bytes(channel);
            }
        }
        out
    }
}

fn value_bytes(channel: &Channel) -> usize {
    channel.values.len() * if channel.short { 2 } else { 4 }
}

fn files_below(folder: &Path, out: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            files_below(&path, out)?;
        } else if path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("fbx"))
        {
            out.push(path);
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let compress = std::env::args().any(|word| word == "--compress");
    let mut words = std::env::args().skip(1).filter(|word| word != "--compress");
    let folder = PathBuf::from(words.next().ok_or("name a folder")?);
    let max_error: f64 = words.next().map_or(Ok(1e-4), |word| word.parse())?;
    let effort = match words.next().as_deref() {
        None | Some("thorough") => Effort::Thorough,
        Some("quick") => Effort::Quick,
        Some(other) => return Err(format!("{other}: quick or thorough").into()),
    };
    let others = words.next().map(PathBuf::from);
    let options = Options {
        effort,
        max_error,
        max_relative_error: f64::INFINITY,
        ..Options::default()
    };
    let mut paths = Vec::new();
    files_below(&folder, &mut paths)?;
    paths.sort();
    println!(
        "{:<58} {:>8} {:>8} {:>8} {:>8} {:>8} {:>7} {:>6}/{:<6} {:>7} {:>5} {:>4}/{:<4} {:>5} {:>6} {:>8} {:>6} {:>8} {:>6} {:>7} size",
        "file",
        "bytes",
        "times",
        "transl",
        "rotat",
        "scale",
        "weight",
        "keys",
        "baked",
        "cubic",
        "lists",
        "chan",
        "one",
        "B/key",
        "spent",
        "other",
        "ratio",
        "coded",
        "ratio",
        "ms"
    );
    let (mut ours, mut theirs, mut coded) = (0, 0, 0);
    for path in paths {
        let name = path
            .strip_prefix(&folder)?
            .to_string_lossy()
            .replace('/', "__");
        let bytes = std::fs::read(&path)?;
        let origin = Origin {
            name: name.clone(),
            ..Origin::default()
        };
        let began = Instant::now();
        let Ok(made) = convert(&bytes, &origin, &options) else {
            continue;
        };
        let ms = began.elapsed().as_secs_f64() * 1e3;
        let report = &made.report;
        let count = Bytes::of(&made.model);
        let total = count.times + count.values.iter().sum::<usize>();
        let spent = report
            .clips
            .iter()
            .map(|c| c.keyed_error)
            .fold(0.0, f64::max)
            / report.bound;
        let other = others
            .as_ref()
            .and_then(|folder| std::fs::read(folder.join(format!("{name}.glb"))).ok())
            .and_then(|glb| Played::read(&glb).ok())
            .map(|played| played.animation_bytes());
        let packed = Options {
            compress: Compression::Meshopt,
            ..options
        };
        let packed = match compress {
            true => Some(convert(&bytes, &origin, &packed)?.report),
            false => None,
        };
        let packed_bytes = packed.as_ref().map(|report| report.animation_bytes);
        if let Some(other) = other {
            ours += total;
            theirs += other;
            coded += packed_bytes.unwrap_or(0);
        }
        println!(
            "{:<58} {:>8} {:>8} {:>8} {:>8} {:>8} {:>7} {:>6}/{:<6} {:>7} {:>5} {:>4}/{:<4} {:>5.1} {:>6.2} {:>8} {:>6.2} {:>8} {:>6.2} {:>7.1} {:.2}m",
            name,
            total,
            count.times,
            count.values[0],
            count.values[1],
            count.values[2],
            count.values[3],
            count.keys,
            report.baked(),
            count.cubic,
            count.time_lists,
            count.channels,
            count.single,
            total as f64 / count.keys.max(1) as f64,
            spent,
            other.map_or("-".into(), |b| b.to_string()),
            other.map_or(f64::NAN, |b| total as f64 / b as f64),
            packed_bytes.map_or("-".into(), |b| b.to_string()),
            packed_bytes
                .zip(other)
                .map_or(f64::NAN, |(a, b)| a as f64 / b as f64),
            ms,
            report.size
        );
    }
    if theirs > 0 {
        let ratio = ours as f64 / theirs as f64;
        println!("{ours} bytes, {theirs} of the others: {ratio:.3}");
        if compress {
            let ratio = coded as f64 / theirs as f64;
            println!("{coded} bytes compressed, {theirs} of the others: {ratio:.3}");
        }
    }
    Ok(())
}
