//! Triangles that the GPU makes, drawn for Bevy as it draws meshes.
//!
//! A **producer** makes vertices and indices in compute passes: the tessellation stage, the drawn ground,
//! or one of your own. This crate owns everything after that: the **pools** that a view keeps them in, the
//! indirect **draws** into Bevy's G-buffer, its shadow maps and pictures without a G-buffer, **counters**
//! on their way back, and a **budget** that moves a producer's tolerance so that a measured time is held.
//! Lights, fog, depth and post-processing stay Bevy's own.
//!
//! Nothing exists on the GPU until a camera has a [`GeometryCamera`] and a producer wants to draw there.
//!
//! | part | what it does |
//! |---|---|
//! | [`GeometryCamera`] | makes a camera see what producers make |
//! | [`layout`] | what draws are told and what producers write, byte for byte as in `shaders/src/geometry` |
//! | [`vertex`] | the words of a stored vertex |
//! | [`ring`] | what the GPU wrote, on its way back without anybody waiting |
//! | [`budget`] | a controller that moves a tolerance so that a time is held |
//! | [`once`] | where a pixel's surface is, by its depth: surfaces that are shaded once a pixel |
//! | `render` | pools, draws and counters (feature `render`) |

pub mod budget;
mod components;
pub mod layout;
pub mod once;
#[cfg(feature = "render")]
pub mod render;
pub mod ring;
pub mod vertex;

pub use components::GeometryCamera;
#[cfg(feature = "render")]
pub use render::{GeometryPlugin, GeometryStats};
