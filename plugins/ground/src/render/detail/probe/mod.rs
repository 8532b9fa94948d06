//! Height queries from what is drawn, see [`crate::detail::probe`].
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

use crate::blocks::layout::ANSWER_PASS;
use crate::detail::probe::DrawnProbes;
use crate::render::GroundKind;
use crate::render::blocks::prepare::prepare as prepare_blocks;
use dolomite_geometry::render::{GeometrySystems, Mapped, shader_asset};
use dolomite_geometry::ring::Ring;
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
    ring: Ring<Mapped, Ticket>,
    kept: Option<Kept>,
    /// To be handed in once more.
    again: Vec<(ProbeQuestion, ProbePart)>,
    /// Since the app began.
    dispatches: u64,
}

/// Adds the systems to an app that renders.
pub(crate) fn build(app: &mut App) {
    let known = app.get_sub_app(RenderApp).map(SubApp::world);
    if known.is_none_or(|world| world.contains_resource::<GroundAnswers>()) {
        return;
    }
    let Some(mut assets) = app.world_mut().get_resource_mut::<Assets<Shader>>() else {
        return;
    };
    let (file, _) = ANSWER_PASS;
    let shader = shader_asset(dolomite_shaders::find(file).source, file);
    let shader = AnswerShader(assets.add(shader));
    app.init_resource::<DrawnProbes>()
        .init_resource::<DrawnProbeStats>()
        .add_systems(PostUpdate, stats::publish.after(GroundProbeSystems));
    stats::register(app);
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .insert_resource(shader)
        .init_resource::<GroundAnswers>()
        .add_systems(ExtractSchedule, (readback::deliver, readback::ask).chain())
        .add_systems(
            Render,
            (
                prepare::prepare
                    .in_set(GeometrySystems::Bind)
                    .after(prepare_blocks::<GroundKind<0>>),
                readback::map.in_set(RenderSystems::Cleanup),
            ),
        )
        .add_systems(
            Core3d,
            pass::answer
                .in_set(Core3dSystems::Prepass)
                .after(GeometrySystems::Make)
                .before(early_prepass),
        );
}
