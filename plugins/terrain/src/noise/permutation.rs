//! The noise of the literature: a 256-entry permutation, four gradients (±1, ±1), quintic fade.
//!
//! K. Perlin, "Improving Noise" (2002), as it is used for terrain on the GPU: octaves from
//! amplitude 0.9 and frequency 0.005 with gain ½ and lacunarity 2. It repeats every 256 cells of
//! each octave and is 0 at the lattice points of all of them; it is here to compare with and to
//! rebuild published scenes. For new ground take [`super::Fractal`].

use super::coordinate::{cell, fraction};
use super::fractal::NoiseError;
use super::lattice::{Ends, Place, fade};
use super::octave::Octave;
use super::oracle::{Sample, cell_noise, fbm};
use super::shuffle::permutation;
use super::sum::MAX_OCTAVES;
use crate::ground::{GroundPoint, GroundSample, Height};
use bevy::math::{DVec2, Vec2};
use bevy::reflect::Reflect;
use serde::{Deserialize, Serialize};

/// FBM of permutation noise: Σ amplitude·2⁻ᵏ·noise(2ᵏ·position/wavelength).
///
/// The error against f64 is that of [`super::Fractal`].
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PermutationNoise {
    /// Seed of the Mersenne Twister that shuffles the permutation.
    pub seed: u32,
    /// Octaves, 1 to 24.
    pub octaves: u32,
    /// Amplitude of the first octave, metres; not 0, up to 1e6 either way.
    pub amplitude: f32,
    /// Wavelength of the first octave, metres; the finest octave's must be at least 1 mm.
    pub wavelength: f32,
}

impl Default for PermutationNoise {
    /// The settings of the literature on its scale of 100 m: amplitude 0.9 × 100 m, frequency
    /// 0.005 a metre, 8 octaves.
    fn default() -> Self {
        Self {
            seed: 1,
            octaves: 8,
            amplitude: 90.0,
            wavelength: 200.0,
        }
    }
}

/// A validated [`PermutationNoise`] with its permutation and octave table.
#[derive(Clone, Debug, PartialEq)]
pub struct PreparedPermutation {
    pub(crate) octaves: Vec<Octave>,
    pub(crate) permutation: Box<[u8; 256]>,
}

impl PermutationNoise {
    /// Checks the settings, shuffles the permutation and lays out the octaves.
    ///
    /// # Errors
    /// Names the first field that is NaN, infinite or out of its range.
    pub fn prepare(&self) -> Result<PreparedPermutation, NoiseError> {
        let fractal = super::Fractal {
            seed: 0,
            octaves: self.octaves.clamp(1, MAX_OCTAVES as u32),
            amplitude: self.amplitude,
            wavelength: self.wavelength,
            ..super::Fractal::default()
        };
        NoiseError::check(
            self.octaves == fractal.octaves,
            "octaves",
            f64::from(self.octaves),
            "from 1 to 24",
        )?;
        let mut octaves = fractal.prepare()?.octaves;
        // Classic octaves share one lattice and one table: no offsets, no seeds.
        for octave in &mut octaves {
            (octave.offset, octave.seed) = ([0; 2], 0);
        }
        Ok(PreparedPermutation {
            octaves,
            permutation: Box::new(permutation(self.seed)),
        })
    }
}

impl PreparedPermutation {
    /// The two bits that choose the gradient of lattice point (x, z).
    #[inline]
    fn choice(&self, x: u32, z: u32) -> u8 {
        let column = u32::from(self.permutation[(x & 255) as usize]);
        self.permutation[(column.wrapping_add(z) & 255) as usize] & 3
    }

    /// The four gradients in the order of the literature: (1, 1), (−1, 1), (−1, −1), (1, −1).
    #[inline]
    fn gradient(&self, x: u32, z: u32) -> Vec2 {
        const GRADIENTS: [Vec2; 4] = [
            Vec2::new(1.0, 1.0),
            Vec2::new(-1.0, 1.0),
            Vec2::new(-1.0, -1.0),
            Vec2::new(1.0, -1.0),
        ];
        GRADIENTS[usize::from(self.choice(x, z))]
    }

    /// Height and gradient at a place, f32.
    #[must_use]
    pub fn sample(&self, point: GroundPoint) -> Height {
        let position = point.to_fixed();
        let mut sum = Height::default();
        for octave in &self.octaves {
            let [x, z] = position.map(|p| octave.frequency.coordinate(p));
            let (fx, fz) = (fraction(x), fraction(z));
            let (u, w) = (fade(fx), fade(fz));
            let (cx, cz) = (cell(x), cell(z));
            let at = |x: u32| {
                let (g0, g1) = (self.gradient(x, cz), self.gradient(x, cz.wrapping_add(1)));
                Ends {
                    x0: g0.x,
                    z0: g0.y,
                    x1: g1.x,
                    z1: g1.y,
                }
            };
            let ends = [at(cx), at(cx.wrapping_add(1))];
            let noise = Place::new(ends, (fx, u), (fz, w)).noise();
            sum.value += noise.value * octave.scale.amplitude;
            sum.gradient += Vec2::new(noise.dx, noise.dz) * octave.scale.slope;
        }
        sum
    }

    /// One octave's noise in f64, lattice units.
    pub(crate) fn noise_f64(&self, octave: &Octave, xz: DVec2) -> Sample {
        let (x, fx) = octave.frequency.coordinate_f64(xz.x, 0);
        let (z, fz) = octave.frequency.coordinate_f64(xz.y, 0);
        cell_noise(DVec2::new(fx, fz), |i, j| {
            self.gradient((x as u32).wrapping_add(i), (z as u32).wrapping_add(j))
                .as_dvec2()
        })
    }

    /// Height and gradient in f64 at (x, z) metres.
    #[must_use]
    pub fn sample_f64(&self, xz: DVec2) -> GroundSample {
        fbm(&self.octaves, |octave| self.noise_f64(octave, xz))
    }
}
