//! What the player chose in the menu: a file of its own beside that of the settings, which stays as they wrote it.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use bevy::prelude::*;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{Settings, SettingsError, paths, ron_options};

/// Where choices are kept; without it nowhere.
#[derive(Resource, Clone, Debug)]
pub struct KeepTo(pub PathBuf);

/// What the menu can change, each as in [`Settings`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Choices {
    mouse_sensitivity: f32,
    invert_y: bool,
    fov: f32,
    sound: bool,
    volume: f32,
}

/// Why choices are not kept. Those that were kept before are there still.
#[derive(Debug, Error)]
#[error("{}: the settings cannot be kept: {source}", .path.display())]
pub struct KeepError {
    path: PathBuf,
    source: io::Error,
}

impl Choices {
    /// Those of these settings.
    #[must_use]
    pub const fn of(settings: &Settings) -> Self {
        Self {
            mouse_sensitivity: settings.mouse_sensitivity,
            invert_y: settings.invert_y,
            fov: settings.fov,
            sound: settings.sound,
            volume: settings.volume,
        }
    }

    /// Puts them in the place of what settings say.
    pub fn put(self, settings: &mut Settings) {
        settings.mouse_sensitivity = self.mouse_sensitivity;
        settings.invert_y = self.invert_y;
        settings.fov = self.fov;
        settings.sound = self.sound;
        settings.volume = self.volume;
    }

    /// Writes them beside the file, and renames that: whenever the machine stops, a whole file is there.
    ///
    /// # Errors
    /// [`KeepError`]: no folder can be made, or no file written.
    pub fn write(self, path: &Path) -> Result<(), KeepError> {
        let write = || {
            if let Some(folder) = path.parent() {
                fs::create_dir_all(folder)?;
            }
            let text = ron::to_string(&self).map_err(io::Error::other)?;
            let beside = path.with_extension("new");
            let mut file = fs::File::create(&beside)?;
            file.write_all(text.as_bytes())?;
            file.sync_all()?;
            fs::rename(&beside, path)
        };
        write().map_err(|source| KeepError {
            path: path.to_owned(),
            source,
        })
    }

    /// Settings with the choices of a file, where there is one.
    ///
    /// # Errors
    /// [`SettingsError`] as of a file of settings.
    pub fn over(mut settings: Settings, path: &Path) -> Result<Settings, SettingsError> {
        let text = match fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(settings),
            Err(source) => {
                return Err(SettingsError::Read {
                    path: path.to_owned(),
                    source,
                });
            }
        };
        let choices: Self =
            ron_options()
                .from_str(&text)
                .map_err(|source| SettingsError::Parse {
                    path: path.to_owned(),
                    source: Box::new(source),
                })?;
        choices.put(&mut settings);
        settings.check(path)?;
        Ok(settings)
    }
}

/// Where choices lie: a file beside [`paths::user_settings`].
#[must_use]
pub fn user_choices() -> Option<PathBuf> {
    paths::user_settings().map(|path| path.with_file_name("menu.ron"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("dolomite-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        folder
    }

    #[test]
    fn what_was_chosen_comes_again_and_the_rest_stays() {
        let folder = folder("choices");
        let path = folder.join("deeper/menu.ron");
        let chosen = Settings {
            volume: 0.3,
            sound: false,
            invert_y: true,
            fov: 70.0,
            walk_speed: 9.0,
            ..Settings::default()
        };
        assert_eq!(
            Choices::over(Settings::default(), &path).unwrap(),
            Settings::default()
        );
        Choices::of(&chosen).write(&path).unwrap();
        let again = Choices::over(Settings::default(), &path).unwrap();
        let wanted = Settings {
            walk_speed: Settings::default().walk_speed,
            ..chosen
        };
        assert_eq!(again, wanted);
        assert_eq!(
            fs::read_dir(path.parent().unwrap()).unwrap().count(),
            1,
            "nothing lies beside"
        );
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_broken_file_is_named_and_never_a_panic() {
        let folder = folder("broken-choices");
        let path = folder.join("menu.ron");
        Choices::of(&Settings::default()).write(&path).unwrap();
        let whole = fs::read_to_string(&path).unwrap();
        for end in 0..whole.len() {
            fs::write(&path, &whole[..end]).unwrap();
            let error = Choices::over(Settings::default(), &path).unwrap_err();
            assert!(error.to_string().contains("menu.ron"), "{error}");
        }
        fs::write(&path, whole.replace("volume:0.8", "volume:8.0")).unwrap();
        let error = Choices::over(Settings::default(), &path).unwrap_err();
        assert!(error.to_string().contains("volume"), "{error}");
        // Where a folder should be there is a file.
        fs::write(folder.join("file"), "").unwrap();
        let error = Choices::of(&Settings::default()).write(&folder.join("file/menu.ron"));
        assert!(error.unwrap_err().to_string().contains("cannot be kept"));
        fs::remove_dir_all(folder).unwrap();
    }
}
