//! Counters of the stage on their way from the GPU to the main world, and faults of shaders.

use std::sync::{Arc, Mutex, PoisonError};

use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::prelude::*;
use thiserror::Error;

use super::prepare::StageKinds;

/// What the stage does, two or three frames ago; all kinds and views together.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct StageStats {
    /// Vertices emitted.
    pub vertices: u32,
    /// Triangles and segments emitted.
    pub primitives: u32,
    /// Patches that were looked at.
    pub patches: u32,
    /// Those of them that an outer level discarded: they emit nothing.
    pub discarded: u32,
    /// How often levels were lowered by a fifth to fit a pool, in the worst case.
    pub lowered: u32,
    /// Primitives that would be emitted without lowering.
    pub wanted_primitives: u32,
    /// Dispatches of the last frame: 7 for each kind and view whose inputs changed.
    pub dispatches: u32,
    /// Vertices and indices, bytes.
    pub bytes: u64,
    /// Those of them that the CPU made and uploaded in the last frame, bytes.
    pub uploaded: u64,
    /// Kinds whose functions cannot be used; they are not drawn until their file is corrected.
    pub faults: Vec<StageFault>,
}

impl StageStats {
    /// Patches that emit something. The counters of the GPU are some frames older than the number of
    /// patches: while patches go, more may have been discarded than there are.
    #[must_use]
    pub const fn seen(&self) -> u32 {
        self.patches.saturating_sub(self.discarded)
    }
}

/// Why patches of a kind are not drawn.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "the shader of {kind} cannot be used: {reason}; correct its control, evaluate, amplify or material function"
)]
pub struct StageFault {
    /// Type name of the kind.
    pub kind: String,
    /// What the compiler said, with the place.
    pub reason: String,
}

/// The newest counters, shared by both worlds.
#[derive(Resource, Clone, Default)]
pub struct StageShared(Arc<Mutex<Shared>>);

#[derive(Default)]
struct Shared {
    newest: StageStats,
    dispatches: u32,
    uploaded: u64,
}

impl StageShared {
    fn with<T>(&self, f: impl FnOnce(&mut Shared) -> T) -> T {
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

    /// Keeps a fault of a kind.
    pub fn report(&self, kind: &str, reason: String) {
        self.clear(kind);
        let kind = kind.to_owned();
        self.with(|shared| shared.newest.faults.push(StageFault { kind, reason }));
    }

    /// Forgets the faults of a kind.
    pub fn clear(&self, kind: &str) {
        self.with(|shared| shared.newest.faults.retain(|fault| fault.kind != kind));
    }
}

const PATHS: [&str; 5] = [
    "dolomite/stage/vertices",
    "dolomite/stage/primitives",
    "dolomite/stage/dispatches",
    "dolomite/stage/lowered",
    "dolomite/stage/bytes",
];

/// Registers the diagnostics.
pub fn register(app: &mut App) {
    for path in PATHS {
        app.register_diagnostic(Diagnostic::new(DiagnosticPath::const_new(path)));
    }
}

/// Main world: takes the newest counters over and publishes them.
pub fn publish(
    shared: Res<StageShared>,
    mut stats: ResMut<StageStats>,
    mut diagnostics: Diagnostics,
) {
    let newest = shared.with(|shared| shared.newest.clone());
    let values = [
        f64::from(newest.vertices),
        f64::from(newest.primitives),
        f64::from(newest.dispatches),
        f64::from(newest.lowered),
        newest.bytes as f64,
    ];
    stats.set_if_neq(newest);
    for (path, value) in PATHS.into_iter().zip(values) {
        diagnostics.add_measurement(&DiagnosticPath::const_new(path), || value);
    }
}

/// Render world, after the submit: sums the counters of all kinds and views.
pub fn collect(mut kinds: ResMut<StageKinds>, shared: Res<StageShared>) {
    let mut sum = StageStats::default();
    for kind in kinds.0.values_mut() {
        let vertex = kind.traits.vertex_bytes() + if kind.traits.moves { 12 } else { 0 };
        for state in kind.views.values_mut() {
            state.counters.advance();
            let newest = state.counters.newest;
            sum.vertices += newest.vertices;
            sum.primitives += newest.primitives;
            sum.discarded += newest.discarded;
            sum.patches += state.patches();
            sum.lowered = sum.lowered.max(newest.lowered);
            sum.wanted_primitives = sum
                .wanted_primitives
                .saturating_add(newest.wanted_primitives);
            sum.bytes += u64::from(newest.vertices) * vertex + u64::from(newest.indexed[0]) * 4;
        }
    }
    shared.with(|shared| {
        sum.dispatches = std::mem::take(&mut shared.dispatches);
        sum.uploaded = std::mem::take(&mut shared.uploaded);
        sum.faults = std::mem::take(&mut shared.newest.faults);
        shared.newest = sum;
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_of_patches_that_are_gone_do_no_harm() {
        let stats = |patches, discarded| StageStats {
            patches,
            discarded,
            ..Default::default()
        };
        assert_eq!(stats(10, 3).seen(), 7);
        assert_eq!(stats(10, 300).seen(), 0);
    }
}
