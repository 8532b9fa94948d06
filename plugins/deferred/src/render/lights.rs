//! What lights the world, on the CPU and on the GPU.

use std::collections::HashSet;

use bevy::camera::visibility::RenderLayers;
use bevy::prelude::*;
use bevy::render::render_resource::Buffer;

use crate::choice::Suns;
use crate::light::{LightRefusal, LightRow};

/// All lights of the world.
#[derive(Resource, Default)]
pub struct Lights {
    /// By Bevy's index.
    pub rows: Vec<LightRow>,
    /// Layers of those that are not on the default one alone.
    pub layers: bevy::platform::collections::HashMap<u32, RenderLayers>,
    /// `rows` on the GPU; `None` while there are none.
    pub buffer: Option<Buffer>,
    /// What the buffer holds.
    pub(super) uploaded: Vec<LightRow>,
    /// Refusals that were told.
    pub(super) told: HashSet<LightRefusal>,
    /// How many lights are refused.
    pub refused: u32,
    /// Directional lights.
    pub suns: Suns,
}
