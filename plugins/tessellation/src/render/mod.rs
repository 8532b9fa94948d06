//! The GPU half: the programmable tessellation [`stage`], the [`ground`] as one of its kinds, and the
//! [`classic`] scene as another.

pub mod classic;
pub mod ground;
pub mod stage;
