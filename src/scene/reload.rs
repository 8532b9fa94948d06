//! While the game runs: a changed scene file is taken over; a broken one is reported, and the
//! last good scene stays.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::common_conditions::on_real_timer;

use super::{CurrentScene, Files, SceneRequest, changed, load_watched};
use crate::settings::paths::AssetsDir;

/// How often the files are looked at.
const PERIOD: Duration = Duration::from_millis(500);

/// Why the newest change of the scene's files was not taken over; `None` when it was.
#[derive(Resource, Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneFault(pub Option<String>);

/// The set in which [`CurrentScene`] is replaced (schedule `PreUpdate`).
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ReloadSystems;

/// Takes over changes to the files of [`CurrentScene`]. Needs no renderer.
pub struct ReloadPlugin;

impl Plugin for ReloadPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<SceneFault>().add_systems(
            PreUpdate,
            reload_changed
                .run_if(on_real_timer(PERIOD))
                .in_set(ReloadSystems),
        );
    }
}

/// Loads the scene again when one of its files has another time of change than when it was read.
pub fn reload_changed(
    request: Res<SceneRequest>,
    assets: Res<AssetsDir>,
    mut scene: ResMut<CurrentScene>,
    mut fault: ResMut<SceneFault>,
    mut watched: Local<Option<Files>>,
) {
    if request.is_changed() {
        // Another scene was asked for, and has files of its own.
        *watched = None;
    }
    let watched = watched.get_or_insert_with(|| scene.files.clone());
    let now: Files = watched
        .iter()
        .map(|(path, _)| (path.clone(), changed(path)))
        .collect();
    // A file that is away for a moment is one being written: where nothing else has changed it is waited for.
    // A file that has another name now stays away; the scene's own change then says so.
    let mut changes = watched
        .iter()
        .zip(&now)
        .filter(|((_, before), (_, now))| before != now);
    if changes.all(|((_, before), (_, now))| before.is_some() && now.is_none()) {
        return;
    }
    let mut files = Files::new();
    match load_watched(&request, &assets.0, &mut files) {
        Ok(loaded) => {
            *watched = loaded.files.clone();
            scene.0 = loaded;
            fault.0 = None;
        }
        Err(error) => {
            let error = error.to_string();
            error!("{error}; the last good scene stays");
            fault.0 = Some(error);
            // Not again until the next change, which may be that a file appears which the scene names.
            *watched = if files.is_empty() { now } else { files };
        }
    }
}
