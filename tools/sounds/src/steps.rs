//! Steps: a heel that lands, and what the ground gives back.

use crate::filter::{Filter, Pass, filtered};
use crate::noise::Noise;
use crate::shape::{add, faded, levelled, strike};
use std::f64::consts::TAU;

/// Samples a second.
pub const RATE: u32 = 22_050;

/// What is walked on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Walked {
    /// Rock and scree.
    Rock,
    /// Grass.
    Grass,
    /// Sand.
    Sand,
    /// Snow.
    Snow,
    /// Paving.
    Road,
    /// Shallow water.
    Water,
}

fn count(seconds: f64) -> usize {
    (seconds * f64::from(RATE)) as usize
}

/// A frequency as a part of the sample rate.
fn hertz(frequency: f64) -> f64 {
    frequency / f64::from(RATE)
}

/// Noise between two frequencies under an envelope.
fn hiss(noise: &mut Noise, seconds: f64, band: (f64, f64), rise: f64, fall: f64) -> Vec<f64> {
    let white = noise.burst(count(seconds));
    let low = filtered(&white, Pass::High, hertz(band.0), 0.7);
    let both = filtered(&low, Pass::Low, hertz(band.1), 0.7);
    let shaped = both
        .iter()
        .enumerate()
        .map(|(k, sample)| sample * strike(k as f64 / f64::from(RATE), rise, fall));
    shaped.collect()
}

/// A body that gives way: a wave whose pitch sinks by a third while it dies away.
fn thump(seconds: f64, pitch: f64, fall: f64) -> Vec<f64> {
    let mut turns = 0.0;
    let wave = (0..count(seconds)).map(|k| {
        let time = k as f64 / f64::from(RATE);
        turns += hertz(pitch) * (0.67 + 0.33 * strike(time, 0.0, 0.02));
        libm::sin(TAU * turns) * strike(time, 0.002, fall)
    });
    wave.collect()
}

/// Many small bursts: grains of sand, crystals, stalks. `times` a second, each `long` seconds, in a band around
/// `pitch`, which varies by half.
fn grains(noise: &mut Noise, seconds: f64, times: f64, long: f64, pitch: f64) -> Vec<f64> {
    let mut out = vec![0.0; count(seconds)];
    for _ in 0..(seconds * times) as usize {
        let at = count(noise.range(0.0, seconds * 0.9));
        let mut filter = Filter::default();
        let own = pitch * noise.range(0.75, 1.5);
        let loud = noise.range(0.2, 1.0);
        let grain: Vec<f64> = (0..count(long))
            .map(|k| {
                let time = k as f64 / f64::from(RATE);
                let white = noise.white() * strike(time, 0.0005, long / 4.0);
                filter.next(Pass::Band, hertz(own), 2.0, white)
            })
            .collect();
        add(&mut out, at, &grain, loud);
    }
    out
}

/// The same, louder in the middle of a step: heel first, then the weight comes over.
fn pressed(samples: &[f64], middle: f64, width: f64) -> Vec<f64> {
    let shaped = samples.iter().enumerate().map(|(k, sample)| {
        let off = (k as f64 / f64::from(RATE) - middle) / width;
        sample * libm::exp(-off * off)
    });
    shaped.collect()
}

/// One step.
pub fn step(walked: Walked, mut noise: Noise) -> Vec<f64> {
    let noise = &mut noise;
    let long = if walked == Walked::Water { 0.24 } else { 0.15 };
    let mut out = vec![0.0; count(long)];
    let heel = noise.range(0.9, 1.1);
    // When the ball of the foot follows.
    let ball = count(noise.range(0.045, 0.065));
    match walked {
        Walked::Rock => {
            add(&mut out, 0, &thump(0.1, 110.0 * heel, 0.02), 0.5);
            add(
                &mut out,
                0,
                &hiss(noise, 0.06, (1500.0, 5200.0), 0.001, 0.009),
                0.9,
            );
            add(
                &mut out,
                ball,
                &hiss(noise, 0.08, (900.0, 4200.0), 0.006, 0.018),
                0.45,
            );
            add(&mut out, 0, &grains(noise, 0.14, 160.0, 0.006, 3400.0), 0.5);
        }
        Walked::Grass => {
            add(&mut out, 0, &thump(0.12, 75.0 * heel, 0.025), 0.45);
            let rustle = grains(noise, 0.15, 900.0, 0.004, 4200.0);
            add(&mut out, 0, &pressed(&rustle, 0.05, 0.045), 0.5);
            add(
                &mut out,
                0,
                &hiss(noise, 0.14, (700.0, 3800.0), 0.025, 0.03),
                0.5,
            );
        }
        Walked::Sand => {
            add(&mut out, 0, &thump(0.12, 62.0 * heel, 0.03), 0.6);
            let grit = grains(noise, 0.15, 1600.0, 0.003, 2300.0);
            add(&mut out, 0, &pressed(&grit, 0.06, 0.05), 0.35);
            add(
                &mut out,
                0,
                &hiss(noise, 0.15, (250.0, 1700.0), 0.02, 0.035),
                0.8,
            );
        }
        Walked::Snow => {
            add(&mut out, 0, &thump(0.1, 95.0 * heel, 0.02), 0.3);
            let crunch = grains(noise, 0.15, 700.0, 0.007, 1900.0);
            add(&mut out, 0, &pressed(&crunch, 0.06, 0.05), 0.9);
            let squeak = grains(noise, 0.15, 300.0, 0.012, 900.0);
            add(&mut out, 0, &pressed(&squeak, 0.075, 0.04), 0.7);
        }
        Walked::Road => {
            add(&mut out, 0, &thump(0.08, 150.0 * heel, 0.014), 0.8);
            add(
                &mut out,
                0,
                &hiss(noise, 0.03, (2000.0, 5500.0), 0.0006, 0.004),
                0.8,
            );
            add(&mut out, ball, &thump(0.07, 105.0 * heel, 0.016), 0.5);
            add(
                &mut out,
                ball,
                &hiss(noise, 0.04, (1200.0, 3600.0), 0.001, 0.007),
                0.4,
            );
        }
        Walked::Water => {
            add(
                &mut out,
                0,
                &hiss(noise, 0.22, (500.0, 3200.0), 0.012, 0.05),
                1.0,
            );
            // Bubbles: pitches that rise while they close (M. Minnaert, 1933: pitch is inverse to the radius).
            for _ in 0..7 {
                let at = count(noise.range(0.03, 0.15));
                let pitch = noise.range(450.0, 1300.0);
                let mut turns = 0.0;
                let bubble: Vec<f64> = (0..count(0.06))
                    .map(|k| {
                        let time = k as f64 / f64::from(RATE);
                        turns += hertz(pitch * (1.0 + 9.0 * time));
                        libm::sin(TAU * turns) * strike(time, 0.003, 0.012)
                    })
                    .collect();
                add(&mut out, at, &bubble, noise.range(0.15, 0.4));
            }
        }
    }
    levelled(&faded(&out, RATE), 0.7)
}
