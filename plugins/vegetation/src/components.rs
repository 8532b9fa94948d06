//! What an app spawns: what grows on a terrain, and which cameras see it.

use std::sync::Arc;

use bevy::prelude::*;

use crate::kind::Kinds;
use crate::kind_error::KindError;

/// What grows on the terrain of the same entity.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(VegetationState)]
pub struct Vegetation {
    /// What grows. A list that cannot be drawn is named in [`VegetationState::fault`]; the last good one holds on.
    #[reflect(ignore)]
    pub kinds: Arc<Kinds>,
    /// Share of all densities, 0 to 1: at 0 nothing is computed. Of all roots those of the lowest ranks are kept.
    pub density: f32,
    /// Share of how far away each kind is drawn, 0 to 4.
    pub reach: f32,
    /// Seed of all random choices.
    pub seed: u32,
    /// Most trees and rocks at once, which are entities: those of the lowest ranks stand.
    pub most_meshes: usize,
}

impl Default for Vegetation {
    /// Nothing.
    fn default() -> Self {
        Self {
            kinds: Arc::default(),
            density: 1.0,
            reach: 1.0,
            seed: 1,
            most_meshes: 4000,
        }
    }
}

/// On a camera that sees what grows.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct VegetationView;

/// On a camera with a [`VegetationView`]: the rank of what grows is found in each pixel, into a texture of its own. Of the
/// candidates of a kind those of the lowest ranks stand where it grows thinly, and are drawn far away.
///
/// While a camera has it, what grows in its view is drawn once more: 8 bytes a pixel. Without one there is no pass, no
/// pipeline, no texture and no buffer. Trees and rocks, which are entities, are not in it.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct VegetationRanks;

/// What the plugin knows of a [`Vegetation`].
#[derive(Component, Debug, Default)]
pub struct VegetationState {
    /// The last list of kinds that could be drawn, with where each grows.
    pub kinds: Option<Arc<Kinds>>,
    /// Why the list of the component is not used, if it is not.
    pub fault: Option<KindError>,
}
