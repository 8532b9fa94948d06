//! What is counted, in Bevy's `DiagnosticsStore`.

use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::prelude::*;

use super::meshes::MeshStats;
use super::stats::VegetationStats;

/// Blades that are drawn.
const BLADES: DiagnosticPath = DiagnosticPath::const_new("dolomite/vegetation/blades");
/// Bytes of buffers on the GPU.
const BYTES: DiagnosticPath = DiagnosticPath::const_new("dolomite/vegetation/bytes");
/// Dispatches since the app began.
const DISPATCHES: DiagnosticPath = DiagnosticPath::const_new("dolomite/vegetation/dispatches");
/// Trees and rocks, which are entities.
const MESHES: DiagnosticPath = DiagnosticPath::const_new("dolomite/vegetation/meshes");
/// Milliseconds that the last search for these took, in a task.
const SEARCH: DiagnosticPath = DiagnosticPath::const_new("dolomite/vegetation/search_ms");

pub(super) fn build(app: &mut App) {
    for path in [BLADES, BYTES, DISPATCHES, MESHES, SEARCH] {
        app.register_diagnostic(Diagnostic::new(path));
    }
    app.add_systems(
        Last,
        publish.run_if(any_with_component::<crate::components::Vegetation>),
    );
}

fn publish(drawn: Res<VegetationStats>, meshes: Res<MeshStats>, mut diagnostics: Diagnostics) {
    let drawn = drawn.get();
    let blades: u32 = drawn.records.iter().sum();
    diagnostics.add_measurement(&BLADES, || f64::from(blades));
    diagnostics.add_measurement(&BYTES, || drawn.bytes as f64);
    diagnostics.add_measurement(&DISPATCHES, || drawn.dispatches as f64);
    diagnostics.add_measurement(&MESHES, || meshes.entities as f64);
    diagnostics.add_measurement(&SEARCH, || meshes.search_ms);
}
