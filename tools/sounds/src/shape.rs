//! Envelopes and levels.

use std::f64::consts::PI;

/// Rises in `rise` seconds by half a cosine, and falls to 1/e in each `fall` seconds after.
pub fn strike(seconds: f64, rise: f64, fall: f64) -> f64 {
    if seconds < 0.0 {
        0.0
    } else if seconds < rise {
        0.5 - 0.5 * libm::cos(PI * seconds / rise)
    } else {
        libm::exp(-(seconds - rise) / fall)
    }
}

/// Adds `part` to `whole` from sample `at` on, `gain` times; what is beyond the end is cut off.
pub fn add(whole: &mut [f64], at: usize, part: &[f64], gain: f64) {
    for (out, sample) in whole.iter_mut().skip(at).zip(part) {
        *out += gain * sample;
    }
}

/// Without its mean.
pub fn centred(samples: &[f64]) -> Vec<f64> {
    let mean = samples.iter().sum::<f64>() / samples.len().max(1) as f64;
    samples.iter().map(|x| x - mean).collect()
}

/// The same around 0, and begun and ended with silence: half cosines of a millisecond and of a tenth of the length.
pub fn faded(samples: &[f64], rate: u32) -> Vec<f64> {
    let mut samples = centred(samples);
    let count = samples.len();
    let first = (rate as usize / 1000).clamp(1, count);
    let last = (count / 10).max(1);
    let half = |k: usize, of: usize| 0.5 - 0.5 * libm::cos(PI * k as f64 / of as f64);
    for (k, sample) in samples.iter_mut().enumerate().take(first) {
        *sample *= half(k, first);
    }
    for (k, sample) in samples.iter_mut().rev().enumerate().take(last) {
        *sample *= half(k, last);
    }
    samples
}

/// The same with its greatest sample at `peak`.
pub fn levelled(samples: &[f64], peak: f64) -> Vec<f64> {
    let most = samples.iter().fold(0.0, |most, x| f64::max(most, x.abs()));
    let gain = if most > 0.0 { peak / most } else { 0.0 };
    samples.iter().map(|x| gain * x).collect()
}
