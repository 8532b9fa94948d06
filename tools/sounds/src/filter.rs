//! Filters.
//!
//! A loop is filtered by going round it until the filter has forgotten how it began: what comes out then is the
//! response to the endless repetition, which has no seam.

use std::f64::consts::{PI, TAU};

/// A state variable filter of two poles (A. Simper, *Linear trapezoidal integrated SVF*, 2013).
#[derive(Clone, Copy, Debug, Default)]
pub struct Filter {
    first: f64,
    second: f64,
}

/// What a filter lets through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pass {
    /// Below its frequency.
    Low,
    /// Around it; 1 at its middle.
    Band,
    /// Above it.
    High,
}

impl Filter {
    /// The next sample; `frequency` in parts of the sample rate, below 0.49, `quality` is middle over width.
    pub fn next(&mut self, pass: Pass, frequency: f64, quality: f64, sample: f64) -> f64 {
        let g = libm::tan(PI * frequency.clamp(1e-5, 0.49));
        let k = 1.0 / quality;
        let a1 = 1.0 / (1.0 + g * (g + k));
        let v3 = sample - self.second;
        let v1 = a1 * self.first + a1 * g * v3;
        let v2 = self.second + g * v1;
        self.first = 2.0 * v1 - self.first;
        self.second = 2.0 * v2 - self.second;
        match pass {
            Pass::Low => v2,
            Pass::Band => k * v1,
            Pass::High => sample - k * v1 - v2,
        }
    }
}

/// Filters samples from silence.
pub fn filtered(samples: &[f64], pass: Pass, frequency: f64, quality: f64) -> Vec<f64> {
    let mut filter = Filter::default();
    samples
        .iter()
        .map(|sample| filter.next(pass, frequency, quality, *sample))
        .collect()
}

/// Filters a loop; `frequency` by the part of the loop, 0 to 1, and itself a loop.
pub fn round(
    samples: &[f64],
    pass: Pass,
    quality: f64,
    frequency: impl Fn(f64) -> f64,
) -> Vec<f64> {
    let mut filter = Filter::default();
    let mut out = vec![0.0; samples.len()];
    // Twice is enough: a filter that passes 20 Hz has forgotten everything after some tenths of a second.
    for _ in 0..3 {
        for (k, sample) in samples.iter().enumerate() {
            let part = k as f64 / samples.len() as f64;
            out[k] = filter.next(pass, frequency(part), quality, *sample);
        }
    }
    out
}

/// A wave that goes `times` round the loop: −1 to 1 at a part of it.
pub fn swing(part: f64, times: u32, phase: f64) -> f64 {
    libm::sin(TAU * (part * f64::from(times) + phase))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;

    fn gain(pass: Pass, at: f64) -> f64 {
        // 100 whole waves, the first half left out.
        let count = (100.0 / at) as usize;
        let wave: Vec<f64> = (0..count).map(|k| libm::sin(TAU * at * k as f64)).collect();
        let out = filtered(&wave, pass, 0.02, 1.0);
        let square: f64 = out[count / 2..].iter().map(|x| x * x).sum();
        (2.0 * square / (count / 2) as f64).sqrt()
    }

    #[test]
    fn filters_pass_what_they_are_for() {
        assert!((gain(Pass::Band, 0.02) - 1.0).abs() < 0.01);
        assert!(gain(Pass::Band, 0.2) < 0.1 && gain(Pass::Band, 0.001) < 0.1);
        assert!((gain(Pass::Low, 0.001) - 1.0).abs() < 0.01 && gain(Pass::Low, 0.2) < 0.02);
        assert!((gain(Pass::High, 0.3) - 1.0).abs() < 0.02 && gain(Pass::High, 0.001) < 0.01);
    }

    #[test]
    fn a_loop_has_no_seam() {
        let noise = Noise::new(1, "loop").burst(4000);
        let once = round(&noise, Pass::Band, 2.0, |part| {
            0.02 + 0.01 * swing(part, 1, 0.0)
        });
        // Going round once more changes nothing.
        let mut twice = noise.clone();
        twice.extend(&noise);
        let again = round(&twice, Pass::Band, 2.0, |part| {
            0.02 + 0.01 * swing((2.0 * part).fract(), 1, 0.0)
        });
        let worst = (0..4000)
            .map(|k| (once[k] - again[4000 + k]).abs())
            .fold(0.0, f64::max);
        assert!(worst < 1e-12, "{worst}");
    }
}
