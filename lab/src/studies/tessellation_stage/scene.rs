//! The scene of the frames with shadow views: five bodies before a camera, a light above them.

use super::gbuffer::MAIN;
use dolomite_tessellation::tables::Instance;
use dolomite_tessellation::{Levels, PatchMesh, Tessellator};

/// Most shadow views of the sweep.
pub const MOST: usize = 6;

/// Where the five entities stand, metres; the camera stands at the origin and looks along −z.
pub const PLACES: [[f32; 3]; 5] = [
    [-3.6, 0.7, -8.0],
    [-1.9, -0.5, -6.5],
    [0.0, 0.4, -7.0],
    [1.9, -0.4, -6.0],
    [3.7, 0.6, -8.5],
];

/// Radius 1, the parameters of `examples/sphere.rs`.
#[must_use]
pub fn entity(place: [f32; 3], level: f32) -> Instance {
    let mut entity = Instance::IDENTITY;
    for (k, along) in place.into_iter().enumerate() {
        entity.rows[k][3] = along;
        entity.previous[k][3] = along;
    }
    entity.params[0] = [level, 0.14, 1.4, 0.0];
    entity
}

/// Room for five meshes that share nothing.
#[must_use]
pub fn pools(tessellator: Tessellator, mesh: &PatchMesh, level: f32) -> [u32; 2] {
    let patch = tessellator.tessellate(&Levels::uniform(level));
    let patches = (PLACES.len() * mesh.patches()) as u32;
    [patch.coordinates.len(), patch.primitives.len()].map(|each| each as u32 * patches)
}

/// Perspective of a vertical angle of 45 degrees, reversed depth without a far plane; column by column.
#[must_use]
pub fn camera() -> [[f32; 4]; 4] {
    // 1 / tan(22.5 degrees) = 1 + sqrt(2).
    let scale = 1.0 + std::f32::consts::SQRT_2;
    let aspect = MAIN[0] as f32 / MAIN[1] as f32;
    let near = 0.1;
    [
        [scale / aspect, 0.0, 0.0, 0.0],
        [0.0, scale, 0.0, 0.0],
        [0.0, 0.0, 0.0, -1.0],
        [0.0, 0.0, near, 0.0],
    ]
}

/// A cascade of a light from above: x to the right, −z up, the farther the wider.
#[must_use]
pub fn light(cascade: usize) -> [[f32; 4]; 4] {
    let half = [4.0, 6.0, 9.0, 13.0, 18.0, 24.0][cascade.min(MOST - 1)];
    let scale = 1.0 / half;
    // The middle of the scene is 7 m away; 100 m of depth, nearer to the light is greater.
    [
        [scale, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.01, 0.0],
        [0.0, -scale, 0.0, 0.0],
        [0.0, -7.0 * scale, 0.5, 1.0],
    ]
}
