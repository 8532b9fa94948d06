//! Makes the terrain's ground textures from integer hashes and a seed: no
//! photograph and no outside data goes in, and the same seed gives the same
//! bytes on every machine and for any number of threads.
//!
//! A layer is painted at twice its size ([`layers`]), flattened and reduced
//! with normals, roughness and occlusion from its height ([`tile`]), and the
//! layers are stacked into two images ([`atlas`]).

pub mod atlas;
pub mod colour;
pub mod error;
pub mod hash;
pub mod layers;
pub mod noise;
pub mod plane;
pub mod preview;
pub mod surface;
pub mod tile;
pub mod wave;

use error::TextureError;
use layers::Layer;
use tile::Fields;

/// Seed of the committed textures.
pub const SEED: u32 = 20_260;

/// Side of the committed textures' layers, texels.
pub const SIZE: usize = 512;

/// Smallest and largest side of a layer.
pub const SIZES: [usize; 2] = [64, 2048];

/// Makes one layer of `size` x `size` texels.
///
/// # Errors
///
/// [`TextureError::Size`] when `size` is not a power of two within [`SIZES`].
pub fn generate(layer: Layer, size: usize, seed: u32) -> Result<Fields, TextureError> {
    if !size.is_power_of_two() || size < SIZES[0] || size > SIZES[1] {
        return Err(TextureError::Size { size });
    }
    let surface = layer.paint(2 * size, seed);
    Ok(tile::finish(&surface, &layer.look()))
}
