//! What can go wrong.

use std::path::PathBuf;

/// Errors of the texture maker.
#[derive(Debug, thiserror::Error)]
pub enum TextureError {
    /// The side of a layer is not one the maker supports.
    #[error(
        "a layer of {size} texels a side: must be a power of two from {} to {}",
        crate::SIZES[0],
        crate::SIZES[1]
    )]
    Size {
        /// The side that was asked for, texels.
        size: usize,
    },
    /// A folder could not be made.
    #[error("cannot make the folder {path}")]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file could not be written.
    #[error("cannot write {path}")]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// An image could not be encoded.
    #[error("cannot encode {path}")]
    Encode {
        /// The file it was for.
        path: PathBuf,
        /// Why.
        source: image::ImageError,
    },
}
