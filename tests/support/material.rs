//! Ground of one grey, for tests that look at shapes.

use bevy::app::App;
use bevy::asset::RenderAssetUsages;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use dolomite::ground::TerrainMaterial;
use dolomite::ground::render::texture::{LAYERS, texture_array};

/// A material of the smallest textures.
pub fn material(app: &mut App) -> TerrainMaterial {
    let mut images = app.world_mut().resource_mut::<Assets<Image>>();
    let mut array = |srgb| {
        let size = Extent3d {
            width: 4,
            height: 4 * LAYERS,
            depth_or_array_layers: 1,
        };
        let stack = Image::new_fill(
            size,
            TextureDimension::D2,
            &[128; 4],
            TextureFormat::Rgba8Unorm,
            RenderAssetUsages::all(),
        );
        images.add(texture_array(&stack, LAYERS, srgb).expect("a stack of squares"))
    };
    TerrainMaterial::new(array(true), array(false))
}
