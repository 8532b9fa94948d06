//! Study `tessellation`: is the stage what OpenGL and Vulkan specify, on the CPU and on the adapter?
//!
//! | module | what |
//! |---|---|
//! | [`study`] | the study: random patches, their faults, the error of their coordinates |
//! | [`random`] | what is tessellated |
//! | [`expected`] | levels and counts, written anew from the specification |
//! | [`rules`] | the invariance rules of the specification |
//! | [`outline`] | which vertices and triangles lie at which side |
//! | [`rational`] | where vertices lie, in rational numbers |
//! | [`report`] | tallies, rows, figure, summary |
//! | [`check`] | exact cover, winding, the distance to a capture |
//! | [`cases`], [`captures`] | captured patches and their comparison |
//! | [`wgsl`] | the WGSL on an adapter |

pub mod captures;
pub mod cases;
pub mod check;
pub mod expected;
pub mod outline;
pub mod random;
pub mod rational;
pub mod report;
pub mod rules;
pub mod study;
pub mod wgsl;

pub use study::STUDY;
