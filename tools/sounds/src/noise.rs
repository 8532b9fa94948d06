//! Random numbers: PCG-RXS-M-XS-32 (M. O'Neill, *PCG*, 2014), in wrapping 32-bit arithmetic.

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct Noise {
    state: u32,
}

const fn output(state: u32) -> u32 {
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

impl Noise {
    /// A stream for a seed and a name: sounds do not share numbers.
    #[must_use]
    pub fn new(seed: u32, name: &str) -> Self {
        // FNV-1a.
        let hash = name.bytes().fold(2_166_136_261_u32 ^ seed, |hash, byte| {
            (hash ^ u32::from(byte)).wrapping_mul(16_777_619)
        });
        Self {
            state: output(hash),
        }
    }

    /// The next number, 0 to 1 without 1.
    pub fn unit(&mut self) -> f64 {
        self.state = self
            .state
            .wrapping_mul(747_796_405)
            .wrapping_add(2_891_336_453);
        f64::from(output(self.state)) / 4_294_967_296.0
    }

    /// The next number from `low` to `high`.
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// The next number, −1 to 1: white noise of RMS 0.577.
    pub fn white(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// As many samples of white noise.
    pub fn burst(&mut self, samples: usize) -> Vec<f64> {
        (0..samples).map(|_| self.white()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_white_and_a_function_of_its_name() {
        let samples = Noise::new(1, "wind").burst(100_000);
        let mean = samples.iter().sum::<f64>() / 1e5;
        let square = samples.iter().map(|x| x * x).sum::<f64>() / 1e5;
        let next: f64 = samples.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / 1e5;
        // Standard errors are 0.0018, 0.0009 and 0.0011; five of them.
        assert!(mean.abs() < 0.009, "{mean}");
        assert!((square - 1.0 / 3.0).abs() < 0.0045, "{square}");
        assert!(next.abs() < 0.0055, "{next}");
        assert_eq!(samples[..4], Noise::new(1, "wind").burst(4));
        assert_ne!(samples[..4], Noise::new(1, "sea").burst(4));
    }
}
