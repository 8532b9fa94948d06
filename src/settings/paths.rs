//! Where the game finds its files: assets, and the settings of the user.

use std::path::{Path, PathBuf};

use bevy::prelude::Resource;
use thiserror::Error;

/// Environment variable that names the assets folder, before all other places.
pub const ASSETS_VARIABLE: &str = "DOLOMITE_ASSETS";

/// A folder that must lie inside an assets folder; tells it from any folder called `assets`.
const MARKER: &str = "scenes";

/// The assets folder of the running game.
#[derive(Resource, Clone, Debug)]
pub struct AssetsDir(pub PathBuf);

/// Why no assets folder was found.
#[derive(Debug, Error)]
pub enum AssetsError {
    /// The folder that the environment names is none of ours.
    #[error(
        "{ASSETS_VARIABLE} names {}, which holds no `{MARKER}` folder: \
         set it to the `assets` folder of Dolomite, or unset it",
        .0.display()
    )]
    NotAssets(PathBuf),
    /// No place held an assets folder.
    #[error(
        "no assets folder found (looked at {}): run from the checkout, or set {ASSETS_VARIABLE} \
         to the `assets` folder of Dolomite",
        .0.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(", ")
    )]
    NotFound(Vec<PathBuf>),
}

/// The folder that holds `scenes`, `dem` and `textures`.
///
/// Looks at the environment variable `DOLOMITE_ASSETS`, beside the executable, in the checkout
/// that the program was built from, and in the current folder, in this order.
///
/// # Errors
/// [`AssetsError`] when the variable names a folder that is no assets folder, or when nothing is
/// found.
pub fn assets_dir() -> Result<PathBuf, AssetsError> {
    if let Some(named) = std::env::var_os(ASSETS_VARIABLE) {
        let named = PathBuf::from(named);
        return if is_assets(&named) {
            Ok(named)
        } else {
            Err(AssetsError::NotAssets(named))
        };
    }
    let beside = std::env::current_exe()
        .ok()
        .and_then(|exe| exe.parent().map(|folder| folder.join("assets")));
    let places: Vec<PathBuf> = beside
        .into_iter()
        .chain([
            Path::new(env!("CARGO_MANIFEST_DIR")).join("assets"),
            PathBuf::from("assets"),
        ])
        .collect();
    match places.iter().find(|place| is_assets(place)) {
        // Absolute, because Bevy reads a relative asset folder from beside the executable.
        Some(found) => Ok(std::path::absolute(found).unwrap_or_else(|_| found.clone())),
        None => Err(AssetsError::NotFound(places)),
    }
}

/// Environment variable that names the folder of shared data.
pub const SHARED_VARIABLE: &str = "DOLOMITE_SHARED";

/// The folder of the larger data that lie beside the project: `named`, else that of the environment
/// variable `DOLOMITE_SHARED`, else `shared` beside the checkout that the program was built from. It
/// need not be there.
pub fn shared_dir(named: Option<&Path>) -> PathBuf {
    let variable = || std::env::var_os(SHARED_VARIABLE).filter(|value| !value.is_empty());
    match named {
        Some(named) => named.to_owned(),
        None => variable().map_or_else(
            || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"),
            PathBuf::from,
        ),
    }
}

fn is_assets(folder: &Path) -> bool {
    folder.join(MARKER).is_dir()
}

/// Where the settings of the user lie when no file is named:
/// `$XDG_CONFIG_HOME/dolomite/settings.ron`, else `~/.config/dolomite/settings.ron`, else (no
/// home folder) none.
pub fn user_settings() -> Option<PathBuf> {
    let config = std::env::var_os("XDG_CONFIG_HOME")
        .filter(|value| !value.is_empty())
        .map(PathBuf::from)
        .or_else(|| std::env::var_os("HOME").map(|home| PathBuf::from(home).join(".config")))?;
    Some(config.join("dolomite").join("settings.ron"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_without_scenes_is_no_assets_folder() {
        let checkout = Path::new(env!("CARGO_MANIFEST_DIR"));
        assert!(is_assets(&checkout.join("assets")));
        assert!(!is_assets(&checkout.join("src")));
        assert!(!is_assets(&checkout.join("no such folder")));
    }
}
