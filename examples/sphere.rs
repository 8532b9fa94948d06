//! A sphere displaced by noise, from eight triangle patches: `cargo run --release --example sphere`.

mod support;

use std::sync::Arc;

use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use dolomite::tessellation::render::stage::{PatchKind, PatchMaterial, PatchPlugin};
use dolomite::tessellation::stage::{PatchLayout, Patches, shapes};

#[derive(Resource, AsBindGroup, Clone)]
struct Rock {}

impl PatchKind for Rock {
    const LAYOUT: PatchLayout = PatchLayout::TRIANGLE;

    fn shader() -> &'static str {
        "shaders/rock.wgsl"
    }

    fn materials(&self) -> Vec<PatchMaterial> {
        let rock = |red, green, blue, roughness| PatchMaterial {
            base_color: LinearRgba::rgb(red, green, blue),
            roughness,
            ..default()
        };
        vec![rock(0.16, 0.12, 0.09, 0.95), rock(0.62, 0.60, 0.57, 0.7)]
    }
}

fn main() {
    support::app("Displaced sphere")
        .add_plugins(PatchPlugin(Rock {}))
        .add_systems(Startup, setup)
        .run();
}

fn setup(mut commands: Commands) {
    let mesh = Arc::new(shapes::octahedron());
    let rock = Patches::<Rock>::new(mesh).with(0, Vec4::new(0.0, 0.16, 1.7, 0.0));
    commands.spawn(rock);
    commands.spawn(support::light(900.0));
    let circle = support::Circle {
        centre: Vec3::ZERO,
        distance: 2.9,
        yaw: 0.5,
        pitch: 0.3,
    };
    commands.spawn(support::camera(circle, 4.0));
}
