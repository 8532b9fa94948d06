//! glTF files: skeleton, skins, clips and skinned meshes, without Bevy's assets.
//!
//! The skeleton has the joints of all skins, every node that a clip moves, and all nodes above them, so
//! that its model frame is the file's scene: metres, +Y up, the figure looks along +Z.
//!
//! Every range of every buffer is looked at before it is read; a broken file is refused by a
//! [`LoadError`], never by a panic.

mod accessor;
mod animation;
mod mesh;
mod nodes;
mod uri;
mod words;

pub use mesh::SkinnedMesh;

use crate::clip::{Clip, ClipData, ClipError};
use crate::skeleton::{Skeleton, SkeletonError};
use bevy::math::Affine3A;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The joints that a mesh hangs on.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    /// Its name; may be empty.
    pub name: String,
    /// For each of the mesh's joint numbers, the joint of the skeleton.
    pub joints: Vec<usize>,
    /// For each of them, from the mesh's frame to the joint's at rest.
    pub inverse_binds: Vec<Affine3A>,
}

/// What a file holds of a figure.
#[derive(Clone, Debug)]
pub struct Rig {
    /// Joints.
    pub skeleton: Skeleton,
    /// For each node of the file its joint, if it is one.
    pub joint_of_node: Vec<Option<usize>>,
    /// Skins, in the file's order.
    pub skins: Vec<Skin>,
    /// Clips, in the file's order, ready to be sampled.
    pub clips: Vec<Clip>,
    /// The same clips as the file has them: what [`oracle`](crate::clip::oracle) works on.
    pub sources: Vec<ClipData>,
    /// Meshes with a skin, one for each primitive.
    pub meshes: Vec<SkinnedMesh>,
}

/// Why a file is not a rig.
#[derive(Debug, Error)]
pub enum LoadError {
    /// The file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Not glTF 2.0.
    #[error("not a glTF 2.0 file: {0}")]
    Format(#[from] gltf::Error),
    /// A word that glTF does not have, or the number of something that is not there.
    #[error(
        "{0}: what stands there is no word of glTF 2.0, or names something that the file has not"
    )]
    Word(String),
    /// A buffer is missing.
    #[error("buffer {buffer} ({uri}): {reason}; put it beside the file, or convert to .glb")]
    Buffer {
        /// Its number in the file.
        buffer: usize,
        /// Where it should be.
        uri: String,
        /// Why it is not there.
        reason: String,
    },
    /// Numbers are not what the place needs.
    #[error("accessor {accessor} ({of}): {reason}")]
    Accessor {
        /// Its number in the file.
        accessor: usize,
        /// What it is for.
        of: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// A node hangs from itself, or from two others.
    #[error("node {0} is not part of a tree: it hangs from itself or from two nodes")]
    NotATree(usize),
    /// A skin is wrong.
    #[error("skin {skin}: {reason}")]
    Skin {
        /// Its number in the file.
        skin: usize,
        /// What is wrong.
        reason: String,
    },
    /// A mesh is wrong.
    #[error("mesh {mesh}, primitive {primitive}: {reason}")]
    Mesh {
        /// Its number in the file.
        mesh: usize,
        /// Its primitive.
        primitive: usize,
        /// What is wrong.
        reason: String,
    },
    /// No skin and no clip.
    #[error("the file has neither a skin nor an animation")]
    NothingToMove,
    /// The joints are not a skeleton.
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
    /// A clip is refused.
    #[error(transparent)]
    Clip(#[from] ClipError),
}

impl Rig {
    /// Reads a `.glb` or `.gltf` file; its buffers may lie in it or below its own folder.
    ///
    /// # Errors
    /// [`LoadError`].
    pub fn read(path: &Path) -> Result<Self, LoadError> {
        let bytes = std::fs::read(path).map_err(|source| LoadError::Read {
            path: path.to_owned(),
            source,
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::from_bytes(&bytes, |uri| std::fs::read(folder.join(uri)))
    }

    /// Reads a file that is in memory. `buffer` finds a buffer that lies elsewhere by its path below the
    /// file's own folder; what leads out of it is refused before.
    ///
    /// # Errors
    /// [`LoadError`].
    pub fn from_bytes(
        bytes: &[u8],
        buffer: impl FnMut(&str) -> std::io::Result<Vec<u8>>,
    ) -> Result<Self, LoadError> {
        let gltf::Gltf { document, blob } = gltf::Gltf::from_slice_without_validation(bytes)?;
        words::check(document.as_json())?;
        let buffers = uri::buffers(&document, blob, buffer)?;
        let nodes::Nodes {
            skeleton,
            joint_of_node,
        } = nodes::read(&document)?;
        let mut skins = Vec::new();
        for skin in document.skins() {
            skins.push(nodes::skin(&skin, &joint_of_node, &buffers)?);
        }
        let mut sources = Vec::new();
        let mut clips = Vec::new();
        for animation in document.animations() {
            let data = animation::read(&animation, &joint_of_node, &buffers)?;
            clips.push(Clip::new(&skeleton, &data)?);
            sources.push(data);
        }
        let meshes = mesh::read_all(&document, &skins, &buffers)?;
        Ok(Self {
            skeleton,
            joint_of_node,
            skins,
            clips,
            sources,
            meshes,
        })
    }

    /// The clip of that name.
    #[must_use]
    pub fn clip(&self, name: &str) -> Option<&Clip> {
        self.clips.iter().find(|clip| clip.name() == name)
    }
}
