//! Numbers that look random and come again with their seed.

/// A generator of random numbers (SplitMix64: Steele, Lea, Flood, "Fast splittable pseudorandom number generators",
/// 2014).
#[derive(Debug, Clone)]
pub struct Random {
    state: u64,
}

impl Random {
    /// Begins at a seed; neighbouring seeds give unlike numbers.
    pub fn new(seed: u64) -> Self {
        Self {
            state: seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d,
        }
    }

    /// All 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From 0 up to 1, without 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From `low` up to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// From `low` up to `high`, both above 0, each order of magnitude as often.
    pub fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// From 0 up to `count`, without `count`; 0 where there is nothing to choose from.
    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() % (count.max(1) as u64)) as usize
    }

    /// True with a chance of 0 to 1.
    pub fn chance(&mut self, chance: f64) -> bool {
        self.unit() < chance
    }

    /// One of some.
    pub fn pick<T: Clone>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())].clone()
    }

    /// Three numbers up to `size` either way, to hundredths, so that files stay readable.
    pub fn vector(&mut self, size: f64) -> [f64; 3] {
        [0, 1, 2].map(|_| round(self.between(-size, size), 2))
    }
}

/// To so many decimal places.
pub fn round(x: f64, places: i32) -> f64 {
    let shift = 10_f64.powi(places);
    (x * shift).round() / shift
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_come_again_and_neighbours_differ() {
        let first = |seed| Random::new(seed).bits();
        assert_eq!(first(7), first(7));
        assert!((first(7) ^ first(8)).count_ones() > 16);
        let mut random = Random::new(1);
        let mean = (0..10_000).map(|_| random.unit()).sum::<f64>() / 1e4;
        assert!((mean - 0.5).abs() < 0.02, "{mean}");
    }
}
