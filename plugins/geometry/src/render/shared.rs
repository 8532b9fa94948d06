//! What is counted and what is at fault, shared by both worlds.

use std::sync::{Arc, Mutex, PoisonError};

use bevy::prelude::*;
use thiserror::Error;

/// What producers made and hold, two or three frames ago; all producers and views together.
#[derive(Resource, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct GeometryStats {
    /// Vertices emitted.
    pub vertices: u32,
    /// Triangles and segments emitted.
    pub primitives: u32,
    /// Patches and blocks of ground that were looked at.
    pub patches: u32,
    /// Those of them that emit nothing.
    pub discarded: u32,
    /// By how many steps detail was lowered to fit a pool, in the worst case.
    pub lowered: u32,
    /// Primitives that would be emitted without lowering.
    pub wanted_primitives: u32,
    /// Dispatches of the last frame: none for views whose inputs rest.
    pub dispatches: u32,
    /// Vertices and indices that are drawn, bytes.
    pub bytes: u64,
    /// Bytes of all buffers of all views; see [`Self::pools`].
    pub allocated: u64,
    /// Vertices and indices that the CPU made and uploaded in the last frame, bytes.
    pub uploaded: u64,
    /// Each producer in each view.
    #[reflect(ignore)]
    pub pools: Arc<[PoolStats]>,
    /// Producers whose functions cannot be used; they are not drawn until their file is corrected.
    pub faults: Vec<GeometryFault>,
}

/// One producer in one view. Published as `dolomite/geometry/allocated/<kind>/<camera>`, and `primitives` beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PoolStats {
    /// Name of the producer.
    pub kind: &'static str,
    /// The camera; `None` for what all views of the producer share, published as `shared`.
    pub camera: Option<Entity>,
    /// Bytes of buffers, what the producer keeps for the view included.
    pub allocated: u64,
    /// Triangles of the view, as counted some frames ago.
    pub primitives: u32,
}

impl GeometryStats {
    /// Patches and blocks of ground that emit something. The counters of the GPU are some frames older than the number
    /// of patches: while patches go, more may have been discarded than there are.
    #[must_use]
    pub const fn seen(&self) -> u32 {
        self.patches.saturating_sub(self.discarded)
    }
}

/// Why a producer is not drawn.
#[derive(Clone, Debug, PartialEq, Eq, Error, Reflect)]
#[error(
    "the shader of {kind} cannot be used: {reason}; correct its control, evaluate, amplify or material function"
)]
pub struct GeometryFault {
    /// Name of the producer: the type name of a kind.
    pub kind: String,
    /// What the compiler said, with the place.
    pub reason: String,
}

/// The newest counters, shared by both worlds.
#[derive(Resource, Clone, Default)]
pub struct GeometryShared(Arc<Mutex<Shared>>);

#[derive(Default)]
pub(super) struct Shared {
    pub newest: GeometryStats,
    pub dispatches: u32,
    pub uploaded: u64,
}

impl GeometryShared {
    pub(super) fn with<T>(&self, f: impl FnOnce(&mut Shared) -> T) -> T {
        // Plain numbers and texts: a panic elsewhere cannot leave them half-written.
        f(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Adds to this frame's dispatches.
    pub fn count_dispatches(&self, count: u32) {
        self.with(|shared| shared.dispatches += count);
    }

    /// Adds to this frame's uploads.
    pub fn count_upload(&self, bytes: u64) {
        self.with(|shared| shared.uploaded += bytes);
    }

    /// Keeps a fault of a producer.
    pub fn report(&self, kind: &str, reason: String) {
        self.clear(kind);
        let kind = kind.to_owned();
        self.with(|shared| shared.newest.faults.push(GeometryFault { kind, reason }));
    }

    pub(super) fn has_faults(&self) -> bool {
        self.with(|shared| !shared.newest.faults.is_empty())
    }

    /// Forgets the faults of a producer.
    pub fn clear(&self, kind: &str) {
        self.with(|shared| shared.newest.faults.retain(|fault| fault.kind != kind));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_of_patches_that_are_gone_do_no_harm() {
        let stats = |patches, discarded| GeometryStats {
            patches,
            discarded,
            ..Default::default()
        };
        assert_eq!(stats(10, 3).seen(), 7);
        assert_eq!(stats(10, 300).seen(), 0);
    }
}
