//! Integer hashes and the random stream that every texture is made from.
//!
//! The mixing function is the output permutation of PCG-RXS-M-XS-32 after one
//! step of its generator, the form that Jarzynski & Olano, "Hash Functions for
//! GPU Rendering" (JCGT 9(3), 2020), recommend for procedural textures. All of
//! it is wrapping 32-bit integer arithmetic, so it gives the same bits on every
//! machine.

/// One step of the PCG generator followed by its output permutation: a
/// bijection of the 32-bit integers.
#[must_use]
pub const fn pcg(x: u32) -> u32 {
    let state = x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// Hash of a lattice cell under a seed.
#[must_use]
pub const fn hash_cell(x: u32, y: u32, seed: u32) -> u32 {
    pcg(x.wrapping_add(pcg(y.wrapping_add(pcg(seed)))))
}

/// The top 24 bits of a hash as a number in `[0, 1)`; every such number is
/// exact in `f32`.
#[must_use]
pub const fn unit(hash: u32) -> f32 {
    (hash >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// A stream of pseudo-random numbers: PCG-RXS-M-XS-32, period 2^32.
///
/// Used where things are scattered one after another (blades, stones); places
/// that are evaluated per texel use [`hash_cell`] instead, so that they do not
/// depend on the order of evaluation.
#[derive(Clone, Debug)]
pub struct Stream {
    state: u32,
}

impl Stream {
    /// A stream that is a function of the seed only.
    #[must_use]
    pub const fn new(seed: u32) -> Self {
        Self { state: pcg(seed) }
    }

    /// The next 32 bits.
    pub const fn bits(&mut self) -> u32 {
        let out = pcg(self.state);
        self.state = self
            .state
            .wrapping_mul(747_796_405)
            .wrapping_add(2_891_336_453);
        out
    }

    /// The next number in `[0, 1)`.
    pub const fn unit(&mut self) -> f32 {
        unit(self.bits())
    }

    /// The next number in `[low, high)`.
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// The next number in `(-1, 1)`, densest at 0 (sum of two uniform numbers:
    /// a triangular distribution of standard deviation 0.41).
    pub fn signed(&mut self) -> f32 {
        self.unit() - self.unit()
    }

    /// A direction uniform on the unit circle.
    pub fn direction(&mut self) -> [f32; 2] {
        direction(self.unit())
    }
}

/// The unit vector at an angle given in turns (1 = the full circle).
#[must_use]
pub fn direction(turns: f32) -> [f32; 2] {
    [crate::wave::cos_turns(turns), crate::wave::sin_turns(turns)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pcg_is_a_bijection_on_a_sample() {
        let mut seen: Vec<u32> = (0..100_000).map(pcg).collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), 100_000);
    }

    #[test]
    fn stream_has_the_mean_and_variance_of_the_uniform_distribution() {
        let mut stream = Stream::new(7);
        let n = 100_000;
        let (mut sum, mut squares) = (0.0_f64, 0.0_f64);
        for _ in 0..n {
            let x = f64::from(stream.unit());
            assert!((0.0..1.0).contains(&x));
            sum += x;
            squares += x * x;
        }
        let mean = sum / f64::from(n);
        let variance = squares / f64::from(n) - mean * mean;
        // Standard error of the mean is 0.29/sqrt(n) = 0.0009; 5 of them.
        assert!((mean - 0.5).abs() < 0.005, "{mean}");
        assert!((variance - 1.0 / 12.0).abs() < 0.002, "{variance}");
    }

    #[test]
    fn streams_of_different_seeds_differ() {
        let a: Vec<u32> = {
            let mut s = Stream::new(1);
            (0..8).map(|_| s.bits()).collect()
        };
        let b: Vec<u32> = {
            let mut s = Stream::new(2);
            (0..8).map(|_| s.bits()).collect()
        };
        assert_ne!(a, b);
    }
}
