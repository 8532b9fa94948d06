//! Hills of noise in one grey, for tests that look at shapes.

use bevy::app::App;
use bevy::asset::RenderAssetUsages;
use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use dolomite::ground::render::texture::{LAYERS, texture_array};
use dolomite::ground::{GroundMaterial, GroundTextures, Sea};
use dolomite::terrain::{Fractal, GroundRect, Layer, Source, Terrain, TerrainData};

/// Hills: where, of what, and the sea among them.
pub struct Hills {
    /// Middle of the ground, metres.
    pub centre: DVec2,
    /// Its side, metres.
    pub side: f64,
    /// The noise.
    pub noise: Fractal,
    /// Height below the noise, metres.
    pub base: f32,
    /// Height of the sea.
    pub sea: Option<f32>,
}

impl Hills {
    /// Spawns them, and gives their ground.
    pub fn spawn(self, app: &mut App) -> Terrain {
        let terrain = Terrain::new(TerrainData {
            extent: GroundRect::square(self.centre, self.side),
            layers: vec![Layer {
                source: Source::Fractal(self.noise),
                mask: None,
            }],
            base: self.base,
            sea_level: self.sea,
        })
        .expect("valid hills");
        let material = material(app);
        app.world_mut().spawn((terrain.clone(), material));
        terrain
    }
}

/// A material of the smallest textures, and a sea for ground that has a level for it.
fn material(app: &mut App) -> (GroundMaterial, GroundTextures, Sea) {
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
    let textures = GroundTextures {
        albedo_height: array(true),
        normal_roughness: array(false),
    };
    (GroundMaterial::default(), textures, Sea::default())
}
