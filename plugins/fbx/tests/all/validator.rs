//! Every result through Khronos' glTF validator: no error, no warning.
//!
//! It is an npm package, which `scripts/lib/node.sh` installs. Without it these tests skip, with a line that says
//! so; in CI they fail.

use crate::support::ascii;
use crate::support::{files_below, shared_fbx};
use dolomite_fbx::{Compression, Effort, Options, Origin, Weights, convert};
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn is_there() -> bool {
    let package = root().join("tests/node/node_modules/gltf-validator/package.json");
    // Packages may lie there of a machine that had Node.
    let runs = Command::new("node").arg("--version").output().is_ok();
    if runs && package.exists() {
        return true;
    }
    let line =
        "Node or the npm package gltf-validator is not installed: scripts/lib/node.sh does that";
    assert!(
        std::env::var_os("CI").is_none(),
        "CI must not skip the validator: {line}"
    );
    eprintln!("skipped: {line}");
    false
}

/// Whether all files are valid, and what the validator said.
fn validate(files: &[PathBuf]) -> (bool, String) {
    let run = Command::new("node")
        .arg(root().join("tests/node/validate.mjs"))
        .args(files)
        .output()
        .expect("node runs");
    let said =
        String::from_utf8_lossy(&run.stdout).into_owned() + &String::from_utf8_lossy(&run.stderr);
    (run.status.success(), said)
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("dolomite_fbx_{name}_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the temporary folder can be written");
    folder
}

#[test]
fn every_result_is_valid() {
    if !is_there() {
        return;
    }
    let folder = folder("valid");
    let mut files = Vec::new();
    let mut take = |bytes: &[u8], origin: Origin, options: &Options| {
        let Ok(made) = convert(bytes, &origin, options) else {
            return false;
        };
        let path = folder.join(format!("{}.glb", files.len()));
        std::fs::write(&path, made.to_glb().unwrap()).unwrap();
        files.push(path);
        true
    };
    let eight = Options {
        weights: Weights::Eight,
        ..Options::default()
    };
    let thorough = Options {
        effort: Effort::Thorough,
        ..Options::default()
    };
    let mut options = vec![Options::default(), eight, thorough];
    if cfg!(feature = "meshopt") {
        options.push(Options {
            compress: Compression::Meshopt,
            ..Options::default()
        });
    }
    for options in &options {
        let strip = ascii::strip(90.0);
        assert!(take(strip.as_bytes(), Origin::default(), options));
    }
    // A hidden node with properties of a user.
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let text = std::fs::read_to_string(cases.join("field/a10_user_properties.fbx")).unwrap();
    let off = "P: \"Visibility\", \"Visibility\", \"\", \"A\",0\n P: \"mass\"";
    let text = text.replace("P: \"mass\"", off);
    assert!(text.contains("Visibility"));
    assert!(take(text.as_bytes(), Origin::default(), &options[0]));
    let hero = root().join("assets/hero/hero.fbx");
    let shared = shared_fbx().map(|folder| files_below(&folder));
    for path in [hero.clone()]
        .into_iter()
        .chain(files_below(&cases))
        .chain(shared.into_iter().flatten())
    {
        let origin = Origin {
            name: path.display().to_string(),
            folder: path.parent().map(Into::into),
            ..Origin::default()
        };
        let bytes = std::fs::read(&path).unwrap();
        for options in &options {
            // Among the shared files some are broken, and refused.
            let made = take(&bytes, origin.clone(), options);
            assert!(made || path != hero);
        }
    }
    let (valid, said) = validate(&files);
    std::fs::remove_dir_all(folder).unwrap();
    println!("{said}");
    assert!(valid, "{said}");
    assert_eq!(said.trim(), format!("{} files, 0 not valid", files.len()));
}

/// Some views of a file are compressed and some are not: those that would be no smaller.
#[cfg(feature = "meshopt")]
#[test]
fn views_of_both_kinds_are_valid() {
    if !is_there() {
        return;
    }
    let text = crate::support::motions::shaken(300);
    let options = Options {
        compress: Compression::Meshopt,
        ..Options::default()
    };
    let made = convert(text.as_bytes(), &Origin::default(), &options).unwrap();
    let files = made.to_gltf("mixed");
    let root: serde_json::Value = serde_json::from_slice(&files.json).unwrap();
    let views = root["bufferViews"].as_array().unwrap();
    let of_kind = |buffer: u64| {
        let own = views.iter().filter(|view| view["buffer"] == buffer);
        own.filter(|view| view.get("extensions").is_some() == (buffer == 1))
            .count()
    };
    let (plain, packed) = (of_kind(0), of_kind(1));
    assert!(plain > 0 && packed > 0, "{plain} plain, {packed} packed");
    assert_eq!(plain + packed, views.len());
    let folder = folder("mixed");
    let path = folder.join("mixed.glb");
    std::fs::write(&path, made.to_glb().unwrap()).unwrap();
    let (valid, said) = validate(&[path]);
    std::fs::remove_dir_all(folder).unwrap();
    println!("{said}");
    assert!(valid, "{said}");
}

/// Materials of the field's cases: transforms and emission are extensions.
#[test]
fn looks_are_valid() {
    if !is_there() {
        return;
    }
    let data = root().join("plugins/fbx/tests/data/field");
    let folder = folder("looks");
    let mut files = Vec::new();
    for path in files_below(&data) {
        let origin = Origin {
            name: path.display().to_string(),
            folder: Some(data.clone()),
            ..Origin::default()
        };
        let bytes = std::fs::read(&path).unwrap();
        let made = convert(&bytes, &origin, &Options::default()).unwrap();
        let to = folder.join(format!("{}.glb", files.len()));
        std::fs::write(&to, made.to_glb().unwrap()).unwrap();
        files.push(to);
    }
    let (valid, said) = validate(&files);
    std::fs::remove_dir_all(folder).unwrap();
    println!("{said}");
    assert!(valid && files.len() >= 4, "{said}");
}

#[test]
fn a_file_with_an_error_is_refused() {
    if !is_there() {
        return;
    }
    let folder = folder("broken");
    let text = ascii::strip(90.0);
    let made = convert(text.as_bytes(), &Origin::default(), &Options::default()).unwrap();
    let sound = made.to_glb().unwrap();
    // The first mesh that a node names is another one, which does not exist.
    let at = sound
        .windows(8)
        .position(|bytes| bytes == b"\"mesh\":0")
        .unwrap();
    let mut broken = sound.clone();
    broken[at + 7] = b'9';
    let files = [folder.join("sound.glb"), folder.join("broken.glb")];
    std::fs::write(&files[0], sound).unwrap();
    std::fs::write(&files[1], broken).unwrap();
    let (valid, said) = validate(&files);
    std::fs::remove_dir_all(folder).unwrap();
    assert!(!valid && said.contains("UNRESOLVED_REFERENCE"), "{said}");
    assert!(said.contains("2 files, 1 not valid"), "{said}");
}
