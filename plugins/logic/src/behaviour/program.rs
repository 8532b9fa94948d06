//! A behaviour as it runs: one array of nodes in the order of their tree, each before its children.

use super::spec::Curve;
use crate::names::Key;
use crate::value::Value;

/// Number of no node.
pub(super) const NONE: u16 = u16::MAX;

/// Most nodes, each tree as often as it is used.
pub(super) const MOST_NODES: usize = 4096;

/// What a node does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Op {
    Sequence,
    Select,
    Choose,
    Not,
    Anyway,
    Repeat,
    /// Seconds, and where the agent keeps the step until which it fails.
    Cooldown(f32, u16),
    /// Seconds, and where the agent keeps the step in which it began.
    Limit(f32, u16),
    Above(Key, f32),
    Below(Key, f32),
    Is(Key, Value),
    Known(Key),
    Unknown(Key),
    Set(Key, Value),
    /// Seconds.
    Wait(f32),
    /// Verb, and the value that names the target.
    Send(Key, Key),
    Say(Key),
    /// The leaf's number, and its parameters.
    Do(u16, [u16; 2]),
}

impl Op {
    /// Whether it only looks: asked again while what follows it in a sequence runs.
    pub const fn is_test(&self) -> bool {
        matches!(
            self,
            Self::Above(..) | Self::Below(..) | Self::Is(..) | Self::Known(_) | Self::Unknown(_)
        )
    }
}

/// A factor of a score.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Factor {
    Always(f32),
    Of(Key, Curve),
}

/// A node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Code {
    pub op: Op,
    /// Past its last child's last child: where its next sibling is, if it has one.
    pub end: u16,
    pub parent: u16,
    /// Its score, if it is a child of a `Choose`.
    pub factors: [u16; 2],
}

/// A whole behaviour.
#[derive(Clone, Debug, Default)]
pub struct Program {
    pub(super) nodes: Vec<Code>,
    pub(super) factors: Vec<Factor>,
    pub(super) parameters: Vec<(Key, Value)>,
    pub(super) start: Vec<(Key, Value)>,
    pub(super) slots: u16,
    pub(super) stay: f32,
}

impl Program {
    /// Nodes, each tree as often as it is used.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether it has none, as before the first one was read.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Values that an agent starts with.
    #[must_use]
    pub fn start(&self) -> &[(Key, Value)] {
        &self.start
    }

    /// The leaf of a node.
    pub(super) fn leaf(&self, node: u16) -> Option<u16> {
        match self.nodes.get(usize::from(node))?.op {
            Op::Do(leaf, _) => Some(leaf),
            _ => None,
        }
    }

    /// The parameters of a leaf's node.
    pub(super) fn parameters(&self, node: u16) -> &[(Key, Value)] {
        match self.nodes.get(usize::from(node)).map(|code| code.op) {
            Some(Op::Do(_, [from, to])) => &self.parameters[usize::from(from)..usize::from(to)],
            _ => &[],
        }
    }
}
