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
use super::{AnswerShader, GroundAnswers, MeshKey, Ticket};
use crate::detail::probe::{AnswerHead, Asked, MOST_ASKED};
use crate::render::GroundKind;
use crate::render::blocks::prepare::BlockViews;
use crate::render::blocks::state::BlockState;
use crate::render::detail::detail_key;
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
        drawn: &BlockState,
    ) {
        let of_others = [
            &drawn.params,
            &drawn.records,
            &drawn.heads,
            &drawn.seen,
            &drawn.counts,
        ];
        let bound = of_others.map(|buffer| buffer.id());
        if self.groups.is_some() && self.bound == bound {
            return;
        }
        let asked =
            [&self.asked, &self.places, &self.answers].map(|buffer| buffer.as_entire_binding());
        let [asked, places, answers] = asked;
        self.groups = drawn.groups.as_ref().map(|groups| {
            let layout = cache.get_bind_group_layout(&pipeline.own);
            let entries = BindGroupEntries::with_indices(((2, asked), (3, places), (4, answers)));
            let own = device.create_bind_group("answer_own", &layout, &entries);
            [groups.shared.clone(), own]
        });
        self.bound = bound.to_vec();
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
    blocks: &'a BlockViews<GroundKind<0>>,
    view: Entity,
) -> Option<(&'a BlockState, &'a GeometryView)> {
    let producer = producers.get(detail_key::<GroundKind<0>>())?;
    Some((blocks.views.get(&view)?, producer.views.get(&view)?))
}

/// Uploads what is asked in this frame; makes what is missing for it.
pub(super) fn prepare(
    mut answers: ResMut<GroundAnswers>,
    producers: Res<Producers>,
    blocks: Res<BlockViews<GroundKind<0>>>,
    shader: Res<AnswerShader>,
    cache: Res<PipelineCache>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    let answers = &mut *answers;
    let (Some(question), Some(view)) = (&answers.question, answers.view) else {
        return;
    };
    let Some((drawn, state)) = drawn(&producers, &blocks, view) else {
        return;
    };
    let key = MeshKey {
        view,
        stamp: drawn.stamp,
        seen: drawn.seen.id(),
    };
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
    let pipeline = answers
        .pipeline
        .get_or_insert_with(|| AnswerPipeline::new(&shader.0, &cache));
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
    buffers.bind(&device, &cache, pipeline, drawn);
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
