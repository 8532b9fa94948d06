//! Reads the ground's texture arrays, so that a wrong file is an error and not a grey mountain.

use std::path::{Path, PathBuf};

use bevy::asset::RenderAssetUsages;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use dolomite::ground::render::texture::{LAYERS, TextureArrayError, texture_array};
use thiserror::Error;

/// Why a texture array was refused.
#[derive(Debug, Error)]
pub enum TextureError {
    /// The file is missing or no PNG.
    #[error(
        "texture {}: {source}; run from a whole checkout, or make the textures again \
         (`cargo run --release -p dolomite_textures`)",
        .path.display()
    )]
    Read {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        source: image::ImageError,
    },
    /// The picture is no stack of squares.
    #[error("texture {}: {source}", .path.display())]
    Shape {
        /// The file.
        path: PathBuf,
        /// What it should be.
        source: TextureArrayError,
    },
}

/// What the four channels of a texture hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// sRGB colour, and a plain fourth channel.
    Colour,
    /// Four plain channels.
    Data,
}

/// Reads both texture arrays of the ground from their folder: colour and height; normal, roughness and
/// occlusion.
///
/// # Errors
/// [`TextureError`], naming the file.
pub fn read_ground(folder: &Path) -> Result<[Image; 2], TextureError> {
    Ok([
        read_array(&folder.join("terrain_albedo_height.png"), Content::Colour)?,
        read_array(&folder.join("terrain_normal_roughness.png"), Content::Data)?,
    ])
}

/// Reads a stack of [`LAYERS`] squares (sand, grass, rock, snow, scree) as a 2D array with all
/// mips, repeated at its borders.
///
/// # Errors
/// [`TextureError`], naming the file.
pub fn read_array(path: &Path, content: Content) -> Result<Image, TextureError> {
    let picture = image::ImageReader::open(path)
        .map_err(image::ImageError::from)
        .and_then(image::ImageReader::decode)
        .map_err(|source| TextureError::Read {
            path: path.to_owned(),
            source,
        })?
        .into_rgba8();
    let (width, height) = picture.dimensions();
    let stacked = Image::new(
        Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        picture.into_raw(),
        TextureFormat::Rgba8Unorm,
        RenderAssetUsages::all(),
    );
    texture_array(&stacked, LAYERS, content == Content::Colour).map_err(|source| {
        TextureError::Shape {
            path: path.to_owned(),
            source,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_file_is_an_error_that_names_it() {
        let missing = read_array(Path::new("no/such.png"), Content::Data).unwrap_err();
        assert!(missing.to_string().contains("no/such.png"));
        let path = std::env::temp_dir().join(format!("dolomite-{}.png", std::process::id()));
        image::RgbaImage::new(8, 8).save(&path).unwrap();
        let wrong = read_array(&path, Content::Data).unwrap_err().to_string();
        std::fs::remove_file(&path).unwrap();
        assert!(
            wrong.contains("8 × 8") && wrong.contains("8 × 40"),
            "{wrong}"
        );
    }

    #[test]
    fn colour_is_srgb_and_data_is_not() {
        let path = std::env::temp_dir().join(format!("dolomite-stack-{}.png", std::process::id()));
        image::RgbaImage::new(8, 8 * LAYERS).save(&path).unwrap();
        let colour = read_array(&path, Content::Colour).unwrap();
        let data = read_array(&path, Content::Data).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert_eq!(
            colour.texture_descriptor.format,
            TextureFormat::Rgba8UnormSrgb
        );
        assert_eq!(data.texture_descriptor.format, TextureFormat::Rgba8Unorm);
        assert_eq!(data.texture_descriptor.size.depth_or_array_layers, LAYERS);
    }
}
