//! Six thousand stars, each an octahedron of eight triangle patches, which are refined to spheres as
//! they come near: `cargo run --release --example stars`.

mod support;

use std::sync::Arc;

use bevy::math::ops;
use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use dolomite::tessellation::render::{GeometryMaterial, PatchKind, PatchPlugin, PatchShader};
use dolomite::tessellation::{PatchLayout, Patches, shapes};

const STARS: u32 = 6000;

/// Shines by itself.
#[derive(Resource, AsBindGroup, Clone)]
pub struct Star {}

impl PatchKind for Star {
    const LAYOUT: PatchLayout = PatchLayout::TRIANGLE;
    const SHADOWS: bool = false;

    fn shader() -> PatchShader {
        PatchShader::File("shaders/globe.wgsl")
    }

    /// From red dwarfs to blue giants.
    fn materials(&self) -> Vec<GeometryMaterial> {
        let shines = |red, green, blue| GeometryMaterial {
            base_color: LinearRgba::BLACK,
            emissive: LinearRgba::rgb(red, green, blue) * 1_500.0,
            ..default()
        };
        vec![
            shines(1.0, 0.45, 0.2),
            shines(1.0, 0.75, 0.45),
            shines(1.0, 0.95, 0.85),
            shines(0.8, 0.9, 1.2),
            shines(0.55, 0.7, 1.5),
        ]
    }
}

fn main() {
    support::app("Stars")
        .add_plugins(PatchPlugin(Star {}))
        .add_systems(Startup, setup)
        .run();
}

/// A number from 0 to 1 (PCG: O'Neill 2014).
fn random(state: &mut u32) -> f32 {
    *state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((*state >> ((*state >> 28) + 4)) ^ *state).wrapping_mul(277_803_737);
    ((word >> 22) ^ word) as f32 / u32::MAX as f32
}

fn setup(mut commands: Commands) {
    let mesh = Arc::new(shapes::octahedron(1));
    let mut seed = 7;
    for _ in 0..STARS {
        let mut next = || random(&mut seed);
        let at = if next() < 0.25 {
            // The bulge: a flattened ball, denser towards its middle.
            let ball = Vec3::new(next(), next(), next()) + Vec3::new(next(), next(), next());
            (ball - 1.0) * Vec3::new(20.0, 11.0, 20.0) * next()
        } else {
            // A spiral of two arms.
            let away = 6.0 + 115.0 * next() * next();
            let arm = if next() < 0.5 {
                0.0
            } else {
                core::f32::consts::PI
            };
            let angle = arm + 2.6 * ops::ln(away) + (next() - 0.5) * (next() - 0.5) * 5.0;
            let thick = (next() + next() + next() - 1.5) * 3.0;
            Vec3::new(away * ops::cos(angle), thick, away * ops::sin(angle))
        };
        let size = 0.07 + 0.4 * next() * next() * next() * next();
        let colour = (next() * 5.0).floor().min(4.0);
        commands.spawn((
            Patches::<Star>::new(mesh.clone()).with(0, Vec4::new(colour, 0.0, 0.0, 0.0)),
            Transform::from_translation(at).with_scale(Vec3::splat(size)),
        ));
    }
    commands.spawn(support::light(0.0, 0.0));
    let circle = support::Circle {
        centre: Vec3::ZERO,
        distance: 95.0,
        yaw: 0.4,
        pitch: 0.55,
    };
    commands.spawn(support::camera(circle, 4.0, 13.5));
}
