//! Gradient noise on the square lattice: value, gradient and Hessian in one evaluation.
//!
//! Conventions: a sample lies in the cell with lower corner (x, z) at the fractions (fx, fz) in
//! [0, 1); lengths are in cells. Each lattice point has a gradient g in [−1, 1)². The noise is
//!
//! n = Σᵢⱼ Uᵢ(fx) Uⱼ(fz) gᵢⱼ · (fx − i, fz − j),  U₁ = fade, U₀ = 1 − fade,
//!
//! (K. Perlin, "Improving Noise", 2002) with the quintic fade, which makes n twice continuously
//! differentiable. The blend along z is done first, for each of the two lattice columns, because
//! what it needs is constant along a row of samples: a column at given fz is linear in fx.
//!
//! |n| ≤ 1: with |g| ≤ 1 the sum is at most m(fx) + m(fz), m(t) = (1 − U)t + U(1 − t) ≤ ½.

use super::real::Real;

/// The quintic fade and its first two derivatives.
#[derive(Clone, Copy)]
pub(crate) struct Fade<F> {
    pub value: F,
    pub first: F,
    pub second: F,
}

/// Fade at `t` in [0, 1], which must be a multiple of 2⁻²⁴ (then 1 − t and t − ½ are exact).
///
/// 6t⁵ − 15t⁴ + 10t³ is expanded about its centre, s = t − ½: ½ + s(15/8 − s²(5 − 6s²)), where no
/// two large terms cancel: absolute error at most 1.2e-7 (2 ulp of ½ and 1). The first derivative is
/// 30q² with q = t(1 − t), the second 60q(1 − 2t).
#[inline(always)]
pub(crate) fn fade<F: Real>(t: F) -> Fade<F> {
    let s = t - 0.5;
    let s2 = s * s;
    let value = s * (t.like(1.875) - s2 * (t.like(5.0) - s2 * 6.0)) + 0.5;
    let q = t * (t.like(1.0) - t);
    let first = q * q * 30.0;
    let second = q * 60.0 * (t.like(1.0) - (t + t));
    Fade {
        value,
        first,
        second,
    }
}

/// The gradients at the two lattice points of a column: at z and at z + 1.
#[derive(Clone, Copy)]
pub(crate) struct Ends<F> {
    pub x0: F,
    pub z0: F,
    pub x1: F,
    pub z1: F,
}

/// A lattice column blended along z. With dx the distance from the column,
/// value = slope·dx + rise and ∂/∂z = cross_slope·dx + cross_rise.
#[derive(Clone, Copy)]
struct Column<F> {
    slope: F,
    rise: F,
    cross_slope: F,
    cross_rise: F,
}

/// Blends a column at the fraction `fz` with its fade `w`.
#[inline(always)]
fn column<F: Real>(ends: Ends<F>, fz: F, w: Fade<F>) -> Column<F> {
    let turn = ends.x1 - ends.x0;
    let rise0 = ends.z0 * fz;
    let rise1 = ends.z1 * (fz - 1.0);
    let lift = rise1 - rise0;
    Column {
        slope: ends.x0 + w.value * turn,
        rise: rise0 + w.value * lift,
        cross_slope: w.first * turn,
        cross_rise: (ends.z0 + w.value * (ends.z1 - ends.z0)) + w.first * lift,
    }
}

/// The second derivative of a column along z, bend_slope·dx + bend_rise.
#[inline(always)]
fn column_bend<F: Real>(ends: Ends<F>, fz: F, w: Fade<F>) -> (F, F) {
    let lift = ends.z1 * (fz - 1.0) - ends.z0 * fz;
    let twice = w.first + w.first;
    (
        w.second * (ends.x1 - ends.x0),
        twice * (ends.z1 - ends.z0) + w.second * lift,
    )
}

/// Noise and its derivatives in lattice units (1, 1/cell, 1/cell²).
#[derive(Clone, Copy)]
pub(crate) struct Noise<F> {
    pub value: F,
    pub dx: F,
    pub dz: F,
}

/// Second derivatives, 1/cell².
#[derive(Clone, Copy)]
pub(crate) struct Hessian<F> {
    pub xx: F,
    pub xz: F,
    pub zz: F,
}

/// A sample's place in a cell with the gradients around it: the noise there, when it is asked for.
#[derive(Clone, Copy)]
pub(crate) struct Place<F> {
    ends: [Ends<F>; 2],
    a: Column<F>,
    b: Column<F>,
    fx: F,
    u: Fade<F>,
    fz: F,
    w: Fade<F>,
}

impl<F: Real> Place<F> {
    /// `ends` of the left and right column; fractions and their fades along x and z.
    #[inline(always)]
    pub(crate) fn new(ends: [Ends<F>; 2], (fx, u): (F, Fade<F>), (fz, w): (F, Fade<F>)) -> Self {
        let (a, b) = (column(ends[0], fz, w), column(ends[1], fz, w));
        Self {
            ends,
            a,
            b,
            fx,
            u,
            fz,
            w,
        }
    }

    /// Value and gradient.
    #[inline(always)]
    pub(crate) fn noise(&self) -> Noise<F> {
        let Self { a, b, fx, u, .. } = *self;
        let gx = fx - 1.0;
        let left = a.slope * fx + a.rise;
        let step = (b.slope * gx + b.rise) - left;
        let left_z = a.cross_slope * fx + a.cross_rise;
        let right_z = b.cross_slope * gx + b.cross_rise;
        Noise {
            value: left + u.value * step,
            dx: (a.slope + u.value * (b.slope - a.slope)) + u.first * step,
            dz: left_z + u.value * (right_z - left_z),
        }
    }

    /// Second derivatives.
    #[inline(always)]
    pub(crate) fn hessian(&self) -> Hessian<F> {
        let Self {
            a, b, fx, u, fz, w, ..
        } = *self;
        let (a_slope, a_rise) = column_bend(self.ends[0], fz, w);
        let (b_slope, b_rise) = column_bend(self.ends[1], fz, w);
        let gx = fx - 1.0;
        let step = (b.slope * gx + b.rise) - (a.slope * fx + a.rise);
        let step_z = (b.cross_slope * gx + b.cross_rise) - (a.cross_slope * fx + a.cross_rise);
        let left_zz = a_slope * fx + a_rise;
        let right_zz = b_slope * gx + b_rise;
        let twice = u.first + u.first;
        Hessian {
            xx: twice * (b.slope - a.slope) + u.second * step,
            xz: (a.cross_slope + u.value * (b.cross_slope - a.cross_slope)) + u.first * step_z,
            zz: left_zz + u.value * (right_zz - left_zz),
        }
    }
}

/// The gradients of the cell's two columns: lower corner at column `x`, the two rows already
/// hashed ([`super::hash::row_hash`]).
#[inline(always)]
pub(crate) fn cell_gradients<F: Real>(x: F::Word, row0: F::Word, row1: F::Word) -> [Ends<F>; 2] {
    [
        column_gradients(x, row0, row1),
        column_gradients(F::next(x), row0, row1),
    ]
}

/// The gradients at column `x` of two hashed rows.
#[inline(always)]
fn column_gradients<F: Real>(x: F::Word, row0: F::Word, row1: F::Word) -> Ends<F> {
    let (x0, z0) = F::halves(F::point_hash(x, row0));
    let (x1, z1) = F::halves(F::point_hash(x, row1));
    Ends { x0, z0, x1, z1 }
}

#[cfg(test)]
mod tests {
    use super::super::hash::row_hash;
    use super::*;

    fn sample(x: u32, z: u32, fx: f32, fz: f32) -> (Noise<f32>, Hessian<f32>) {
        let (u, w) = (fade(fx), fade(fz));
        let ends = cell_gradients::<f32>(x, row_hash(z, 7), row_hash(z.wrapping_add(1), 7));
        let place = Place::new(ends, (fx, u), (fz, w));
        (place.noise(), place.hessian())
    }

    #[test]
    fn fade_is_the_quintic() {
        for k in 0..=4096_u32 {
            let t = k as f32 / 4096.0;
            let (d, f) = (f64::from(t), fade(t));
            let value = d * d * d * (d * (6.0 * d - 15.0) + 10.0);
            let first = 30.0 * d * d * (d - 1.0) * (d - 1.0);
            let second = 60.0 * d * (d - 1.0) * (2.0 * d - 1.0);
            // 2 ulp of 1; of 1.875; of 5.8.
            assert!((f64::from(f.value) - value).abs() <= 1.2e-7, "{t}");
            assert!((f64::from(f.first) - first).abs() <= 2.4e-7, "{t}");
            assert!((f64::from(f.second) - second).abs() <= 9.6e-7, "{t}");
        }
        assert_eq!(
            (fade(0.0_f32).value, fade(1.0_f32).value),
            (0.0, 1.0),
            "ends are exact"
        );
    }

    #[test]
    fn lattice_points_are_zeros_with_their_gradient() {
        let (noise, _) = sample(41, 1000, 0.0, 0.0);
        let (gx, gz) = f32::halves(super::super::hash::point_hash(41, row_hash(1000, 7)));
        assert_eq!((noise.value, noise.dx, noise.dz), (0.0, gx, gz));
    }

    #[test]
    fn seams_are_continuous_to_second_order() {
        let last = 1.0 - 1.0 / 16_777_216.0;
        for z in 0..64 {
            let fz = z as f32 / 64.0;
            for (a, b) in [
                (sample(u32::MAX, 3, last, fz), sample(0, 3, 0.0, fz)),
                (sample(9, u32::MAX, fz, last), sample(9, 0, fz, 0.0)),
            ] {
                let (na, ha) = a;
                let (nb, hb) = b;
                // One step of 2^-24 times slopes <= 2.8 and second derivatives <= 20, plus rounding.
                assert!((na.value - nb.value).abs() < 1e-6);
                assert!((na.dx - nb.dx).abs() < 4e-6 && (na.dz - nb.dz).abs() < 4e-6);
                assert!((ha.xx - hb.xx).abs() < 3e-5 && (ha.zz - hb.zz).abs() < 3e-5);
                assert!((ha.xz - hb.xz).abs() < 3e-5);
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_value() {
        // Central differences of f32 values, h = 2^-6: truncation h²/6 × third derivative (about
        // 60) = 2.5e-3, rounding 1e-7/h = 1e-5.
        let h = 1.0 / 64.0;
        for k in 0..200_u32 {
            let fx = (k % 14) as f32 / 16.0 + h;
            let fz = (k % 13) as f32 / 16.0 + h;
            let (noise, hessian) = sample(k, k * 3, fx, fz);
            let at = |x: f32, z: f32| sample(k, k * 3, fx + x, fz + z).0;
            let dx = (at(h, 0.0).value - at(-h, 0.0).value) / (2.0 * h);
            let dz = (at(0.0, h).value - at(0.0, -h).value) / (2.0 * h);
            assert!((dx - noise.dx).abs() < 5e-3 && (dz - noise.dz).abs() < 5e-3);
            let xx = (at(h, 0.0).dx - at(-h, 0.0).dx) / (2.0 * h);
            let xz = (at(0.0, h).dx - at(0.0, -h).dx) / (2.0 * h);
            let zz = (at(0.0, h).dz - at(0.0, -h).dz) / (2.0 * h);
            // Fourth derivatives reach some 400: h²/6 × 400 = 1.6e-2.
            assert!((xx - hessian.xx).abs() < 3e-2 && (zz - hessian.zz).abs() < 3e-2);
            assert!((xz - hessian.xz).abs() < 3e-2);
        }
    }
}
