//! What `--exec` names: commands that are done once the scene is there.

use std::path::{Path, PathBuf};

use bevy::prelude::*;
use dolomite::inspector::console::Tone;
use dolomite::inspector::{Console, commands::own::read_script};
use thiserror::Error;

use crate::play::camera::FreeCamera;

/// A script that was read and waits for the scene.
#[derive(Resource, Clone, Debug)]
pub struct Script {
    /// Its file, for messages.
    pub name: String,
    /// Its lines.
    pub text: String,
}

/// A script that cannot be read.
#[derive(Clone, Debug, Error)]
#[error("--exec {}: {reason}", .path.display())]
pub struct ScriptError {
    /// The file.
    pub path: PathBuf,
    /// Why.
    pub reason: String,
}

impl Script {
    /// Reads a file of commands.
    ///
    /// # Errors
    /// [`ScriptError`].
    pub fn read(path: &Path) -> Result<Self, ScriptError> {
        let text = read_script(path).map_err(|mistake| ScriptError {
            path: path.to_owned(),
            reason: mistake.0,
        })?;
        Ok(Self {
            name: path.display().to_string(),
            text,
        })
    }
}

/// Says on standard output what the console says: there is a script.
#[derive(Resource, Default)]
struct Told(u64);

/// Enters the [`Script`] once there is a camera that draws.
pub struct ScriptPlugin;

impl Plugin for ScriptPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            PreUpdate,
            (
                enter.run_if(resource_exists::<Script>.and_then(
                    any_with_component::<FreeCamera>.and_then(any_with_component::<Camera3d>),
                )),
                tell.run_if(resource_exists::<Told>.and_then(resource_changed::<Console>)),
            ),
        );
    }
}

fn enter(world: &mut World) {
    if let Some(script) = world.remove_resource::<Script>() {
        begin(world, &script);
    }
}

/// Enters a script.
pub fn begin(world: &mut World, script: &Script) {
    let said = world.resource::<Console>().lines_said();
    world.insert_resource(Told(said));
    world
        .resource_mut::<Console>()
        .enter_script(&script.name, &script.text);
}

fn tell(told: Option<ResMut<Told>>, console: Res<Console>) {
    let Some(mut told) = told else { return };
    let new = (console.lines_said() - told.0) as usize;
    told.0 = console.lines_said();
    let kept = console.output();
    let skipped = kept.len().saturating_sub(new);
    for (tone, line) in kept.skip(skipped) {
        match tone {
            Tone::Typed => println!("> {line}"),
            Tone::Said => println!("{line}"),
            Tone::Fault => eprintln!("dolomite: {line}"),
        }
    }
}
