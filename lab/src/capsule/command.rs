//! `dolomite_lab capsule`: writes capsules.

use std::path::PathBuf;

use clap::Parser;
use dolomite_testkit::gpu::Gpu;

use super::CapsuleError;
use super::list::{Entry, Settings, all};
use super::native::{Native, ROUND};

/// Writes capsules: runs of compute passes with all that they need and all that must come out, for any
/// implementation of WebGPU.
#[derive(Debug, Parser)]
#[command(name = "dolomite_lab capsule")]
pub struct Arguments {
    /// Which; `all` for every one, `short` for those that CI plays
    #[arg(required_unless_present = "list")]
    pub name: Option<String>,
    /// The file; for `all` and `short` the folder, which is made if need be
    #[arg(long, value_name = "FILE", required_unless_present_any = ["list", "time"])]
    pub out: Option<PathBuf>,
    /// Prints what capsules there are
    #[arg(long)]
    pub list: bool,
    /// Seed of what is random in them
    #[arg(long, default_value_t = 1)]
    pub seed: u32,
    /// Patches of `tuples`
    #[arg(long, default_value_t = 10_000)]
    pub count: usize,
    /// Runs its passes in so many rounds on this machine's Vulkan adapter, and says how long they take, in place of
    /// writing a file
    #[arg(long, value_name = "ROUNDS")]
    pub time: Option<usize>,
}

/// Does what was asked for; gives the lines to print.
///
/// # Errors
/// [`CapsuleError`].
pub fn run(arguments: &Arguments) -> Result<Vec<String>, CapsuleError> {
    let entries = all();
    let settings = Settings {
        seed: arguments.seed,
        count: arguments.count,
    };
    if let (Some(name), Some(repeats)) = (&arguments.name, arguments.time) {
        return time(&entries, name, settings, repeats);
    }
    let (Some(name), Some(out), false) = (&arguments.name, &arguments.out, arguments.list) else {
        let line = |entry: &Entry| format!("{:<30} {}", entry.name, entry.about);
        return Ok(entries.iter().map(line).collect());
    };
    let short = name == "short";
    let every = name == "all" || short;
    let chosen: Vec<&Entry> = entries
        .iter()
        .filter(|entry| every && (entry.is_short() || !short) || entry.name == *name)
        .collect();
    if chosen.is_empty() {
        return Err(CapsuleError::Unknown(name.clone()));
    }
    let file = |path: PathBuf| move |source| CapsuleError::File { path, source };
    if every {
        std::fs::create_dir_all(out).map_err(file(out.clone()))?;
    }
    let mut lines = Vec::new();
    for entry in chosen {
        let path = if every {
            out.join(format!("{}.capsule", entry.name))
        } else {
            out.clone()
        };
        let bytes = entry.make(settings)?.to_bytes();
        std::fs::write(&path, &bytes).map_err(file(path.clone()))?;
        lines.push(format!(
            "written: {} ({} bytes)",
            path.display(),
            bytes.len()
        ));
    }
    Ok(lines)
}

/// The times of a capsule's passes on this machine, milliseconds.
fn time(
    entries: &[Entry],
    name: &str,
    settings: Settings,
    repeats: usize,
) -> Result<Vec<String>, CapsuleError> {
    let entry = entries.iter().find(|entry| entry.name == name);
    let entry = entry.ok_or_else(|| CapsuleError::Unknown(name.to_owned()))?;
    let capsule = entry.make(settings)?;
    let gpu = Gpu::new()?;
    let native = Native::new(&gpu, &capsule)?;
    // The first compiles what the driver has left for then.
    native.times(2)?;
    let mut times = native.times(repeats.max(1))?;
    times.sort_unstable();
    let milliseconds = |at: usize| 1e3 * times[at].as_secs_f64();
    Ok(vec![format!(
        "{name} on {}: {} rounds of {ROUND} runs; a run: shortest {:.2} ms, median {:.2} ms, longest {:.2} ms",
        gpu.name,
        times.len(),
        milliseconds(0),
        milliseconds(times.len() / 2),
        milliseconds(times.len() - 1),
    )])
}
