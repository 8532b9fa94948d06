//! What things and people make heard: a crossbow, a bolt that hits, a call, a lift, a latch.

use crate::filter::{Filter, Pass, filtered, round, swing};
use crate::noise::Noise;
use crate::shape::{add, centred, faded, levelled, strike};
use std::f64::consts::TAU;

/// Samples a second of what is short and sharp.
pub const SHARP: u32 = 22_050;

/// Samples a second of the others.
pub const DULL: u32 = 11_025;

fn count(seconds: f64, rate: u32) -> usize {
    (seconds * f64::from(rate)) as usize
}

fn time(k: usize, rate: u32) -> f64 {
    k as f64 / f64::from(rate)
}

/// A crossbow: the nut lets go, the string slaps the stock, the prod hums.
pub fn shot(mut noise: Noise) -> Vec<f64> {
    let mut out = vec![0.0; count(0.32, SHARP)];
    let click = noise.burst(count(0.02, SHARP));
    let click: Vec<f64> = (0..)
        .zip(filtered(&click, Pass::High, 2500.0 / f64::from(SHARP), 0.8))
        .map(|(k, x)| x * strike(time(k, SHARP), 0.0003, 0.002))
        .collect();
    add(&mut out, 0, &click, 0.7);
    let slap = noise.burst(count(0.1, SHARP));
    let slap: Vec<f64> = (0..)
        .zip(filtered(&slap, Pass::Low, 2600.0 / f64::from(SHARP), 0.9))
        .map(|(k, x)| x * strike(time(k, SHARP), 0.0008, 0.012))
        .collect();
    let at = count(0.008, SHARP);
    add(&mut out, at, &slap, 1.6);
    // A string that is slack after the shot: its partials are no whole multiples.
    for (pitch, gain, fall) in [(128.0, 0.8, 0.06), (311.0, 0.4, 0.04), (587.0, 0.2, 0.025)] {
        let hum: Vec<f64> = (0..count(0.3, SHARP))
            .map(|k| {
                let t = time(k, SHARP);
                libm::sin(TAU * pitch * t * (1.0 - 0.25 * t)) * strike(t, 0.001, fall)
            })
            .collect();
        add(&mut out, at, &hum, gain);
    }
    levelled(&faded(&out, SHARP), 0.8)
}

/// A bolt that hits somebody or something soft.
pub fn hit(mut noise: Noise) -> Vec<f64> {
    let mut out = vec![0.0; count(0.14, SHARP)];
    let mut filter = Filter::default();
    let mut turns = 0.0;
    for (k, sample) in out.iter_mut().enumerate() {
        let t = time(k, SHARP);
        turns += (140.0 - 260.0 * t) / f64::from(SHARP);
        let body = libm::sin(TAU * turns) * strike(t, 0.001, 0.025);
        let white = noise.white() * strike(t, 0.0004, 0.01);
        let dull = filter.next(Pass::Low, 1500.0 / f64::from(SHARP), 0.8, white);
        *sample = body + 1.2 * dull;
    }
    levelled(&faded(&out, SHARP), 0.7)
}

/// A call: a voice whose pitch rises and falls, through two formants that go from one vowel to another.
pub fn call(mut noise: Noise) -> Vec<f64> {
    let long = 0.5;
    let (mut first, mut second, mut third) =
        (Filter::default(), Filter::default(), Filter::default());
    let mut turns = 0.0;
    let voiced = (0..count(long, DULL)).map(|k| {
        let t = time(k, DULL);
        let part = t / long;
        let pitch = 165.0 + 85.0 * libm::sin(0.5 * TAU * part) + 4.0 * libm::sin(TAU * 6.0 * t);
        turns += pitch / f64::from(DULL);
        // The pulse of the vocal folds: harmonics that fall off, none above half the sample rate.
        let most = (0.45 * f64::from(DULL) / pitch) as u32;
        let pulse: f64 = (1..=most.min(24))
            .map(|n| libm::sin(TAU * turns * f64::from(n)) / f64::from(n))
            .sum();
        let source = pulse + 0.08 * noise.white();
        let at = |from: f64, to: f64| (from + (to - from) * part) / f64::from(DULL);
        let vowel = first.next(Pass::Band, at(560.0, 420.0), 5.0, source)
            + 0.7 * second.next(Pass::Band, at(1750.0, 2000.0), 8.0, source)
            + 0.25 * third.next(Pass::Band, at(2600.0, 2700.0), 8.0, source);
        let rise = (t / 0.04).min(1.0);
        let fall = ((long - t) / 0.16).min(1.0);
        vowel * rise * fall
    });
    let samples: Vec<f64> = voiced.collect();
    levelled(&faded(&samples, DULL), 0.8)
}

/// A lift under way, a loop: a winch of whole turns, wheels on a rail.
pub fn lift(mut noise: Noise) -> Vec<f64> {
    let length = count(0.6, DULL);
    let rail = round(&noise.burst(length), Pass::Band, 1.2, |_| {
        700.0 / f64::from(DULL)
    });
    let hum = (0..length).map(|k| {
        let part = k as f64 / length as f64;
        // Whole waves in 0.6 s: 55, 110, 165 and 275 Hz.
        let waves = [(33, 0.5), (66, 0.35), (99, 0.2), (165, 0.12)];
        let sum: f64 = waves
            .iter()
            .map(|(times, gain)| gain * swing(part, *times, 0.0))
            .sum();
        let clatter = 0.5 + 0.5 * swing(part, 6, 0.0);
        sum + 0.9 * rail[k] * (0.4 + 0.6 * clatter * clatter)
    });
    let hum: Vec<f64> = hum.collect();
    levelled(&centred(&hum), 0.6)
}

/// A latch or a button.
pub fn latch(mut noise: Noise) -> Vec<f64> {
    let mut out = vec![0.0; count(0.09, SHARP)];
    for (at, pitch, gain) in [(0.0, 2900.0, 1.0), (0.028, 1900.0, 0.7)] {
        let mut filter = Filter::default();
        let tick: Vec<f64> = (0..count(0.05, SHARP))
            .map(|k| {
                let white = noise.white() * strike(time(k, SHARP), 0.0003, 0.003);
                filter.next(Pass::Band, pitch / f64::from(SHARP), 3.0, white)
            })
            .collect();
        add(&mut out, count(at, SHARP), &tick, gain);
    }
    levelled(&faded(&out, SHARP), 0.6)
}
