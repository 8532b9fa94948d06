//! FLIP: how different two images look to a person who flips between them.
//!
//! P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild, "FLIP: A difference evaluator for
//! alternating images", HPG 2020, for images of `0..=1` (LDR). P. Andersson, J. Nilsson, P. Shirley, T. Akenine-Möller,
//! "Visualizing errors in rendered high dynamic range images", Eurographics 2021, for radiance (HDR). In f64; it agrees
//! with the reference implementation, which is in f32, to 5e-6 in each pixel (`tests/flip`).
//!
//! A pixel that is no number has the error 1 and counts as black for its neighbours.

mod colour;
mod filter;
mod hdr;
mod ldr;

pub use hdr::{Exposures, HdrFlip, ToneMap, exposures, hdr, hdr_with};
pub use ldr::{Flip, ldr};

/// Pixels in a degree of the field of view, for 0.7 m before a monitor 0.7 m wide with 3840 pixels.
pub const PIXELS_PER_DEGREE: f64 = 67.020_643_276_582_25;
