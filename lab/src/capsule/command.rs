//! `dolomite_lab capsule`: writes capsules.

use std::path::PathBuf;

use clap::Parser;

use super::CapsuleError;
use super::list::{Entry, Settings, all};

/// Writes capsules: runs of compute passes with all that they need and all that must come out, for any
/// implementation of WebGPU.
#[derive(Debug, Parser)]
#[command(name = "dolomite_lab capsule")]
pub struct Arguments {
    /// Which; `all` for every one
    #[arg(required_unless_present = "list")]
    pub name: Option<String>,
    /// The file; for `all` the folder, which is made if need be
    #[arg(long, value_name = "FILE", required_unless_present = "list")]
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
}

/// Does what was asked for; gives the lines to print.
///
/// # Errors
/// [`CapsuleError`].
pub fn run(arguments: &Arguments) -> Result<Vec<String>, CapsuleError> {
    let entries = all();
    let (Some(name), Some(out), false) = (&arguments.name, &arguments.out, arguments.list) else {
        let line = |entry: &Entry| format!("{:<30} {}", entry.name, entry.about);
        return Ok(entries.iter().map(line).collect());
    };
    let every = name == "all";
    let chosen: Vec<&Entry> = entries
        .iter()
        .filter(|entry| every || entry.name == *name)
        .collect();
    if chosen.is_empty() {
        return Err(CapsuleError::Unknown(name.clone()));
    }
    let file = |path: PathBuf| move |source| CapsuleError::File { path, source };
    if every {
        std::fs::create_dir_all(out).map_err(file(out.clone()))?;
    }
    let settings = Settings {
        seed: arguments.seed,
        count: arguments.count,
    };
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
