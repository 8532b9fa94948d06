//! Ground answers from what is drawn, see [`crate::detail::probe`].
//!
//! In a frame: `ask` takes the question of all probes, `prepare` uploads it, `answer` finds the triangles
//! after the view's vertices have been chosen and written, `map` asks for the answers after the submit;
//! one to three frames later `deliver` hands them to the probes. Nothing waits for the GPU. Places and
//! view at rest have the same answers: they are handed in again, and nothing is dispatched.
//!
//! Without a probe nothing is made; when the last one goes, the buffers go too.

mod pass;
mod pipeline;
mod prepare;
mod readback;
mod stats;

use bevy::core_pipeline::prepass::node::early_prepass;
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::prelude::*;
use bevy::render::render_resource::BufferId;
use bevy::render::{ExtractSchedule, Render, RenderApp, RenderSystems};
use dolomite_terrain::{GroundProbeSystems, ProbePart, ProbeQuestion};

use crate::detail::probe::{ANSWER_PASS, DrawnProbes};
use crate::detail::ring::Ring;
use crate::render::GroundKind;
use dolomite_tessellation::render::library::shader;
pub use stats::{AnswerCensus, DrawnProbeStats, answer_census};

/// The shader of the pass.
#[derive(Resource)]
struct AnswerShader(Handle<Shader>);

/// Which triangles an answer is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct MeshKey {
    view: Entity,
    /// Number of the choice, and the buffer that it is in.
    stamp: u32,
    seen: BufferId,
}

/// What was asked, while its answer is under way.
struct Ticket {
    question: ProbeQuestion,
    first: u32,
    count: u32,
    key: MeshKey,
}

/// Answers to all places, and to which.
struct Kept {
    question: ProbeQuestion,
    key: MeshKey,
    part: ProbePart,
}

/// Questions and answers, in the render world.
#[derive(Resource, Default)]
struct GroundAnswers {
    /// Of this frame; none without probes.
    question: Option<ProbeQuestion>,
    /// The view that answers.
    view: Option<Entity>,
    settings: DrawnProbes,
    /// Slot of the first place whose turn is next.
    cursor: u32,
    pipeline: Option<pipeline::AnswerPipeline>,
    buffers: Option<prepare::AnswerBuffers>,
    ring: Ring<readback::Mapped, Ticket>,
    kept: Option<Kept>,
    /// To be handed in once more.
    again: Vec<(ProbeQuestion, ProbePart)>,
    /// Since the app began.
    dispatches: u64,
}

/// Adds the systems to an app that renders.
pub(crate) fn build(app: &mut App) {
    let (file, _) = ANSWER_PASS;
    let mut assets = app.world_mut().resource_mut::<Assets<Shader>>();
    let entry = assets.add(shader(dolomite_shaders::find(file).source, file));
    app.init_resource::<DrawnProbes>()
        .init_resource::<DrawnProbeStats>()
        .add_systems(PostUpdate, stats::publish.after(GroundProbeSystems));
    stats::register(app);
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .insert_resource(AnswerShader(entry))
        .init_resource::<GroundAnswers>()
        .add_systems(ExtractSchedule, (readback::deliver, readback::ask).chain())
        .add_systems(
            Render,
            (
                prepare::prepare
                    .in_set(RenderSystems::PrepareBindGroups)
                    .after(super::prepare::prepare::<GroundKind>),
                readback::map.in_set(RenderSystems::Cleanup),
            ),
        )
        .add_systems(
            Core3d,
            pass::answer
                .in_set(Core3dSystems::Prepass)
                .after(super::pass::choose::<GroundKind>)
                .before(early_prepass),
        );
}
