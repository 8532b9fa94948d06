//! The second compiler: Tint, by `tests/node/compile.mjs`.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::Command;

use serde_json::{Value, json};

use super::composer::Composed;

/// A shader, and what it is called in the report.
pub struct Named {
    pub name: String,
    pub shader: Composed,
}

/// What Tint said of some shaders.
pub struct Report {
    pub accepted: bool,
    /// A line for each fault, and a last one that counts.
    pub said: String,
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/node")
}

/// False, after a line that says so, where the npm packages are not installed; in CI that fails.
pub fn is_there() -> bool {
    // Packages may lie there of a machine that had Node.
    let runs = Command::new("node").arg("--version").output().is_ok();
    if runs && folder().join("node_modules/webgpu/package.json").exists() {
        return true;
    }
    let line = "Node or the npm package webgpu is not installed: source scripts/lib/system.sh && source scripts/lib/node.sh && need_node_tests";
    assert!(
        std::env::var_os("CI").is_none(),
        "CI must not skip Tint: {line}"
    );
    eprintln!("skipped: {line}");
    false
}

/// Compiles all of them by Tint. Those whose WGSL is the same are compiled once.
pub fn compile(label: &str, shaders: &[Named]) -> Report {
    let out = std::env::temp_dir().join(format!("dolomite_tint_{label}_{}", std::process::id()));
    std::fs::create_dir_all(&out).expect("a folder for WGSL files");
    let mut known = BTreeSet::new();
    let mut list = Vec::new();
    for Named { name, shader } in shaders {
        if !known.insert(&shader.wgsl) {
            continue;
        }
        let file = format!("{}.wgsl", known.len());
        std::fs::write(out.join(&file), &shader.wgsl).expect("a WGSL file");
        let mut entry = shader.entries.clone();
        entry["name"] = Value::from(name.as_str());
        entry["file"] = Value::from(file);
        list.push(entry);
    }
    let text = json!(list).to_string();
    std::fs::write(out.join("shaders.json"), text).expect("the list");
    let run = Command::new("node")
        .arg(folder().join("compile.mjs"))
        .arg(&out)
        .output()
        .expect("node runs");
    let said = String::from_utf8_lossy(&run.stdout).into_owned()
        + String::from_utf8_lossy(&run.stderr).as_ref();
    if run.status.success() {
        std::fs::remove_dir_all(&out).expect("the folder is ours");
    } else {
        eprintln!("the WGSL files are kept in {}", out.display());
    }
    Report {
        accepted: run.status.success(),
        said,
    }
}
