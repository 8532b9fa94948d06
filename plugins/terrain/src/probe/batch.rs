//! All probes in one array: what is asked of who draws, and what comes back.

use crate::ground::{GroundPoint, GroundRect};
use bevy::ecs::lifecycle::HookContext;
use bevy::ecs::prelude::*;
use bevy::ecs::reflect::ReflectResource;
use bevy::ecs::world::DeferredWorld;
use bevy::math::DVec2;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bytemuck::{Pod, Zeroable};
use std::ops::Range;
use std::sync::Arc;
use thiserror::Error;

/// A probe's slot in the arrays.
#[derive(Component, Clone, Copy, Debug)]
pub(super) struct Asked {
    /// Its slot; [`Asked::NONE`] before it has one.
    pub slot: u32,
    /// Where it was asked last; not a number before.
    pub place: DVec2,
}

impl Asked {
    pub const NONE: u32 = u32::MAX;
}

impl Default for Asked {
    fn default() -> Self {
        Self {
            slot: Self::NONE,
            place: DVec2::NAN,
        }
    }
}

/// Gives a removed probe's slot back.
pub(super) fn release(mut world: DeferredWorld, context: HookContext) {
    let Some(mut asked) = world.get_mut::<Asked>(context.entity) else {
        return;
    };
    let slot = std::mem::take(&mut *asked).slot;
    if let Some(mut batch) = world.get_resource_mut::<ProbeBatch>() {
        batch.free(slot);
    }
}

/// What a slot is in use for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    /// Whose; `None` while it is free.
    pub entity: Option<Entity>,
    /// The frame since which it is theirs.
    since: u32,
    /// In f64, as the true surface is asked for it.
    pub place: DVec2,
    /// When it was there.
    pub frame: u32,
    /// Whether the true surface is still to be found there.
    pub waiting: bool,
}

/// The probes of the world in flat arrays, in an order that stays: a probe keeps its slot for as long
/// as it lives, and what is freed goes to the next one.
///
/// By reflection its setting alone is seen.
#[derive(Resource, Debug, Reflect)]
#[reflect(Resource, Default)]
pub struct ProbeBatch {
    /// Most true answers that are found in one frame; the rest waits its turn, so that a crowd never
    /// holds up a frame. Default 16 384; at least 1 (clamped). Of ground with eight octaves, two cores find
    /// 65 536 in 34 to 64 ms without optimisation for speed (the profile `dev`).
    pub per_frame: usize,
    #[reflect(ignore)]
    frame: u32,
    #[reflect(ignore)]
    pub(super) slots: Vec<Slot>,
    #[reflect(ignore)]
    places: Arc<Vec<GroundPoint>>,
    #[reflect(ignore)]
    free: Vec<u32>,
    #[reflect(ignore)]
    changed: Range<u32>,
    /// Slots that wait for the true surface, and where the round goes on.
    #[reflect(ignore)]
    pub(super) waiting: usize,
    #[reflect(ignore)]
    pub(super) cursor: usize,
    #[reflect(ignore)]
    inbox: Vec<(ProbeQuestion, ProbePart)>,
}

impl Default for ProbeBatch {
    fn default() -> Self {
        Self {
            per_frame: 1 << 14,
            frame: 0,
            slots: Vec::new(),
            places: Arc::default(),
            free: Vec::new(),
            changed: 0..0,
            waiting: 0,
            cursor: 0,
            inbox: Vec::new(),
        }
    }
}

/// The probes of one frame, to be kept until its answer is there. Cheap to clone.
#[derive(Clone, Debug)]
pub struct ProbeQuestion {
    /// The frame; it is drawn with these places.
    pub frame: u32,
    /// Where, by slot. Free slots, and probes at places that are not finite, hold some place; their
    /// answers are passed over.
    pub places: Arc<Vec<GroundPoint>>,
    /// Slots outside of this range are as they were in the question of the frame before.
    pub changed: Range<u32>,
}

/// What was found under one place: 20 bytes, as a shader writes them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct ProbeAnswer {
    /// Height of the triangle, metres above y = 0, or above [`ProbePart::base`]; [`Self::rise`] is added
    /// to it.
    pub height: f32,
    /// Metres from `height` up to the triangle at the place. An f32 of 1000 m has steps of 6e-5 m: who
    /// interpolates gives a corner's height and the rise from there, and loses nothing.
    pub rise: f32,
    /// Its slope along x and z, rise over run.
    pub gradient: [f32; 2],
    /// How far it may lie above or below the true surface, metres; below 0 where no triangle is.
    pub bound: f32,
}

impl ProbeAnswer {
    /// No triangle there.
    pub const NOTHING: Self = Self {
        height: 0.0,
        rise: 0.0,
        gradient: [0.0; 2],
        bound: -1.0,
    };

    /// Whether a triangle was found, with numbers that can be used.
    #[must_use]
    pub fn is_hit(&self) -> bool {
        let [x, z] = self.gradient;
        self.bound >= 0.0
            && [self.height, self.rise, x, z, self.bound]
                .iter()
                .all(|n| n.is_finite())
    }
}

/// What was found under some of the places of a question, in the order of their slots.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProbePart {
    /// Slot of the first answer.
    pub first: u32,
    /// What the heights of the answers are relative to, metres above y = 0.
    pub base: f64,
    /// One a slot.
    pub answers: Arc<Vec<ProbeAnswer>>,
}

/// Answers that do not fit their question.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{found} answers to a question of {expected} places")]
pub struct ProbeError {
    /// Places of the question.
    pub expected: usize,
    /// Answers that came.
    pub found: usize,
}

impl ProbeBatch {
    /// The present frame: counted in `PostUpdate`, from 1 on; wraps.
    #[must_use]
    pub fn frame(&self) -> u32 {
        self.frame
    }

    /// Number of slots, free ones as well.
    #[must_use]
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Whether there has never been a probe.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// Number of probes: slots that are not free.
    #[must_use]
    pub fn probes(&self) -> usize {
        self.slots.len() - self.free.len()
    }

    /// Probes that wait for the true surface.
    #[must_use]
    pub fn waiting(&self) -> usize {
        self.waiting
    }

    /// The probes of this frame, for who draws it. To be taken after
    /// [`GroundProbeSystems`](super::GroundProbeSystems). It copies nothing; the array is copied at the
    /// next change of a place if the question is still kept then.
    #[must_use]
    pub fn question(&self) -> ProbeQuestion {
        ProbeQuestion {
            frame: self.frame,
            places: self.places.clone(),
            changed: self.changed.clone(),
        }
    }

    /// Hands in what was drawn under the places of a question, by slot. Probes receive it at the
    /// beginning of the next frame; those that came after the question, or have an answer to a later one,
    /// do not.
    ///
    /// # Errors
    /// [`ProbeError`] if there are more or fewer answers than places; nothing is taken then.
    pub fn fill(
        &mut self,
        question: ProbeQuestion,
        answers: Vec<ProbeAnswer>,
    ) -> Result<(), ProbeError> {
        let (expected, found) = (question.places.len(), answers.len());
        if expected != found {
            return Err(ProbeError { expected, found });
        }
        let part = ProbePart {
            answers: Arc::new(answers),
            ..ProbePart::default()
        };
        self.fill_part(question, part)
    }

    /// As [`Self::fill`], of some of the places: who cannot answer all of a crowd in one frame answers
    /// them in turn.
    ///
    /// # Errors
    /// [`ProbeError`] if there are more answers than places from the part's first on; nothing is taken
    /// then.
    pub fn fill_part(
        &mut self,
        question: ProbeQuestion,
        part: ProbePart,
    ) -> Result<(), ProbeError> {
        let expected = question.places.len().saturating_sub(part.first as usize);
        let found = part.answers.len();
        if found > expected {
            return Err(ProbeError { expected, found });
        }
        self.inbox.push((question, part));
        Ok(())
    }

    /// What has been handed in; the inbox is empty afterwards.
    pub(super) fn take_inbox(&mut self) -> Vec<(ProbeQuestion, ProbePart)> {
        std::mem::take(&mut self.inbox)
    }

    /// The next frame; nothing has changed in it yet.
    pub(super) fn begin(&mut self) {
        self.frame = self.frame.wrapping_add(1);
        self.changed = 0..0;
    }

    /// A slot for a new probe.
    pub(super) fn allot(&mut self, entity: Entity) -> u32 {
        let slot = Slot {
            entity: Some(entity),
            since: self.frame,
            place: DVec2::NAN,
            frame: self.frame,
            waiting: false,
        };
        if let Some(free) = self.free.pop() {
            self.slots[free as usize] = slot;
            return free;
        }
        self.slots.push(slot);
        Arc::make_mut(&mut self.places).push(GroundPoint::default());
        (self.slots.len() - 1) as u32
    }

    /// Takes a slot back.
    fn free(&mut self, index: u32) {
        if let Some(slot) = self.slots.get_mut(index as usize)
            && slot.entity.take().is_some()
        {
            self.waiting -= usize::from(std::mem::take(&mut slot.waiting));
            self.free.push(index);
        }
    }

    /// A probe is somewhere else.
    pub(super) fn ask(&mut self, index: u32, place: DVec2) {
        let frame = self.frame;
        let Some(slot) = self.slots.get_mut(index as usize) else {
            return;
        };
        self.waiting += usize::from(!slot.waiting);
        (slot.place, slot.frame, slot.waiting) = (place, frame, true);
        Arc::make_mut(&mut self.places)[index as usize] = GroundPoint::new(place);
        self.changed = if self.changed.is_empty() {
            index..index + 1
        } else {
            self.changed.start.min(index)..self.changed.end.max(index + 1)
        };
    }

    /// The true surface is another one: all wait again.
    pub(super) fn ask_all(&mut self) {
        self.waiting = 0;
        let frame = self.frame;
        for slot in &mut self.slots {
            slot.waiting = slot.entity.is_some();
            slot.frame = frame;
            self.waiting += usize::from(slot.waiting);
        }
    }

    /// The true surface is another one within these rectangles: probes there wait again.
    pub(super) fn ask_within(&mut self, rects: &[GroundRect]) {
        let frame = self.frame;
        for slot in &mut self.slots {
            let meets = slot.entity.is_some() && rects.iter().any(|rect| rect.contains(slot.place));
            if meets {
                self.waiting += usize::from(!slot.waiting);
                (slot.waiting, slot.frame) = (true, frame);
            }
        }
    }

    /// Whether the answers of `frame` are of the probe that has the slot now.
    pub(super) fn is_of_owner(&self, index: u32, frame: u32) -> bool {
        let slot = self.slots.get(index as usize);
        // Wrapping: half of the range back is "before".
        slot.is_some_and(|slot| frame.wrapping_sub(slot.since) < 1 << 31)
    }
}
