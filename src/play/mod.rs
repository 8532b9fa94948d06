//! The half of the game that needs no renderer: scene, figure, camera, switches.
//!
//! Runs under `MinimalPlugins`; tests and servers write [`PlayerInput`] themselves.
//!
//! | file | concern |
//! |---|---|
//! | [`camera`] | the camera, free or following |
//! | [`figure`], [`jump`] | the walking figure; its leaps |
//! | [`city`] | walls of a city |
//! | [`things`], [`body`] | boulders, blocks, lifts, stones; the figure among them |

pub mod body;
pub mod camera;
pub mod city;
pub mod edits;
pub mod figure;
pub mod jump;
pub mod things;

use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;

use crate::input::PlayerInput;
use crate::scene::reload::ReloadPlugin;
use crate::scene::{CurrentScene, Pose, read_about};
use crate::settings::Settings;
use body::BodyPlugin;
use camera::{CameraPlugin, FreeCamera};
use city::CityWallsPlugin;
use edits::EditsPlugin;
use figure::{Figure, FigurePlugin};
use things::ThingsPlugin;

/// Which point the detail of the ground follows.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DetailFocus {
    /// The camera.
    #[default]
    Camera,
    /// The figure.
    Figure,
}

/// What the player has switched on.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Resource, Default, PartialEq)]
pub struct Switches {
    /// Triangle edges are drawn.
    pub lines: bool,
    /// Triangles are filled.
    pub fill: bool,
    /// Which point detail follows.
    pub focus: DetailFocus,
    /// The panel of keys is shown.
    pub keys: bool,
    /// What collision knows is drawn: shapes, contacts, tiles.
    pub shapes: bool,
    /// What logic senses is drawn: fields of view, who is seen, what is remembered, ways.
    pub senses: bool,
    /// The camera follows the figure, which then walks by the keys that else fly the camera.
    pub follow: bool,
    /// The figure holds a torch.
    pub torch: bool,
}

impl Default for Switches {
    fn default() -> Self {
        Self {
            lines: false,
            fill: true,
            focus: DetailFocus::Camera,
            keys: false,
            shapes: false,
            senses: false,
            follow: false,
            torch: false,
        }
    }
}

/// The bound that the player switches to where none is set, pixels.
const ERROR: f32 = 1.0;

/// The entity that carries the `Terrain` of the [`CurrentScene`].
#[derive(Component)]
pub struct Landscape;

/// Scene, figure, camera and switches. Expects the resources [`CurrentScene`],
/// [`SceneRequest`](crate::scene::SceneRequest) and
/// [`AssetsDir`](crate::settings::paths::AssetsDir).
pub struct SimulationPlugin;

impl Plugin for SimulationPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<PlayerInput>()
            .init_resource::<Settings>()
            .init_resource::<Switches>()
            .register_type::<Settings>()
            .register_type::<Switches>()
            .add_plugins((
                CameraPlugin,
                FigurePlugin,
                ReloadPlugin,
                ThingsPlugin,
                BodyPlugin,
                CityWallsPlugin,
                EditsPlugin,
            ))
            .add_systems(PreStartup, spawn)
            .add_systems(
                Update,
                (
                    switch,
                    switch_rule.run_if(|input: Res<PlayerInput>| input.switch_metric),
                    replace_terrain,
                ),
            );
    }
}

fn spawn(mut commands: Commands, scene: Res<CurrentScene>, settings: Res<Settings>) {
    commands.spawn((Landscape, scene.terrain.clone()));
    read_about(&scene.terrain, scene.figure);
    commands.spawn(Figure::at(scene.figure, &scene.terrain).facing(scene.facing));
    let DVec3 { x, z, .. } = scene.camera.position;
    read_about(&scene.terrain, DVec2::new(x, z));
    commands.spawn(start_camera(scene.camera, &scene, &settings));
}

/// A camera at rest at `pose`, or above the ground there.
pub fn start_camera(pose: Pose, scene: &CurrentScene, settings: &Settings) -> FreeCamera {
    FreeCamera {
        pose: scene.lifted(pose),
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
        shapes: old.shapes ^ input.switch_shapes,
        senses: old.senses,
        follow: old.follow ^ input.switch_follow,
        torch: old.torch ^ input.switch_torch,
    };
    switches.set_if_neq(next);
}

/// Of patches, or with its error bounded: the ground of a landscape is refined by either.
fn switch_rule(scene: Res<CurrentScene>, mut settings: ResMut<Settings>) {
    if scene.own.is_some() {
        return;
    }
    settings.max_error = match settings.max_error.or(settings.budget) {
        Some(_) => None,
        None => Some(ERROR),
    };
    settings.budget = None;
}

/// Gives the landscape the ground of a scene that was loaded again.
fn replace_terrain(
    scene: Res<CurrentScene>,
    mut landscape: Query<&mut dolomite::terrain::Terrain, With<Landscape>>,
) {
    if scene.is_changed() {
        for mut terrain in &mut landscape {
            if !terrain.same(&scene.terrain) {
                *terrain = scene.terrain.clone();
            }
        }
    }
}
