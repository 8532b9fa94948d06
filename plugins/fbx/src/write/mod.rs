//! From [`Model`](crate::model::Model) to the bytes of a glTF file.

mod animation;
mod buffer;
mod container;
mod document;
mod looks;
mod meshes;
mod names;

pub use container::{GltfFiles, Output};
