//! From [`Model`](crate::model::Model) to the bytes of a glTF file.

pub(crate) mod animation;
pub(crate) mod buffer;
pub(crate) mod compress;
mod container;
pub(crate) mod document;
mod looks;
mod meshes;
mod names;

pub use container::{GltfFiles, Output};
