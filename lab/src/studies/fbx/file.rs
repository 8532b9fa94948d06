//! The files of a folder, and their reference frames.

use dolomite_fbx::check::{Frame, read_frames};
use std::path::{Path, PathBuf};

/// An FBX file.
#[derive(Debug, Clone, PartialEq)]
pub struct FbxFile {
    /// Where it is.
    pub path: PathBuf,
    /// Where it is below the folder, with `/`.
    pub name: String,
    /// Meshes that it is to come to.
    pub frames: Vec<(PathBuf, Frame)>,
}

/// Every .fbx below a folder, sorted by name, with the frames that a `frames.json` in it lists.
///
/// # Errors
/// One sentence on what could not be read.
pub fn files_below(folder: &Path) -> Result<Vec<FbxFile>, String> {
    let mut paths = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        let entries = std::fs::read_dir(&next).map_err(|e| format!("{}: {e}", next.display()))?;
        for entry in entries {
            let path = entry
                .map_err(|e| format!("{}: {e}", next.display()))?
                .path();
            if path.is_dir() {
                folders.push(path);
            } else if path
                .extension()
                .is_some_and(|ending| ending.eq_ignore_ascii_case("fbx"))
            {
                paths.push(path);
            }
        }
    }
    paths.sort();
    let list = folder.join("frames.json");
    let frames = match list.is_file() {
        true => read_frames(&list).map_err(|error| error.to_string())?,
        false => Vec::new(),
    };
    let file = |path: PathBuf| {
        let below = path.strip_prefix(folder).unwrap_or(&path);
        let name = below.to_string_lossy().replace('\\', "/");
        let own = frames.iter().filter(|frame| frame.fbx == name);
        FbxFile {
            frames: own
                .map(|frame| (folder.join(&frame.obj), frame.clone()))
                .collect(),
            name,
            path,
        }
    };
    Ok(paths.into_iter().map(file).collect())
}
