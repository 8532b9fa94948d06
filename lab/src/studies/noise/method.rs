//! What the study asks of a noise, ours or another's.
//!
//! All of them make fractal Brownian motion of gradient noise: octaves of gain ½ and lacunarity 2,
//! the first with a wavelength of [`WAVELENGTH`]. The power of two makes the frequency exact in
//! every format, so that nothing but the method's own arithmetic is wrong.

use super::points::Points;
use bevy::math::DVec2;
use std::time::Instant;

/// Wavelength of the first octave, metres.
pub const WAVELENGTH: f64 = 256.0;

/// Ratio of amplitudes of successive octaves.
pub const GAIN: f64 = 0.5;

/// Ratio of frequencies of successive octaves.
pub const LACUNARITY: f64 = 2.0;

/// Results of one evaluation; a method fills the ones of its own type.
#[derive(Debug, Clone, Default)]
pub struct Output {
    /// Values of methods that compute in f32.
    pub values: Vec<f32>,
    /// Gradients along x, per metre, where they were asked for and are offered.
    pub dx: Vec<f32>,
    /// The same along z.
    pub dz: Vec<f32>,
    /// Values of methods that compute in f64.
    pub values_f64: Vec<f64>,
}

impl Output {
    /// Room for `count` results. Filled with NaN: a result that is not written is seen as wrong.
    pub fn new(count: usize) -> Self {
        Self {
            values: vec![f32::NAN; count],
            dx: vec![f32::NAN; count],
            dz: vec![f32::NAN; count],
            values_f64: vec![f64::NAN; count],
        }
    }
}

/// A result of a method's definition, or of a method, in f64.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exact {
    /// In the method's own unit.
    pub value: f64,
    /// Per metre; `None` where the definition has none.
    pub gradient: Option<DVec2>,
}

/// A noise with its settings.
pub trait Method {
    /// As tables and legends say it.
    fn name(&self) -> &'static str;

    /// What it runs on.
    fn device(&self) -> String {
        "CPU, 1 core".to_owned()
    }

    /// Bytes that it keeps: tables and parameters.
    fn bytes(&self) -> usize;

    /// Amplitude of the first octave, in the unit of its values: errors are relative to it.
    fn amplitude(&self) -> f64;

    /// Whether it computes in f64 ([`Output::values_f64`]).
    fn is_f64(&self) -> bool {
        false
    }

    /// Whether it gives gradients.
    fn has_gradient(&self) -> bool {
        false
    }

    /// Whether it can be asked for these points.
    fn takes(&self, _points: &Points) -> bool {
        true
    }

    /// Fills `out`, which has room for all points; gradients too if `with_gradient`, which only
    /// methods that have them are asked.
    fn evaluate(&mut self, points: &Points, with_gradient: bool, out: &mut Output);

    /// Wall time of one evaluation of all points, seconds, on one core unless [`Self::device`] says
    /// otherwise.
    fn seconds(&mut self, points: &Points, with_gradient: bool, out: &mut Output) -> f64 {
        let begin = Instant::now();
        self.evaluate(points, with_gradient, out);
        std::hint::black_box(&mut *out);
        begin.elapsed().as_secs_f64()
    }

    /// The method's own definition in f64, at exactly this position (metres), without the rounding
    /// of the method; `None` where there is none.
    fn definition(&self, _at: DVec2) -> Option<Exact> {
        None
    }
}

/// Sum of the weights of `octaves` octaves, the first of which weighs 1: 2 − 2^(1 − octaves).
pub fn weight_sum(octaves: u32) -> f64 {
    let mut weight = 1.0;
    (0..octaves).fold(0.0, |sum, _| {
        let next = sum + weight;
        weight *= GAIN;
        next
    })
}
