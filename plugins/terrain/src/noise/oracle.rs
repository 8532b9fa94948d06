//! One point in f64, by the textbook formulas: what the f32 evaluators are measured against.
//!
//! Independent of them on purpose: positions in f64, the four corners summed one by one, weights
//! and their derivatives by the product rule. Only the hash and the octave table are shared, for
//! they are the definition. Error about 1e-15 of the amplitude an octave, at any distance.

use super::fractal::{Fractal, NoiseError, PreparedFractal, Sum};
use super::hash::{point_hash, row_hash};
use super::octave::Octave;
use super::sum::SMOOTH_SQUARED;
use crate::ground::GroundSample;
use bevy::math::{DMat2, DVec2};

/// Noise in f64, lattice units: value, gradient, Hessian.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub value: f64,
    pub gradient: DVec2,
    pub hessian: DMat2,
}

/// Fade, first and second derivative, in the usual form.
fn fade(t: f64) -> [f64; 3] {
    [
        t * t * t * (t * (t * 6.0 - 15.0) + 10.0),
        30.0 * t * t * (t - 1.0) * (t - 1.0),
        60.0 * t * (t - 1.0) * (2.0 * t - 1.0),
    ]
}

/// The noise of a cell from its four lattice gradients, `gradient(i, j)` at corner (i, j).
pub(crate) fn cell_noise(f: DVec2, gradient: impl Fn(u32, u32) -> DVec2) -> Sample {
    let (fx, fz) = (fade(f.x), fade(f.y));
    let mut sum = Sample {
        value: 0.0,
        gradient: DVec2::ZERO,
        hessian: DMat2::ZERO,
    };
    for i in 0..2_u32 {
        for j in 0..2_u32 {
            let g = gradient(i, j);
            let d = f - DVec2::new(f64::from(i), f64::from(j));
            // Weights along x and z with their derivatives: fade or 1 − fade.
            let u = if i == 1 {
                fx
            } else {
                [1.0 - fx[0], -fx[1], -fx[2]]
            };
            let w = if j == 1 {
                fz
            } else {
                [1.0 - fz[0], -fz[1], -fz[2]]
            };
            let dot = g.dot(d);
            sum.value += u[0] * w[0] * dot;
            sum.gradient += DVec2::new(u[1] * w[0], u[0] * w[1]) * dot + g * (u[0] * w[0]);
            let xx = u[2] * w[0] * dot + 2.0 * u[1] * w[0] * g.x;
            let zz = u[0] * w[2] * dot + 2.0 * u[0] * w[1] * g.y;
            let xz = u[1] * w[1] * dot + u[0] * w[1] * g.x + u[1] * w[0] * g.y;
            sum.hessian += DMat2::from_cols(DVec2::new(xx, xz), DVec2::new(xz, zz));
        }
    }
    sum
}

impl Octave {
    /// The octave's noise at (x, z) metres, lattice units.
    pub(crate) fn noise_f64(&self, xz: DVec2) -> Sample {
        let (x, fx) = self.frequency.coordinate_f64(xz.x, self.offset[0]);
        let (z, fz) = self.frequency.coordinate_f64(xz.y, self.offset[1]);
        cell_noise(DVec2::new(fx, fz), |i, j| {
            let row = row_hash((z as u32).wrapping_add(j), self.seed);
            let hash = point_hash((x as u32).wrapping_add(i), row);
            DVec2::new(
                f64::from((hash >> 16) as i16) / 32_768.0,
                f64::from(hash as i16) / 32_768.0,
            )
        })
    }
}

/// FBM in f64 metres of a list of octaves.
pub(crate) fn fbm(octaves: &[Octave], noise: impl Fn(&Octave) -> Sample) -> GroundSample {
    octaves.iter().fold(GroundSample::default(), |sum, octave| {
        let n = noise(octave);
        GroundSample {
            height: sum.height + octave.amplitude * n.value,
            gradient: sum.gradient + n.gradient * octave.slope(),
        }
    })
}

impl PreparedFractal {
    /// Height and gradient in f64 at (x, z) metres.
    #[must_use]
    pub fn sample_f64(&self, xz: DVec2) -> GroundSample {
        let Some(warp) = &self.warp else {
            return self.sum_f64(xz);
        };
        let x = fbm(&warp.x, |octave| octave.noise_f64(xz));
        let z = fbm(&warp.z, |octave| octave.noise_f64(xz));
        let sample = self.sum_f64(xz + DVec2::new(x.height, z.height));
        let g = sample.gradient;
        GroundSample {
            height: sample.height,
            gradient: g + x.gradient * g.x + z.gradient * g.y,
        }
    }

    fn sum_f64(&self, xz: DVec2) -> GroundSample {
        match self.sum {
            Sum::Fbm => fbm(&self.octaves, |octave| octave.noise_f64(xz)),
            Sum::Billow => self.billow_f64(xz),
            Sum::Ridged => self.ridged_f64(xz),
            Sum::Eroded => self.eroded_f64(xz),
        }
    }

    fn billow_f64(&self, xz: DVec2) -> GroundSample {
        let mut sum = GroundSample::default();
        for octave in &self.octaves {
            let n = octave.noise_f64(xz);
            let length = (n.value * n.value + f64::from(SMOOTH_SQUARED)).sqrt();
            sum.height += octave.amplitude * (2.0 * length - 1.0);
            sum.gradient += n.gradient * (octave.slope() * 2.0 * n.value / length);
        }
        sum
    }

    fn ridged_f64(&self, xz: DVec2) -> GroundSample {
        let mut sum = GroundSample::default();
        let (mut weight, mut weight_gradient) = (1.0, DVec2::ZERO);
        for octave in &self.octaves {
            let n = octave.noise_f64(xz);
            let length = (n.value * n.value + f64::from(SMOOTH_SQUARED)).sqrt();
            let ridge = 1.0 - length;
            let square = ridge * ridge;
            let gradient =
                n.gradient * (-2.0 * ridge * n.value / length * octave.frequency.value());
            sum.height += octave.amplitude * square * weight;
            sum.gradient += (gradient * weight + weight_gradient * square) * octave.amplitude;
            (weight, weight_gradient) = (square, gradient);
        }
        sum
    }

    fn eroded_f64(&self, xz: DVec2) -> GroundSample {
        let mut sum = GroundSample::default();
        let Some(first) = self.octaves.first() else {
            return sum;
        };
        let erosion = f64::from(self.erosion);
        let (mut slope, mut jacobian) = (DVec2::ZERO, DMat2::ZERO);
        for octave in &self.octaves {
            let n = octave.noise_f64(xz);
            let relative = octave.slope() / first.slope();
            slope += n.gradient * relative;
            jacobian += n.hessian * (relative * octave.frequency.value());
            let weight = 1.0 / (1.0 + erosion * slope.length_squared());
            let fall = jacobian * slope * (-2.0 * erosion * weight * weight);
            sum.height += octave.amplitude * n.value * weight;
            sum.gradient +=
                n.gradient * (octave.slope() * weight) + fall * (octave.amplitude * n.value);
        }
        sum
    }
}

impl Fractal {
    /// Height and gradient in f64 at (x, z) metres; as [`Fractal::sample`], it prepares each time.
    ///
    /// # Errors
    /// As [`Fractal::validate`].
    pub fn sample_f64(&self, xz: DVec2) -> Result<GroundSample, NoiseError> {
        Ok(self.prepare()?.sample_f64(xz))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hessian_is_the_derivative_of_the_gradient() {
        let gradient = |i: u32, j: u32| {
            DVec2::new(0.3 + f64::from(i), -0.7 * f64::from(j) + 0.2 * f64::from(i))
        };
        let h = 1e-5;
        for k in 0..50 {
            let f = DVec2::new(
                f64::from(k % 7) / 8.0 + 0.05,
                f64::from(k % 9) / 10.0 + 0.05,
            );
            let at = |d: DVec2| cell_noise(f + d, gradient).gradient;
            let columns =
                [DVec2::X, DVec2::Y].map(|axis| (at(axis * h) - at(axis * -h)) / (2.0 * h));
            let hessian = cell_noise(f, gradient).hessian;
            // h² × fourth derivative (a few hundred) + 1e-16 / h.
            assert!(
                (hessian.x_axis - columns[0]).length() < 1e-6,
                "{f}: {hessian} {columns:?}"
            );
            assert!(
                (hessian.y_axis - columns[1]).length() < 1e-6,
                "{f}: {hessian} {columns:?}"
            );
        }
    }
}
