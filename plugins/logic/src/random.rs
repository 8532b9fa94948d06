//! Random numbers that are the same everywhere: PCG-32 (M. O'Neill, PCG: a family of simple fast space-efficient
//! statistically good algorithms for random number generation, 2014).

/// A stream of random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Random(u64);

impl Random {
    /// Same seed, same numbers.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_add(1_442_695_040_888_963_407));
        // Seeds that are near each other have streams that are not.
        random.bits();
        random.bits();
        random
    }

    /// 32 random bits.
    #[inline]
    pub const fn bits(&mut self) -> u32 {
        let old = self.0;
        self.0 = old
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let mixed = (((old >> 18) ^ old) >> 27) as u32;
        mixed.rotate_right((old >> 59) as u32)
    }

    /// From 0 to below 1, in steps of 2^-24.
    #[inline]
    pub const fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / 16_777_216.0
    }

    /// From -size to below size.
    #[inline]
    pub const fn signed(&mut self, size: f32) -> f32 {
        (self.unit() * 2.0 - 1.0) * size
    }

    /// Below `count`, which has to be above 0; by the high bits of a product.
    #[inline]
    pub const fn below(&mut self, count: u32) -> u32 {
        ((self.bits() as u64 * count as u64) >> 32) as u32
    }
}
