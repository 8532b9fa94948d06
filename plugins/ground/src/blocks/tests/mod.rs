//! What must hold of blocks, on small grounds and pictures; each with a version that does not.

pub mod eyes;
pub mod grounds;
mod guarantee;
mod near;
mod nested;
pub mod remade;
mod stated;
mod still;
mod surface;
