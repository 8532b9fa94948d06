//! What a step cost.

use crate::behaviour::ThoughtCounters;
use crate::movement::WalkCounters;
use crate::need::Asleep;
use crate::parts::Shots;
use crate::senses::SightCounters;
use crate::values::Logic;
use bevy::app::App;
use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::ecs::prelude::*;
use bevy::reflect::prelude::*;

/// The last step; also under `dolomite/logic/…` in Bevy's diagnostics.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct LogicCounters {
    /// Entities with logic: `…/entities`.
    pub entities: u32,
    /// Of them asleep: `…/asleep`.
    pub asleep: u32,
    /// Agents whose behaviours ran: `…/thinking`.
    pub thinking: u32,
    /// Rays of sight, whole ones: `…/rays`.
    pub rays: u32,
    /// Walkers that were steered: `…/walking`.
    pub walking: u32,
    /// Shots that fly: `…/shots`.
    pub shots: u32,
}

const ENTITIES: DiagnosticPath = DiagnosticPath::const_new("dolomite/logic/entities");
const ASLEEP: DiagnosticPath = DiagnosticPath::const_new("dolomite/logic/asleep");
const THINKING: DiagnosticPath = DiagnosticPath::const_new("dolomite/logic/thinking");
const RAYS: DiagnosticPath = DiagnosticPath::const_new("dolomite/logic/rays");
const WALKING: DiagnosticPath = DiagnosticPath::const_new("dolomite/logic/walking");
const SHOTS: DiagnosticPath = DiagnosticPath::const_new("dolomite/logic/shots");

pub(crate) fn build(app: &mut App) {
    app.init_resource::<LogicCounters>()
        .register_type::<LogicCounters>();
    for path in [ENTITIES, ASLEEP, THINKING, RAYS, WALKING, SHOTS] {
        app.register_diagnostic(Diagnostic::new(path));
    }
}

/// Counts what was done.
pub(crate) fn count(
    mut counters: ResMut<LogicCounters>,
    logic: Query<(), With<Logic>>,
    asleep: Query<(), With<Asleep>>,
    thoughts: Res<ThoughtCounters>,
    sight: Res<SightCounters>,
    walk: Res<WalkCounters>,
    shots: Res<Shots>,
    mut diagnostics: Diagnostics,
) {
    // Both are counted by tables, not by entities.
    *counters = LogicCounters {
        entities: logic.iter().len() as u32,
        asleep: asleep.iter().len() as u32,
        thinking: thoughts.agents,
        rays: sight.rays,
        walking: walk.steered,
        shots: shots.0.len() as u32,
    };
    let LogicCounters {
        entities,
        asleep,
        thinking,
        rays,
        walking,
        shots,
    } = *counters;
    for (path, count) in [
        (&ENTITIES, entities),
        (&ASLEEP, asleep),
        (&THINKING, thinking),
        (&RAYS, rays),
        (&WALKING, walking),
        (&SHOTS, shots),
    ] {
        diagnostics.add_measurement(path, || f64::from(count));
    }
}
