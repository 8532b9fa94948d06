//! Clips: the file's curves are sampled, and keys are chosen that keep to an error at the skin.

mod choose;
mod clip;
mod fit;
mod grid;
mod keys;
mod metric;
mod pack;
mod parts;
mod play;
mod reduce;
mod refine;
mod sample;
mod spend;
mod steps;
mod value;
mod work;

pub(crate) use clip::clip;
pub(crate) use grid::Stretch;
pub(crate) use keys::{BLENDS, MOVES};
pub(crate) use metric::{SHELL, Shells, order};
pub(crate) use parts::{in_parts, threads};
pub(crate) use play::{Player, Pose, play};
pub(crate) use reduce::Reduced;
pub(crate) use refine::Source;
pub(crate) use sample::{MorphCurves, Samples, Take};
