//! The Utah teapot (Newell 1975) from 32 bicubic Bézier patches of 16 control points:
//! `cargo run --release --example teapot`.

mod support;

use std::sync::Arc;

use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use dolomite::tessellation::render::{GeometryMaterial, PatchKind, PatchPlugin, PatchShader};
use dolomite::tessellation::{PatchLayout, PatchMesh, Patches, Winding};

/// Bicubic Bézier surfaces.
#[derive(Resource, AsBindGroup, Clone)]
pub struct Bezier {}

impl PatchKind for Bezier {
    const LAYOUT: PatchLayout = PatchLayout::BICUBIC;
    const WINDING: Winding = Winding::Ccw;
    const DOUBLE_SIDED: bool = true;

    fn shader() -> PatchShader {
        PatchShader::File("shaders/bezier.wgsl")
    }

    fn materials(&self) -> Vec<GeometryMaterial> {
        vec![GeometryMaterial {
            base_color: LinearRgba::rgb(0.4, 0.035, 0.02),
            roughness: 0.22,
            ..default()
        }]
    }
}

fn main() {
    support::app("Teapot")
        .add_plugins(PatchPlugin(Bezier {}))
        .add_systems(Startup, setup)
        .run();
}

/// What is turned round the axis: four (radius, height) of each strip of the profile.
const TURNED: [[[f32; 2]; 4]; 6] = [
    // Rim, two of the body, two of the lid, bottom.
    [[1.4, 2.4], [1.3375, 2.53125], [1.4375, 2.53125], [1.5, 2.4]],
    [[1.5, 2.4], [1.75, 1.875], [2.0, 1.35], [2.0, 0.9]],
    [[2.0, 0.9], [2.0, 0.45], [1.5, 0.225], [1.5, 0.15]],
    [[0.0, 3.15], [0.8, 3.15], [0.0, 2.85], [0.2, 2.7]],
    [[0.2, 2.7], [0.4, 2.55], [1.3, 2.55], [1.3, 2.4]],
    [[1.5, 0.15], [1.5, 0.075], [1.425, 0.0], [0.0, 0.0]],
];

/// Handle and spout, the half before the plane z = 0: rows of four (x, height), of which the middle
/// two stand out by the third number.
const SWEPT: [[([[f32; 2]; 4], f32); 4]; 4] = [
    [
        (
            [[-1.6, 2.025], [-1.6, 2.025], [-1.5, 2.25], [-1.5, 2.25]],
            0.3,
        ),
        (
            [[-2.3, 2.025], [-2.3, 2.025], [-2.5, 2.25], [-2.5, 2.25]],
            0.3,
        ),
        (
            [[-2.7, 2.025], [-2.7, 2.025], [-3.0, 2.25], [-3.0, 2.25]],
            0.3,
        ),
        ([[-2.7, 1.8], [-2.7, 1.8], [-3.0, 1.8], [-3.0, 1.8]], 0.3),
    ],
    [
        ([[-2.7, 1.8], [-2.7, 1.8], [-3.0, 1.8], [-3.0, 1.8]], 0.3),
        (
            [[-2.7, 1.575], [-2.7, 1.575], [-3.0, 1.35], [-3.0, 1.35]],
            0.3,
        ),
        (
            [
                [-2.5, 1.125],
                [-2.5, 1.125],
                [-2.65, 0.9375],
                [-2.65, 0.9375],
            ],
            0.3,
        ),
        ([[-2.0, 0.9], [-2.0, 0.9], [-1.9, 0.6], [-1.9, 0.6]], 0.3),
    ],
    [
        ([[1.7, 1.425], [1.7, 1.425], [1.7, 0.6], [1.7, 0.6]], 0.66),
        (
            [[2.6, 1.425], [2.6, 1.425], [3.1, 0.825], [3.1, 0.825]],
            0.66,
        ),
        ([[2.3, 2.1], [2.3, 2.1], [2.4, 2.025], [2.4, 2.025]], 0.25),
        ([[2.7, 2.4], [2.7, 2.4], [3.3, 2.4], [3.3, 2.4]], 0.25),
    ],
    [
        ([[2.7, 2.4], [2.7, 2.4], [3.3, 2.4], [3.3, 2.4]], 0.25),
        (
            [
                [2.8, 2.475],
                [2.8, 2.475],
                [3.525, 2.49375],
                [3.525, 2.49375],
            ],
            0.25,
        ),
        (
            [[2.9, 2.475], [2.9, 2.475], [3.45, 2.5125], [3.45, 2.5125]],
            0.15,
        ),
        ([[2.8, 2.4], [2.8, 2.4], [3.2, 2.4], [3.2, 2.4]], 0.15),
    ],
];

/// Newell's control points off the axes of a quarter circle stand at this share of its radius.
const QUARTER: f32 = 0.56;

fn teapot() -> Result<PatchMesh, impl std::error::Error> {
    let mut points: Vec<[f32; 4]> = Vec::new();
    for strip in TURNED {
        // Quarter turns: (x, z) along the first axis and across to the second.
        for [along, across] in [
            [[1.0, 0.0], [0.0, 1.0]],
            [[0.0, 1.0], [-1.0, 0.0]],
            [[-1.0, 0.0], [0.0, -1.0]],
            [[0.0, -1.0], [1.0, 0.0]],
        ] {
            for [radius, height] in strip {
                for [a, b] in [[1.0, 0.0], [1.0, QUARTER], [QUARTER, 1.0], [0.0, 1.0]] {
                    let x = radius * (a * along[0] + b * across[0]);
                    let z = radius * (a * along[1] + b * across[1]);
                    points.push([x, height, z, 0.0]);
                }
            }
        }
    }
    for patch in SWEPT {
        for side in [1.0, -1.0] {
            for (row, out) in patch {
                let depths = [0.0, out * side, out * side, 0.0];
                points.extend(row.iter().zip(depths).map(|([x, y], z)| [*x, *y, z, 0.0]));
            }
        }
    }
    PatchMesh::from_patches(PatchLayout::BICUBIC, &points)
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) -> Result {
    commands.spawn(Patches::<Bezier>::new(Arc::new(teapot()?)));
    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(400.0, 400.0))),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color: Color::linear_rgb(0.2, 0.19, 0.18),
            perceptual_roughness: 0.6,
            ..default()
        })),
    ));
    commands.spawn(support::light(60_000.0, 1_500.0));
    let circle = support::Circle {
        centre: Vec3::new(0.2, 1.3, 0.0),
        distance: 9.5,
        yaw: 0.5,
        pitch: 0.35,
    };
    commands.spawn(support::camera(circle, 4.0, 14.2));
    Ok(())
}
