//! A figure that walks in a circle, in an app of its own. Any .glb with a skin and clips will do, and a file
//! that says what the clips mean; that of this project's person is made by
//! `dolomite fbx2gltf assets/hero/hero.fbx hero.glb`, then
//! `cargo run --release -p dolomite_character --example walk -- hero.glb assets/hero/gaits.ron`.

use std::sync::Arc;

use bevy::asset::UnapprovedPathMode;
use bevy::prelude::*;
use dolomite_character::gait::{GaitData, Motion};
use dolomite_character::{Character, CharacterMotion, CharacterPlugin, Figure, Rig};

fn main() {
    // The file may lie anywhere: it is its owner who names it.
    let files = AssetPlugin {
        unapproved_path_mode: UnapprovedPathMode::Allow,
        ..default()
    };
    App::new()
        .add_plugins((DefaultPlugins.set(files), CharacterPlugin))
        .add_systems(Startup, setup)
        .add_systems(Update, walk)
        .run();
}

fn setup(mut commands: Commands, assets: Res<AssetServer>) -> Result {
    let [model, gaits] = [1, 2].map(|index| std::env::args().nth(index).unwrap_or_default());
    let model = std::path::absolute(model)?;
    let rig = Rig::read(model.as_ref())?;
    let gaits = GaitData::from_ron(&std::fs::read_to_string(gaits)?)?;
    let figure = Arc::new(Figure::new(rig, &gaits)?);
    let scene = assets.load(GltfAssetLabel::Scene(0).from_asset(model));
    commands
        .spawn((Character { figure }, Visibility::default()))
        .with_child(WorldAssetRoot(scene));
    let eye = Transform::from_xyz(1.5, 2.2, 5.0).looking_at(Vec3::Y * 0.8, Vec3::Y);
    commands.spawn((Camera3d::default(), eye));
    let sun = Transform::from_xyz(2.0, 3.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y);
    commands.spawn((DirectionalLight::default(), sun));
    Ok(())
}

/// Once round in ten seconds, at the speed of the clip.
fn walk(time: Res<Time>, mut figures: Query<(&mut Transform, &mut CharacterMotion)>) {
    let (speed, turn_rate) = (1.5, core::f32::consts::TAU / 10.0);
    for (mut place, mut motion) in &mut figures {
        motion.0 = Motion {
            speed,
            turn_rate,
            ..default()
        };
        place.rotate_y(turn_rate * time.delta_secs());
        let ahead = place.rotation * Vec3::Z;
        place.translation += ahead * speed * time.delta_secs();
    }
}
