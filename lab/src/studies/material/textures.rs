//! The ground's textures as the game has them.

use bevy::asset::RenderAssetUsages;
use bevy::image::Image;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use dolomite_ground::render::texture::texture_array;

/// Both arrays.
#[must_use]
pub fn arrays() -> [Image; 2] {
    let albedo = include_bytes!("../../../../assets/textures/terrain_albedo_height.png");
    let normal = include_bytes!("../../../../assets/textures/terrain_normal_roughness.png");
    [array(albedo, true), array(normal, false)]
}

fn array(png: &[u8], srgb: bool) -> Image {
    let texels = image::load_from_memory(png)
        .expect("the committed file is a PNG")
        .into_rgba8();
    let (width, height) = texels.dimensions();
    let stacked = Image::new(
        Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        texels.into_raw(),
        TextureFormat::Rgba8Unorm,
        RenderAssetUsages::all(),
    );
    texture_array(&stacked, height / width, srgb).expect("the committed file has whole layers")
}
