//! What is told of drawn answers.

use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::prelude::*;
use dolomite_terrain::{ProbeBatch, ProbePart, ProbeQuestion};

use super::GroundAnswers;
use crate::shown::ShownTerrains;

/// Drawn answers, as they arrive in the main world.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DrawnProbeStats {
    /// Places that the newest answer is to.
    pub asked: u32,
    /// How many of them have a drawn triangle.
    pub drawn: u32,
    /// Frame that the newest answer is of ([`ProbeBatch::frame`]); `None` before the first.
    pub newest: Option<u32>,
    /// Frames from the question to when the probes had the newest answer; while none comes, it grows.
    pub age: u32,
    /// Dispatches since the app began: none while places and view are at rest.
    pub dispatches: u64,
}

const PATHS: [&str; 3] = [
    "dolomite/probes/asked",
    "dolomite/probes/drawn",
    "dolomite/probes/age",
];

/// Registers the diagnostics.
pub(super) fn register(app: &mut App) {
    for path in PATHS {
        app.register_diagnostic(Diagnostic::new(DiagnosticPath::const_new(path)));
    }
}

impl DrawnProbeStats {
    /// Takes note of an answer.
    pub(super) fn note(&mut self, question: &ProbeQuestion, part: &ProbePart, dispatches: u64) {
        self.dispatches = dispatches;
        // Wrapping: half of the range ahead is "later".
        if self
            .newest
            .is_some_and(|newest| newest.wrapping_sub(question.frame) < 1 << 31)
        {
            return;
        }
        self.newest = Some(question.frame);
        self.asked = part.answers.len() as u32;
        self.drawn = part.answers.iter().filter(|a| a.is_hit()).count() as u32;
    }
}

/// Main world, when probes have received their answers.
pub(super) fn publish(
    batch: Option<Res<ProbeBatch>>,
    shown: Res<ShownTerrains>,
    mut told: Local<bool>,
    mut stats: ResMut<DrawnProbeStats>,
    mut diagnostics: Diagnostics,
) {
    let (Some(batch), Some(newest)) = (batch.filter(|batch| batch.probes() > 0), stats.newest)
    else {
        return;
    };
    if shown.count() > 1 && !*told {
        *told = true;
        warn!(
            "{} terrains are drawn, but height queries are of the triangles of the first of them alone; over the others probes have their true answers",
            shown.count()
        );
    }
    stats.age = batch.frame().wrapping_sub(newest);
    let values = [stats.asked, stats.drawn, stats.age];
    for (path, value) in PATHS.into_iter().zip(values) {
        diagnostics.add_measurement(&DiagnosticPath::const_new(path), || f64::from(value));
    }
}

/// What height queries hold on the GPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AnswerCensus {
    /// Pipelines queued.
    pub pipelines: usize,
    /// Buffers of questions, answers and their way back.
    pub buffers: usize,
    /// Dispatches since the app began.
    pub dispatches: u64,
}

/// Counts what height queries hold in a render world: all 0 as long as there is no probe, or no active camera with a
/// [`TerrainView`](crate::TerrainView) and without a [`PatchDetail`](crate::PatchDetail).
pub fn answer_census(render_world: &World) -> AnswerCensus {
    let Some(answers) = render_world.get_resource::<GroundAnswers>() else {
        return AnswerCensus::default();
    };
    AnswerCensus {
        pipelines: usize::from(answers.pipeline.is_some()),
        buffers: answers.ring.buffers() + 3 * usize::from(answers.buffers.is_some()),
        dispatches: answers.dispatches,
    }
}
