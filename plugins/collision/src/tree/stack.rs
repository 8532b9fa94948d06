//! What a traversal has still to look at.

use std::cell::Cell;

/// A node or a leaf, and what it is sorted by: a time, or a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Smallest first.
    pub key: f32,
    /// See `Node::first`.
    pub first: u32,
    /// See `Node::count`.
    pub count: u32,
}

impl Entry {
    /// The node that everything is below.
    pub const ROOT: Self = Self {
        key: f32::NEG_INFINITY,
        first: 0,
        count: 0,
    };
}

thread_local! {
    static SPARE: Cell<Vec<Entry>> = const { Cell::new(Vec::new()) };
}

/// Lends the stack of this thread, empty. A query from within a query gets another one.
#[inline]
pub fn with<R>(work: impl FnOnce(&mut Vec<Entry>) -> R) -> R {
    let mut stack = SPARE.take();
    stack.clear();
    let result = work(&mut stack);
    SPARE.set(stack);
    result
}

/// Puts entries on the stack, the greatest key first, so that the smallest is taken first. Of equal keys the earlier
/// entry is taken first.
#[inline]
pub fn push_sorted(stack: &mut Vec<Entry>, entries: impl Iterator<Item = Entry>) {
    let start = stack.len();
    for entry in entries {
        let mut at = stack.len();
        stack.push(entry);
        while at > start && stack[at - 1].key <= entry.key {
            stack[at] = stack[at - 1];
            at -= 1;
        }
        stack[at] = entry;
    }
}
