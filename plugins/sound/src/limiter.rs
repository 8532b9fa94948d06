//! Keeps what comes out within full scale without cutting it.
//!
//! A limiter with look-ahead: each sample may be `CEILING / |x|` loud. The least of these over the next samples, smoothed
//! by a mean over as many, is the gain; since every term of the mean is at most what the sample in its middle allows, no
//! sample that comes out is beyond the ceiling. It delays by its look-ahead. What is below the ceiling is not changed.

use std::collections::VecDeque;

use kira::Frame;
use kira::effect::{Effect, EffectBuilder};
use kira::info::Info;

/// Greatest amplitude that comes out: 0.27 dB below full scale.
pub const CEILING: f32 = 0.97;

/// Samples that it looks ahead, and by which it delays: 1.5 ms at 44.1 kHz.
pub const AHEAD: usize = 64;

/// Part of the way back to full gain in a sample: 63 % in some 90 ms at 44.1 kHz.
const RELEASE: f32 = 1.0 / 4000.0;

/// Made by itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct LimiterBuilder;

impl EffectBuilder for LimiterBuilder {
    type Handle = ();

    fn build(self) -> (Box<dyn Effect>, Self::Handle) {
        (Box::new(Limiter::default()), ())
    }
}

/// The limiter.
#[derive(Clone, Debug)]
pub struct Limiter {
    /// The last samples, the oldest at `at`.
    samples: [Frame; AHEAD],
    /// The gains of the mean.
    gains: [f32; AHEAD],
    sum: f64,
    at: usize,
    time: u64,
    /// What is allowed, with the time; rising from front to back: the front is the least of the last [`AHEAD`].
    least: VecDeque<(u64, f32)>,
    gain: f32,
}

impl Default for Limiter {
    fn default() -> Self {
        Self {
            samples: [Frame::ZERO; AHEAD],
            gains: [1.0; AHEAD],
            sum: AHEAD as f64,
            at: 0,
            time: 0,
            least: VecDeque::with_capacity(AHEAD + 1),
            gain: 1.0,
        }
    }
}

impl Limiter {
    /// The sample of [`AHEAD`] − 1 samples ago, as loud as it may be. What is not finite counts as silence.
    pub fn next(&mut self, sample: Frame) -> Frame {
        let whole = sample.left.is_finite() && sample.right.is_finite();
        let sample = if whole { sample } else { Frame::ZERO };
        let most = sample.left.abs().max(sample.right.abs());
        let allowed = if most > CEILING { CEILING / most } else { 1.0 };
        while self
            .least
            .back()
            .is_some_and(|(_, known)| *known >= allowed)
        {
            self.least.pop_back();
        }
        self.least.push_back((self.time, allowed));
        if self
            .least
            .front()
            .is_some_and(|(time, _)| time + AHEAD as u64 <= self.time)
        {
            self.least.pop_front();
        }
        let least = self.least.front().map_or(1.0, |(_, allowed)| *allowed);
        self.gain = least.min(self.gain + RELEASE * (1.0 - self.gain));
        self.sum += f64::from(self.gain) - f64::from(self.gains[self.at]);
        self.gains[self.at] = self.gain;
        self.samples[self.at] = sample;
        self.at = (self.at + 1) % AHEAD;
        self.time += 1;
        let mean = (self.sum / AHEAD as f64).min(1.0) as f32;
        self.samples[self.at] * mean
    }
}

impl Effect for Limiter {
    fn process(&mut self, input: &mut [Frame], _: f64, _: &Info) {
        for frame in input {
            *frame = self.next(*frame);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(samples: impl Iterator<Item = f32>) -> Vec<f32> {
        let mut limiter = Limiter::default();
        samples
            .map(|x| limiter.next(Frame::from_mono(x)).left)
            .collect()
    }

    #[test]
    fn what_is_soft_comes_out_as_it_was() {
        let soft: Vec<f32> = (0..1000)
            .map(|k| 0.9 * ((k * 37 % 100) as f32 / 50.0 - 1.0))
            .collect();
        let out = run(soft.iter().copied());
        assert_eq!(out[AHEAD - 1..], soft[..1000 - (AHEAD - 1)]);
    }

    #[test]
    fn nothing_is_beyond_the_ceiling_and_nothing_jumps() {
        let mut state = 7_u32;
        let wild: Vec<f32> = (0..200_000)
            .map(|k| {
                state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
                let white = (state >> 8) as f32 / 8_388_608.0 - 1.0;
                // Bursts of up to 40 times full scale, silence, single spikes.
                match (k / 5000) % 4 {
                    0 => 40.0 * white,
                    1 => 0.0,
                    2 => 0.5 * white,
                    _ => f32::from(u8::from(k % 611 == 0)) * 1e6,
                }
            })
            .collect();
        let out = run(wild.iter().copied());
        let most = out.iter().fold(0.0, |most: f32, x| most.max(x.abs()));
        // The mean is of rounded numbers.
        assert!(most <= CEILING * (1.0 + 1e-6), "{most}");
        assert!(most > 0.9, "{most}");
        // The gain, where a steady tone tells it, changes little from sample to sample.
        let steady = run((0..20_000).map(|k| {
            if (5000..10_000).contains(&k) {
                5.0
            } else {
                0.5
            }
        }));
        let before = steady[4000..5000]
            .windows(2)
            .map(|w| (w[1] - w[0]).abs())
            .fold(0.0, f32::max);
        assert!(before < 1e-6);
        let inside = steady[5200..9000]
            .windows(2)
            .map(|w| (w[1] - w[0]).abs())
            .fold(0.0, f32::max);
        assert!(inside < 1e-4, "{inside}");
    }

    #[test]
    fn what_is_not_finite_is_silence() {
        let bad = [f32::NAN, f32::INFINITY, 0.5, f32::NEG_INFINITY];
        let out = run(bad.into_iter().cycle().take(4000));
        assert!(out.iter().all(|x| x.is_finite()));
        assert_eq!(out[AHEAD - 1..AHEAD + 3], [0.0, 0.0, 0.5, 0.0]);
    }
}
