//! Counters on their way from all producers to the main world and its diagnostics.

use std::sync::Arc;

use bevy::diagnostic::{
    Diagnostic, DiagnosticMeasurement, DiagnosticPath, DiagnosticsStore, RegisterDiagnostic,
};
use bevy::platform::time::Instant;
use bevy::prelude::*;

use super::extract::ExtractedGeometryCamera;
use super::producer::Producers;
use super::shared::{GeometryShared, GeometryStats, PoolStats};
use crate::GeometryCamera;
use crate::layout::PREVIOUS_BYTES;

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

/// Where what is counted of a producer in a view is published.
fn pool_path(pool: &PoolStats, what: &str) -> DiagnosticPath {
    let kind = pool.kind.rsplit("::").next().unwrap_or(pool.kind);
    let whose = pool
        .camera
        .map_or_else(|| "shared".to_owned(), |camera| camera.to_string());
    DiagnosticPath::new(format!("dolomite/geometry/{what}/{kind}/{whose}"))
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
    // A measurement a change, not one a frame: buffers are seldom made, and a view at rest has the same triangles.
    if newest.pools != stats.pools {
        let same = |a: &PoolStats, b: &PoolStats| (a.kind, a.camera) == (b.kind, b.camera);
        let is_gone = |old: &&PoolStats| !newest.pools.iter().any(|new| same(new, old));
        let gone = stats.pools.iter().filter(is_gone).map(|pool| PoolStats {
            allocated: 0,
            primitives: 0,
            ..*pool
        });
        for pool in newest.pools.iter().copied().chain(gone) {
            publish_of_view(&mut store, &pool, "allocated", time, pool.allocated as f64);
            // What all views share draws nothing.
            if pool.camera.is_some() {
                let primitives = f64::from(pool.primitives);
                publish_of_view(&mut store, &pool, "primitives", time, primitives);
            }
        }
    }
    stats.set_if_neq(newest);
}

fn publish_of_view(
    store: &mut DiagnosticsStore,
    pool: &PoolStats,
    what: &str,
    time: Instant,
    value: f64,
) {
    let path = pool_path(pool, what);
    if store.get(&path).is_none() {
        store.add(Diagnostic::new(path.clone()).with_max_history_length(1));
    }
    measure(store, &path, time, value);
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
                primitives: 0,
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
                    primitives: newest.primitives,
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
    fn a_view_has_a_path_of_its_own() {
        let pool = PoolStats {
            kind: "some::module::Kind",
            camera: Entity::from_raw_u32(7),
            allocated: 1,
            primitives: 0,
        };
        let path = pool_path(&pool, "allocated").to_string();
        assert!(
            path.starts_with("dolomite/geometry/allocated/Kind/7"),
            "{path}"
        );
    }
}
