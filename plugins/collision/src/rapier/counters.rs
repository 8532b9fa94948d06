//! What the bridge holds and did.

use bevy::app::App;
use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::ecs::prelude::*;
use bevy::reflect::prelude::*;

/// What the bridge holds and has done; tiles and bytes also under `dolomite/collision/rapier/…` in Bevy's
/// diagnostics.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, PartialEq)]
pub struct BridgeCounters {
    /// Tiles that there are: `…/tiles`.
    pub tiles: u32,
    /// Bytes that they hold: `…/bytes`.
    pub bytes: u64,
    /// Tiles that were made, all in all.
    pub made: u64,
    /// Tiles whose samples were looked at again because the ground changed in them, or anywhere, all in all.
    pub looked_at: u64,
    /// Tiles that got other samples in place, all in all.
    pub replaced: u64,
    /// Bodies that were woken because their ground changed, all in all.
    pub woken: u64,
    /// Bodies that were lifted with rising ground, all in all.
    pub lifted: u64,
    /// Bodies that got less ground than they cover, or shapes that movers cannot meet, all in all.
    pub refused: u64,
}

const TILES: DiagnosticPath = DiagnosticPath::const_new("dolomite/collision/rapier/tiles");
const BYTES: DiagnosticPath = DiagnosticPath::const_new("dolomite/collision/rapier/bytes");

pub(super) fn build(app: &mut App) {
    app.init_resource::<BridgeCounters>()
        .register_type::<BridgeCounters>();
    for path in [TILES, BYTES] {
        app.register_diagnostic(Diagnostic::new(path));
    }
}

/// Publishes them.
pub(super) fn publish(counters: Res<BridgeCounters>, mut diagnostics: Diagnostics) {
    diagnostics.add_measurement(&TILES, || f64::from(counters.tiles));
    diagnostics.add_measurement(&BYTES, || counters.bytes as f64);
}
