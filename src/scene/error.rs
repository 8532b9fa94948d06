//! Why a scene could not be loaded.

use std::path::PathBuf;

use dolomite::terrain::{EditError, EditFileError, HeightMapError, TerrainError};
use dolomite::vegetation::KindError;
use thiserror::Error;

/// Why a scene could not be loaded.
#[derive(Debug, Error)]
pub enum SceneError {
    /// Neither a name nor a file.
    #[error(
        "scene `{scene}`: neither a scene ({}), nor a scene file (.ron), nor a height map \
         (.png, .tif, .asc, .hgt, .raw, .r16, .r32, .f32)",
        .names.join(", ")
    )]
    Unknown {
        /// What was asked for.
        scene: String,
        /// The scenes that have a name.
        names: Vec<&'static str>,
    },
    /// The scene file cannot be read.
    #[error("scene file {}: {source}; check the name", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The scene file is not RON, or has a field that is none of ours.
    #[error(
        "scene file {}, {source}; assets/scenes/mountain.ron explains every field",
        .path.display()
    )]
    Parse {
        /// The file.
        path: PathBuf,
        /// Line, column and reason.
        source: Box<ron::error::SpannedError>,
    },
    /// A value of the scene file makes no sense.
    #[error("scene file {}: {reason}", .path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The value, why it was refused, what to write.
        reason: String,
    },
    /// Lamps were asked for in a scene that has none, or more of them than can be drawn.
    #[error("scene `{scene}`, `--lights`: {reason}")]
    Lamps {
        /// The scene.
        scene: String,
        /// Why, and what to do.
        reason: String,
    },
    /// What was edited of its ground cannot be read.
    #[error(transparent)]
    Edits(#[from] EditFileError),
    /// Its ground cannot be edited, and was.
    #[error(transparent)]
    Edited(#[from] EditError),
    /// A file of kinds was refused.
    #[error(transparent)]
    Kinds(#[from] KindError),
    /// A height map was refused.
    #[error("{}{source}", .scene.as_ref().map_or(String::new(), |path| format!("scene file {}: ", path.display())))]
    Map {
        /// The scene file that names the map, if one does.
        scene: Option<PathBuf>,
        /// The map's file, the reason, and what to do.
        source: Box<HeightMapError>,
    },
    /// A [`NamedScene`](super::NamedScene) was refused.
    #[error(transparent)]
    Named(#[from] Box<dyn std::error::Error + Send + Sync>),
    /// The layers make no ground.
    #[error("scene file {}: {source}", .path.display())]
    Terrain {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: Box<TerrainError>,
    },
}
