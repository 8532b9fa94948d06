//! Numbers that look random and come again with their seed.

use glam::DVec3;

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
            state: seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x2545_f491_4f6c_dd1d,
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

    /// From 0 to `end` − 1; 0 for `end` 0.
    pub fn below(&mut self, end: usize) -> usize {
        ((u128::from(self.bits()) * end as u128) >> 64) as usize
    }

    /// True in this share of the calls.
    pub fn chance(&mut self, share: f64) -> bool {
        self.unit() < share
    }

    /// A unit vector, each direction as often (Archimedes: z and the angle are uniform).
    pub fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (sin, cos) = (std::f64::consts::TAU * self.unit()).sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(r * cos, r * sin, z)
    }
}

/// The `i`-th of `count` points of the Hammersley set in the unit square, shifted by `shift` on the torus (Cranley and
/// Patterson 1976): the second coordinate is the radical inverse of `i` in base 2.
pub fn hammersley(i: u32, count: u32, shift: [f64; 2]) -> [f64; 2] {
    let inverse = f64::from(i.reverse_bits()) / 4_294_967_296.0;
    [
        ((f64::from(i) + 0.5) / f64::from(count) + shift[0]).fract(),
        (inverse + shift[1]).fract(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stream_is_uniform_and_comes_again() {
        let mut random = Random::new(1);
        let n = 100_000;
        let mean = (0..n).map(|_| random.unit()).sum::<f64>() / f64::from(n);
        // The mean of n uniform numbers deviates by 1/sqrt(12 n) = 0.0009; five times that is 0.0046.
        assert!((mean - 0.5).abs() < 0.0046, "{mean}");
        assert_eq!(Random::new(7).bits(), Random::new(7).bits());
        assert_ne!(Random::new(7).bits(), Random::new(8).bits());
        assert!((0..1000).all(|_| random.below(3) < 3));
    }

    #[test]
    fn every_strip_of_the_hammersley_set_holds_one_point() {
        let mut strips = [[0; 64]; 2];
        for i in 0..64 {
            let point = hammersley(i, 64, [0.0; 2]);
            for (strip, x) in strips.iter_mut().zip(point) {
                strip[(x * 64.0) as usize] += 1;
            }
        }
        assert_eq!(strips, [[1; 64]; 2]);
    }
}
