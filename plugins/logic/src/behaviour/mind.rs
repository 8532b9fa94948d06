//! What an agent keeps of its behaviour.

use super::program::NONE;
use crate::values::{Logic, Values};
use bevy::ecs::prelude::*;

/// What became of a node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Status {
    /// It goes on in the next tick.
    #[default]
    Running,
    /// It is done.
    Success,
    /// It cannot be done.
    Failure,
}

/// The number of a behaviour in an app.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BehaviourId(pub(super) u16);

/// An agent that follows a behaviour. One entity, however large its tree is.
#[derive(Component, Clone, Debug, PartialEq, Eq)]
#[require(Logic, Values)]
pub struct Mind {
    pub(super) behaviour: BehaviourId,
    /// Which edition of it the numbers below belong to; 0 before the first tick.
    pub(super) edition: u32,
    /// The node that runs.
    pub(super) running: u16,
    /// The leaf that ran and was left in this tick, and its node.
    pub(super) stopped: (u16, u16),
    /// Since which step.
    pub(super) since: u32,
    pub(super) status: Status,
    /// The leaf that runs, so that it can be told to stop when the behaviour is another one by now.
    pub(super) leaf: u16,
    /// The node where the first part of this tick's way stopped.
    pub(super) way: u16,
    /// Steps that cooldowns and limits keep.
    slots: Box<[u32]>,
}

impl Mind {
    /// Follows a behaviour from its root on.
    #[must_use]
    pub fn new(behaviour: BehaviourId) -> Self {
        Self {
            behaviour,
            edition: 0,
            running: NONE,
            stopped: (NONE, NONE),
            since: 0,
            status: Status::Running,
            leaf: NONE,
            way: NONE,
            slots: Box::default(),
        }
    }

    /// Which behaviour.
    #[must_use]
    pub const fn behaviour(&self) -> BehaviourId {
        self.behaviour
    }

    /// What became of its tree in the last tick.
    #[must_use]
    pub const fn status(&self) -> Status {
        self.status
    }

    /// The node that runs, in the order in which nodes are written; `None` between two rounds of its tree.
    #[must_use]
    pub fn running(&self) -> Option<u16> {
        (self.running != NONE).then_some(self.running)
    }

    /// From the root on in the next tick.
    pub(super) fn restart(&mut self, edition: u32, slots: u16) {
        self.edition = edition;
        // Its node is one of another program.
        self.stopped = (self.leaf, NONE);
        self.leaf = NONE;
        self.running = NONE;
        self.slots = vec![0; usize::from(slots)].into_boxed_slice();
    }

    pub(super) fn slot(&self, slot: u16) -> u32 {
        self.slots.get(usize::from(slot)).copied().unwrap_or(0)
    }

    pub(super) fn set_slot(&mut self, slot: u16, step: u32) {
        if let Some(kept) = self.slots.get_mut(usize::from(slot)) {
            *kept = step;
        }
    }

    /// Words for a hash of the state.
    pub(crate) fn bits(&self) -> [u32; 3] {
        let nodes = u32::from(self.running) << 16 | u32::from(self.leaf);
        [nodes, self.since, self.status as u32]
    }
}
