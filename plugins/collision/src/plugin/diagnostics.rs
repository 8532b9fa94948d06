//! What a step cost.

use super::bodies::Bodies;
use super::movers::{CharacterBody, MoveState};
use bevy::app::App;
use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::ecs::prelude::*;
use bevy::reflect::prelude::*;

/// The last step; also under `dolomite/collision/…` in Bevy's diagnostics.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, PartialEq)]
pub struct CollisionCounters {
    /// Movers: `…/moves`.
    pub moves: u32,
    /// Sweeps and queries of them: `…/casts`.
    pub casts: u32,
    /// Advances of their slides: `…/iterations`.
    pub iterations: u32,
    /// Bodies that there were: `…/bodies`.
    pub bodies: u32,
    /// Bytes of their trees, those that are shared once for each: `…/bytes`.
    pub bytes: u64,
}

const MOVES: DiagnosticPath = DiagnosticPath::const_new("dolomite/collision/moves");
const CASTS: DiagnosticPath = DiagnosticPath::const_new("dolomite/collision/casts");
const ITERATIONS: DiagnosticPath = DiagnosticPath::const_new("dolomite/collision/iterations");
const BODIES: DiagnosticPath = DiagnosticPath::const_new("dolomite/collision/bodies");
const BYTES: DiagnosticPath = DiagnosticPath::const_new("dolomite/collision/bytes");

pub(super) fn build(app: &mut App) {
    app.init_resource::<CollisionCounters>();
    for path in [MOVES, CASTS, ITERATIONS, BODIES, BYTES] {
        app.register_diagnostic(Diagnostic::new(path));
    }
}

/// Counts what was done.
pub(super) fn count(
    mut counters: ResMut<CollisionCounters>,
    // A state stays where its body was taken away.
    states: Query<&MoveState, With<CharacterBody>>,
    bodies: Res<Bodies>,
    mut diagnostics: Diagnostics,
) {
    let mut sum = CollisionCounters::default();
    for state in &states {
        sum.moves += 1;
        sum.casts += state.outcome.casts;
        sum.iterations += state.outcome.iterations;
    }
    sum.bodies = bodies.placed.len() as u32;
    sum.bytes = bodies
        .placed
        .iter()
        .map(|body| body.tree.bytes() as u64)
        .sum();
    *counters = sum;
    diagnostics.add_measurement(&MOVES, || f64::from(sum.moves));
    diagnostics.add_measurement(&CASTS, || f64::from(sum.casts));
    diagnostics.add_measurement(&ITERATIONS, || f64::from(sum.iterations));
    diagnostics.add_measurement(&BODIES, || f64::from(sum.bodies));
    diagnostics.add_measurement(&BYTES, || sum.bytes as f64);
}
