//! The GPU half: the programmable tessellation [`stage`], and the [`ground`] as one of its kinds.

pub mod ground;
pub mod stage;
