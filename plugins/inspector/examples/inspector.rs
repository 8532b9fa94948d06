//! The inspector over a stranger's app: `cargo run --release -p dolomite_inspector --example inspector`.
//!
//! F10 opens the panel, the key left of 1 the console. Try `set Spin.turns 0.5`.

use bevy::prelude::*;
use dolomite_inspector::InspectorPlugin;
use dolomite_inspector::settings::described::{Describe, Description, Field};

/// What the app lets one set. That it is registered is all the inspector needs.
#[derive(Component, Reflect)]
#[reflect(Component)]
struct Spin {
    /// Turns a second.
    turns: f32,
}

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, InspectorPlugin))
        .register_type::<Spin>()
        // Not needed: with it there is a slider.
        .describe::<Spin>(Description::new("Turns a thing").field(
            "turns",
            Field::new("Turns a second").range(-2.0..=2.0).unit("/s"),
        ))
        .add_systems(Startup, setup)
        .add_systems(Update, spin)
        .run();
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(0.0, 1.5, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        DirectionalLight::default(),
        Transform::from_xyz(1.0, 2.0, 2.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        Name::new("cube"),
        Mesh3d(meshes.add(Cuboid::new(1.0, 1.0, 1.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.8, 0.45, 0.2))),
        Spin { turns: 0.1 },
    ));
}

fn spin(time: Res<Time>, mut spinning: Query<(&mut Transform, &Spin)>) {
    for (mut transform, spin) in &mut spinning {
        transform.rotate_y(std::f32::consts::TAU * spin.turns * time.delta_secs());
    }
}
