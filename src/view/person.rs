//! Persons from FBX files: joints and clips from the .glb that [`FbxPlugin`](dolomite::fbx::FbxPlugin) made of a file,
//! meshes from the scene of the same file, and what its clips mean from a RON file beside it.
//!
//! A file is loaded beside the game, as any asset of Bevy's is. Who waits for one asks [`Loading::poll`] each frame.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy::asset::LoadState;
use bevy::prelude::*;
use bevy::world_serialization::WorldAsset;
use dolomite::character::gait::{GaitData, GaitError};
use dolomite::character::{Figure, LoadError, Rig};
use dolomite::fbx::FbxConversion;
use thiserror::Error;

/// Where a person lies, below the assets folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PersonFiles {
    /// Model and clips.
    pub model: &'static str,
    /// What the clips mean.
    pub gaits: &'static str,
}

/// Why a person is not there.
#[derive(Debug, Error)]
pub enum PersonError {
    /// The model was not loaded.
    #[error("{model}: {reason}")]
    Model {
        /// The file.
        model: &'static str,
        /// What the loader said.
        reason: String,
    },
    /// It has no figure in it.
    #[error(
        "{model}: {source}; it needs a skin and clips: assets/hero/README.md says how one is made"
    )]
    Rig {
        /// The file.
        model: &'static str,
        /// What is wrong.
        source: LoadError,
    },
    /// The meaning of its clips cannot be read.
    #[error("{}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Its clips are not those that are spoken of.
    #[error("{}: {source}", .path.display())]
    Gaits {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: GaitError,
    },
}

/// A person who is there.
#[derive(Clone, Debug)]
pub struct Person {
    /// Joints and clips.
    pub figure: Arc<Figure>,
    /// Meshes.
    pub scene: Option<Handle<WorldAsset>>,
}

/// A person who is being loaded.
#[derive(Clone, Debug)]
pub struct Loading {
    files: PersonFiles,
    gltf: Handle<Gltf>,
    made: Handle<FbxConversion>,
}

impl Loading {
    /// Begins.
    #[must_use]
    pub fn new(files: PersonFiles, assets: &AssetServer) -> Self {
        Self {
            files,
            gltf: assets.load(files.model),
            made: assets.load(format!("{}#{}", files.model, FbxConversion::LABEL)),
        }
    }

    /// The person, or why there is none; nothing while it is being loaded. With textures and meshes: it appears whole.
    pub fn poll(
        &self,
        assets: &AssetServer,
        gltfs: &Assets<Gltf>,
        conversions: &Assets<FbxConversion>,
        folder: &Path,
    ) -> Option<Result<Person, PersonError>> {
        let states = (assets.load_state(&self.gltf), assets.load_state(&self.made));
        if let (LoadState::Failed(error), _) | (_, LoadState::Failed(error)) = states {
            return Some(Err(PersonError::Model {
                model: self.files.model,
                reason: error.to_string(),
            }));
        }
        if !assets.is_loaded_with_dependencies(&self.gltf) {
            return None;
        }
        let (gltf, made) = (gltfs.get(&self.gltf)?, conversions.get(&self.made)?);
        let figure = figure(&made.glb, self.files, folder);
        Some(figure.map(|figure| Person {
            figure: Arc::new(figure),
            scene: gltf.scenes.first().cloned(),
        }))
    }
}

/// Joints and clips of a .glb, with the meaning that the file in `assets` gives them.
fn figure(glb: &[u8], files: PersonFiles, assets: &Path) -> Result<Figure, PersonError> {
    let rig =
        Rig::from_bytes(glb, |_| Err(std::io::ErrorKind::NotFound.into())).map_err(|source| {
            PersonError::Rig {
                model: files.model,
                source,
            }
        })?;
    let path = assets.join(files.gaits);
    let text = std::fs::read_to_string(&path).map_err(|source| PersonError::Read {
        path: path.clone(),
        source,
    })?;
    GaitData::from_ron(&text)
        .and_then(|gaits| Figure::new(rig, &gaits))
        .map_err(|source| PersonError::Gaits { path, source })
}
