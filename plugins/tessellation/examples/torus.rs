//! A torus of 72 patches, cut as finely as the picture asks for, in an app with nothing of Dolomite but the
//! tessellation stage: `cargo run --release -p dolomite_tessellation --example torus`. Its functions stand in
//! `assets/torus.wgsl`.

use std::sync::Arc;

use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use dolomite_geometry::GeometryCamera;
use dolomite_tessellation::render::{GeometryMaterial, PatchKind, PatchPlugin, PatchShader};
use dolomite_tessellation::{PatchLayout, PatchMesh, Patches};

/// The kind of these patches: their functions, and no data beside the corners.
#[derive(Resource, AsBindGroup, Clone)]
pub struct Torus {}

impl PatchKind for Torus {
    const LAYOUT: PatchLayout = PatchLayout::QUAD;

    fn shader() -> PatchShader {
        PatchShader::File("torus.wgsl")
    }

    fn materials(&self) -> Vec<GeometryMaterial> {
        vec![GeometryMaterial {
            base_color: LinearRgba::rgb(0.5, 0.22, 0.05),
            roughness: 0.35,
            ..default()
        }]
    }
}

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, PatchPlugin(Torus {})))
        .add_systems(Startup, setup)
        .run()
}

/// 12 by 6 patches; the last of a row shares its corners with the first.
pub fn setup(mut commands: Commands) -> Result {
    let point = |k: u32| [(k % 12) as f32 / 12.0, (k / 12) as f32 / 6.0, 0.0, 0.0];
    let corner = |i: u32, j: u32| (i % 12) + 12 * (j % 6);
    let quad = |k: u32| {
        let (i, j) = (k % 12, k / 12);
        [
            corner(i, j),
            corner(i + 1, j),
            corner(i + 1, j + 1),
            corner(i, j + 1),
        ]
    };
    let points = (0..72).map(point).collect();
    let mesh = PatchMesh::new(PatchLayout::QUAD, points, (0..72).flat_map(quad).collect())?;
    commands.spawn(Patches::<Torus>::new(Arc::new(mesh)));
    let sun = DirectionalLight {
        shadow_maps_enabled: true,
        ..default()
    };
    commands.spawn((
        sun,
        Transform::default().looking_to(Vec3::new(-1.0, -2.0, -1.5), Vec3::Y),
    ));
    let eye = Transform::from_xyz(0.0, 2.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y);
    commands.spawn((
        Camera3d::default(),
        Msaa::Off,
        GeometryCamera::default(),
        eye,
    ));
    Ok(())
}
