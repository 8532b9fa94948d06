//! What comes of a file.

use crate::model::{Mesh, Model};
use crate::report::Report;
use std::collections::BTreeMap;

/// A converted file: what becomes glTF, and what to say of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Conversion {
    /// Nodes, meshes, clips.
    pub model: Model,
    /// What was made, how exact it is and what is lost.
    pub report: Report,
}

impl Conversion {
    /// For each mesh, which FBX mesh and which of its vertices each vertex came from, over all parts;
    /// for [`check::vertex_error`](crate::check::vertex_error).
    pub fn sources(&self) -> BTreeMap<usize, (u32, Vec<u32>)> {
        let of = |mesh: &Mesh| {
            let sources = mesh
                .parts
                .iter()
                .flat_map(|part| part.sources.iter().copied());
            (mesh.source, sources.collect())
        };
        self.model.meshes.iter().map(of).enumerate().collect()
    }
}
