//! What a frame cost, in poses.

use super::{Character, CharacterLod};
use bevy::app::App;
use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::ecs::prelude::*;
use bevy::reflect::prelude::*;

/// Figures of the last frame; also under `dolomite/character/…` in Bevy's diagnostics.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, PartialEq)]
pub struct CharacterCounters {
    /// Sampled and blended: `…/sampled`.
    pub sampled: u32,
    /// Shown a pose that was sampled before: `…/interpolated`.
    pub interpolated: u32,
    /// Too small or out of sight: `…/resting`.
    pub resting: u32,
}

const SAMPLED: DiagnosticPath = DiagnosticPath::const_new("dolomite/character/sampled");
const INTERPOLATED: DiagnosticPath = DiagnosticPath::const_new("dolomite/character/interpolated");
const RESTING: DiagnosticPath = DiagnosticPath::const_new("dolomite/character/resting");

pub(super) fn build(app: &mut App) {
    app.init_resource::<CharacterCounters>();
    for path in [SAMPLED, INTERPOLATED, RESTING] {
        app.register_diagnostic(Diagnostic::new(path));
    }
}

/// Counts what `animate` did.
pub(super) fn count(
    mut counters: ResMut<CharacterCounters>,
    figures: Query<&CharacterLod, With<Character>>,
    mut diagnostics: Diagnostics,
) {
    let (mut sampled, mut interpolated, mut resting) = (0, 0, 0);
    for lod in &figures {
        match (lod.sampling, lod.since) {
            (super::Sampling::Off, _) => resting += 1,
            // A sample sets it to 0.
            (_, 0.0) => sampled += 1,
            _ => interpolated += 1,
        }
    }
    *counters = CharacterCounters {
        sampled,
        interpolated,
        resting,
    };
    diagnostics.add_measurement(&SAMPLED, || f64::from(sampled));
    diagnostics.add_measurement(&INTERPOLATED, || f64::from(interpolated));
    diagnostics.add_measurement(&RESTING, || f64::from(resting));
}
