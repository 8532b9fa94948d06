//! Counters on their way from the GPU to the main world, bytes, and faults of shaders.

use std::sync::{Arc, Mutex, PoisonError};

use bevy::diagnostic::{
    Diagnostic, DiagnosticMeasurement, DiagnosticPath, DiagnosticsStore, RegisterDiagnostic,
};
use bevy::platform::time::Instant;
use bevy::prelude::*;
use thiserror::Error;

use super::extract::ExtractedGeometryCamera;
use super::producer::Producers;
use crate::GeometryCamera;
use crate::layout::PREVIOUS_BYTES;

/// What producers made and hold, two or three frames ago; all producers and views together.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct GeometryStats {
    /// Vertices emitted.
    pub vertices: u32,
    /// Triangles and segments emitted.
    pub primitives: u32,
    /// Patches and cells that were looked at.
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
    pub pools: Arc<[PoolStats]>,
    /// Producers whose functions cannot be used; they are not drawn until their file is corrected.
    pub faults: Vec<GeometryFault>,
}

/// One producer in one view. Published as `dolomite/geometry/allocated/<kind>/<camera>`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PoolStats {
    /// Name of the producer.
    pub kind: &'static str,
    /// The camera; `None` for what all views of the producer share, published as `shared`.
    pub camera: Option<Entity>,
    /// Bytes of buffers, what the producer keeps for the view included.
    pub allocated: u64,
}

impl GeometryStats {
    /// Patches and cells that emit something. The counters of the GPU are some frames older than the number
    /// of patches: while patches go, more may have been discarded than there are.
    #[must_use]
    pub const fn seen(&self) -> u32 {
        self.patches.saturating_sub(self.discarded)
    }
}

/// Why a producer is not drawn.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
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
struct Shared {
    newest: GeometryStats,
    dispatches: u32,
    uploaded: u64,
}

impl GeometryShared {
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

    /// Keeps a fault of a producer.
    pub fn report(&self, kind: &str, reason: String) {
        self.clear(kind);
        let kind = kind.to_owned();
        self.with(|shared| shared.newest.faults.push(GeometryFault { kind, reason }));
    }

    fn has_faults(&self) -> bool {
        self.with(|shared| !shared.newest.faults.is_empty())
    }

    /// Forgets the faults of a producer.
    pub fn clear(&self, kind: &str) {
        self.with(|shared| shared.newest.faults.retain(|fault| fault.kind != kind));
    }
}

const PATHS: [&str; 6] = [
    "dolomite/geometry/vertices",
    "dolomite/geometry/primitives",
    "dolomite/geometry/dispatches",
    "dolomite/geometry/lowered",
    "dolomite/geometry/bytes",
    "dolomite/geometry/allocated",
];

/// Registers the diagnostics.
pub(super) fn register(app: &mut App) {
    for path in PATHS {
        app.register_diagnostic(Diagnostic::new(DiagnosticPath::const_new(path)));
    }
}

/// Where the bytes of a producer in a view are published.
fn pool_path(pool: &PoolStats) -> DiagnosticPath {
    let kind = pool.kind.rsplit("::").next().unwrap_or(pool.kind);
    let whose = pool
        .camera
        .map_or_else(|| "shared".to_owned(), |camera| camera.to_string());
    DiagnosticPath::new(format!("dolomite/geometry/allocated/{kind}/{whose}"))
}

/// Main world: whether there are counters, or were some until now, which have to become 0.
pub(super) fn are_counted(
    cameras: Query<(), With<GeometryCamera>>,
    stats: Res<GeometryStats>,
    shared: Res<GeometryShared>,
) -> bool {
    let rests = stats.pools.is_empty() && stats.faults.is_empty();
    let idle = stats.dispatches == 0 && stats.uploaded == 0;
    !cameras.is_empty() || !rests || !idle || shared.has_faults()
}

/// Main world: takes the newest counters over and publishes them.
pub(super) fn publish(
    shared: Res<GeometryShared>,
    mut stats: ResMut<GeometryStats>,
    mut store: ResMut<DiagnosticsStore>,
) {
    let newest = shared.with(|shared| shared.newest.clone());
    let values = [
        f64::from(newest.vertices),
        f64::from(newest.primitives),
        f64::from(newest.dispatches),
        f64::from(newest.lowered),
        newest.bytes as f64,
        newest.allocated as f64,
    ];
    let time = Instant::now();
    for (path, value) in PATHS.into_iter().zip(values) {
        measure(&mut store, &DiagnosticPath::const_new(path), time, value);
    }
    // Buffers are seldom made: a measurement a change, not one a frame.
    if newest.pools != stats.pools {
        let is_gone = |old: &&PoolStats| {
            let same = |new: &PoolStats| (new.kind, new.camera) == (old.kind, old.camera);
            !newest.pools.iter().any(same)
        };
        let gone = stats.pools.iter().filter(is_gone).map(|pool| (pool, 0));
        let there = newest.pools.iter().map(|pool| (pool, pool.allocated));
        for (pool, bytes) in there.chain(gone) {
            let path = pool_path(pool);
            if store.get(&path).is_none() {
                store.add(Diagnostic::new(path.clone()).with_max_history_length(1));
            }
            measure(&mut store, &path, time, bytes as f64);
        }
    }
    stats.set_if_neq(newest);
}

fn measure(store: &mut DiagnosticsStore, path: &DiagnosticPath, time: Instant, value: f64) {
    let diagnostic = store.get_mut(path).filter(|found| found.is_enabled);
    if let Some(diagnostic) = diagnostic {
        diagnostic.add_measurement(DiagnosticMeasurement { time, value });
    }
}

/// Render world, after the submit: sums the counters of all producers and views.
pub(super) fn collect(
    mut producers: ResMut<Producers>,
    cameras: Query<&ExtractedGeometryCamera>,
    shared: Res<GeometryShared>,
    mut pools: Local<Vec<PoolStats>>,
) {
    let mut sum = GeometryStats::default();
    pools.clear();
    for producer in producers.iter_mut() {
        if producer.shared_bytes > 0 {
            sum.allocated += producer.shared_bytes;
            pools.push(PoolStats {
                kind: producer.name,
                camera: None,
                allocated: producer.shared_bytes,
            });
        }
        let moves = producer.traits.moves;
        let vertex = producer.traits.vertex_bytes() + if moves { PREVIOUS_BYTES } else { 0 };
        for (view, state) in &mut producer.views {
            state.counters.advance();
            let newest = state.counters.newest;
            let used = u64::from(newest.vertices) * vertex + u64::from(newest.indexed[0]) * 4;
            let allocated = state.bytes();
            sum.vertices += newest.vertices;
            sum.primitives += newest.primitives;
            sum.discarded += newest.discarded;
            sum.patches += state.looked_at;
            sum.lowered = sum.lowered.max(newest.lowered);
            sum.wanted_primitives = sum
                .wanted_primitives
                .saturating_add(newest.wanted_primitives);
            sum.bytes += used;
            sum.allocated += allocated;
            if let Ok(camera) = cameras.get(*view) {
                pools.push(PoolStats {
                    kind: producer.name,
                    camera: Some(camera.main),
                    allocated,
                });
            }
        }
    }
    // Views of a producer have no order of their own.
    pools.sort_by_key(|pool| (pool.kind, pool.camera));
    shared.with(|shared| {
        sum.dispatches = std::mem::take(&mut shared.dispatches);
        sum.uploaded = std::mem::take(&mut shared.uploaded);
        sum.faults = std::mem::take(&mut shared.newest.faults);
        sum.pools = if *shared.newest.pools == **pools {
            shared.newest.pools.clone()
        } else {
            Arc::from(pools.as_slice())
        };
        shared.newest = sum;
    });
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

    #[test]
    fn a_view_has_a_path_of_its_own() {
        let pool = PoolStats {
            kind: "some::module::Kind",
            camera: Entity::from_raw_u32(7),
            allocated: 1,
        };
        let path = pool_path(&pool).to_string();
        assert!(
            path.starts_with("dolomite/geometry/allocated/Kind/7"),
            "{path}"
        );
    }
}
