//! Texture arrays with mip levels, from the stacked images that the ground materials come as.

use bevy::asset::{RenderAssetUsages, uuid_handle};
use bevy::image::{Image, ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor};
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use bevy::render::render_resource::{
    Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
};
use bevy::render::renderer::RenderAdapterInfo;
use thiserror::Error;

use super::builtin::{COUNT, Making};
use crate::cover::TerrainView;
use crate::material::{GroundMaterial, Surface};
use crate::shown::ShownTerrains;

/// Layers of the textures that [`MaterialBands`](crate::MaterialBands) speaks of.
pub const LAYERS: u32 = 5;

/// Textures that come with the crate; made when a terrain that is drawn first needs them.
const BUILT_IN: [Handle<Image>; 2] = [
    uuid_handle!("5c9e1f0a-5f0b-4c7e-9d35-6f7d0d2b8a01"),
    uuid_handle!("5c9e1f0a-5f0b-4c7e-9d35-6f7d0d2b8a02"),
];

/// The texture arrays of a terrain; on the entity that carries its [`GroundMaterial`], which requires it.
///
/// Both are 2D arrays of as many layers as the material names, or images with square layers stacked from top
/// to bottom, of which the plugin makes arrays. A layer that an array has not is its last one. Until both are
/// there the terrain is not drawn; a material without textures waits for none. The default are five layers of
/// 256 × 256 texels that come with the crate (3.5 MiB once for all terrains): sand, grass, rock, snow, scree.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct GroundTextures {
    /// `Rgba8UnormSrgb`: albedo in rgb, height for height blending in a.
    pub albedo_height: Handle<Image>,
    /// `Rgba8Unorm`: tangent-space normal xy, perceptual roughness, ambient occlusion.
    pub normal_roughness: Handle<Image>,
}

impl Default for GroundTextures {
    fn default() -> Self {
        let [albedo_height, normal_roughness] = BUILT_IN;
        Self {
            albedo_height,
            normal_roughness,
        }
    }
}

impl GroundTextures {
    /// Whether an array is one of these.
    pub(super) fn names(&self, array: &Handle<Image>) -> bool {
        self.handles().iter().any(|(handle, _)| *handle == array)
    }

    fn handles(&self) -> [(&Handle<Image>, bool); 2] {
        [(&self.albedo_height, true), (&self.normal_roughness, false)]
    }
}

/// Whether a material has a layer with a texture.
pub(super) fn textured(material: &GroundMaterial) -> bool {
    let layers = material.layers.iter();
    layers
        .map(|layer| layer.surface)
        .any(|surface| matches!(surface, Surface::Texture(_)))
}

/// Why an image cannot become a texture array.
#[derive(Debug, Error, PartialEq, Eq)]
pub enum TextureArrayError {
    /// The layers do not divide the height, or a layer is not square with a power-of-two side.
    #[error(
        "an image of {width} × {height} texels is not {layers} square layers with a power-of-two side stacked from top to bottom; make it {width} × {wanted}"
    )]
    Shape {
        /// Width, texels.
        width: u32,
        /// Height, texels.
        height: u32,
        /// Layers asked for.
        layers: u32,
        /// The height that it should have.
        wanted: u32,
    },
    /// Not 8-bit RGBA.
    #[error("texture format {0:?} cannot become a texture array; save the image as 8-bit RGBA")]
    Format(TextureFormat),
    /// The texels are no longer in memory.
    #[error("the image's texels are on the GPU only; load it with RenderAssetUsages::all()")]
    NoData,
}

/// Cuts a vertical stack of `layers` square images into a 2D array with all mip levels.
///
/// Each level is the mean of 2 × 2 texels of the one below: in linear light where `srgb` (alpha
/// always linear). The sampler repeats and filters trilinearly.
///
/// # Errors
/// See [`TextureArrayError`].
pub fn texture_array(stacked: &Image, layers: u32, srgb: bool) -> Result<Image, TextureArrayError> {
    let descriptor = &stacked.texture_descriptor;
    let (width, height) = (descriptor.size.width, descriptor.size.height);
    if layers == 0 || !width.is_power_of_two() || height != width * layers {
        return Err(TextureArrayError::Shape {
            width,
            height,
            layers,
            wanted: width * layers,
        });
    }
    if !matches!(
        descriptor.format,
        TextureFormat::Rgba8Unorm | TextureFormat::Rgba8UnormSrgb
    ) {
        return Err(TextureArrayError::Format(descriptor.format));
    }
    let texels = stacked.data.as_deref().ok_or(TextureArrayError::NoData)?;
    let layer_bytes = (width * width * 4) as usize;
    let mut data = Vec::with_capacity(texels.len() * 4 / 3 + 64);
    for layer in texels.chunks_exact(layer_bytes) {
        let mut level = layer.to_vec();
        let mut side = width as usize;
        data.extend_from_slice(&level);
        while side > 1 {
            level = halve(&level, side, srgb);
            side /= 2;
            data.extend_from_slice(&level);
        }
    }
    let size = Extent3d {
        width,
        height: width,
        depth_or_array_layers: layers,
    };
    let format = if srgb {
        TextureFormat::Rgba8UnormSrgb
    } else {
        TextureFormat::Rgba8Unorm
    };
    let mut image = Image::new_uninit(
        size,
        TextureDimension::D2,
        format,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.data = Some(data);
    image.texture_descriptor.mip_level_count = width.ilog2() + 1;
    image.texture_view_descriptor = Some(TextureViewDescriptor {
        dimension: Some(TextureViewDimension::D2Array),
        ..default()
    });
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        label: Some("terrain_textures".into()),
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        mipmap_filter: ImageFilterMode::Linear,
        ..default()
    });
    Ok(image)
}

/// The next mip level of a square RGBA8 image.
fn halve(level: &[u8], side: usize, srgb: bool) -> Vec<u8> {
    let half = side / 2;
    let mut out = Vec::with_capacity(half * half * 4);
    for y in 0..half {
        for x in 0..half {
            for channel in 0..4 {
                let at =
                    |dx: usize, dy: usize| level[((2 * y + dy) * side + 2 * x + dx) * 4 + channel];
                let four = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
                let byte = if srgb && channel < 3 {
                    let linear = four.map(|byte| Srgba::gamma_function(f32::from(byte) / 255.0));
                    let mean = linear.iter().sum::<f32>() / 4.0;
                    (Srgba::gamma_function_inverse(mean) * 255.0 + 0.5) as u8
                } else {
                    // Rounded to nearest: + 2 of 4.
                    ((four.iter().map(|&byte| u16::from(byte)).sum::<u16>() + 2) / 4) as u8
                };
                out.push(byte);
            }
        }
    }
    out
}

/// Texture arrays that are ready to be drawn with.
#[derive(Resource, Default)]
pub(crate) struct ReadyArrays {
    ready: HashSet<AssetId<Image>>,
    /// Those that come with the crate, while they are being made.
    making: Option<Making>,
}

impl ReadyArrays {
    /// Whether all that a material samples is there.
    pub(super) fn has(&self, material: &GroundMaterial, textures: &GroundTextures) -> bool {
        !textured(material)
            || textures
                .handles()
                .iter()
                .all(|(handle, _)| self.ready.contains(&handle.id()))
    }
}

/// Makes the textures that come with the crate, once a terrain that is drawn needs them.
pub(super) fn make_built_in(
    shown: Res<ShownTerrains>,
    views: Query<(), With<TerrainView>>,
    materials: Query<(&GroundMaterial, &GroundTextures)>,
    mut images: ResMut<Assets<Image>>,
    mut ready: ResMut<ReadyArrays>,
    adapter: Option<Res<RenderAdapterInfo>>,
) {
    let ReadyArrays { ready, making } = &mut *ready;
    if ready.contains(&BUILT_IN[0].id()) {
        return;
    }
    let of =
        |textures: &GroundTextures| textures.handles().iter().any(|(h, _)| is_built_in(h.id()));
    let needed = |(material, textures)| textured(material) && of(textures);
    let mut drawn = materials.iter_many(shown.entities());
    if making.is_none() && !views.is_empty() && drawn.any(needed) {
        *making = Some(Making::start());
    }
    let Some(stacks) = making.as_mut().and_then(Making::finished) else {
        return;
    };
    *making = None;
    for ((handle, stack), srgb) in BUILT_IN.iter().zip(&stacks).zip([true, false]) {
        let made = texture_array(stack, COUNT as u32, srgb);
        // Their shape is the one that is asked for.
        if let Ok(array) = made.map(|array| filtered(array, adapter.as_deref()))
            && images.insert(handle.id(), array).is_ok()
        {
            ready.insert(handle.id());
        }
    }
}

fn is_built_in(id: AssetId<Image>) -> bool {
    BUILT_IN.iter().any(|handle| handle.id() == id)
}

/// The array with a sampler for the device: a processor that draws pays for every tap in full.
fn filtered(mut array: Image, adapter: Option<&RenderAdapterInfo>) -> Image {
    let software = adapter.is_some_and(|adapter| adapter.device_type == wgpu::DeviceType::Cpu);
    if let ImageSampler::Descriptor(sampler) = &mut array.sampler {
        sampler.anisotropy_clamp = if software { 1 } else { 8 };
    }
    array
}

/// Turns the stacked images that a [`GroundTextures`] names into texture arrays, in place, as
/// soon as they are loaded. A wrong image is reported once and left as it is.
pub(super) fn make_arrays(
    textures: Query<&GroundTextures>,
    mut images: ResMut<Assets<Image>>,
    mut ready: ResMut<ReadyArrays>,
    mut refused: Local<Vec<AssetId<Image>>>,
    adapter: Option<Res<RenderAdapterInfo>>,
) {
    for (handle, srgb) in textures.iter().flat_map(GroundTextures::handles) {
        let id = handle.id();
        if ready.ready.contains(&id) || refused.contains(&id) || is_built_in(id) {
            continue;
        }
        let Some(image) = images.get(id) else {
            // One that was made, not loaded, and lives on the GPU alone: an array, as it should be.
            if handle.path().is_none() && id != AssetId::default() {
                ready.ready.insert(id);
            }
            continue;
        };
        let size = image.texture_descriptor.size;
        if size.depth_or_array_layers > 1 {
            ready.ready.insert(id);
            continue;
        }
        let layers = (size.height / size.width.max(1)).max(1);
        let made = texture_array(image, layers, srgb).map_err(|error| error.to_string());
        let put = made.and_then(|array| {
            let array = filtered(array, adapter.as_deref());
            images.insert(id, array).map_err(|error| error.to_string())
        });
        match put {
            Ok(()) => {
                ready.ready.insert(id);
            }
            Err(error) => {
                error!("texture of the ground {:?}: {error}", handle.path());
                refused.push(id);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shown::follow_terrains;
    use bevy::math::DVec2;
    use dolomite_terrain::{GroundRect, Terrain, TerrainData};

    fn stack(width: u32, height: u32, texel: [u8; 4]) -> Image {
        Image::new_fill(
            Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            TextureDimension::D2,
            &texel,
            TextureFormat::Rgba8UnormSrgb,
            RenderAssetUsages::all(),
        )
    }

    #[test]
    fn an_even_colour_stays_the_same_in_every_level() {
        let array = texture_array(&stack(8, 16, [200, 100, 50, 25]), 2, true).expect("well-formed");
        assert_eq!(array.texture_descriptor.mip_level_count, 4);
        let data = array.data.expect("texels are kept");
        assert_eq!(data.len(), 2 * (64 + 16 + 4 + 1) * 4);
        assert!(
            data.chunks_exact(4)
                .all(|texel| texel == [200, 100, 50, 25])
        );
    }

    #[test]
    fn black_and_white_average_in_linear_light() {
        let mut checks = stack(2, 2, [0, 0, 0, 0]);
        let data = checks.data.as_mut().expect("just made");
        data[..8].fill(255);
        let array = texture_array(&checks, 1, true).expect("well-formed");
        let data = array.data.expect("texels are kept");
        // sRGB of a linear half is 188; alpha is linear: (255 + 255 + 0 + 0) / 4, rounded.
        assert_eq!(data[16..], [188, 188, 188, 128]);
    }

    #[test]
    fn textures_are_made_for_terrains_that_are_drawn_alone() {
        let mut app = App::new();
        app.add_plugins(MinimalPlugins)
            .init_resource::<ShownTerrains>()
            .init_resource::<ReadyArrays>()
            .init_resource::<Assets<Image>>()
            .add_systems(Update, make_built_in)
            .add_systems(PostUpdate, follow_terrains);
        let terrain = Terrain::new(TerrainData {
            extent: GroundRect::square(DVec2::ZERO, 10.0),
            layers: Vec::new(),
            base: 0.0,
            sea_level: None,
        });
        let ground = (
            terrain.expect("valid"),
            GroundMaterial::default(),
            Visibility::Hidden,
        );
        let ground = app.world_mut().spawn(ground).id();
        let begun = |app: &mut App| {
            // One frame says what is shown, the next one begins.
            app.update();
            app.update();
            let arrays = app.world().resource::<ReadyArrays>();
            arrays.making.is_some() || !arrays.ready.is_empty()
        };
        let view = app.world_mut().spawn(TerrainView).id();
        assert!(!begun(&mut app), "hidden");
        app.world_mut()
            .entity_mut(ground)
            .insert(Visibility::Inherited);
        app.world_mut().despawn(view);
        assert!(!begun(&mut app), "nobody looks");
        app.world_mut().spawn(TerrainView);
        assert!(begun(&mut app));
    }

    #[test]
    fn a_wrong_shape_is_refused_with_the_way_out() {
        let error = texture_array(&stack(8, 20, [0; 4]), 2, true).expect_err("20 is not 2 × 8");
        assert!(error.to_string().contains("8 × 16"), "{error}");
    }
}
