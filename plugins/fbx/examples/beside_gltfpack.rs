//! Bytes of clips under `EXT_meshopt_compression`, beside those that gltfpack makes of the same files, at the same error.
//!
//! `cargo run --release -p dolomite_fbx --no-default-features --features meshopt --example beside_gltfpack -- CLI.js FOLDER [OTHERS]`
//!
//! CLI.js is the npm package gltfpack's; `scripts/compare-gltfpack` installs it and calls this. Each FBX file of
//! FOLDER is converted plainly and very exactly; gltfpack packs that with several settings; what it made is read
//! back by the crate's own checker and held against the exact file. Then the FBX file is converted with
//! `Compression::Meshopt` and that error as its bound, and held against the exact file in the same way. OTHERS is a folder of .glb files that FBX2glTF
//! made (`a/b.fbx` is `a__b.fbx.glb` there), which are held against the exact file too. One line
//! of JSON for each file and setting, and one for all. Files in which nothing moves are left out.

use dolomite_fbx::check::Played;
use dolomite_fbx::{Compression, Effort, Options, Origin, convert};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What ours is held against.
struct Setting {
    name: &'static str,
    /// What is packed: the exact file, or FBX2glTF's.
    baked: bool,
    /// gltfpack's; without any the file is taken as it is.
    flags: Option<&'static [&'static str]>,
}

/// From exact to coarse. Without `-cc` gltfpack has no filters, and its settings of bits no effect on rotations.
const SETTINGS: [Setting; 6] = [
    Setting {
        name: "gltfpack -cc, 16 bits, 60 Hz",
        baked: false,
        flags: Some(&["-cc", "-ar", "16", "-at", "20", "-as", "20", "-af", "60"]),
    },
    Setting {
        name: "gltfpack -cc, 16 bits, 30 Hz",
        baked: false,
        flags: Some(&["-cc", "-ar", "16", "-at", "20", "-as", "20"]),
    },
    Setting {
        name: "gltfpack -cc, 14 bits, 30 Hz",
        baked: false,
        flags: Some(&["-cc", "-ar", "14", "-at", "16", "-as", "16"]),
    },
    Setting {
        name: "gltfpack -cc as it comes: 12 bits, 30 Hz",
        baked: false,
        flags: Some(&["-cc"]),
    },
    Setting {
        name: "FBX2glTF, then gltfpack -cc, 16 bits, its keys",
        baked: true,
        flags: Some(&["-cc", "-ar", "16", "-at", "20", "-as", "20", "-af", "0"]),
    },
    Setting {
        name: "FBX2glTF alone",
        baked: true,
        flags: None,
    },
];

/// Errors above this share of the model's size are no loss of precision.
const ANOTHER: f64 = 0.1;

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

/// `None` where gltfpack refuses the file.
fn packed(cli: &Path, work: &Path, glb: &Path, flags: &[&str]) -> std::io::Result<Option<Vec<u8>>> {
    let out = work.join("packed.glb");
    let _ = std::fs::remove_file(&out);
    let status = Command::new("node")
        .arg(cli)
        .arg("-kn")
        .args(flags)
        .arg("-i")
        .arg(glb)
        .arg("-o")
        .arg(&out)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()?;
    match status.success() && out.exists() {
        true => std::fs::read(out).map(Some),
        false => Ok(None),
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let cli = PathBuf::from(words.next().ok_or("name gltfpack's cli.js")?);
    let folder = PathBuf::from(words.next().ok_or("name a folder")?);
    let others = words.next().map(PathBuf::from);
    let work = std::env::temp_dir().join(format!("dolomite_gltfpack_{}", std::process::id()));
    std::fs::create_dir_all(&work)?;
    let mut paths = Vec::new();
    files_below(&folder, &mut paths)?;
    paths.sort();
    let mut sums = [(0_usize, 0_usize, 0_usize); SETTINGS.len()];
    for path in paths {
        let bytes = std::fs::read(&path)?;
        let origin = Origin {
            name: path.display().to_string(),
            ..Origin::default()
        };
        let exact = Options {
            max_error: 1e-6,
            max_relative_error: f64::INFINITY,
            ..Options::default()
        };
        let Ok(exact) = convert(&bytes, &origin, &exact) else {
            continue;
        };
        let glb = exact.to_glb()?;
        let input = work.join("exact.glb");
        std::fs::write(&input, &glb)?;
        let truth = Played::read(&glb)?;
        let name = path.strip_prefix(&folder)?.to_string_lossy().into_owned();
        let bake = others
            .as_ref()
            .map(|folder| folder.join(format!("{}.glb", name.replace('/', "__"))))
            .filter(|bake| bake.exists());
        for (setting, sum) in SETTINGS.iter().zip(&mut sums) {
            let source = match (setting.baked, &bake) {
                (false, _) => &input,
                (true, Some(bake)) => bake,
                (true, None) => continue,
            };
            let theirs = match setting.flags {
                Some(flags) => packed(&cli, &work, source, flags)?,
                None => Some(std::fs::read(source)?),
            };
            let Some(theirs) = theirs else {
                eprintln!("{name}: gltfpack refuses it");
                continue;
            };
            let Ok(theirs) = Played::read(&theirs) else {
                eprintln!("{name}, {}: cannot be read", setting.name);
                continue;
            };
            if truth.rest_from(&theirs) > 1e-3 * exact.report.size {
                eprintln!("{name}, {}: stands elsewhere at rest", setting.name);
                continue;
            }
            let Some(error) = truth.farthest_from(&theirs) else {
                eprintln!("{name}, {}: something is left out", setting.name);
                continue;
            };
            // As far off as that it is another motion, in another unit or at another time.
            if error > ANOTHER * exact.report.size {
                eprintln!("{name}, {}: off by {error:.1e} m", setting.name);
                continue;
            }
            if theirs.animation_bytes() == 0 || error <= 0.0 {
                continue;
            }
            let mut bound = error;
            let (mut ours, mut own);
            let mut tries = 0;
            // Measured at the same times in the same way, which are not those that the bound was held at.
            loop {
                let options = Options {
                    max_error: bound,
                    max_relative_error: f64::INFINITY,
                    compress: Compression::Meshopt,
                    effort: Effort::Thorough,
                    ..Options::default()
                };
                ours = Played::read(&convert(&bytes, &origin, &options)?.to_glb()?)?;
                own = truth.farthest_from(&ours).unwrap_or(f64::INFINITY);
                tries += 1;
                if own <= error || tries == 4 {
                    break;
                }
                bound *= 0.95 * error / own;
            }
            sum.0 += ours.animation_bytes();
            sum.1 += theirs.animation_bytes();
            sum.2 += usize::from(own > error);
            println!(
                "{}",
                serde_json::json!({
                    "file": name,
                    "setting": setting.name,
                    "their_error": error,
                    "our_error": own,
                    "their_bytes": theirs.animation_bytes(),
                    "our_bytes": ours.animation_bytes(),
                })
            );
        }
    }
    std::fs::remove_dir_all(&work)?;
    for (setting, (ours, theirs, worse)) in SETTINGS.iter().zip(sums) {
        println!(
            "{}",
            serde_json::json!({
                "setting": setting.name,
                "our_bytes": ours,
                "their_bytes": theirs,
                "ratio": ours as f64 / theirs.max(1) as f64,
                "files_with_a_larger_error_of_ours": worse,
            })
        );
    }
    Ok(())
}
