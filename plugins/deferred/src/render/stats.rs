//! What was drawn, for tests, benches and panels; published as `dolomite/deferred/<name>`.

use std::sync::{Arc, Mutex, PoisonError};

use bevy::diagnostic::{Diagnostic, DiagnosticPath, DiagnosticsStore};
use bevy::prelude::*;

use crate::choice::Chosen;

/// The views that were lit in the last frame. Both worlds share it.
#[derive(Resource, Clone, Debug, Default)]
pub struct DeferredStats(Arc<Mutex<Vec<ViewStats>>>);

/// One view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ViewStats {
    /// The camera.
    pub camera: Entity,
    /// The way it was lit by.
    pub chosen: Chosen,
    /// Point and spot lights in view.
    pub lights: u32,
    /// Lights of the world that were refused.
    pub refused: u32,
    /// Passes that were recorded.
    pub passes: u32,
    /// Bytes of buffers and textures of ours, the rows of all lights included.
    pub bytes: u64,
}

impl DeferredStats {
    /// The views of the last frame.
    #[must_use]
    pub fn views(&self) -> Vec<ViewStats> {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// Forgets the last frame.
    pub(super) fn clear(&self) {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clear();
    }

    /// Adds a view.
    pub(super) fn push(&self, view: ViewStats) {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(view);
    }
}

const LIGHTS: DiagnosticPath = DiagnosticPath::const_new("dolomite/deferred/lights");
const PASSES: DiagnosticPath = DiagnosticPath::const_new("dolomite/deferred/passes");
const BYTES: DiagnosticPath = DiagnosticPath::const_new("dolomite/deferred/bytes");

/// Sums over all views, where diagnostics are kept and a view was lit; and of each view, where that changed.
pub fn publish(
    stats: Res<DeferredStats>,
    store: Option<ResMut<DiagnosticsStore>>,
    mut known: Local<Vec<ViewStats>>,
) {
    let Some(mut store) = store else { return };
    let views = stats.views();
    if views.is_empty() {
        return;
    }
    if *known != views {
        for view in &views {
            let of_view = [
                ("passes", f64::from(view.passes)),
                ("bytes", view.bytes as f64),
            ];
            for (what, value) in of_view {
                let path = format!("dolomite/deferred/{what}/light/{}", view.camera);
                measure(&mut store, &DiagnosticPath::new(path), value);
            }
        }
        known.clone_from(&views);
    }
    let sums = [
        (
            LIGHTS,
            views.iter().map(|view| f64::from(view.lights)).sum(),
        ),
        (
            PASSES,
            views.iter().map(|view| f64::from(view.passes)).sum(),
        ),
        (
            BYTES,
            views.iter().map(|view| view.bytes as f64).sum::<f64>(),
        ),
    ];
    for (path, sum) in sums {
        measure(&mut store, &path, sum);
    }
}

fn measure(store: &mut DiagnosticsStore, path: &DiagnosticPath, value: f64) {
    if store.get(path).is_none() {
        store.add(Diagnostic::new(path.clone()));
    }
    if let Some(diagnostic) = store.get_mut(path) {
        diagnostic.add_measurement(bevy::diagnostic::DiagnosticMeasurement {
            time: bevy::platform::time::Instant::now(),
            value,
        });
    }
}
