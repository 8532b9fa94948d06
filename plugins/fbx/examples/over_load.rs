//! How long a quick conversion takes over ufbx's loading alone, for the FBX files of a folder.
//!
//! `cargo run --release -p dolomite_fbx --no-default-features --example over_load -- FOLDER [REPEATS]`
//!
//! Time of one thread over so many runs (21 unless told), in turn; all files together, and the median of the files. Where the
//! system says how long a thread was on a processor (Linux), that is what counts, so that others may use the machine too.

use dolomite_fbx::check::Truth;
use dolomite_fbx::{Options, Origin, convert};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Seconds that this thread has run.
fn ran(began: Instant) -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| began.elapsed().as_secs_f64(), |ns| ns * 1e-9)
}

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
    let begun = Instant::now();
    let (mut whole, mut load, mut ratios) = (0.0, 0.0, Vec::new());
    for path in paths {
        let bytes = std::fs::read(&path)?;
        let origin = Origin::default();
        let options = Options {
            threads: 1,
            ..Options::default()
        };
        if convert(&bytes, &origin, &options).is_err() {
            continue;
        }
        // One kind of run after another, since the system counts in steps of milliseconds.
        let each = |run: &dyn Fn()| {
            let began = ran(begun);
            (0..repeats).for_each(|_| run());
            (ran(begun) - began) * 1e3 / repeats as f64
        };
        let of_whole = each(&|| {
            let made = convert(&bytes, &origin, &options).and_then(|made| made.to_glb());
            std::hint::black_box(&made);
        });
        let of_load = each(&|| {
            std::hint::black_box(&Truth::load_alone(&bytes, &origin));
        });
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
