//! Random inputs that are the same on every machine and with every version of every library.

/// A stream of random numbers: PCG-XSH-RR 64/32 (O'Neill 2014).
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// Same seed, same stream.
    #[must_use]
    pub fn new(seed: u32) -> Self {
        let mut random = Self(u64::from(seed).wrapping_add(0x9e37_79b9_7f4a_7c15));
        random.next_u32();
        random
    }

    /// 32 random bits.
    pub fn next_u32(&mut self) -> u32 {
        let state = self.0;
        self.0 = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let xorshifted = (((state >> 18) ^ state) >> 27) as u32;
        xorshifted.rotate_right((state >> 59) as u32)
    }

    /// Uniform in `[0, 1)`, a multiple of 2^-32.
    pub fn unit(&mut self) -> f64 {
        f64::from(self.next_u32()) / 4_294_967_296.0
    }

    /// Uniform in `[-1, 1)`.
    pub fn signed_unit(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Uniform in `[0, 1)`, a multiple of 2^-24, so that it is exact.
    pub fn unit_f32(&mut self) -> f32 {
        (self.next_u32() >> 8) as f32 / 16_777_216.0
    }

    /// Uniform from `low` to `high`.
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit_f32()
    }

    /// Uniform, 0 to `end` − 1; 0 for `end` 0. The bias is at most `end` · 2^-32.
    pub fn below(&mut self, end: usize) -> usize {
        ((u64::from(self.next_u32()) * end as u64) >> 32) as usize
    }
}

/// Another seed for a number, so that parts of a run have streams of their own (the finaliser of
/// MurmurHash3, A. Appleby 2011).
#[must_use]
pub fn mixed(seed: u32, number: u32) -> u32 {
    let mut x = seed ^ number.wrapping_mul(0x9e37_79b9);
    x = (x ^ (x >> 16)).wrapping_mul(0x85eb_ca6b);
    x = (x ^ (x >> 13)).wrapping_mul(0xc2b2_ae35);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stream_is_uniform() {
        let mut random = Random::new(1);
        let n = 100_000;
        let mean = (0..n).map(|_| random.unit()).sum::<f64>() / f64::from(n);
        // The mean of n uniform numbers deviates by 1/sqrt(12 n) = 0.0009; five times that is 0.0046.
        assert!((mean - 0.5).abs() < 0.0046, "{mean}");
    }

    #[test]
    fn numbers_below_an_end_take_every_value_and_none_beyond() {
        let mut random = Random::new(2);
        let mut counts = [0; 7];
        for _ in 0..7000 {
            counts[random.below(7)] += 1;
        }
        // Binomial: 1000 ± 29; five times that.
        assert!(
            counts.iter().all(|&n| (855..=1145).contains(&n)),
            "{counts:?}"
        );
        assert_eq!(random.below(0), 0);
        assert!((0..1000).all(|_| (-2.0..3.0).contains(&random.range(-2.0, 3.0))));
    }

    #[test]
    fn another_seed_is_another_stream() {
        let first = |seed| Random::new(seed).next_u32();
        assert_eq!(first(1), first(1));
        assert_ne!(first(1), first(2));
        assert_ne!(mixed(1, 0), mixed(1, 1));
    }
}
