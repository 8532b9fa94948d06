//! Heights between samples, and their gradient.
//!
//! All samples are taken relative to one of them before they are weighted, so that rounding is of
//! the size of the local relief, not of the altitude.

use super::{Filter, HeightMap};
use crate::ground::{GroundPoint, GroundSample, Height};
use crate::noise::coordinate::{cell, fraction};
use bevy::math::{DVec2, Vec2};

/// Catmull-Rom weights of samples −1, 0, 1, 2 at t in [0, 1].
pub(crate) fn weights(t: f32) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        t2 - 0.5 * (t3 + t),
        1.5 * t3 - 2.5 * t2 + 1.0,
        2.0 * t2 - 1.5 * t3 + 0.5 * t,
        0.5 * (t3 - t2),
    ]
}

/// Their derivatives.
pub(crate) fn slopes(t: f32) -> [f32; 4] {
    let t2 = t * t;
    [
        2.0 * t - 1.5 * t2 - 0.5,
        4.5 * t2 - 5.0 * t,
        4.0 * t - 4.5 * t2 + 0.5,
        1.5 * t2 - t,
    ]
}

/// Weights and derivatives in f64.
pub(crate) fn weights_f64(t: f64) -> ([f64; 4], [f64; 4]) {
    (
        [
            -0.5 * t * t * t + t * t - 0.5 * t,
            1.5 * t * t * t - 2.5 * t * t + 1.0,
            -1.5 * t * t * t + 2.0 * t * t + 0.5 * t,
            0.5 * t * t * t - 0.5 * t * t,
        ],
        [
            -1.5 * t * t + 2.0 * t - 0.5,
            4.5 * t * t - 5.0 * t,
            -4.5 * t * t + 4.0 * t + 0.5,
            1.5 * t * t - t,
        ],
    )
}

/// Between the samples (0, 0) and (1, 1), which `at` gives relative to one of them; the gradient is a sample's.
pub(super) fn bilinear(at: impl Fn(i32, i32) -> f32, fx: f32, fz: f32) -> Height {
    let (east, south, far) = (at(1, 0), at(0, 1), at(1, 1));
    let twist = (far - south) - east;
    Height {
        value: fx * east + fz * (south + fx * twist),
        gradient: Vec2::new(east + fz * twist, south + fx * twist),
    }
}

/// The same by Catmull-Rom, from the samples (−1, −1) to (2, 2).
pub(super) fn bicubic(at: impl Fn(i32, i32) -> f32, fx: f32, fz: f32) -> Height {
    let (mut value, mut gradient) = (0.0, Vec2::ZERO);
    let (wx, sx) = (weights(fx), slopes(fx));
    let (wz, sz) = (weights(fz), slopes(fz));
    for (dj, (w, s)) in (-1..).zip(wz.into_iter().zip(sz)) {
        let row = [at(-1, dj), at(0, dj), at(1, dj), at(2, dj)];
        let along = |k: [f32; 4]| (k[0] * row[0] + k[1] * row[1]) + (k[2] * row[2] + k[3] * row[3]);
        let across = along(wx);
        value += w * across;
        gradient += Vec2::new(w * along(sx), s * across);
    }
    Height { value, gradient }
}

/// Between the samples (0, 0) and (1, 1) in f64; the gradient is a sample's.
pub(super) fn bilinear_f64(at: impl Fn(i32, i32) -> f64, fx: f64, fz: f64) -> GroundSample {
    let north = at(0, 0) + fx * (at(1, 0) - at(0, 0));
    let south = at(0, 1) + fx * (at(1, 1) - at(0, 1));
    let east = (1.0 - fz) * (at(1, 0) - at(0, 0)) + fz * (at(1, 1) - at(0, 1));
    GroundSample {
        height: north + fz * (south - north),
        gradient: DVec2::new(east, south - north),
    }
}

/// The same by Catmull-Rom.
pub(super) fn bicubic_f64(at: impl Fn(i32, i32) -> f64, fx: f64, fz: f64) -> GroundSample {
    let ((wx, sx), (wz, sz)) = (weights_f64(fx), weights_f64(fz));
    let mut sum = GroundSample::default();
    for (dj, (w, s)) in (-1..).zip(wz.into_iter().zip(sz)) {
        for (di, (v, t)) in (-1..).zip(wx.into_iter().zip(sx)) {
            let sample = at(di, dj);
            sum.height += w * v * sample;
            sum.gradient += DVec2::new(w * t, s * v) * sample;
        }
    }
    sum
}

impl HeightMap {
    /// The sample nearest inside the map, metres.
    pub(super) fn clamped(&self, column: i32, row: i32) -> f32 {
        let x = column.clamp(0, self.0.width as i32 - 1) as usize;
        let z = row.clamp(0, self.0.height as i32 - 1) as usize;
        self.0.samples[z * self.0.width as usize + x]
    }

    /// Height and gradient at a place, f32. Error against f64: value 1e-6 of the altitude,
    /// gradient 1e-5 of the local relief over the spacing.
    #[must_use]
    pub fn sample(&self, point: GroundPoint) -> Height {
        let lattice = self.lattice();
        let (at, origin) = (point.to_fixed(), lattice.origin.to_fixed());
        let x = lattice.frequency[0].coordinate(at[0].wrapping_sub(origin[0]));
        let z = lattice.frequency[1].coordinate(at[1].wrapping_sub(origin[1]));
        let (i, j) = (cell(x) as i32, cell(z) as i32);
        let (fx, fz) = (fraction(x), fraction(z));
        let inverse = self.inverse_spacing();
        let mut height = if let Some(stream) = self.stream() {
            stream.sample([i, j], [fx, fz], self.0.filter)
        } else {
            let middle = self.clamped(i, j);
            let at = |di: i32, dj: i32| {
                self.clamped(i.saturating_add(di), j.saturating_add(dj)) - middle
            };
            let near = match self.0.filter {
                Filter::Bilinear => bilinear(at, fx, fz),
                Filter::Bicubic => bicubic(at, fx, fz),
            };
            Height {
                value: middle + near.value,
                ..near
            }
        };
        height.gradient *= inverse;
        height
    }

    /// 1/spacing as every implementation multiplies by it.
    pub(crate) fn inverse_spacing(&self) -> Vec2 {
        let [x, z] = self
            .lattice()
            .frequency
            .map(|frequency| frequency.value() as f32);
        Vec2::new(x, z)
    }

    /// Height and gradient in f64 at (x, z) metres.
    #[must_use]
    pub fn sample_f64(&self, xz: DVec2) -> GroundSample {
        let [x, z] = self.lattice().frequency;
        // Relative to the origin as the integer implementations have it; one rounding, 2⁻⁵³ of the distance.
        let at = xz - self.lattice().origin.to_dvec2();
        let (i, fx) = x.coordinate_f64(at.x, 0);
        let (j, fz) = z.coordinate_f64(at.y, 0);
        let mut sample = if let Some(stream) = self.stream() {
            stream.sample_f64([i, j], [fx, fz], self.0.filter)
        } else {
            let at = |di: i32, dj: i32| {
                f64::from(self.clamped(i.saturating_add(di), j.saturating_add(dj)))
            };
            match self.0.filter {
                Filter::Bilinear => bilinear_f64(at, fx, fz),
                Filter::Bicubic => bicubic_f64(at, fx, fz),
            }
        };
        sample.gradient *= DVec2::new(x.value(), z.value());
        sample
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::IVec2;

    fn map(filter: Filter, origin: DVec2) -> HeightMap {
        // Uneven numbers around 1000 m with a relief of some 40 m.
        let samples = (0..7 * 5)
            .map(|k| 1000.0 + ((k * 37) % 41) as f32)
            .collect();
        HeightMap::new(7, 5, samples, origin, DVec2::new(30.0, 20.0), filter).expect("valid")
    }

    #[test]
    fn samples_are_met_exactly() {
        for filter in [Filter::Bilinear, Filter::Bicubic] {
            let origin = DVec2::new(-1e6, 5e6);
            let map = map(filter, origin);
            for k in 0..35 {
                let at = IVec2::new(k % 7, k / 7);
                // A hair inside the cell, so that rounding of 1/spacing does not leave it.
                let xz = origin + at.as_dvec2() * map.spacing() + DVec2::splat(1e-6);
                let expected = f64::from(map.clamped(at.x, at.y));
                assert!((map.sample_f64(xz).height - expected).abs() < 1e-5);
                let near = map.sample(GroundPoint::new(xz));
                assert!((f64::from(near.value) - expected).abs() < 2e-4);
            }
        }
    }

    #[test]
    fn f32_agrees_with_f64_inside_and_beyond_the_border() {
        for filter in [Filter::Bilinear, Filter::Bicubic] {
            let origin = DVec2::new(9e6, -9e6);
            let map = map(filter, origin);
            for k in 0..2000 {
                let step = DVec2::new(
                    f64::from(k % 47) * 7.3 - 60.0,
                    f64::from(k / 47) * 4.1 - 40.0,
                );
                let exact = map.sample_f64(origin + step);
                let near = map.sample(GroundPoint::new(origin + step));
                // 1 ulp of 1000 m is 6e-5.
                assert!(
                    (f64::from(near.value) - exact.height).abs() < 1.3e-4,
                    "{filter:?} {step}"
                );
                // 1e-5 of 40 m over 20 m.
                assert!(
                    (near.gradient.as_dvec2() - exact.gradient).length() < 2e-5,
                    "{filter:?} {step}"
                );
            }
        }
    }

    #[test]
    fn gradient_is_the_derivative() {
        let map = map(Filter::Bicubic, DVec2::ZERO);
        let h = 1e-4;
        for k in 0..500 {
            let xz = DVec2::new(f64::from(k % 23) * 8.7 + 0.4, f64::from(k / 23) * 3.9 + 0.3);
            let at = |d: DVec2| map.sample_f64(xz + d).height;
            let slope = DVec2::new(
                (at(DVec2::X * h) - at(DVec2::X * -h)) / (2.0 * h),
                (at(DVec2::Y * h) - at(DVec2::Y * -h)) / (2.0 * h),
            );
            // h × jump of the second derivative (< 1/m), and 1e-13 × 1000 m / h.
            assert!(
                (slope - map.sample_f64(xz).gradient).length() < 1e-4,
                "{xz}"
            );
        }
    }
}
