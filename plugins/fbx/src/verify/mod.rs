//! A clip's keys, as they are written, held against the file's curves.
//!
//! Nothing of how the keys were chosen is asked: neither the samples nor the errors over them, but only the
//! file's curves, the channels and where the file's keys are. Every time between two keys, of the file's or
//! of the result's, is looked at at pseudo-random places, at several for a quarter turn of what turns
//! fastest; around the largest errors the largest is searched for. The distance is that of shells around
//! joints, and at the worst times that of the vertices themselves: if these are further off than their
//! shells say, all distances are taken to be that much larger.

mod actors;
mod search;
mod skin;
mod times;

pub(crate) use times::{Checked, check, dice, doubts};
