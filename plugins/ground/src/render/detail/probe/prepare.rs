//! What is asked in a frame, and the buffers for it.

use std::sync::Arc;

use bevy::prelude::*;
use bevy::render::render_resource::{
    BindGroup, BindGroupEntries, Buffer, BufferDescriptor, BufferId, BufferUsages, PipelineCache,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bytemuck::{bytes_of, cast_slice};
use dolomite_terrain::{GroundPoint, ProbeAnswer};

use super::pipeline::AnswerPipeline;
use super::{AnswerShaders, GroundAnswers, MeshKey, Ticket};
use crate::detail::Choice;
use crate::detail::probe::{AnswerHead, Asked, MOST_ASKED};
use crate::render::GroundKind;
use crate::render::blocks::prepare::BlockViews;
use crate::render::blocks::state::BlockState;
use crate::render::detail::detail_key;
use crate::render::detail::prepare::DetailViews;
use crate::render::detail::state::DetailState;
use dolomite_geometry::render::{GeometryView, Mapped, Producers};

/// Bytes of the head, and of each answer and each place.
const HEAD: u64 = size_of::<AnswerHead>() as u64;
const EACH: u64 = size_of::<ProbeAnswer>() as u64;
/// Least size of a buffer: some hundred probes come and go without a new one.
const LEAST: u64 = 4096;

/// Buffers of questions and answers.
pub(super) struct AnswerBuffers {
    asked: Buffer,
    places: Buffer,
    pub answers: Buffer,
    /// Shared, own; and which buffers of others they hold.
    pub groups: Option<[BindGroup; 2]>,
    bound: Vec<BufferId>,
}

impl AnswerBuffers {
    fn new(device: &RenderDevice, count: u32) -> Self {
        let buffer = |label, size: u64, usage| {
            device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let room = room(count);
        let storage = BufferUsages::STORAGE;
        Self {
            asked: buffer(
                "ground_asked",
                size_of::<Asked>() as u64,
                BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            ),
            places: buffer("ground_places", room, storage | BufferUsages::COPY_DST),
            answers: buffer("height_queries", room, storage | BufferUsages::COPY_SRC),
            groups: None,
            bound: Vec::new(),
        }
    }

    fn bind(
        &mut self,
        device: &RenderDevice,
        cache: &PipelineCache,
        pipeline: &AnswerPipeline,
        drawn: Drawn<'_>,
        vertices: &Buffer,
    ) {
        let of_others = drawn.buffers(vertices);
        let bound: Vec<_> = of_others.iter().map(|buffer| buffer.id()).collect();
        if self.groups.is_some() && self.bound == bound {
            return;
        }
        let [own_layout, shared_layout] =
            [&pipeline.own, &pipeline.shared].map(|layout| cache.get_bind_group_layout(layout));
        let asked =
            [&self.asked, &self.places, &self.answers].map(|buffer| buffer.as_entire_binding());
        let [asked, places, answers] = asked;
        self.groups = match drawn {
            Drawn::Blocks(own) => own.groups.as_ref().map(|groups| {
                let entries =
                    BindGroupEntries::with_indices(((2, asked), (3, places), (4, answers)));
                let own = device.create_bind_group("answer_own", &own_layout, &entries);
                [groups.shared.clone(), own]
            }),
            Drawn::Cells(detail) => {
                let [cells, links, seen, counts, _] = &detail.kept;
                let shared = device.create_bind_group(
                    "answer_shared",
                    &shared_layout,
                    &BindGroupEntries::with_indices((
                        (0, detail.uniform.as_entire_binding()),
                        (2, cells.as_entire_binding()),
                        (3, links.as_entire_binding()),
                        (4, seen.as_entire_binding()),
                        (5, counts.as_entire_binding()),
                    )),
                );
                let own = device.create_bind_group(
                    "answer_own",
                    &own_layout,
                    &BindGroupEntries::sequential((
                        detail.corners.as_entire_binding(),
                        vertices.as_entire_binding(),
                        asked,
                        places,
                        answers,
                    )),
                );
                Some([shared, own])
            }
        };
        self.bound = bound;
    }
}

/// What a view's choice has drawn.
#[derive(Clone, Copy)]
pub(super) enum Drawn<'a> {
    Blocks(&'a BlockState),
    Cells(&'a DetailState),
}

impl<'a> Drawn<'a> {
    pub(super) const fn choice(self) -> Choice {
        match self {
            Self::Blocks(_) => Choice::Blocks,
            Self::Cells(_) => Choice::Cells,
        }
    }

    /// Number of the choice, and what is its own.
    fn stamp(self) -> (u32, BufferId) {
        match self {
            Self::Blocks(own) => (own.stamp, own.seen.id()),
            Self::Cells(own) => (own.stamp, own.kept[2].id()),
        }
    }

    /// The buffers that an answer reads.
    fn buffers(self, vertices: &'a Buffer) -> Vec<&'a Buffer> {
        match self {
            Self::Blocks(own) => {
                vec![
                    &own.params,
                    &own.records,
                    &own.heads,
                    &own.seen,
                    &own.counts,
                ]
            }
            Self::Cells(own) => {
                let [cells, links, seen, counts, _] = &own.kept;
                let shared = [&own.uniform, cells, links, seen, counts];
                shared.into_iter().chain([&own.corners, vertices]).collect()
            }
        }
    }
}

/// Bytes of a buffer for so many answers.
fn room(count: u32) -> u64 {
    (HEAD + EACH * u64::from(count))
        .next_power_of_two()
        .max(LEAST)
}

/// The slots whose turn it is, `most` of `all`; and the slot that is next.
fn turn(all: u32, most: u32, cursor: u32) -> (std::ops::Range<u32>, u32) {
    if all <= most {
        return (0..all, 0);
    }
    let first = if cursor < all { cursor } else { 0 };
    let last = first.saturating_add(most).min(all);
    (first..last, if last < all { last } else { 0 })
}

/// A view's ground, where it is drawn with its detail chosen.
pub(super) fn drawn<'a>(
    producers: &'a Producers,
    details: &'a DetailViews<GroundKind<0>>,
    blocks: &'a BlockViews<GroundKind<0>>,
    view: Entity,
) -> Option<(Drawn<'a>, &'a GeometryView)> {
    let producer = producers.get(detail_key::<GroundKind<0>>())?;
    let in_blocks = blocks.views.get(&view).map(Drawn::Blocks);
    let drawn = in_blocks.or_else(|| details.views.get(&view).map(Drawn::Cells))?;
    Some((drawn, producer.views.get(&view)?))
}

/// Uploads what is asked in this frame; makes what is missing for it.
pub(super) fn prepare(
    mut answers: ResMut<GroundAnswers>,
    producers: Res<Producers>,
    (details, blocks): (
        Res<DetailViews<GroundKind<0>>>,
        Res<BlockViews<GroundKind<0>>>,
    ),
    shaders: Res<AnswerShaders>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    let answers = &mut *answers;
    let (Some(question), Some(view)) = (&answers.question, answers.view) else {
        return;
    };
    let Some((drawn, state)) = drawn(&producers, &details, &blocks, view) else {
        return;
    };
    let (stamp, seen) = drawn.stamp();
    let key = MeshKey { view, stamp, seen };
    let same = answers
        .kept
        .as_ref()
        .filter(|kept| kept.key == key && Arc::ptr_eq(&kept.question.places, &question.places));
    if let Some(kept) = same.filter(|_| state.settled) {
        answers.again.push((question.clone(), kept.part.clone()));
        return;
    }
    let most = answers.settings.per_frame.min(MOST_ASKED);
    let (slots, next) = turn(question.places.len() as u32, most, answers.cursor);
    let count = slots.len() as u32;
    let bytes = HEAD + EACH * u64::from(count);
    let ticket = Ticket {
        question: question.clone(),
        first: slots.start,
        count,
        key,
    };
    if !answers.ring.begin(bytes, ticket, || {
        Mapped::new(&device, "height_queries_staging", room(count))
    }) {
        return;
    }
    answers.cursor = next;
    let choice = drawn.choice();
    if answers.pipeline(choice).is_none() {
        let pipeline = AnswerPipeline::new(choice, shaders.of(choice), &cache);
        answers.pipelines.push((choice, pipeline));
    }
    let known = answers.buffers.take();
    let buffers = answers.buffers.insert(
        known
            .filter(|known| known.answers.size() >= bytes)
            .unwrap_or_else(|| AnswerBuffers::new(&device, count)),
    );
    let asked = Asked {
        frame: question.frame,
        count,
        ..Asked::default()
    };
    queue.write_buffer(&buffers.asked, 0, bytes_of(&asked));
    let places: &[GroundPoint] = &question.places[slots.start as usize..slots.end as usize];
    queue.write_buffer(&buffers.places, 0, cast_slice(places));
    if let Some((_, pipeline)) = answers.pipelines.iter().find(|(of, _)| *of == choice) {
        buffers.bind(&device, &cache, pipeline, drawn, &state.vertices);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crowd_takes_turns_and_nobody_is_left_out() {
        assert_eq!(turn(10, 10, 7), (0..10, 0));
        assert_eq!(turn(10, 4, 0), (0..4, 4));
        assert_eq!(turn(10, 4, 8), (8..10, 0));
        assert_eq!(turn(3, 2, 9), (0..2, 2), "the crowd has become smaller");
        let mut asked = [0; 1001];
        let mut cursor = 0;
        for _ in 0..11 {
            let (slots, next) = turn(1001, 100, cursor);
            cursor = next;
            for slot in slots {
                asked[slot as usize] += 1;
            }
        }
        assert_eq!(asked, [1; 1001]);
    }
}
