//! Questions on their way to the GPU and answers on their way back.

use std::sync::Arc;

use bevy::prelude::*;
use bevy::render::render_resource::PollType;
use bevy::render::renderer::RenderDevice;
use bevy::render::sync_world::RenderEntity;
use bevy::render::{Extract, MainWorld};
use dolomite_terrain::{ProbeAnswer, ProbeBatch, ProbePart};

use super::stats::DrawnProbeStats;
use super::{GroundAnswers, Kept, Ticket};
use crate::cover::{PatchDetail, TerrainView};
use crate::detail::probe::{AnswerHead, DrawnProbes};

/// Takes this frame's question, if anybody asks and any view can answer.
pub(super) fn ask(
    mut answers: ResMut<GroundAnswers>,
    batch: Extract<Option<Res<ProbeBatch>>>,
    settings: Extract<Res<DrawnProbes>>,
    cameras: Extract<Query<(RenderEntity, &Camera), (With<TerrainView>, Without<PatchDetail>)>>,
) {
    let batch = batch.as_ref().filter(|batch| batch.probes() > 0);
    let main = cameras
        .iter()
        .filter(|(_, camera)| camera.is_active)
        .min_by_key(|(entity, camera)| (camera.order, *entity));
    let (Some(batch), Some((view, _)), true) = (batch, main, settings.per_frame > 0) else {
        if answers.question.is_some() {
            // What nobody asks for is not kept; but for the pipeline, which nothing takes back.
            *answers = GroundAnswers {
                pipeline: answers.pipeline.take(),
                dispatches: answers.dispatches,
                ..default()
            };
        }
        return;
    };
    answers.question = Some(batch.question());
    answers.view = Some(view);
    answers.settings = **settings;
}

/// Hands what has arrived to the probes.
pub(super) fn deliver(
    mut main: ResMut<MainWorld>,
    mut answers: ResMut<GroundAnswers>,
    device: Res<RenderDevice>,
) {
    let answers = &mut *answers;
    if answers.ring.under_way() {
        // Without waiting. A device that is lost is told of by whoever submits to it.
        let _ = device.poll(PollType::Poll);
    }
    let mut news = std::mem::take(&mut answers.again);
    let kept = &mut answers.kept;
    answers.ring.take_arrived(|ticket, bytes| {
        let Some(part) = read(&ticket, bytes) else {
            return;
        };
        let whole = ticket.count as usize == ticket.question.places.len();
        *kept = whole.then(|| Kept {
            question: ticket.question.clone(),
            key: ticket.key,
            part: part.clone(),
        });
        news.push((ticket.question, part));
    });
    if news.is_empty() {
        return;
    }
    for (question, part) in news {
        if let Some(mut stats) = main.get_resource_mut::<DrawnProbeStats>() {
            stats.note(&question, &part, answers.dispatches);
        }
        if let Some(mut batch) = main.get_resource_mut::<ProbeBatch>()
            && let Err(error) = batch.fill_part(question, part)
        {
            error!("height queries were refused: {error}");
        }
    }
}

/// What the GPU wrote for a question; `None` if it is of another one.
fn read(ticket: &Ticket, bytes: &[u8]) -> Option<ProbePart> {
    let (head, list) = bytes.split_at_checked(size_of::<AnswerHead>())?;
    let head: AnswerHead = bytemuck::pod_read_unaligned(head);
    let expected = (ticket.question.frame, ticket.count, ticket.key.stamp);
    if (head.frame, head.count, head.stamp) != expected {
        return None;
    }
    let answers: Vec<ProbeAnswer> = list
        .chunks_exact(size_of::<ProbeAnswer>())
        .map(bytemuck::pod_read_unaligned)
        .collect();
    Some(ProbePart {
        first: ticket.first,
        base: f64::from(head.anchor_height),
        answers: Arc::new(answers),
    })
}

/// After the submit: asks the device for what was copied.
pub(super) fn map(mut answers: ResMut<GroundAnswers>) {
    answers.ring.map();
}
