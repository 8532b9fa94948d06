//! Leaves: systems that work on all agents that are at one leaf.

use super::mind::{BehaviourId, Status};
use super::program::Program;
use crate::names::Key;
use crate::value::{Typed, Value};
use bevy::ecs::prelude::*;
use bevy::ecs::system::SystemId;
use bevy::platform::collections::HashMap;
use std::sync::Arc;

/// Why a leaf is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Phase {
    /// The agent comes to it.
    Start,
    /// It said [`Status::Running`] in the tick before.
    Continue,
    /// It ran, and the agent turned to something else: what it says now is not heard.
    Stop,
}

/// One agent at a leaf.
#[derive(Clone, Copy, Debug)]
pub struct LeafCall {
    /// Who.
    pub agent: Entity,
    /// Why.
    pub phase: Phase,
    /// What the leaf answers; [`Status::Running`] if it says nothing.
    pub status: Status,
    pub(super) behaviour: BehaviourId,
    pub(super) node: u16,
}

/// The parameters of a leaf where it stands in the tree.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parameters<'a>(&'a [(Key, Value)]);

impl Parameters<'_> {
    /// One of this type.
    #[must_use]
    pub fn get<T: Typed>(&self, name: Key) -> Option<T> {
        let pair = self.0.iter().find(|pair| pair.0 == name);
        pair.and_then(|pair| T::read(pair.1))
    }

    /// One as a number.
    #[must_use]
    pub fn number(&self, name: Key) -> Option<f32> {
        let pair = self.0.iter().find(|pair| pair.0 == name);
        pair.map(|pair| pair.1.number())
    }
}

/// Everybody who is at a leaf in this round.
#[derive(Debug, Default)]
pub struct LeafBatch {
    pub(super) calls: Vec<LeafCall>,
    pub(super) programs: Vec<Arc<Program>>,
    /// Seconds of a step.
    pub seconds: f32,
}

impl LeafBatch {
    /// Each agent, with the parameters of its node.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (&mut LeafCall, Parameters<'_>)> {
        let programs = &self.programs;
        self.calls.iter_mut().map(|call| {
            let program = programs.get(usize::from(call.behaviour.0));
            let all = program.map_or(&[][..], |program| program.parameters(call.node));
            (call, Parameters(all))
        })
    }

    /// How many there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.calls.len()
    }

    /// Whether there is nobody.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.calls.is_empty()
    }
}

/// A system that works on a [`LeafBatch`].
pub(super) type LeafSystem = SystemId<InMut<'static, LeafBatch>, ()>;

/// The leaves of an app.
#[derive(Resource, Default)]
pub struct Leaves {
    numbers: HashMap<Box<str>, u16>,
    pub(super) systems: Vec<LeafSystem>,
}

impl Leaves {
    /// The number of a leaf.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<u16> {
        self.numbers.get(name).copied()
    }

    /// The name of a leaf.
    #[must_use]
    pub fn name(&self, number: u16) -> Option<&str> {
        let mut all = self.numbers.iter();
        let (name, _) = all.find(|(_, known)| **known == number)?;
        Some(name)
    }

    /// A leaf takes the place of one of the same name.
    pub(super) fn add(&mut self, name: &str, system: LeafSystem) {
        if let Some(&number) = self.numbers.get(name) {
            self.systems[usize::from(number)] = system;
        } else {
            self.numbers.insert(name.into(), self.systems.len() as u16);
            self.systems.push(system);
        }
    }

    /// How many there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.systems.len()
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.systems.is_empty()
    }
}
