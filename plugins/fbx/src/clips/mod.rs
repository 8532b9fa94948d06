//! Clips: the file's curves are sampled, and keys are chosen that keep to an error at the skin.

mod choose;
mod fit;
mod grid;
mod keys;
mod metric;
mod parts;
mod play;
mod reduce;
mod refine;
mod sample;
mod spend;
mod value;
mod work;

pub(crate) use metric::{Shells, order};
pub(crate) use play::{Player, play};
pub(crate) use reduce::{Reduced, leverage, reduce};
pub(crate) use refine::{Source, refine};
pub(crate) use sample::{Samples, sample};
