//! Textures that come with the crate: five small layers, made once, so that a terrain needs no file.
//!
//! Sand, grass, rock, snow and scree, in the order of [`MaterialBands`](crate::MaterialBands). Each layer
//! repeats at its borders. A tile is taken to be 3 m wide.

use std::f32::consts::TAU;

use bevy::asset::RenderAssetUsages;
use bevy::math::ops;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, futures_lite::future::zip, poll_once};

use super::noise::{Cells, cells, fbm};

/// Side of a layer, texels: 3.5 MiB for both arrays with their mip levels.
pub const SIDE: usize = 256;

/// Layers.
pub const COUNT: usize = 5;

/// Width of a tile, metres: what slopes are counted by.
const TILE: f32 = 3.0;

/// What is known of a texel before its slope is.
#[derive(Clone, Copy)]
struct Ground {
    /// Linear.
    albedo: Vec3,
    /// 0 to 1.
    height: f32,
    roughness: f32,
}

/// A layer: its ground at (u, v) within 0 to 1, and the height of 1 in metres.
type Recipe = (fn(Vec2) -> Ground, f32);

const RECIPES: [Recipe; COUNT] = [
    (sand, 0.035),
    (grass, 0.09),
    (rock, 0.16),
    (snow, 0.05),
    (scree, 0.09),
];

fn ground(albedo: [f32; 3], shade: f32, height: f32, roughness: f32) -> Ground {
    Ground {
        albedo: Vec3::from(albedo) * shade,
        height: height.clamp(0.0, 1.0),
        roughness,
    }
}

fn sand(at: Vec2) -> Ground {
    let bend = fbm(at, 3, 3, 1);
    let ripple = 0.5 + 0.5 * ops::sin(TAU * (7.0 * at.y + 0.8 * bend));
    let grain = fbm(at, 64, 2, 2);
    let height = 0.35 + 0.3 * ripple + 0.35 * fbm(at, 4, 4, 3) + 0.12 * grain;
    ground(
        [0.42, 0.34, 0.22],
        0.9 + 0.16 * height + 0.22 * grain,
        height,
        0.9,
    )
}

fn grass(at: Vec2) -> Ground {
    let clump = 0.5 + 0.5 * fbm(at, 6, 4, 11);
    let blade = 1.0 - fbm(at, 44, 3, 12).abs() * 1.6;
    let height = 0.55 * clump + 0.45 * blade;
    let dry = (0.5 + 0.9 * fbm(at, 3, 4, 13)).clamp(0.0, 1.0);
    let green = Vec3::new(0.052, 0.105, 0.020).lerp(Vec3::new(0.110, 0.165, 0.040), blade.max(0.0));
    let albedo = green.lerp(Vec3::new(0.18, 0.16, 0.07), 0.3 * dry);
    ground(albedo.to_array(), 0.55 + 0.6 * height, height, 0.93)
}

fn rock(at: Vec2) -> Ground {
    let bent = at + Vec2::new(fbm(at, 3, 4, 21), fbm(at, 3, 4, 22)) * 0.09;
    let ridge = (1.0 - (fbm(bent, 3, 7, 23) * 1.5).abs()).max(0.0);
    let Cells { first, second, .. } = cells(bent, 4, 24);
    let crack = ((second - first) * 9.0).min(1.0);
    let grain = fbm(at, 48, 3, 26);
    let height = 0.1 + 0.74 * ridge + 0.1 * crack + 0.06 * grain;
    let warm = (0.5 + fbm(at, 2, 4, 25)).clamp(0.0, 1.0);
    let albedo = Vec3::new(0.195, 0.195, 0.2).lerp(Vec3::new(0.235, 0.21, 0.175), warm);
    let shade = (0.6 + 0.5 * height) * (0.9 + 0.1 * crack) * (1.0 + 0.15 * grain);
    ground(albedo.to_array(), shade, height, 0.86)
}

fn snow(at: Vec2) -> Ground {
    let drift = 0.5 + 0.5 * fbm(at, 3, 5, 31);
    let grain = fbm(at, 96, 1, 32);
    ground(
        [0.83, 0.86, 0.90],
        0.96 + 0.05 * drift + 0.02 * grain,
        drift + 0.03 * grain,
        0.6,
    )
}

fn scree(at: Vec2) -> Ground {
    let stones = |period, seed| {
        let Cells { first, own, .. } = cells(at, period, seed);
        let dome = (1.0 - 1.7 * first * first).max(0.0).sqrt();
        (dome * (0.45 + 0.55 * own), own)
    };
    let (large, own) = stones(11, 41);
    let (small, other) = stones(27, 42);
    let (top, own) = if large > 0.8 * small {
        (large, own)
    } else {
        (0.8 * small, other)
    };
    let height = 0.1 + 0.8 * top + 0.1 * fbm(at, 32, 3, 43);
    let albedo = Vec3::new(0.24, 0.205, 0.165).lerp(Vec3::new(0.22, 0.22, 0.22), own);
    ground(
        albedo.to_array(),
        (0.4 + 0.5 * height) * (0.8 + 0.5 * own),
        height,
        0.92,
    )
}

/// The texels of a layer: albedo and height, then normal, roughness and occlusion.
fn layer((at, metres): Recipe) -> [Vec<u8>; 2] {
    let place = |x: usize, y: usize| (Vec2::new(x as f32, y as f32) + 0.5) / SIDE as f32;
    let texels: Vec<Ground> = (0..SIDE * SIDE)
        .map(|index| at(place(index % SIDE, index / SIDE)))
        .collect();
    let height = |x: usize, y: usize| texels[(y % SIDE) * SIDE + x % SIDE].height;
    let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    let mut albedo = Vec::with_capacity(SIDE * SIDE * 4);
    let mut normal = Vec::with_capacity(SIDE * SIDE * 4);
    for (index, texel) in texels.iter().enumerate() {
        let (x, y) = (index % SIDE + SIDE, index / SIDE + SIDE);
        let rise = metres * SIDE as f32 / (2.0 * TILE);
        let slope = Vec2::new(
            height(x + 1, y) - height(x - 1, y),
            height(x, y + 1) - height(x, y - 1),
        ) * rise;
        let lean = -slope / (1.0 + slope.length_squared()).sqrt();
        // What lies lower than its surroundings sees less of the sky.
        let around = [(5, 0), (0, 5), (2 * SIDE - 5, 0), (0, 2 * SIDE - 5), (4, 4)]
            .map(|(dx, dy)| height(x + dx, y + dy))
            .iter()
            .sum::<f32>()
            / 5.0;
        let hollow = (around - texel.height).max(0.0);
        let srgb = texel.albedo.to_array().map(Srgba::gamma_function_inverse);
        albedo.extend(srgb.map(byte));
        albedo.push(byte(texel.height));
        normal.extend([lean.x, lean.y].map(|lean| byte(0.5 + 0.5 * lean)));
        normal.extend([byte(texel.roughness), byte(1.0 - 1.2 * hollow)]);
    }
    [albedo, normal]
}

/// Both arrays, stacked from top to bottom: albedo and height, then normal, roughness and occlusion.
fn stacks(layers: impl IntoIterator<Item = [Vec<u8>; 2]>) -> [Image; 2] {
    let mut data = [Vec::new(), Vec::new()];
    for texels in layers {
        for (stack, texels) in data.iter_mut().zip(texels) {
            stack.extend(texels);
        }
    }
    data.map(|data| {
        Image::new(
            Extent3d {
                width: SIDE as u32,
                height: (SIDE * COUNT) as u32,
                depth_or_array_layers: 1,
            },
            TextureDimension::D2,
            data,
            TextureFormat::Rgba8Unorm,
            RenderAssetUsages::all(),
        )
    })
}

/// The layers being made.
pub(super) struct Making(Task<[Image; 2]>);

impl Making {
    /// Starts them, a task a layer.
    pub(super) fn start() -> Self {
        let pool = AsyncComputeTaskPool::get();
        let [a, b, c, d, e] = RECIPES.map(|recipe| pool.spawn(async move { layer(recipe) }));
        Self(pool.spawn(async move {
            let ((a, b), (c, (d, e))) = zip(zip(a, b), zip(c, zip(d, e))).await;
            stacks([a, b, c, d, e])
        }))
    }

    /// The stacks, once they are there.
    pub(super) fn finished(&mut self) -> Option<[Image; 2]> {
        block_on(poll_once(&mut self.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_repeat_and_differ() {
        for (index, (at, _)) in RECIPES.into_iter().enumerate() {
            let mut heights = Vec::new();
            for k in 0..64 {
                let v = k as f32 / 64.0;
                let (low, high) = (at(Vec2::new(1e-5, v)), at(Vec2::new(1.0 - 1e-5, v)));
                // Over 2e-5 of a tile the steepest noise (96 cells, slope of some 3) changes by 6e-3.
                let apart = (low.height - high.height).abs();
                assert!(apart < 0.03, "layer {index} at v = {v}: {apart}");
                heights.push(low.height);
            }
            let (low, high) = heights.iter().fold((1.0_f32, 0.0_f32), |(low, high), &h| {
                (low.min(h), high.max(h))
            });
            assert!(high - low > 0.1, "layer {index} is flat: {low} to {high}");
        }
    }

    #[test]
    fn the_albedo_of_each_layer_is_that_of_its_ground() {
        // Linear luminance as measured of such ground: grass 0.1, rock and scree 0.15 to 0.25, sand 0.3
        // to 0.4, snow 0.8 to 0.9.
        let wanted = [
            (0.25, 0.45),
            (0.05, 0.15),
            (0.08, 0.25),
            (0.75, 0.95),
            (0.08, 0.25),
        ];
        for ((at, _), (low, high)) in RECIPES.into_iter().zip(wanted) {
            let points = (0..1024).map(|k| Vec2::new((k % 32) as f32, (k / 32) as f32) / 32.0);
            let luminance = |at: Ground| at.albedo.dot(Vec3::new(0.2126, 0.7152, 0.0722));
            let mean = points.map(|point| luminance(at(point))).sum::<f32>() / 1024.0;
            assert!((low..high).contains(&mean), "{mean}, not {low} to {high}");
        }
    }
}
