//! Clips: the file's curves are sampled, and keys are chosen that keep to an error at the skin.

mod choose;
mod fit;
mod grid;
mod metric;
mod play;
mod reduce;
mod sample;
mod value;

pub(crate) use metric::{Shells, order};
pub(crate) use play::{Player, play};
pub(crate) use reduce::{Reduced, reduce};
pub(crate) use sample::{Samples, sample};
