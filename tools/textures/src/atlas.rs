//! Stacks layers into images and writes them as PNG.

use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use crate::error::TextureError;
use crate::layers::Layer;
use crate::tile::Tile;

/// File name of the albedo and height of all layers.
pub const ALBEDO_HEIGHT: &str = "terrain_albedo_height.png";
/// File name of the normals, roughness and occlusion of all layers.
pub const NORMAL_ROUGHNESS: &str = "terrain_normal_roughness.png";

/// The two stacked images: `size` texels wide, 5 `size` high, RGBA of 8 bits
/// row by row downwards, the layers in the order of [`Layer::ALL`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Atlas {
    /// Side of a layer, texels.
    pub size: usize,
    /// sRGB albedo; height in alpha.
    pub albedo_height: Vec<u8>,
    /// Normal xy, roughness, occlusion.
    pub normal_roughness: Vec<u8>,
}

impl Atlas {
    /// Stacks finished layers, which must be of one size.
    #[must_use]
    pub fn stack(tiles: &[Tile; Layer::ALL.len()]) -> Self {
        let bytes = |map: fn(&Tile) -> &[[u8; 4]]| {
            tiles
                .iter()
                .flat_map(|t| map(t).as_flattened())
                .copied()
                .collect()
        };
        Self {
            size: tiles[0].size,
            albedo_height: bytes(|t| &t.albedo_height),
            normal_roughness: bytes(|t| &t.normal_roughness),
        }
    }

    /// FNV-1a hash (64 bits) of both images.
    #[must_use]
    pub fn hash(&self) -> u64 {
        let bytes = self.albedo_height.iter().chain(&self.normal_roughness);
        bytes.fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
    }

    /// Writes both images into a folder, which is made if it is missing.
    ///
    /// # Errors
    ///
    /// When the folder or a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), TextureError> {
        std::fs::create_dir_all(folder).map_err(|source| TextureError::Folder {
            path: folder.to_owned(),
            source,
        })?;
        let height = self.size * Layer::ALL.len();
        let sides = [self.size, height];
        write_png(
            &folder.join(ALBEDO_HEIGHT),
            &self.albedo_height,
            sides,
            ExtendedColorType::Rgba8,
        )?;
        write_png(
            &folder.join(NORMAL_ROUGHNESS),
            &self.normal_roughness,
            sides,
            ExtendedColorType::Rgba8,
        )
    }
}

/// Writes 8-bit texels (row by row downwards) of a `[width, height]` image as
/// a PNG, compressed as far as the encoder can.
///
/// # Errors
///
/// When the texels do not fill the image or the file cannot be written.
pub fn write_png(
    path: &Path,
    bytes: &[u8],
    [width, height]: [usize; 2],
    colour: ExtendedColorType,
) -> Result<(), TextureError> {
    let mut png = Vec::new();
    PngEncoder::new_with_quality(&mut png, CompressionType::Best, FilterType::Adaptive)
        .write_image(bytes, width as u32, height as u32, colour)
        .map_err(|source| TextureError::Encode {
            path: path.to_owned(),
            source,
        })?;
    std::fs::write(path, png).map_err(|source| TextureError::Write {
        path: path.to_owned(),
        source,
    })
}
