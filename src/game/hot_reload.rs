//! While the game runs: a changed scene file is taken over; a broken one is reported, and the
//! last good scene stays.

use std::path::PathBuf;
use std::time::Duration;

use bevy::prelude::*;
use bevy::time::common_conditions::on_real_timer;

use super::player::{self, Figure};
use super::scenes::{self, CurrentScene, SceneRequest};

/// How often the files are looked at.
const PERIOD: Duration = Duration::from_millis(500);

/// The assets folder of the running game.
#[derive(Resource, Clone, Debug)]
pub struct AssetsDir(pub PathBuf);

/// Why the newest change of the scene's files was not taken over; `None` when it was.
#[derive(Resource, Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneFault(pub Option<String>);

/// Takes over changes to the files of [`CurrentScene`]. Needs no renderer.
pub struct HotReloadPlugin;

impl Plugin for HotReloadPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<SceneFault>()
            .add_systems(PreUpdate, reload_changed.run_if(on_real_timer(PERIOD)));
    }
}

/// Loads the scene again when one of its files has another time of change than when it was read.
pub fn reload_changed(
    request: Res<SceneRequest>,
    assets: Res<AssetsDir>,
    mut scene: ResMut<CurrentScene>,
    mut fault: ResMut<SceneFault>,
    mut figures: Query<&mut Figure>,
) {
    let now: Vec<_> = scene
        .files
        .iter()
        .map(|(path, _)| (path.clone(), scenes::changed(path)))
        .collect();
    // A file that is away for a moment is one being written.
    if now == scene.files || now.iter().any(|(_, time)| time.is_none()) {
        return;
    }
    match scenes::load(&request, &assets.0) {
        Ok(loaded) => {
            for mut figure in &mut figures {
                player::settle(&mut figure, &loaded.terrain);
            }
            scene.0 = loaded;
            fault.0 = None;
        }
        Err(error) => {
            let error = error.to_string();
            error!("{error}; the last good scene stays");
            fault.0 = Some(error);
            // Not again until the next change.
            scene.0.files = now;
        }
    }
}
