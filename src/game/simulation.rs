//! The half of the game that needs no renderer: scene, figure, camera, switches.
//!
//! Runs under `MinimalPlugins`; tests and servers write [`PlayerInput`] themselves.

use bevy::prelude::*;

use super::camera::{CameraPlugin, FreeCamera, Pose};
use super::hot_reload::HotReloadPlugin;
use super::input::PlayerInput;
use super::player::{Figure, FigurePlugin};
use super::scenes::CurrentScene;
use super::settings::Settings;

/// Which point the detail of the ground follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DetailFocus {
    /// The camera.
    #[default]
    Camera,
    /// The figure.
    Figure,
}

/// What the player has switched on.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Switches {
    /// Triangle edges are drawn.
    pub lines: bool,
    /// Triangles are filled.
    pub fill: bool,
    /// Which point detail follows.
    pub focus: DetailFocus,
    /// The panel of keys is shown.
    pub keys: bool,
    /// The camera follows the figure, which then walks by the keys that else fly the camera.
    pub follow: bool,
}

impl Default for Switches {
    fn default() -> Self {
        Self {
            lines: false,
            fill: true,
            focus: DetailFocus::Camera,
            keys: false,
            follow: false,
        }
    }
}

/// The entity that carries the `Terrain` of the [`CurrentScene`].
#[derive(Component)]
pub struct Landscape;

/// Scene, figure, camera and switches. Expects the resources [`CurrentScene`],
/// [`SceneRequest`](super::scenes::SceneRequest) and
/// [`AssetsDir`](super::hot_reload::AssetsDir).
pub struct SimulationPlugin;

impl Plugin for SimulationPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<PlayerInput>()
            .init_resource::<Settings>()
            .init_resource::<Switches>()
            .add_plugins((CameraPlugin, FigurePlugin, HotReloadPlugin))
            .add_systems(PreStartup, spawn)
            .add_systems(Update, (switch, replace_terrain));
    }
}

fn spawn(mut commands: Commands, scene: Res<CurrentScene>, settings: Res<Settings>) {
    commands.spawn((Landscape, scene.terrain.clone()));
    commands.spawn(Figure::at(scene.figure, &scene.terrain).facing(scene.facing));
    commands.spawn(start_camera(scene.camera, &scene, &settings));
}

/// A camera at rest at `pose`, or above the ground there.
pub fn start_camera(pose: Pose, scene: &CurrentScene, settings: &Settings) -> FreeCamera {
    FreeCamera {
        pose: if scene.classic.is_some() {
            pose
        } else {
            pose.above(&scene.terrain, scene.terrain.sea_level())
        },
        velocity: Vec3::ZERO,
        fov: settings.fov,
        followed: None,
    }
}

fn switch(input: Res<PlayerInput>, mut switches: ResMut<Switches>) {
    let old = *switches;
    let next = Switches {
        lines: old.lines ^ input.switch_lines,
        fill: old.fill ^ input.switch_fill,
        focus: match (old.focus, input.switch_focus) {
            (focus, false) => focus,
            (DetailFocus::Camera, true) => DetailFocus::Figure,
            (DetailFocus::Figure, true) => DetailFocus::Camera,
        },
        keys: old.keys ^ input.switch_keys,
        follow: old.follow ^ input.switch_follow,
    };
    switches.set_if_neq(next);
}

/// Gives the landscape the ground of a scene that was loaded again.
fn replace_terrain(
    scene: Res<CurrentScene>,
    mut landscape: Query<&mut dolomite_terrain::Terrain, With<Landscape>>,
) {
    if scene.is_changed() {
        for mut terrain in &mut landscape {
            if !terrain.same(&scene.terrain) {
                *terrain = scene.terrain.clone();
            }
        }
    }
}
