//! The classic scene: one square of ground in 64 × 64 patches, whose levels follow distance and relief
//! as hardware tessellation of terrain is commonly shown. One surface and one path to compare methods
//! on; the surface is read from a file, its README is the scene's definition.
//!
//! | part | what it does |
//! |---|---|
//! | [`heights`] | the samples and the surface through them |
//! | [`functions`] | levels and vertices of a patch, in Rust: the CPU reference of `shaders/src/classic/functions.wgsl` |
//!
//! Conventions: metres; x and z from −512 to 512, the origin in the middle; +y up.

pub mod functions;
pub mod heights;
pub mod render;

pub use functions::{CLASSIC_LAYOUT, CLASSIC_SPACING, ClassicLevels, ClassicScene, STATIC_LEVEL};
pub use heights::{ClassicHeights, ClassicHeightsError};
