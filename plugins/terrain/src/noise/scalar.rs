//! One point of a fractal in f32.

use super::coordinate::{cell, fraction};
use super::fractal::{Fractal, NoiseError, PreparedFractal};
use super::hash::row_hash;
use super::lattice::{Place, cell_gradients, fade};
use super::octave::{Octave, PreparedWarp};
use super::sum::{Fbm, Kind, STATE, with_kind};
use crate::ground::{GroundPoint, Height, fixed};
use bevy::math::Vec2;

/// Sums the octaves at a position (32.32 metres): value and gradient, before the chain rule of a
/// warp.
fn sum<K: Kind>(octaves: &[Octave], erosion: f32, position: [i64; 2]) -> [f32; 3] {
    let mut state: [f32; STATE] = K::START;
    for octave in octaves {
        let x = octave
            .frequency
            .coordinate(position[0])
            .wrapping_add(octave.offset[0]);
        let z = octave
            .frequency
            .coordinate(position[1])
            .wrapping_add(octave.offset[1]);
        let (fx, fz) = (fraction(x), fraction(z));
        let (u, w) = (fade(fx), fade(fz));
        let rows = [cell(z), cell(z).wrapping_add(1)].map(|z| row_hash(z, octave.seed));
        let ends = cell_gradients::<f32>(cell(x), rows[0], rows[1]);
        let place = Place::new(ends, (fx, u), (fz, w));
        K::step(&mut state, &place, &octave.scale, erosion);
    }
    [state[0], state[1], state[2]]
}

/// A displacement in metres to 32.32 fixed point, rounded down; exact but for the part below
/// 2⁻³² m.
#[inline]
pub(crate) fn displacement_fixed(d: f32) -> i64 {
    fixed(f64::from(d))
}

/// The gradient of f(p + W(p)) from that of f: (I + ∇W)ᵀ ∇f. `x` and `z` are (value, ∂/∂x, ∂/∂z) of
/// the two displacements.
#[inline]
pub(crate) fn unwarp(height: [f32; 3], x: [f32; 3], z: [f32; 3]) -> [f32; 3] {
    let [value, dx, dz] = height;
    [
        value,
        dx + (dx * x[1] + dz * z[1]),
        dz + (dx * x[2] + dz * z[2]),
    ]
}

impl PreparedWarp {
    pub(crate) fn sample(&self, position: [i64; 2]) -> [[f32; 3]; 2] {
        [&self.x, &self.z].map(|octaves| sum::<Fbm>(octaves, 0.0, position))
    }
}

impl PreparedFractal {
    /// Height and gradient at a place, f32: error as stated at [`Fractal`], about 15 ns an octave.
    #[must_use]
    pub fn sample(&self, point: GroundPoint) -> Height {
        let position = point.to_fixed();
        let at =
            |position| with_kind!(self.sum, K => sum::<K>(&self.octaves, self.erosion, position));
        let [value, dx, dz] = match &self.warp {
            None => at(position),
            Some(warp) => {
                let [x, z] = warp.sample(position);
                let moved = [
                    position[0].wrapping_add(displacement_fixed(x[0])),
                    position[1].wrapping_add(displacement_fixed(z[0])),
                ];
                unwarp(at(moved), x, z)
            }
        };
        Height {
            value,
            gradient: Vec2::new(dx, dz),
        }
    }
}

impl Fractal {
    /// Height and gradient at one place, f32. Checks and lays out the octaves each time:
    /// [`Fractal::prepare`] once for more than a few points.
    ///
    /// # Errors
    /// As [`Fractal::validate`].
    pub fn sample(&self, point: GroundPoint) -> Result<Height, NoiseError> {
        Ok(self.prepare()?.sample(point))
    }
}
