//! Every result through Khronos' glTF validator.
//!
//! Skips where the npm package `gltf-validator` (2.0.0-dev.3.10) is not installed: name its folder by
//! `GLTF_VALIDATOR`, for example after `npm install gltf-validator@2.0.0-dev.3.10` in some folder
//! `GLTF_VALIDATOR=that/folder/node_modules/gltf-validator`.

#[path = "support/ascii.rs"]
mod ascii;
mod support;

use dolomite_fbx::{Effort, Options, Origin, Weights, convert};
use std::process::Command;
use support::{files_below, shared_fbx};

const SCRIPT: &str = r#"
const [folder, ...files] = process.argv.slice(1);
const validator = require(folder), fs = require('fs');
(async () => {
  let bad = 0;
  for (const file of files) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 0 });
    if (report.issues.numErrors + report.issues.numWarnings > 0) {
      bad += 1;
      console.log(file, JSON.stringify(report.issues.messages.filter(m => m.severity < 2).slice(0, 3)));
    }
  }
  process.exit(bad ? 1 : 0);
})();
"#;

#[test]
fn every_result_is_valid() {
    let Some(validator) = std::env::var_os("GLTF_VALIDATOR") else {
        eprintln!("skipped: GLTF_VALIDATOR names no folder");
        return;
    };
    let folder = std::env::temp_dir().join(format!("dolomite_fbx_valid_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut files = Vec::new();
    let mut take = |bytes: &[u8], origin: Origin, options: &Options| {
        if let Ok(made) = convert(bytes, &origin, options) {
            let path = folder.join(format!("{}.glb", files.len()));
            std::fs::write(&path, made.to_glb().unwrap()).unwrap();
            files.push(path);
        }
    };
    let eight = Options {
        weights: Weights::Eight,
        ..Options::default()
    };
    let thorough = Options {
        effort: Effort::Thorough,
        ..Options::default()
    };
    take(ascii::strip(90.0).as_bytes(), Origin::default(), &eight);
    take(ascii::strip(90.0).as_bytes(), Origin::default(), &thorough);
    for path in shared_fbx()
        .map(|folder| files_below(&folder))
        .unwrap_or_default()
    {
        let origin = Origin {
            name: path.display().to_string(),
            folder: path.parent().map(Into::into),
            ..Origin::default()
        };
        let bytes = std::fs::read(&path).unwrap();
        take(&bytes, origin.clone(), &Options::default());
        take(&bytes, origin.clone(), &thorough);
        take(&bytes, origin, &eight);
    }
    let run = Command::new("node")
        .arg("-e")
        .arg(SCRIPT)
        .arg(validator)
        .args(&files)
        .output()
        .unwrap();
    let said =
        String::from_utf8_lossy(&run.stdout).into_owned() + &String::from_utf8_lossy(&run.stderr);
    std::fs::remove_dir_all(folder).unwrap();
    assert!(run.status.success(), "{said}");
    eprintln!("{} files are valid", files.len());
}
