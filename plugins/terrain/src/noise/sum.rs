//! How one octave joins the sum, for each kind of sum, with the exact gradient.
//!
//! Conventions: the state of a sum is up to eight numbers a sample; value in metres, gradients in
//! metres a metre, Hessians in 1/metre. An octave's noise comes in lattice units.

use super::coordinate::Frequency;
use super::fractal::Sum;
use super::lattice::Place;
use super::real::Real;

/// Most octaves of a fractal: below the 24th the amplitude of gain ½ is gone in f32.
pub const MAX_OCTAVES: usize = 24;

/// Numbers of state a sample.
pub(crate) const STATE: usize = 8;

/// ε² of the smooth |n| = √(n² + ε²), ε = 1/32: crests are rounded over about 3 % of a cell to
/// either side, and |n|″ ≤ 1/ε keeps the gradient's f32 error within 32 times the value's.
pub(crate) const SMOOTH_SQUARED: f32 = 1.0 / 1024.0;

/// The factors of an octave, in f32 as every implementation uses them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    /// Metres.
    pub amplitude: f32,
    /// Cells a metre.
    pub frequency: f32,
    /// Amplitude × frequency.
    pub slope: f32,
    /// Slope as a share of the first octave's.
    pub relative: f32,
}

impl Scale {
    /// `first` is the slope of the first octave, metres a metre.
    pub(crate) fn new(amplitude: f64, frequency: Frequency, first: f64) -> Self {
        let slope = amplitude * frequency.value();
        // A warp of strength 0 has no slope to compare with.
        let relative = if first == 0.0 { 0.0 } else { slope / first };
        Self {
            amplitude: amplitude as f32,
            frequency: frequency.value() as f32,
            slope: slope as f32,
            relative: relative as f32,
        }
    }
}

/// A kind of sum. State 0, 1, 2 are always value, ∂/∂x, ∂/∂z.
pub(crate) trait Kind: Copy + Send + Sync {
    /// How many numbers of the state are in use.
    const USED: usize;
    /// The state before the first octave.
    const START: [f32; STATE] = [0.0; STATE];
    /// Adds an octave.
    fn step<F: Real>(state: &mut [F; STATE], place: &Place<F>, scale: &Scale, erosion: f32);
}

/// [`Sum::Fbm`].
#[derive(Clone, Copy)]
pub(crate) struct Fbm;

impl Kind for Fbm {
    const USED: usize = 3;

    #[inline(always)]
    fn step<F: Real>(state: &mut [F; STATE], place: &Place<F>, scale: &Scale, _: f32) {
        let noise = place.noise();
        state[0] = state[0] + noise.value * scale.amplitude;
        state[1] = state[1] + noise.dx * scale.slope;
        state[2] = state[2] + noise.dz * scale.slope;
    }
}

/// |n| made smooth and its derivative: √(n² + ε²), n/√(n² + ε²).
#[inline(always)]
fn smooth_abs<F: Real>(n: F) -> (F, F) {
    let length = (n * n + SMOOTH_SQUARED).sqrt();
    (length, n / length)
}

/// [`Sum::Billow`].
#[derive(Clone, Copy)]
pub(crate) struct Billow;

impl Kind for Billow {
    const USED: usize = 3;

    #[inline(always)]
    fn step<F: Real>(state: &mut [F; STATE], place: &Place<F>, scale: &Scale, _: f32) {
        let noise = place.noise();
        let (length, turn) = smooth_abs(noise.value);
        let turn = turn * 2.0 * scale.slope;
        state[0] = state[0] + (length * 2.0 - 1.0) * scale.amplitude;
        state[1] = state[1] + noise.dx * turn;
        state[2] = state[2] + noise.dz * turn;
    }
}

/// [`Sum::Ridged`]: state 3, 4, 5 are the weight and its gradient.
#[derive(Clone, Copy)]
pub(crate) struct Ridged;

impl Kind for Ridged {
    const USED: usize = 6;
    const START: [f32; STATE] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0];

    #[inline(always)]
    fn step<F: Real>(state: &mut [F; STATE], place: &Place<F>, scale: &Scale, _: f32) {
        let noise = place.noise();
        let (length, turn) = smooth_abs(noise.value);
        let ridge = length.like(1.0) - length;
        // r² and its gradient, 2r·(−n/|n|)·∇n.
        let square = ridge * ridge;
        let turn = ridge * turn * (-2.0 * scale.frequency);
        let (dx, dz) = (noise.dx * turn, noise.dz * turn);
        let [_, _, _, weight, weight_x, weight_z, ..] = *state;
        state[0] = state[0] + square * weight * scale.amplitude;
        state[1] = state[1] + (dx * weight + square * weight_x) * scale.amplitude;
        state[2] = state[2] + (dz * weight + square * weight_z) * scale.amplitude;
        state[3] = square;
        state[4] = dx;
        state[5] = dz;
    }
}

/// [`Sum::Eroded`]: state 3, 4 are the gathered slope G, state 5, 6, 7 its Jacobian xx, xz, zz
/// (symmetric: a sum of Hessians).
#[derive(Clone, Copy)]
pub(crate) struct Eroded;

impl Kind for Eroded {
    const USED: usize = 8;

    #[inline(always)]
    fn step<F: Real>(state: &mut [F; STATE], place: &Place<F>, scale: &Scale, erosion: f32) {
        let (noise, hessian) = (place.noise(), place.hessian());
        let bend = scale.relative * scale.frequency;
        state[3] = state[3] + noise.dx * scale.relative;
        state[4] = state[4] + noise.dz * scale.relative;
        state[5] = state[5] + hessian.xx * bend;
        state[6] = state[6] + hessian.xz * bend;
        state[7] = state[7] + hessian.zz * bend;
        let [_, _, _, gx, gz, xx, xz, zz] = *state;
        // w = 1/(1 + e|G|²), ∇w = −2e w² J G; the octave is a·n·w.
        let weight = gx.like(1.0) / ((gx * gx + gz * gz) * erosion + 1.0);
        let fall = noise.value * (weight * weight) * (-2.0 * erosion * scale.amplitude);
        let steep = weight * scale.slope;
        state[0] = state[0] + noise.value * weight * scale.amplitude;
        state[1] = state[1] + (noise.dx * steep + (xx * gx + xz * gz) * fall);
        state[2] = state[2] + (noise.dz * steep + (xz * gx + zz * gz) * fall);
    }
}

/// Runs `$body` with the type alias `$kind` bound to the kind of `$sum`.
macro_rules! with_kind {
    ($sum:expr, $kind:ident => $body:expr) => {
        match $sum {
            $crate::noise::fractal::Sum::Fbm => {
                type $kind = $crate::noise::sum::Fbm;
                $body
            }
            $crate::noise::fractal::Sum::Ridged => {
                type $kind = $crate::noise::sum::Ridged;
                $body
            }
            $crate::noise::fractal::Sum::Billow => {
                type $kind = $crate::noise::sum::Billow;
                $body
            }
            $crate::noise::fractal::Sum::Eroded => {
                type $kind = $crate::noise::sum::Eroded;
                $body
            }
        }
    };
}
pub(crate) use with_kind;

impl Sum {
    /// The number that names the sum in a GPU layer.
    pub(crate) const fn code(self) -> u32 {
        match self {
            Self::Fbm => 0,
            Self::Ridged => 1,
            Self::Billow => 2,
            Self::Eroded => 3,
        }
    }
}
