//! Looks at any FBX file: `cargo run --release --example fbx_viewer -- MODEL.fbx`.
//!
//! It shows the model, plays its clips, and says what became of the file on its way to glTF and what of it
//! glTF cannot carry. Another file may be dropped onto the window.

mod bones;
mod clips;
mod panel;
mod stage;

use std::path::{Path, PathBuf};

use bevy::asset::{AssetPlugin, LoadState, UnapprovedPathMode};
use bevy::prelude::*;
use bevy::window::WindowResolution;
use bevy::world_serialization::WorldInstanceReady;
use clap::Parser;
use dolomite::fbx::{FbxConversion, FbxPlugin};

/// Show an FBX file, play its clips, and say how exact its conversion is.
#[derive(Parser, Resource, Clone)]
#[command(after_help = panel::KEYS)]
struct Arguments {
    /// The file; without one, the person of this project.
    #[arg(value_name = "MODEL.fbx")]
    file: Option<PathBuf>,
    /// The clip that plays first, by its name or number [default: the first].
    #[arg(long)]
    clip: Option<String>,
    /// Save a picture and leave.
    #[arg(long, value_name = "FILE.png")]
    shot: Option<PathBuf>,
    /// Seconds of the clip that the view shows.
    #[arg(long, default_value_t = 0.5)]
    at: f32,
}

/// What is shown.
#[derive(Resource)]
pub struct Shown {
    path: PathBuf,
    gltf: Handle<Gltf>,
    made: Handle<FbxConversion>,
    state: State,
}

/// How far it has got.
#[derive(Clone, Debug, PartialEq)]
pub enum State {
    /// Is being read and converted.
    Loading,
    /// Its scene is being spawned.
    Spawning,
    /// Is there.
    Ready,
    /// Will not be.
    Failed(String),
}

/// The root of the model.
#[derive(Component)]
pub struct Model;

fn main() -> AppExit {
    let arguments = Arguments::parse();
    let file = arguments
        .file
        .clone()
        .unwrap_or_else(|| PathBuf::from("assets/hero/hero.fbx"));
    if !file.is_file() {
        eprintln!(
            "fbx_viewer: {}: there is no such file; name an .fbx",
            file.display()
        );
        return AppExit::from_code(2);
    }
    let mut app = App::new();
    app.add_plugins(
        DefaultPlugins
            .set(WindowPlugin {
                primary_window: Some(Window {
                    title: format!("{} - FBX viewer", name_of(&file)),
                    resolution: WindowResolution::new(1280, 720),
                    ..default()
                }),
                ..default()
            })
            // Files may lie anywhere: it is their owner who names them.
            .set(AssetPlugin {
                unapproved_path_mode: UnapprovedPathMode::Allow,
                ..default()
            }),
    )
    .add_plugins((
        FbxPlugin,
        bones::BonesPlugin,
        stage::StagePlugin,
        clips::ClipsPlugin,
        panel::PanelPlugin,
    ))
    .insert_resource(arguments)
    .add_systems(
        Startup,
        move |mut commands: Commands, assets: Res<AssetServer>| {
            commands.insert_resource(open(&file, &assets));
        },
    )
    .add_systems(Update, (drop_file, follow_loading));
    app.run()
}

/// The last part of a path.
pub fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}

fn open(file: &Path, assets: &AssetServer) -> Shown {
    let path = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    // A `#` in a name would else begin a label.
    let whole = bevy::asset::AssetPath::from_path_buf(path.clone());
    let made = whole.clone().with_label(FbxConversion::LABEL);
    Shown {
        gltf: assets.load(whole),
        made: assets.load(made),
        state: State::Loading,
        path,
    }
}

fn drop_file(
    mut commands: Commands,
    mut dropped: MessageReader<FileDragAndDrop>,
    assets: Res<AssetServer>,
    models: Query<Entity, With<Model>>,
    mut window: Single<&mut Window>,
) {
    for event in dropped.read() {
        let FileDragAndDrop::DroppedFile { path_buf, .. } = event else {
            continue;
        };
        for model in &models {
            commands.entity(model).despawn();
        }
        window.title = format!("{} - FBX viewer", name_of(path_buf));
        commands.insert_resource(open(path_buf, &assets));
    }
}

fn follow_loading(
    mut commands: Commands,
    mut shown: ResMut<Shown>,
    assets: Res<AssetServer>,
    gltfs: Res<Assets<Gltf>>,
) {
    if shown.state != State::Loading {
        return;
    }
    if let LoadState::Failed(error) = assets.load_state(&shown.gltf) {
        eprintln!("fbx_viewer: {error}");
        shown.state = State::Failed(error.to_string());
        return;
    }
    if !assets.is_loaded_with_dependencies(&shown.gltf) {
        return;
    }
    let Some(gltf) = gltfs.get(&shown.gltf) else {
        return;
    };
    let Some(scene) = gltf.default_scene.as_ref().or(gltf.scenes.first()) else {
        shown.state = State::Failed("there is nothing to see in this file".into());
        return;
    };
    commands
        .spawn((Model, WorldAssetRoot(scene.clone())))
        .observe(|_: On<WorldInstanceReady>, mut shown: ResMut<Shown>| shown.state = State::Ready);
    shown.state = State::Spawning;
}
