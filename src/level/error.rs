//! Why a level cannot be played.

use std::path::PathBuf;

use dolomite::logic::BehaviourError;
use dolomite::logic::movement::GridError;
use thiserror::Error;

use crate::scene::SceneError;

/// Why a level cannot be played.
#[derive(Debug, Error)]
pub enum LevelError {
    /// No level of this name.
    #[error("there is no level `{name}`: those that can be played are {}", .there.join(", "))]
    NotThere {
        /// What was asked for.
        name: String,
        /// What there is.
        there: Vec<&'static str>,
    },
    /// Its file cannot be read.
    #[error("level file {}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Its file is not RON, or has a field that is none of ours.
    #[error("level file {}:{source}; assets/levels/mountain.ron and city.ron explain every field", .path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// Line, column and reason.
        source: Box<ron::error::SpannedError>,
    },
    /// A value in it makes no sense.
    #[error("level file {}:{line}: {reason}", .path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// From 1 on.
        line: usize,
        /// The value, and what it has to be.
        reason: String,
    },
    /// What its soldiers do was refused.
    #[error(transparent)]
    Behaviour(#[from] BehaviourError),
    /// Its scene was refused.
    #[error(transparent)]
    Scene(#[from] Box<SceneError>),
    /// Its area is none.
    #[error("the area of the level: {0}")]
    Area(#[from] GridError),
}

impl From<SceneError> for LevelError {
    fn from(error: SceneError) -> Self {
        Self::Scene(Box::new(error))
    }
}
