//! The sky alone: `cargo run --release -p dolomite_sky --example sky`. The sun sinks by a degree a
//! second; `-- --sun AZIMUTH,ELEVATION` holds it, `--shot FILE.png` takes a picture without a window.

#[path = "support/picture.rs"]
mod picture;

use bevy::prelude::*;
use dolomite_sky::{Sky, SkyPlugin, Sun};

fn main() {
    let mut app = picture::app();
    app.add_plugins(SkyPlugin)
        .add_systems(Startup, setup)
        .add_systems(Update, sink)
        .run();
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        Camera3d::default(),
        Msaa::Off,
        Sky::default(),
        Transform::from_xyz(0.0, 1.7, 8.0).looking_to(Vec3::new(0.0, 0.28, -1.0), Vec3::Y),
    ));
    commands.spawn(picture::sun());
    let stone = materials.add(Color::srgb(0.5, 0.47, 0.43));
    for (mesh, height) in [
        (Mesh::from(Plane3d::default().mesh().size(4e4, 4e4)), 0.0),
        (Sphere::new(1.0).into(), 1.0),
    ] {
        commands.spawn((
            Mesh3d(meshes.add(mesh)),
            MeshMaterial3d(stone.clone()),
            Transform::from_xyz(-1.5, height, 0.0),
        ));
    }
}

fn sink(time: Res<Time>, mut suns: Query<&mut Sun>) {
    for mut sun in &mut suns {
        sun.elevation -= time.delta_secs();
    }
}
