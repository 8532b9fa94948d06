//! Where the shared test files are.

use std::path::PathBuf;

/// The folder `data/fbx` of the shared data; `None`, said aloud, where it is absent.
///
/// # Panics
/// Under CI, where absence is a mistake.
pub fn shared_fbx() -> Option<PathBuf> {
    let root = std::env::var_os("DOLOMITE_SHARED").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    let folder = root.join("data/fbx");
    if folder.is_dir() {
        return Some(folder);
    }
    assert!(std::env::var_os("CI").is_none(), "no {}", folder.display());
    eprintln!("skipped: no {}; set DOLOMITE_SHARED", folder.display());
    None
}

/// Every .fbx below a folder, sorted.
pub fn files_below(folder: &std::path::Path) -> Vec<PathBuf> {
    let mut out = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder that was listed") {
            let path = entry.expect("an entry of it").path();
            match path.is_dir() {
                true => folders.push(path),
                false if path.extension().is_some_and(|e| e == "fbx") => out.push(path),
                false => {}
            }
        }
    }
    out.sort();
    out
}
