//! One formula for one lane or many: the arithmetic that the noise is written in.
//!
//! [`Real`] is `f32` or a native vector of `f32`. Every operation is one IEEE 754 operation, each
//! rounded (no fused multiply-add), so both give the same bits lane by lane.

use core::ops::{Add, Div, Mul, Sub};
use fearless_simd::prelude::*;

/// A float, or a vector of floats, with its integer companion.
pub(crate) trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f32, Output = Self>
    + Sub<f32, Output = Self>
    + Mul<f32, Output = Self>
{
    /// Unsigned words, as many as there are lanes.
    type Word: Copy;
    /// `value` in every lane.
    fn like(self, value: f32) -> Self;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Hash of lattice points of one row or of many: `hash::point_hash` in each lane.
    fn point_hash(x: Self::Word, row: Self::Word) -> Self::Word;
    /// `word + 1`, wrapping.
    fn next(word: Self::Word) -> Self::Word;
    /// The high and low halves of a hash as signed 16-bit fixed point: two numbers in [−1, 1).
    fn halves(word: Self::Word) -> (Self, Self);
}

/// 2⁻¹⁵: from a signed 16-bit integer to [−1, 1), exactly.
const HALF_SCALE: f32 = 1.0 / 32_768.0;

impl Real for f32 {
    type Word = u32;

    #[inline(always)]
    fn like(self, value: f32) -> Self {
        value
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }

    #[inline(always)]
    fn point_hash(x: u32, row: u32) -> u32 {
        super::hash::point_hash(x, row)
    }

    #[inline(always)]
    fn next(word: u32) -> u32 {
        word.wrapping_add(1)
    }

    #[inline(always)]
    fn halves(word: u32) -> (f32, f32) {
        let high = (word as i32) >> 16;
        let low = ((word << 16) as i32) >> 16;
        (high as f32 * HALF_SCALE, low as f32 * HALF_SCALE)
    }
}

/// A native vector of `f32` of the instruction set `S`.
#[derive(Clone, Copy)]
pub(crate) struct Wide<S: Simd>(pub(crate) S::f32s);

macro_rules! arithmetic {
    ($($trait:ident $method:ident),*) => {$(
        impl<S: Simd> $trait for Wide<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0))
            }
        }
    )*};
}
arithmetic!(Add add, Sub sub, Mul mul, Div div);

macro_rules! arithmetic_with_scalar {
    ($($trait:ident $method:ident),*) => {$(
        impl<S: Simd> $trait<f32> for Wide<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f32) -> Self {
                Self($trait::$method(self.0, other))
            }
        }
    )*};
}
arithmetic_with_scalar!(Add add, Sub sub, Mul mul);

impl<S: Simd> Real for Wide<S> {
    type Word = S::u32s;

    #[inline(always)]
    fn like(self, value: f32) -> Self {
        Self(S::f32s::splat(self.0.token(), value))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    #[inline(always)]
    fn point_hash(x: S::u32s, row: S::u32s) -> S::u32s {
        use super::hash::{PCG_INCREMENT, PCG_MULTIPLIER, PCG_OUTPUT};
        let state = (x + row) * PCG_MULTIPLIER + PCG_INCREMENT;
        let mixed = ((state >> ((state >> 28_u32) + 4_u32)) ^ state) * PCG_OUTPUT;
        (mixed >> 22_u32) ^ mixed
    }

    #[inline(always)]
    fn next(word: S::u32s) -> S::u32s {
        word + 1_u32
    }

    #[inline(always)]
    fn halves(word: S::u32s) -> (Self, Self) {
        let high: S::i32s = word.bitcast();
        let low: S::i32s = (word << 16_u32).bitcast();
        let high: S::f32s = (high >> 16_u32).to_float();
        let low: S::f32s = (low >> 16_u32).to_float();
        (Self(high * HALF_SCALE), Self(low * HALF_SCALE))
    }
}
