//! The texts of the repository.

use std::fs;
use std::path::Path;

/// Kinds of files that are read.
const TEXTS: [&str; 10] = [
    "rs", "wgsl", "md", "ron", "toml", "json", "py", "sh", "c", "svg",
];

/// A file of the repository.
pub struct File {
    /// From the root, with `/`.
    pub path: String,
    /// What is in it.
    pub text: String,
}

/// The repository.
pub fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// Path of every file of the repository, with `/`, relative to its root.
pub fn all_paths() -> Vec<String> {
    let mut paths = Vec::new();
    let mut folders = vec![root().to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of the repository") {
            let entry = entry.expect("an entry of a folder");
            let name = entry.file_name().to_string_lossy().into_owned();
            if entry.path().is_dir() {
                // Build results and what git keeps for itself; `shared` is data beside the project.
                let ours = (!name.starts_with('.') || name == ".ci" || name == ".config")
                    && !["target", "node_modules", "shared", "__pycache__"].contains(&&*name);
                if ours {
                    folders.push(entry.path());
                }
            } else {
                let path = entry.path();
                let path = path.strip_prefix(root()).expect("below the root");
                let parts: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
                paths.push(parts.join("/"));
            }
        }
    }
    paths.sort();
    paths
}

/// The ending of a file's name.
pub fn ending(path: &str) -> Option<&str> {
    Path::new(path).extension()?.to_str()
}

/// Every text of the repository. Scripts have no ending.
pub fn all_texts() -> Vec<File> {
    let texts = all_paths().into_iter().filter(|path| {
        ending(path).is_some_and(|ending| TEXTS.contains(&ending))
            || path.starts_with("scripts/")
            || path.starts_with(".ci/")
    });
    let texts: Vec<File> = texts
        .filter_map(|path| {
            let text = fs::read_to_string(root().join(&path)).ok()?;
            Some(File { path, text })
        })
        .collect();
    assert!(texts.len() > 300, "{} texts: read too little", texts.len());
    texts
}
