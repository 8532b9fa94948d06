//! An FBX file in an app of its own: `cargo run --release -p dolomite_fbx --example load -- MODEL.fbx`.

use bevy::asset::UnapprovedPathMode;
use bevy::prelude::*;
use dolomite_fbx::FbxPlugin;

fn main() {
    // The file may lie anywhere: it is its owner who names it.
    let files = AssetPlugin {
        unapproved_path_mode: UnapprovedPathMode::Allow,
        ..default()
    };
    App::new()
        .add_plugins((DefaultPlugins.set(files), FbxPlugin))
        .add_systems(Startup, setup)
        .run();
}

fn setup(mut commands: Commands, assets: Res<AssetServer>) {
    let person = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/hero/hero.fbx");
    let model = std::env::args().nth(1).unwrap_or(person.to_owned());
    let scene = assets.load(GltfAssetLabel::Scene(0).from_asset(model));
    commands.spawn(WorldAssetRoot(scene));
    let eye = Transform::from_xyz(0.7, 1.3, 2.6).looking_at(Vec3::Y, Vec3::Y);
    commands.spawn((Camera3d::default(), eye));
    let sun = Transform::from_xyz(2.0, 3.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y);
    commands.spawn((DirectionalLight::default(), sun));
}
