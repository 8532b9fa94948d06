//! How long a quick conversion takes over ufbx's loading alone, for the FBX files of a folder.
//!
//! `cargo run --release -p dolomite_fbx --no-default-features --example over_load -- FOLDER [REPEATS]`
//!
//! Least times of so many runs (21 unless told), in turn; all files together, and the median of the files.

use dolomite_fbx::check::Truth;
use dolomite_fbx::{Options, Origin, convert};
use std::path::{Path, PathBuf};
use std::time::Instant;

fn files_below(folder: &Path, out: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            files_below(&path, out)?;
        } else if path.extension().is_some_and(|e| e == "fbx") {
            out.push(path);
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let folder = PathBuf::from(words.next().ok_or("name a folder")?);
    let repeats: usize = words.next().map_or(Ok(21), |word| word.parse())?;
    let mut paths = Vec::new();
    files_below(&folder, &mut paths)?;
    paths.sort();
    let (mut whole, mut load, mut ratios) = (0.0, 0.0, Vec::new());
    for path in paths {
        let bytes = std::fs::read(&path)?;
        let origin = Origin::default();
        let options = Options::default();
        if convert(&bytes, &origin, &options).is_err() {
            continue;
        }
        let (mut of_whole, mut of_load) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..repeats {
            let began = Instant::now();
            let made = convert(&bytes, &origin, &options).and_then(|made| made.to_glb());
            of_whole = of_whole.min(began.elapsed().as_secs_f64() * 1e3);
            std::hint::black_box(&made);
            let began = Instant::now();
            std::hint::black_box(&Truth::load_alone(&bytes, &origin));
            of_load = of_load.min(began.elapsed().as_secs_f64() * 1e3);
        }
        println!(
            "{of_whole:8.2} ms {of_load:8.2} ms {:5.2} {}",
            of_whole / of_load,
            path.display()
        );
        whole += of_whole;
        load += of_load;
        ratios.push(of_whole / of_load);
    }
    ratios.sort_by(f64::total_cmp);
    let median = ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN);
    println!(
        "{whole:.1} ms over {load:.1} ms: {:.2}; median of the files {median:.2}",
        whole / load
    );
    Ok(())
}
