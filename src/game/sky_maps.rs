//! Cube maps of the sky: what is seen, and what lights the ground.

use bevy::asset::RenderAssetUsages;
use bevy::image::Image;
use bevy::math::{Vec3, ops};
use bevy::render::render_resource::{
    Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
};
use bevy::tasks::{ComputeTaskPool, TaskPool};
use half::f16;

use super::view::EV100;

/// Side of a face of the map that is seen, texels. The sky is smooth.
const SEEN_SIDE: u32 = 128;
/// Side of a face of the map of reflections, and its roughness levels.
const SPECULAR_SIDE: u32 = 32;
const SPECULAR_LEVELS: u32 = 6;
/// Side of a face of the map of diffuse light: it varies by the cosine only.
const DIFFUSE_SIDE: u32 = 8;
/// Directions that a texel of the lighting maps gathers from.
const SAMPLES: u32 = 96;

/// Cube maps in cd/m² over [`SkyMaps::scale`].
pub struct SkyMaps {
    /// The sky as it is seen.
    pub seen: Image,
    /// Light from the hemisphere about each direction: irradiance over π.
    pub diffuse: Image,
    /// Reflections, rougher from level to level.
    pub specular: Image,
    /// Luminance of 1 in the maps, cd/m².
    pub scale: f32,
}

/// Luminance of 1 in the maps of a day, cd/m².
const DAY_SCALE: f32 = 1000.0;

impl SkyMaps {
    /// The maps of a sky that has the `radiance` (cd/m²) in each direction, seen with the exposure
    /// `ev100`; some 0.1 s of a core by day, several times that at dusk.
    ///
    /// The scale follows the exposure: f16 has its fine range where the picture has it, by night
    /// too.
    pub fn new(radiance: impl Fn(Vec3) -> Vec3 + Sync, ev100: f32) -> Self {
        let scale = DAY_SCALE * ops::exp2(ev100 - EV100);
        let seen = face_texels(SEEN_SIDE, |direction| radiance(direction) / scale);
        let sky = Cube {
            side: SEEN_SIDE,
            texels: seen,
        };
        let diffuse = face_texels(DIFFUSE_SIDE, |n| sky.gather(n, 1.0));
        let mut levels = Vec::new();
        for level in 0..SPECULAR_LEVELS {
            let roughness = level as f32 / (SPECULAR_LEVELS - 1) as f32;
            levels.push(face_texels(SPECULAR_SIDE >> level, |n| {
                if level == 0 {
                    sky.look(n)
                } else {
                    sky.gather(n, roughness)
                }
            }));
        }
        Self {
            diffuse: cube_image(DIFFUSE_SIDE, &[diffuse]),
            specular: cube_image(SPECULAR_SIDE, &levels),
            seen: cube_image(SEEN_SIDE, std::slice::from_ref(&sky.texels)),
            scale,
        }
    }
}

struct Cube {
    side: u32,
    /// Six faces, row by row.
    texels: Vec<Vec3>,
}

impl Cube {
    fn look(&self, direction: Vec3) -> Vec3 {
        let (face, u, v) = face_of(direction);
        let at =
            |t: f32| ((t * 0.5 + 0.5) * self.side as f32).clamp(0.0, self.side as f32 - 1.0) as u32;
        self.texels[((face * self.side + at(v)) * self.side + at(u)) as usize]
    }

    /// Mean over a lobe about `n`: the cosine lobe for roughness 1, a narrower power of it below
    /// (Blinn-Phong exponents for GGX: Karis 2013).
    fn gather(&self, n: Vec3, roughness: f32) -> Vec3 {
        let a = roughness * roughness;
        let exponent = (2.0 / (a * a) - 1.0).clamp(1.0, 2000.0);
        let (x, y) = n.any_orthonormal_pair();
        let sum: Vec3 = (0..SAMPLES)
            .map(|i| {
                // Fibonacci lattice, warped to the lobe cos^exponent.
                let share = (i as f32 + 0.5) / SAMPLES as f32;
                let angle = i as f32 * 2.399_963; // the golden angle
                let cos = ops::powf(share, 1.0 / (exponent + 1.0));
                let sin = (1.0 - cos * cos).max(0.0).sqrt();
                let (s, c) = ops::sin_cos(angle);
                self.look(x * (sin * c) + y * (sin * s) + n * cos)
            })
            .sum();
        sum / SAMPLES as f32
    }
}

/// Bevy's cube maps are left-handed: +z and −z swap (as in its atmosphere's environment map).
fn direction(face: u32, u: f32, v: f32) -> Vec3 {
    let d = match face {
        0 => Vec3::new(1.0, -v, -u),
        1 => Vec3::new(-1.0, -v, u),
        2 => Vec3::new(u, 1.0, v),
        3 => Vec3::new(u, -1.0, -v),
        4 => Vec3::new(u, -v, 1.0),
        _ => Vec3::new(-u, -v, -1.0),
    };
    (d * Vec3::new(1.0, 1.0, -1.0)).normalize()
}

fn face_of(direction: Vec3) -> (u32, f32, f32) {
    let d = direction * Vec3::new(1.0, 1.0, -1.0);
    let size = d.abs();
    if size.x >= size.y && size.x >= size.z {
        let (u, face) = if d.x > 0.0 { (-d.z, 0) } else { (d.z, 1) };
        (face, u / size.x, -d.y / size.x)
    } else if size.y >= size.z {
        let (v, face) = if d.y > 0.0 { (d.z, 2) } else { (-d.z, 3) };
        (face, d.x / size.y, v / size.y)
    } else {
        let (u, face) = if d.z > 0.0 { (d.x, 4) } else { (-d.x, 5) };
        (face, u / size.z, -d.y / size.z)
    }
}

/// Six faces of `side` × `side`, each texel by the direction of its centre; on all cores.
fn face_texels(side: u32, texel: impl Fn(Vec3) -> Vec3 + Sync) -> Vec<Vec3> {
    let texel = &texel;
    let pool = ComputeTaskPool::get_or_init(TaskPool::default);
    let faces = pool.scope(|scope| {
        for face in 0..6 {
            scope.spawn(async move {
                let centre = |i: u32| (2.0 * i as f32 + 1.0) / side as f32 - 1.0;
                (0..side * side)
                    .map(|i| texel(direction(face, centre(i % side), centre(i / side))))
                    .collect::<Vec<_>>()
            });
        }
    });
    faces.into_iter().flatten().collect()
}

/// A cube map with mip levels from lists of six faces each.
fn cube_image(side: u32, levels: &[Vec<Vec3>]) -> Image {
    let mut data = Vec::new();
    for face in 0..6_usize {
        for (level, texels) in levels.iter().enumerate() {
            let count = ((side >> level) * (side >> level)) as usize;
            for texel in &texels[face * count..(face + 1) * count] {
                for value in [texel.x, texel.y, texel.z, 1.0] {
                    data.extend_from_slice(&f16::from_f32(value.min(60_000.0)).to_le_bytes());
                }
            }
        }
    }
    let size = Extent3d {
        width: side,
        height: side,
        depth_or_array_layers: 6,
    };
    let mut image = Image::new_uninit(
        size,
        TextureDimension::D2,
        TextureFormat::Rgba16Float,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.data = Some(data);
    image.texture_descriptor.mip_level_count = levels.len() as u32;
    image.texture_view_descriptor = Some(TextureViewDescriptor {
        dimension: Some(TextureViewDimension::Cube),
        ..Default::default()
    });
    image
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_and_directions_are_inverse() {
        for face in 0..6 {
            for (u, v) in [(0.0, 0.0), (0.5, -0.25), (-0.75, 0.6)] {
                let (f, x, y) = face_of(direction(face, u, v));
                // Three roundings of numbers up to 1.
                assert!(
                    f == face && (x - u).abs() < 4e-7 && (y - v).abs() < 4e-7,
                    "{face} {u} {v}: {f} {x} {y}"
                );
            }
        }
    }

    #[test]
    fn a_night_fills_the_same_bits_as_a_day() {
        let mean = |radiance: f32, ev100: f32| {
            let maps = SkyMaps::new(|_| Vec3::splat(radiance), ev100);
            let data = maps.seen.data.expect("texels");
            let texel = f16::from_le_bytes([data[0], data[1]]).to_f32();
            (texel, maps.scale)
        };
        assert_eq!(
            mean(2500.0, EV100),
            (2.5, 1000.0),
            "by day the scale is 1000"
        );
        // A moonless zenith: f16 holds it to half a thousandth, and would hold it to a tenth over
        // the scale of the day.
        let (texel, scale) = mean(2e-4, -2.7);
        assert!((texel * scale / 2e-4 - 1.0).abs() < 5e-4, "{texel} {scale}");
        let day = f16::from_f32(2e-4 / 1000.0).to_f32() * 1000.0;
        assert!((day / 2e-4 - 1.0).abs() > 0.02, "{day}");
    }

    #[test]
    fn an_even_sky_lights_evenly() {
        let sky = Cube {
            side: 4,
            texels: vec![Vec3::ONE; 96],
        };
        for roughness in [0.2, 0.5, 1.0] {
            // A mean of ones.
            assert!(
                (sky.gather(Vec3::Y, roughness) - Vec3::ONE)
                    .abs()
                    .max_element()
                    < 1e-5
            );
        }
    }
}
