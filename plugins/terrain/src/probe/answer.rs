//! The systems: where probes are, what is true there, what was drawn there.

use super::batch::{Asked, ProbeBatch, ProbePart, ProbeQuestion};
use super::{DrawnAnswer, GroundProbe};
use crate::ground::GroundSample;
use crate::terrain::{Terrain, terrain_at};
use bevy::app::{App, PostUpdate, PreUpdate};
use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::prelude::*;
use bevy::math::DVec2;
use bevy::tasks::{ComputeTaskPool, TaskPool};
use bevy::transform::{TransformSystems, components::Transform, helper::TransformHelper};
use bevy::utils::Parallel;

/// Probes are collected and answered in this set (schedule `PostUpdate`, after transforms); what was drawn
/// is handed to them in it before anything else happens in a frame (schedule `PreUpdate`).
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct GroundProbeSystems;

pub(crate) fn build(app: &mut App) {
    app.init_resource::<ProbeBatch>()
        .add_systems(PreUpdate, deliver_drawn.in_set(GroundProbeSystems))
        .add_systems(
            PostUpdate,
            (enter, collect, find_true)
                .chain()
                .in_set(GroundProbeSystems)
                .after(TransformSystems::Propagate),
        );
}

/// Fewest probes that are worth a task of their own, some 10 µs of each system's work.
const PER_TASK: usize = 512;

/// Begins the frame, and gives new probes a slot.
fn enter(mut batch: ResMut<ProbeBatch>, mut new: Query<(Entity, &mut Asked), Added<GroundProbe>>) {
    batch.begin();
    for (entity, mut asked) in &mut new {
        if asked.slot == Asked::NONE {
            asked.slot = batch.allot(entity);
        }
    }
}

/// Notes which probes moved.
fn collect(
    mut batch: ResMut<ProbeBatch>,
    mut probes: Query<(Entity, &mut Asked, Ref<Transform>, Has<ChildOf>), With<GroundProbe>>,
    places: TransformHelper,
    mut moved: Local<Parallel<Vec<(u32, DVec2)>>>,
) {
    probes
        .par_iter_mut()
        .for_each(|(entity, mut asked, own, has_parent)| {
            // Most probes have no parent and stand: they cost one comparison of ticks.
            let place = if !has_parent {
                if !own.is_changed() && !asked.place.is_nan() {
                    return;
                }
                own.translation
            } else {
                // An entity whose chain of parents is broken keeps its last answer.
                match places.compute_global_transform(entity) {
                    Ok(place) => place.translation(),
                    Err(_) => return,
                }
            };
            let place = DVec2::new(f64::from(place.x), f64::from(place.z));
            // Equal to itself, which a NaN is not.
            let place = if place.is_finite() {
                place
            } else {
                DVec2::INFINITY
            };
            if asked.place != place {
                asked.place = place;
                moved.borrow_local_mut().push((asked.slot, place));
            }
        });
    for list in moved.iter_mut() {
        for (slot, place) in list.drain(..) {
            batch.ask(slot, place);
        }
    }
}

/// Finds the true surface for probes that wait, as many as a frame may, on all cores.
fn find_true(
    terrains: Query<(Entity, Ref<Terrain>)>,
    mut removed: RemovedComponents<Terrain>,
    mut batch: ResMut<ProbeBatch>,
    mut probes: Query<&mut GroundProbe>,
    mut round: Local<Vec<(usize, DVec2)>>,
    mut known: Local<EntityHashMap<Terrain>>,
) {
    let gone = removed.read().inspect(|entity| {
        known.remove(entity);
    });
    if gone.count() > 0 {
        batch.ask_all();
    }
    for (entity, terrain) in &terrains {
        if !terrain.is_changed() {
            continue;
        }
        // Where it was edited, probes on what changed are asked alone.
        let before = known.insert(entity, Terrain::clone(&terrain));
        match before.and_then(|before| terrain.changed_since(&before)) {
            Some(rects) => batch.ask_within(&rects),
            None => batch.ask_all(),
        }
    }
    if batch.waiting == 0 {
        return;
    }
    take_round(&mut batch, &mut round);
    let samples = sample_all(&in_order(&terrains), &round);
    for ((index, _), sample) in round.iter().zip(samples) {
        let slot = batch.slots[*index];
        let Some(mut probe) = slot.entity.and_then(|entity| probes.get_mut(entity).ok()) else {
            continue;
        };
        let next = GroundProbe {
            sample,
            frame: slot.frame,
            drawn: probe.drawn.filter(|_| slot.place.is_finite()),
        };
        // The frame alone, of a probe whose answer is the same, is news too: it moved.
        probe.set_if_neq(next);
    }
}

/// The next slots whose turn it is; they no longer wait.
fn take_round(batch: &mut ProbeBatch, round: &mut Vec<(usize, DVec2)>) {
    round.clear();
    let most = batch.waiting.min(batch.per_frame.max(1));
    let all = batch.slots.len();
    let mut seen = 0;
    while round.len() < most && seen < all {
        batch.cursor = if batch.cursor < all { batch.cursor } else { 0 };
        let slot = &mut batch.slots[batch.cursor];
        if std::mem::take(&mut slot.waiting) {
            round.push((batch.cursor, slot.place));
        }
        batch.cursor += 1;
        seen += 1;
    }
    batch.waiting -= round.len();
}

/// All terrains, in the order of their entities: of two that overlap the same one always answers.
fn in_order<'a>(terrains: &'a Query<(Entity, Ref<Terrain>)>) -> Vec<&'a Terrain> {
    let mut found: Vec<(Entity, &Terrain)> = terrains
        .iter()
        .map(|(entity, terrain)| (entity, terrain.into_inner()))
        .collect();
    found.sort_unstable_by_key(|(entity, _)| entity.index_u32());
    found.into_iter().map(|(_, terrain)| terrain).collect()
}

/// The true surface at all places; `None` where a place is not finite, or no terrain is in the world.
fn sample_all(terrains: &[&Terrain], round: &[(usize, DVec2)]) -> Vec<Option<GroundSample>> {
    let one = |place: DVec2| {
        let terrain = terrain_at(terrains.iter().copied(), place)?;
        place.is_finite().then(|| terrain.sample_f64(place))
    };
    if round.len() <= PER_TASK {
        return round.iter().map(|(_, place)| one(*place)).collect();
    }
    let pool = ComputeTaskPool::get_or_init(TaskPool::default);
    let part = round
        .len()
        .div_ceil(pool.thread_num().max(1) * 4)
        .max(PER_TASK);
    let parts = pool.scope(|scope| {
        for places in round.chunks(part) {
            scope.spawn(async move {
                places
                    .iter()
                    .map(|(_, place)| one(*place))
                    .collect::<Vec<_>>()
            });
        }
    });
    parts.into_iter().flatten().collect()
}

/// Hands what was drawn to its probes.
fn deliver_drawn(mut batch: ResMut<ProbeBatch>, mut probes: Query<(&Asked, &mut GroundProbe)>) {
    for (question, part) in batch.take_inbox() {
        let batch = &*batch;
        let slots = part.first..part.first.saturating_add(part.answers.len() as u32);
        probes.par_iter_mut().for_each(|(asked, mut probe)| {
            if !slots.contains(&asked.slot) {
                return;
            }
            let later = probe.drawn.is_some_and(|known| {
                // Wrapping: half of the range ahead is "later".
                known.frame.wrapping_sub(question.frame) < 1 << 31
            });
            if later || !asked.place.is_finite() || !batch.is_of_owner(asked.slot, question.frame) {
                return;
            }
            let drawn = drawn(&question, &part, asked.slot);
            if probe.drawn != drawn {
                probe.drawn = drawn;
            }
        });
    }
}

/// What a part says of one of its slots.
fn drawn(question: &ProbeQuestion, part: &ProbePart, slot: u32) -> Option<DrawnAnswer> {
    let answer = part.answers[(slot - part.first) as usize];
    answer.is_hit().then(|| DrawnAnswer {
        sample: GroundSample {
            height: part.base + f64::from(answer.height) + f64::from(answer.rise),
            gradient: DVec2::from(answer.gradient.map(f64::from)),
        },
        place: question.places[slot as usize].to_dvec2(),
        bound: f64::from(answer.bound),
        frame: question.frame,
    })
}
