//! A sphere displaced by noise, from eight triangle patches: `cargo run --release --example sphere`.

mod support;

use std::sync::Arc;

use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use dolomite::tessellation::render::{PatchKind, PatchPlugin, PatchShader};
use dolomite::tessellation::{PatchLayout, Patches, shapes};

/// A boulder.
#[derive(Resource, AsBindGroup, Clone)]
pub struct Rock {}

impl PatchKind for Rock {
    const LAYOUT: PatchLayout = PatchLayout::TRIANGLE;

    const UV_RANGE: f32 = 2.0;
    const CUSTOM_MATERIAL: bool = true;

    fn shader() -> PatchShader {
        PatchShader::File("shaders/rock.wgsl")
    }
}

fn main() {
    support::app("Displaced sphere")
        .add_plugins(PatchPlugin(Rock {}))
        .add_systems(Startup, setup)
        .run();
}

fn setup(mut commands: Commands) {
    let mesh = Arc::new(shapes::octahedron(4));
    let rock = Patches::<Rock>::new(mesh).with(0, Vec4::new(0.0, 0.14, 1.4, 0.0));
    commands.spawn(rock);
    commands.spawn(support::light(60_000.0, 700.0));
    let circle = support::Circle {
        centre: Vec3::ZERO,
        distance: 2.9,
        yaw: 0.5,
        pitch: 0.3,
    };
    commands.spawn(support::camera(circle, 3.0, 13.6));
}
