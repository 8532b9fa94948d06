//! Gradient noise of our own: integer lattice coordinates, PCG hashing, value and exact gradient
//! in one evaluation, the same function in scalar f32, vectors of f32, f64 and WGSL.
//!
//! | file | what |
//! |---|---|
//! | `coordinate` | 32.32 fixed-point positions to lattice cells, exact at any distance |
//! | `hash` | PCG |
//! | `real` | one formula for one lane or many |
//! | `lattice` | noise in a cell: value, gradient, Hessian |
//! | `fractal` | settings and their checks |
//! | `octave` | the octave table |
//! | `sum` | how an octave joins FBM, ridged, billow, eroded sums |
//! | `scalar` | one point in f32 |
//! | `tile`, `points` | many points in f32 |
//! | `oracle` | one point in f64, by other formulas |
//! | `permutation` | the permutation-table noise of the literature |
//! | `shuffle` | its permutation, by Mersenne Twister |

pub mod coordinate;
pub mod fractal;
pub mod hash;
mod lattice;
mod octave;
pub(crate) mod oracle;
pub mod permutation;
pub(crate) mod points;
mod real;
mod scalar;
mod shuffle;
pub(crate) mod sum;
pub(crate) mod tile;

pub use coordinate::Frequency;
pub use fractal::{Fractal, NoiseError, PreparedFractal, Sum, Warp};
pub use octave::{Octave, PreparedWarp};
pub use permutation::{PermutationNoise, PreparedPermutation};
