//! Loops of air, water and fire.

use crate::filter::{Pass, round, swing};
use crate::noise::Noise;
use crate::shape::{centred, levelled, strike};

/// Samples a second: wind and surf have next to nothing above 5 kHz.
pub const RATE: u32 = 11_025;

fn count(seconds: f64) -> usize {
    (seconds * f64::from(RATE)) as usize
}

fn hertz(frequency: f64) -> f64 {
    frequency / f64::from(RATE)
}

/// Multiplies by a function of the part of the loop.
fn shaped(samples: &[f64], by: impl Fn(f64) -> f64) -> Vec<f64> {
    let length = samples.len() as f64;
    let scaled = samples
        .iter()
        .enumerate()
        .map(|(k, x)| x * by(k as f64 / length));
    scaled.collect()
}

fn sum(parts: &[(f64, Vec<f64>)]) -> Vec<f64> {
    let length = parts[0].1.len();
    let at = |k: usize| parts.iter().map(|(gain, part)| gain * part[k]).sum();
    (0..length).map(at).collect()
}

/// Wind: noise around a pitch that wanders with the gusts, and a whistle far above it.
pub fn wind(mut noise: Noise) -> Vec<f64> {
    let length = count(2.5);
    let gust = |part: f64| 0.5 + 0.28 * swing(part, 1, 0.1) + 0.22 * swing(part, 3, 0.4);
    let low = round(&noise.burst(length), Pass::Low, 0.8, |part| {
        hertz(180.0 + 260.0 * gust(part))
    });
    let middle = round(&noise.burst(length), Pass::Band, 1.6, |part| {
        hertz(420.0 + 380.0 * gust(part))
    });
    let whistle = round(&noise.burst(length), Pass::Band, 9.0, |part| {
        hertz(950.0 + 420.0 * gust(part) + 60.0 * swing(part, 5, 0.0))
    });
    let all = sum(&[
        (1.0, shaped(&low, |part| 0.6 + 0.4 * gust(part))),
        (0.8, shaped(&middle, gust)),
        (0.5, shaped(&whistle, |part| gust(part) * gust(part))),
    ]);
    let rumble = round(&all, Pass::High, 0.7, |_| hertz(60.0));
    levelled(&centred(&rumble), 0.6)
}

/// Surf: a wave that comes, breaks and runs back over sand, over others farther out.
pub fn sea(mut noise: Noise) -> Vec<f64> {
    let length = count(3.0);
    let breaks = |part: f64| {
        let wave = 0.5 + 0.5 * swing(part, 1, 0.75);
        wave * wave * wave
    };
    let runs = |part: f64| {
        let wave = 0.5 + 0.5 * swing(part, 1, 0.55);
        wave * wave
    };
    let far = round(&noise.burst(length), Pass::Low, 0.7, |_| hertz(320.0));
    let roar = round(&noise.burst(length), Pass::Low, 0.6, |part| {
        hertz(350.0 + 1100.0 * breaks(part))
    });
    let foam = round(&noise.burst(length), Pass::High, 0.7, |_| hertz(1900.0));
    let all = sum(&[
        (0.7, far),
        (1.0, shaped(&roar, |part| 0.15 + 0.85 * breaks(part))),
        (0.16, shaped(&foam, |part| 0.1 + 0.9 * runs(part))),
    ]);
    let rumble = round(&all, Pass::High, 0.7, |_| hertz(45.0));
    levelled(&centred(&rumble), 0.6)
}

/// A fire: a low flutter, hiss, and wood that cracks.
pub fn fire(mut noise: Noise) -> Vec<f64> {
    let length = count(1.2);
    let flutter = round(&noise.burst(length), Pass::Low, 0.7, |part| {
        hertz(160.0 + 60.0 * swing(part, 4, 0.2))
    });
    let hiss = round(&noise.burst(length), Pass::Band, 0.6, |_| hertz(2300.0));
    // Cracks, which go over the seam as they go over any other place.
    let mut cracks = vec![0.0; length];
    for _ in 0..26 {
        let at = (noise.unit() * length as f64) as usize;
        let loud = noise.range(0.1, 1.0);
        let fall = noise.range(0.0008, 0.004);
        for k in 0..count(0.02) {
            let time = k as f64 / f64::from(RATE);
            cracks[(at + k) % length] += noise.white() * loud * loud * strike(time, 0.0002, fall);
        }
    }
    let all = sum(&[
        (
            1.0,
            shaped(&flutter, |part| 0.7 + 0.3 * swing(part, 7, 0.0)),
        ),
        (0.08, hiss),
        (0.5, round(&cracks, Pass::High, 0.7, |_| hertz(500.0))),
    ]);
    let rumble = round(&all, Pass::High, 0.7, |_| hertz(45.0));
    levelled(&centred(&rumble), 0.6)
}
