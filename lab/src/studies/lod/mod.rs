//! Level of detail of a terrain: vertices against the largest error in pixels.
//!
//! Every method draws the same terrain for the same camera; its one knob is turned until the largest
//! error over the same places is the wanted one ([`mod@tune`]); then vertices are compared. An error is
//! the distance on the screen between the true surface and the drawn one at a place of the ground
//! ([`mod@measure`]). Errors are worked out on the CPU in f64.
//!
//! | module | what |
//! |---|---|
//! | [`mod@measure`] | what errors come to |
//! | [`baseline`] | what a method offers |
//! | [`uniform`], [`cdlod`], [`bisected`] | a static grid; CDLOD; equal edges and greedy |
//! | [`bisection`] | the triangles of the last two |
//! | [`mod@tune`], [`mod@compare`] | turns the knob; all methods under all cameras |
//! | [`ours`] | our choice in blocks, with its three metrics |
//! | [`mod@judge`] | a drawn surface against the ground: errors, holes |
//! | [`mod@guarantee`] | is any error above the tolerance: many cameras, many places |
//! | [`mod@drawn`], [`mod@soak`] | the same of the triangles that the adapter drew, for as long as one likes |
//! | [`mod@cracks`], [`mod@pops`] | gaps in meshes; movement from frame to frame |
//! | [`precision`], [`mod@speed`] | a million metres away; times on the CPU |
//! | [`mod@passes`] | times of the choice on the adapter |
//! | [`mod@run`], [`report`] | the study, and what is told of it |

#![expect(
    clippy::disallowed_methods,
    reason = "f64 measurements: the last bit of a logarithm or a tangent decides nothing"
)]

pub mod baseline;
pub mod bisected;
pub mod bisection;
pub mod cdlod;
pub mod compare;
pub mod cracks;
pub mod drawn;
pub mod guarantee;
pub mod judge;
pub mod measure;
pub mod ours;
pub mod passes;
pub mod pops;
pub mod precision;
pub mod report;
pub mod run;
pub mod soak;
pub mod speed;
pub mod tune;
pub mod uniform;

pub use run::STUDY;
