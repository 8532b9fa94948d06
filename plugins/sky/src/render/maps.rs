//! Cube maps of the sky: what is seen, and what lights the ground.

use bevy::asset::RenderAssetUsages;
use bevy::image::Image;
use bevy::math::{Vec3, ops};
use bevy::render::render_resource::{
    Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
};
use half::f16;

use super::cube::{Cores, Cube, face_texels};
use crate::twilight::DAY_EV100;

/// Side of a face of the map of reflections, and its roughness levels.
const SPECULAR_SIDE: u32 = 32;
const SPECULAR_LEVELS: u32 = 6;
/// Side of a face of the map of diffuse light: it varies by the cosine only.
const DIFFUSE_SIDE: u32 = 8;

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
    /// `ev100`; `side` texels a side of what is seen. At 128 some 0.1 s of a core by day, several
    /// times that at dusk.
    ///
    /// The scale follows the exposure: f16 has its fine range where the picture has it, by night
    /// too.
    pub fn new(
        radiance: impl Fn(Vec3) -> Vec3 + Sync,
        ev100: f32,
        side: u32,
        cores: Cores,
    ) -> Self {
        let scale = DAY_SCALE * ops::exp2(ev100 - DAY_EV100);
        let sky = Cube {
            side,
            texels: face_texels(side, cores, |direction| radiance(direction) / scale),
        };
        let diffuse = face_texels(DIFFUSE_SIDE, cores, |n| sky.gather(n, 1.0));
        let mut levels = Vec::new();
        for level in 0..SPECULAR_LEVELS {
            let roughness = level as f32 / (SPECULAR_LEVELS - 1) as f32;
            levels.push(face_texels(SPECULAR_SIDE >> level, cores, |n| {
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
            seen: cube_image(side, std::slice::from_ref(&sky.texels)),
            scale,
        }
    }
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
    fn a_night_fills_the_same_bits_as_a_day() {
        let mean = |radiance: f32, ev100: f32| {
            let maps = SkyMaps::new(|_| Vec3::splat(radiance), ev100, 16, Cores::One);
            let data = maps.seen.data.expect("texels");
            let texel = f16::from_le_bytes([data[0], data[1]]).to_f32();
            (texel, maps.scale)
        };
        assert_eq!(
            mean(2500.0, DAY_EV100),
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
}
