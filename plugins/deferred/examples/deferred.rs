//! A night of four hundred lamps, some of them before the eye:
//! `cargo run --release -p dolomite_deferred --example deferred`; `-- --shot FILE.png` takes a picture without a window.

#[path = "support/picture.rs"]
mod picture;

use bevy::prelude::*;
use dolomite_deferred::{DeferredLighting, DeferredPlugin};

fn main() {
    picture::app()
        .add_plugins(DeferredPlugin)
        .insert_resource(bevy::pbr::DefaultOpaqueRendererMethod::deferred())
        .insert_resource(GlobalAmbientLight::NONE)
        .insert_resource(ClearColor(Color::BLACK))
        .add_systems(Startup, setup)
        .run();
}

/// Houses, lamps, and the eye.
pub fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    // All that it takes: the component.
    let eye = Transform::from_xyz(-9.0, 7.0, 16.0).looking_at(Vec3::new(0.0, 0.0, -6.0), Vec3::Y);
    commands.spawn((
        Camera3d::default(),
        DeferredLighting::default(),
        bevy::camera::Exposure { ev100: 5.0 },
        eye,
    ));
    let house = meshes.add(Cuboid::new(1.6, 1.0, 1.6));
    let wall = materials.add(Color::srgb(0.6, 0.55, 0.5));
    let street = StandardMaterial {
        base_color: Color::srgb(0.25, 0.25, 0.27),
        perceptual_roughness: 0.35,
        ..default()
    };
    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(200.0, 200.0))),
        MeshMaterial3d(materials.add(street)),
    ));
    for k in 0..400 {
        let (x, z) = ((k % 20) as f32 * 2.5 - 25.0, (k / 20) as f32 * -2.5 + 10.0);
        // The golden ratio spreads heights and colours.
        let part = (k as f32 * 0.618_034).fract();
        let size = Vec3::new(1.0, 0.6 + 2.4 * part * part, 1.0);
        commands.spawn((
            Mesh3d(house.clone()),
            MeshMaterial3d(wall.clone()),
            Transform::from_xyz(x, 0.5 * size.y, z).with_scale(size),
        ));
        commands.spawn((
            PointLight {
                color: Color::hsl(30.0 + 200.0 * (7.0 * part).fract(), 0.8, 0.6),
                intensity: 6000.0,
                range: 4.0,
                ..default()
            },
            Transform::from_xyz(x + 1.25, 0.8, z + 1.25),
        ));
    }
}
