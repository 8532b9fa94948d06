//! What tests and studies share. Plugins have it as a dev-dependency; nothing that ships uses it.
//!
//! | module | feature | what |
//! |---|---|---|
//! | [`gpu`] | | compute shaders on whatever adapter there is, without a window |
//! | [`metrics`] | | errors, medians, hashes |
//! | [`random`] | | inputs that are the same everywhere |
//! | [`double_double`] | | numbers of 106 bits |
//! | [`sweeps`] | | when a moving ellipsoid touches a triangle, in those |
//! | [`hostile`], [`places`] | | sweeps that are hard to get right, and what random geometry is made of |
//! | [`cores`] | | work on all cores, results in order |
//! | [`mesh`] | | is a mesh closed: edges without a counterpart |
//! | [`logs`] | | warnings and errors of an app, to be counted |
//! | `stage` | `stage` | the passes of the tessellation stage, without Bevy's renderer |
//! | `draw` | `stage` | what they emitted, drawn, stored or evaluated by the draw |
//! | `raster` | `stage` | pixels that triangles leave uncovered |
//! | `blocks` | `detail` | the passes that choose the ground's detail in blocks, and answer places |
//! | `missed` | `detail` | places of a ground of which samples say too little |
//! | `skinning` | `skinning` | skinning from a palette on the adapter, by the CPU reference, and in f64 |
//! | `flip` | `flip` | how far apart two pictures are |
//! | `light` | `light` | scenes of the light oracle in an app, and the radiance that its camera sees |
//!
//! `stage/record.rs`, `blocks/run.rs` and `blocks/answers.rs` are all that records passes.

#[cfg(feature = "detail")]
pub mod blocks;
pub mod cores;
pub mod double_double;
#[cfg(feature = "stage")]
pub mod draw;
#[cfg(feature = "flip")]
pub mod flip;
pub mod gpu;
pub mod hostile;
#[cfg(feature = "light")]
pub mod light;
pub mod logs;
pub mod mesh;
pub mod metrics;
#[cfg(feature = "detail")]
pub mod missed;
pub mod places;
pub mod random;
#[cfg(feature = "stage")]
pub mod raster;
#[cfg(feature = "skinning")]
pub mod skinning;
#[cfg(feature = "stage")]
pub mod stage;
pub mod sweeps;
