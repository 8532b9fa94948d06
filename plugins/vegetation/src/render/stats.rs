//! What is counted, shared by both worlds.

use std::sync::{Arc, Mutex, PoisonError};

use bevy::prelude::*;

use super::layout::LISTS;

/// What the views of an app draw, two or three frames ago; of the view of the most records.
#[derive(Resource, Clone, Default)]
pub struct VegetationStats(Arc<Mutex<VegetationCount>>);

/// Numbers of [`VegetationStats`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VegetationCount {
    /// Dispatches since the app began.
    pub dispatches: u64,
    /// Passes in which plants were drawn, since the app began.
    pub draws: u64,
    /// Plants of each list: blades of three levels of detail, flowers of two, chains of three.
    pub records: [u32; LISTS],
    /// Candidates that were looked at.
    pub looked: u32,
    /// Those that stand within the rings, whether they are drawn or not.
    pub standing: u32,
    /// Share of the ranks that is drawn: less than 1 where the pool is too small.
    pub cut: f32,
    /// Plants that a pool without end would hold.
    pub wanted: u32,
    /// Triangles with tiles.
    pub pieces: u32,
    /// Bytes of all buffers of all views.
    pub bytes: u64,
    /// Views that hold buffers.
    pub views: u32,
    /// Pipelines.
    pub pipelines: u32,
}

impl VegetationStats {
    /// The newest.
    #[must_use]
    pub fn get(&self) -> VegetationCount {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn change(&self, change: impl FnOnce(&mut VegetationCount)) {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }
}
