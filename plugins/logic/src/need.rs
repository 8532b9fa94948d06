//! Who is worked on how often: near a focus every step, far from it rarely, asleep never.
//!
//! Who sleeps is in another table of the world, which behaviours, sight, memories, walkers, patrols and attention do not
//! go over, so that these cost nothing of it in a step. What it has of ready-made parts goes on: timers, doors, lifts,
//! zones and hitboxes work, it can be seen, and its ears hear. Any action on it wakes it, as does a noise that it could
//! hear.

use crate::action::Action;
use crate::clock::LogicClock;
use crate::names::Key;
use crate::values::Logic;
use bevy::ecs::prelude::*;
use bevy::math::Vec3;
use bevy::reflect::prelude::*;
use bevy::transform::components::Transform;

/// What attention is paid around: the player, a camera.
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Clone)]
#[require(Logic, Transform)]
pub struct Focus;

/// How often an agent is worked on. Without it: every step. Set by distance to the nearest [`Focus`], or by hand where
/// `fixed`.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
#[require(Logic)]
pub struct Attention {
    /// In every n-th step.
    every: u32,
    /// Which of them, so that not all have their turn in the same step.
    phase: u32,
    /// Whether distance does not change it.
    pub fixed: bool,
}

impl Default for Attention {
    fn default() -> Self {
        Self {
            every: 1,
            phase: 0,
            fixed: false,
        }
    }
}

impl Attention {
    /// In every n-th step; 0 counts as 1.
    #[must_use]
    pub const fn every(steps: u32) -> Self {
        Self {
            every: if steps == 0 { 1 } else { steps },
            phase: 0,
            fixed: true,
        }
    }

    /// In every how many steps.
    #[inline]
    #[must_use]
    pub const fn steps(&self) -> u32 {
        self.every
    }

    /// Whether this step is one of them.
    #[inline]
    #[must_use]
    pub const fn is_due(&self, step: u64) -> bool {
        self.every == 1
            || (step as u32)
                .wrapping_add(self.phase)
                .is_multiple_of(self.every)
    }
}

/// Thinks, sees and walks no more until an action or a noise wakes it.
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Clone)]
#[require(Logic)]
pub struct Asleep;

/// What distance means.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct AttentionSettings {
    /// Metres to a focus up to which every step counts; twice as far every second one does, and so on.
    pub near: f32,
    /// At most this many steps.
    pub most: u32,
}

impl Default for AttentionSettings {
    /// 64 m, and every 16th step.
    fn default() -> Self {
        Self {
            near: 64.0,
            most: 16,
        }
    }
}

/// Steps from one look at distances to the next.
const LOOK: u64 = 16;

/// Whether distances are looked at in this step: a run condition.
pub(crate) fn looks(clock: Res<LogicClock>, focus: Query<(), With<Focus>>) -> bool {
    clock.step % LOOK == 1 && !focus.is_empty()
}

/// Pays attention by distance.
pub(crate) fn pay(
    settings: Res<AttentionSettings>,
    focuses: Query<&Transform, With<Focus>>,
    mut agents: Query<(Entity, &mut Attention, &Transform), Without<Asleep>>,
) {
    let near = settings.near.max(1e-3);
    let places: Vec<Vec3> = focuses.iter().map(|at| at.translation).collect();
    for (entity, mut attention, at) in &mut agents {
        if attention.fixed {
            continue;
        }
        let least = places
            .iter()
            .map(|place| place.distance(at.translation))
            .fold(f32::INFINITY, f32::min);
        let mut every = 1;
        // Who has no place is as far away as can be.
        while least > near * every as f32 && every < settings.most {
            every = every.saturating_mul(2).min(settings.most);
        }
        let phase = entity.index_u32();
        if attention.every != every || attention.phase != phase {
            attention.every = every;
            attention.phase = phase;
        }
    }
}

/// Wakes whom an action is on, and puts to sleep who is asked to.
pub(crate) fn wake(
    mut actions: MessageReader<Action>,
    asleep: Query<(), With<Asleep>>,
    logic: Query<(), With<Logic>>,
    mut commands: Commands,
) {
    // The last action on an entity counts.
    for action in actions.read() {
        let sleeps = action.verb == Key::SLEEP;
        if sleeps && logic.contains(action.target) {
            // Somebody else may have asked for its end in the same step.
            commands.entity(action.target).try_insert(Asleep);
        } else if !sleeps
            && (asleep.contains(action.target) || action.verb == Key::WAKE)
            && let Ok(mut entity) = commands.get_entity(action.target)
        {
            entity.try_remove::<Asleep>();
        }
    }
}
