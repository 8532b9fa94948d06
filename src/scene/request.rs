//! What the player asked for.

use bevy::prelude::*;
use dolomite::terrain::elevation::Options;

use super::NamedScene;

/// What the player asked for.
#[derive(Resource, Clone)]
pub struct SceneRequest {
    /// A name of [`BUILT_IN`](super::BUILT_IN) or of `named`, a scene file (`.ron`), or a height map.
    pub scene: String,
    /// How to read it where it is a height map.
    pub map: MapOptions,
    /// Amplitude of the detail below the sample spacing, metres; `None`: the scene's own.
    pub detail: Option<f32>,
    /// Number of lamps, in scenes that have some; `None`: the scene's own.
    pub lights: Option<u32>,
    /// Scenes that have names besides those of [`BUILT_IN`](super::BUILT_IN).
    pub named: Vec<NamedScene>,
}

impl SceneRequest {
    /// Asks for a scene by its name or file, with everything else as it is by itself.
    pub fn new(scene: impl Into<String>) -> Self {
        Self {
            scene: scene.into(),
            map: MapOptions::default(),
            detail: None,
            lights: None,
            named: Vec::new(),
        }
    }
}

/// How a height map that is named on the command line is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapOptions {
    /// Metres between samples; `None`: what the file tells, else 30.
    pub spacing: Option<f64>,
    /// How the file is read.
    pub read: Options,
    /// Level of the sea where there is no data, metres; `None`: filled from the border.
    pub sea: Option<f32>,
    /// Metres for one unit of a sample; `None`: 1, and 0.1 for PNG of 16 bits, so that the 65 535 steps of
    /// a sample span the heights of the Earth.
    pub scale: Option<f32>,
    /// Metres added to the scaled sample.
    pub offset: f32,
    /// Most bytes that its heights take in memory, and as many on a GPU: a map that would take more is read by tiles. See
    /// `HeightMapFile::budget` of `dolomite_terrain`.
    pub budget: Option<u64>,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            spacing: None,
            read: Options::default(),
            sea: None,
            scale: None,
            offset: 0.0,
            budget: None,
        }
    }
}
