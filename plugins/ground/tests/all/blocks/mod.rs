//! The level of detail in blocks through its passes, on whatever adapter there is.

mod aligned;
mod answers;
mod culled;
mod edited;
mod near;
mod reference;
mod room;
pub mod support;
mod tiled;
mod times;
