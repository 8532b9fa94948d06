//! What was drawn of the maps of still lights, for tests and panels.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use bevy::prelude::*;

/// Faces of still lights in the last frame. Both worlds share it.
#[derive(Resource, Clone, Debug, Default)]
pub struct StillStats(Arc<[AtomicU32; 2]>);

impl StillStats {
    /// Drawn.
    #[must_use]
    pub fn drawn(&self) -> u32 {
        self.0[0].load(Ordering::Relaxed)
    }

    /// Left as they were.
    #[must_use]
    pub fn kept(&self) -> u32 {
        self.0[1].load(Ordering::Relaxed)
    }

    pub(super) fn set(&self, drawn: u32, kept: u32) {
        self.0[0].store(drawn, Ordering::Relaxed);
        self.0[1].store(kept, Ordering::Relaxed);
    }
}
