//! Eight quaternions at a time.
//!
//! Every operation is one IEEE 754 operation, rounded, in a fixed order and without fused multiply-add,
//! so the bits are the same with every instruction set.

use crate::pose::{LANES, Lane};
use fearless_simd::{f32x8, prelude::*};

/// Quaternions, or what becomes some: x, y, z, w of eight.
pub(crate) type Quat8<S> = [f32x8<S>; 4];

#[inline(always)]
pub(crate) fn load<S: Simd, const N: usize>(simd: S, lanes: &[Lane; N]) -> [f32x8<S>; N] {
    core::array::from_fn(|i| f32x8::from_slice(simd, &lanes[i]))
}

#[inline(always)]
pub(crate) fn store<S: Simd, const N: usize>(values: &[f32x8<S>; N], lanes: &mut [Lane; N]) {
    for (value, lane) in values.iter().zip(lanes) {
        value.store_slice(lane);
    }
}

/// `N` numbers of eight joints out of a flat array, from `at` on.
#[inline(always)]
pub(crate) fn load_flat<S: Simd, const N: usize>(
    simd: S,
    flat: &[f32],
    at: usize,
) -> [f32x8<S>; N] {
    let values = &flat[at..at + N * LANES];
    core::array::from_fn(|i| f32x8::from_slice(simd, &values[i * LANES..(i + 1) * LANES]))
}

/// (1 − u) a + u b, exact at both ends.
#[inline(always)]
pub(crate) fn lerp<S: Simd, const N: usize>(
    a: &[f32x8<S>; N],
    b: &[f32x8<S>; N],
    u: f32x8<S>,
) -> [f32x8<S>; N] {
    let v = f32x8::splat(u.token(), 1.0) - u;
    core::array::from_fn(|i| a[i] * v + b[i] * u)
}

#[inline(always)]
pub(crate) fn dot<S: Simd>(a: &Quat8<S>, b: &Quat8<S>) -> f32x8<S> {
    (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])
}

/// Unit quaternions; the identity where the length is zero.
#[inline(always)]
pub(crate) fn normalise<S: Simd>(q: &Quat8<S>) -> Quat8<S> {
    let simd = q[0].token();
    let square = dot(q, q);
    // 1e-30: below it the square of the length has lost its digits; no sum of unit quaternions with
    // weights of use comes near.
    let there = square.simd_gt(f32x8::splat(simd, 1e-30));
    let one = f32x8::splat(simd, 1.0);
    let zero = f32x8::splat(simd, 0.0);
    let inverse = one / there.select(square, one).sqrt();
    [
        there.select(q[0] * inverse, zero),
        there.select(q[1] * inverse, zero),
        there.select(q[2] * inverse, zero),
        there.select(q[3] * inverse, one),
    ]
}

/// (angle / half chord)² as a polynomial in the square of the half chord, which is ≤ 1/2: with
/// s = sin(θ/2), θ² = 4 asin²(s). Interpolated at Chebyshev's points; relative error 1.3e-7 in f32.
const ANGLE: [f32; 8] = [
    3.999_999_8,
    1.333_367_1,
    0.709_715_9,
    0.478_714_2,
    0.164_926_16,
    0.869_712_77,
    -1.063_798_2,
    1.278_171_4,
];

/// sin(x)/x as a polynomial in x², for x² ≤ (π/2)². Made the same way; relative error 1.0e-7 in f32.
const SINC: [f32; 5] = [
    1.0,
    -0.166_666_58,
    0.008_333_05,
    -0.000_198_090_14,
    2.605_101_8e-6,
];

#[inline(always)]
fn polynomial<S: Simd, const N: usize>(x: f32x8<S>, coefficients: &[f32; N]) -> f32x8<S> {
    let simd = x.token();
    let mut sum = f32x8::splat(simd, coefficients[N - 1]);
    for coefficient in coefficients[..N - 1].iter().rev() {
        sum = sum * x + f32x8::splat(simd, *coefficient);
    }
    sum
}

/// Spherical interpolation of unit quaternions at most a right angle (of four dimensions) apart, as
/// neighbouring keys are stored. No branch, and no trouble where both are the same: the angle comes from
/// the chord, and sin(uθ)/sin θ is a quotient of sin(x)/x.
#[inline(always)]
pub(crate) fn slerp<S: Simd>(a: &Quat8<S>, b: &Quat8<S>, u: f32x8<S>) -> Quat8<S> {
    let simd = u.token();
    let difference: Quat8<S> = core::array::from_fn(|i| b[i] - a[i]);
    let half = dot(&difference, &difference) * f32x8::splat(simd, 0.25);
    let square = half * polynomial(half, &ANGLE);
    let v = f32x8::splat(simd, 1.0) - u;
    let inverse = f32x8::splat(simd, 1.0) / polynomial(square, &SINC);
    let to_a = v * polynomial(v * v * square, &SINC) * inverse;
    let to_b = u * polynomial(u * u * square, &SINC) * inverse;
    core::array::from_fn(|i| a[i] * to_a + b[i] * to_b)
}

/// glTF's cubic spline: values and tangents at both ends, `u` in [0, 1] of `dt` seconds.
/// Source: glTF 2.0 specification, appendix C.5.
#[inline(always)]
pub(crate) fn hermite<S: Simd, const N: usize>(
    a: &[f32x8<S>; N],
    out_tangent: &[f32x8<S>; N],
    b: &[f32x8<S>; N],
    in_tangent: &[f32x8<S>; N],
    u: f32x8<S>,
    dt: f32x8<S>,
) -> [f32x8<S>; N] {
    let simd = u.token();
    let number = |x: f32| f32x8::splat(simd, x);
    let (v, u2) = (number(1.0) - u, u * u);
    // (1 − u)² (1 + 2u) and its like: no cancellation near the ends.
    let of_a = v * v * (u * number(2.0) + number(1.0));
    let of_b = u2 * (number(3.0) - u * number(2.0));
    let of_out = u * v * v * dt;
    let of_in = number(0.0) - u2 * v * dt;
    core::array::from_fn(|i| {
        (a[i] * of_a + b[i] * of_b) + (out_tangent[i] * of_out + in_tangent[i] * of_in)
    })
}
