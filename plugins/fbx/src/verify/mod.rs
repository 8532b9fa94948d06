//! A clip's keys, as they are written, held against the file's curves.
//!
//! Nothing of how the keys were chosen is asked: neither the samples nor the errors over them, but only the
//! file's curves, the channels and where the file's keys are. What is off is the farthest of six points 3 cm around every
//! node that moves and of every vertex. Between neighbouring keys the error is bounded by how fast both motions
//! change (`bound.rs`), so that what is stated holds at every time.

mod actors;
mod bodies;
mod bound;
mod chain;
mod found;
mod lengths;
mod moves;
mod places;
mod played;
mod times;

pub(crate) use bodies::Bodies;
pub(crate) use chain::{Chain, down};
pub(crate) use found::{Found, Span, Subject};
pub(crate) use times::{Checked, check, doubts};
