//! Why a behaviour was refused.

use thiserror::Error;

/// A behaviour that was not taken; the last good one of the same file stays.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{file}:{line}:{column}: {reason}")]
pub struct BehaviourError {
    /// The file, or the name that the text was given.
    pub file: String,
    /// From 1 on; 0 where the file could not be read.
    pub line: usize,
    /// In characters, from 1 on.
    pub column: usize,
    /// What is wrong there.
    pub reason: Reason,
}

/// What is wrong with a behaviour.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Reason {
    /// The file cannot be read.
    #[error("the file cannot be read: {0}")]
    Read(String),
    /// Not RON, or not a behaviour.
    #[error("{0}")]
    Syntax(String),
    /// No tree of this name.
    #[error("there is no tree `{0}`")]
    UnknownTree(String),
    /// No system was added for this leaf.
    #[error("there is no leaf `{0}`; a system for it has to be added before")]
    UnknownLeaf(String),
    /// A value that the file does not declare.
    #[error("the value `{0}` is not declared under `values`")]
    UnknownValue(String),
    /// A tree that is part of itself.
    #[error("a loop of trees: {}", .0.join(" → "))]
    Loop(Vec<String>),
    /// Two of the same name.
    #[error("`{0}` is there twice")]
    Twice(String),
    /// NaN or infinite.
    #[error("a number of `{0}` is not finite")]
    NotFinite(String),
    /// A time or a part that means nothing.
    #[error("`{name}` needs {needs}")]
    Range {
        /// What of.
        name: String,
        /// What it has to be.
        needs: &'static str,
    },
    /// A node without children.
    #[error("a {0} without children")]
    Empty(&'static str),
    /// Too many nodes, once trees are put where they are used.
    #[error("more than {0} nodes, with each tree as often as it is used")]
    TooLarge(usize),
    /// Too many nodes in each other, once trees are put where they are used.
    #[error("more than {0} nodes in each other")]
    TooDeep(usize),
    /// A value of another kind than it is declared with.
    #[error("`{name}` is declared as a {has}, and not a {given}")]
    Kind {
        /// Which value.
        name: String,
        /// As it is declared.
        has: String,
        /// As it is used.
        given: String,
    },
}

/// Line and column, from 1 on, of a piece of a text.
pub(super) fn place_of(text: &str, piece: &str) -> (usize, usize) {
    // Names are borrowed from the text that was read, so that where they lie says where they stand.
    let offset = (piece.as_ptr() as usize).wrapping_sub(text.as_ptr() as usize);
    let before = text.get(..offset).unwrap_or("");
    let line = before.matches('\n').count() + 1;
    let start = before.rfind('\n').map_or(0, |at| at + 1);
    (line, before[start..].chars().count() + 1)
}
