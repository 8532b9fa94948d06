//! A lane of lamps: posts are tubes along Catmull-Rom curves of isoline patches, globes are
//! octahedra of triangle patches: `cargo run --release --example lamps`.

mod support;

use std::sync::Arc;

use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use dolomite::tessellation::render::{GeometryMaterial, PatchKind, PatchPlugin, PatchShader};
use dolomite::tessellation::{PatchLayout, PatchMesh, Patches, shapes};

/// Iron tubes: 12 sides of two triangles stand for each segment.
#[derive(Resource, AsBindGroup, Clone)]
pub struct Post {}

impl PatchKind for Post {
    const LAYOUT: PatchLayout = PatchLayout::lines(4);
    const AMPLIFIED: u32 = 72;

    fn shader() -> PatchShader {
        PatchShader::File("shaders/tube.wgsl")
    }

    fn materials(&self) -> Vec<GeometryMaterial> {
        vec![GeometryMaterial {
            base_color: LinearRgba::rgb(0.04, 0.05, 0.05),
            roughness: 0.35,
            ..default()
        }]
    }
}

/// Glowing glass.
#[derive(Resource, AsBindGroup, Clone)]
pub struct Globe {}

impl PatchKind for Globe {
    const LAYOUT: PatchLayout = PatchLayout::TRIANGLE;
    const SHADOWS: bool = false;

    fn shader() -> PatchShader {
        PatchShader::File("shaders/globe.wgsl")
    }

    fn materials(&self) -> Vec<GeometryMaterial> {
        vec![GeometryMaterial {
            base_color: LinearRgba::rgb(0.9, 0.8, 0.6),
            emissive: LinearRgba::rgb(1.0, 0.66, 0.3) * 9_000.0,
            ..default()
        }]
    }
}

fn main() {
    support::app("Lamps")
        .add_plugins((PatchPlugin(Post {}), PatchPlugin(Globe {})))
        .add_systems(Startup, setup)
        .run();
}

/// A curve through points with radii, as patches of four: the ends are repeated.
fn curve(points: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let at = |k: usize| points[k.clamp(1, points.len()) - 1];
    (1..points.len())
        .flat_map(|k| [at(k - 1), at(k), at(k + 1), at(k + 2)])
        .collect()
}

/// Foot, shaft, and a crook of the shepherd's kind with a curl; metres.
fn post() -> Result<PatchMesh, impl std::error::Error> {
    let shaft = [
        [0.0, 0.0, 0.0, 0.16],
        [0.0, 0.12, 0.0, 0.15],
        [0.0, 0.22, 0.0, 0.07],
        [0.0, 0.5, 0.0, 0.06],
        [0.0, 2.9, 0.0, 0.045],
        [0.05, 3.5, 0.0, 0.04],
        [0.35, 3.95, 0.0, 0.035],
        [0.75, 3.98, 0.0, 0.03],
        [0.98, 3.7, 0.0, 0.028],
        [1.0, 3.45, 0.0, 0.028],
    ];
    let curl = [
        [0.02, 3.2, 0.0, 0.02],
        [0.25, 3.4, 0.0, 0.018],
        [0.45, 3.62, 0.0, 0.016],
        [0.62, 3.6, 0.0, 0.014],
        [0.62, 3.42, 0.0, 0.012],
        [0.48, 3.4, 0.0, 0.01],
        [0.47, 3.5, 0.0, 0.008],
    ];
    let patches = [curve(&shaft), curve(&curl)].concat();
    PatchMesh::from_patches(PatchLayout::lines(4), &patches)
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) -> Result {
    let post = Arc::new(post()?);
    let globe = Arc::new(shapes::octahedron(1));
    for k in 0..7 {
        let side = if k % 2 == 0 { -1.0 } else { 1.0 };
        let turn = if k % 2 == 0 {
            0.0
        } else {
            core::f32::consts::PI
        };
        let place = Transform::from_xyz(2.4 * side, 0.0, -4.0 * k as f32)
            .with_rotation(Quat::from_rotation_y(turn));
        commands.spawn((Patches::<Post>::new(post.clone()), place));
        let lamp = place.transform_point(Vec3::new(1.0, 3.24, 0.0));
        commands.spawn((
            Patches::<Globe>::new(globe.clone()),
            Transform::from_translation(lamp).with_scale(Vec3::splat(0.22)),
        ));
        commands.spawn((
            PointLight {
                color: Color::linear_rgb(1.0, 0.66, 0.3),
                intensity: 3_000_000.0,
                range: 30.0,
                radius: 0.22,
                ..default()
            },
            Transform::from_translation(lamp),
        ));
    }
    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(400.0, 400.0))),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color: Color::linear_rgb(0.14, 0.13, 0.12),
            perceptual_roughness: 0.8,
            ..default()
        })),
    ));
    commands.spawn(support::light(1_200.0, 40.0));
    let circle = support::Circle {
        centre: Vec3::new(0.0, 2.0, -6.0),
        distance: 12.5,
        yaw: 0.28,
        pitch: 0.12,
    };
    commands.spawn(support::camera(circle, 3.0, 12.0));
    Ok(())
}
