//! The syntax of a file, as far as is wanted that ufbx does not hand on: how large it is unpacked, and
//! numbers that ufbx keeps as flags.
//!
//! A file is a tree of named nodes with values. Both forms are walked from front to back without a tree
//! in memory. Whatever is wrong ends the walk: ufbx says what it is.

mod ascii;
mod binary;
mod smoothing;

pub(crate) use binary::unpacked;
pub(crate) use smoothing::{Smoothing, smoothing_groups};

/// What a node holds besides other nodes.
#[derive(Clone, Copy)]
enum Values<'a> {
    /// Properties of a binary node, and how many.
    Binary(&'a [u8], usize),
    /// Text between the name and what comes next.
    Text(&'a [u8]),
}

/// Calls `take` for every node with its depth (0 at the top), its name and its values.
fn walk<'a>(bytes: &'a [u8], take: &mut impl FnMut(usize, &'a [u8], Values<'a>)) {
    match binary::is_binary(bytes) {
        true => binary::walk(bytes, take),
        false => ascii::walk(bytes, take),
    }
}

impl<'a> Values<'a> {
    /// The last string, as it lies in the file.
    fn last_string(self) -> Option<&'a [u8]> {
        match self {
            Self::Binary(bytes, count) => binary::last_string(bytes, count),
            Self::Text(text) => ascii::last_string(text),
        }
    }

    /// All numbers, whole ones; what is none is left out.
    fn numbers(self) -> Vec<i64> {
        match self {
            Self::Binary(bytes, count) => binary::numbers(bytes, count),
            Self::Text(text) => ascii::numbers(text),
        }
    }
}
