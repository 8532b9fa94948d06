//! f32 against the f64 oracle: error in shares of the amplitude and of amplitude / wavelength, from
//! 1 m to 1e7 m from the origin; and the oracle's gradient against differences of its own values.

use crate::support;

use bevy::math::DVec2;
use dolomite_terrain::{Fractal, PermutationNoise, Sum};
use support::{Random, SUMS, WARP};

const DISTANCES: [f64; 8] = [1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7];
const SAMPLES: usize = 20_000;

/// Largest error of value and gradient at a distance, relative.
fn errors(fractal: &Fractal, distance: f64, random: &mut Random) -> (f64, f64) {
    let prepared = fractal.prepare().expect("valid");
    let amplitude = f64::from(fractal.amplitude);
    let slope = amplitude / f64::from(fractal.wavelength);
    let mut largest = (0.0_f64, 0.0_f64);
    for _ in 0..SAMPLES {
        let xz = random.place(distance);
        let exact = prepared.sample_f64(xz);
        let near = prepared.sample(support::point(xz));
        let value = (f64::from(near.value) - exact.height).abs() / amplitude;
        let gradient = (near.gradient.as_dvec2() - exact.gradient).length() / slope;
        largest = (largest.0.max(value), largest.1.max(gradient));
    }
    largest
}

#[test]
fn fbm_is_within_1e5_of_the_amplitude_at_any_distance() {
    let mut random = Random(1);
    for (wavelength, octaves) in [(1.0, 8), (200.0, 8), (4000.0, 12), (3337.7, 16)] {
        let fractal = Fractal {
            wavelength,
            octaves,
            amplitude: 1000.0,
            seed: 7,
            ..Fractal::default()
        };
        let found: Vec<_> = DISTANCES
            .iter()
            .map(|&d| errors(&fractal, d, &mut random))
            .collect();
        for (distance, (value, gradient)) in DISTANCES.iter().zip(&found) {
            println!(
                "wavelength {wavelength} octaves {octaves} distance {distance:e}: value {value:.2e}, gradient {gradient:.2e}"
            );
            assert!(*value <= 1e-5, "{distance}: {value:e}");
            assert!(*gradient <= 1e-4, "{distance}: {gradient:e}");
        }
        // No growth: maxima of 20 000 samples scatter by less than a factor of 2. Below a
        // wavelength from the origin only a few cells are seen, so compare from 1e3 m on.
        let (near, far) = (found[3], found[7]);
        assert!(
            far.0 <= 2.0 * near.0 && far.1 <= 2.0 * near.1,
            "{near:?} {far:?}"
        );
    }
}

#[test]
fn other_lacunarities_and_gains_stay_within_their_share() {
    let mut random = Random(2);
    for (lacunarity, gain) in [(1.9, 0.55), (2.17, 0.45), (3.1, 0.3)] {
        let fractal = Fractal {
            lacunarity,
            gain,
            octaves: 8,
            seed: 3,
            ..Fractal::default()
        };
        // The sum of gainᵏ, and of (gain × lacunarity)ᵏ, instead of 2 and 8.
        let total = |ratio: f32| (0..8).fold(0.0, |sum, _| sum * f64::from(ratio) + 1.0);
        let (value, gradient) = errors(&fractal, 1e6, &mut random);
        assert!(value <= 5e-6 * total(gain), "{lacunarity}: {value:e}");
        assert!(
            gradient <= 1.2e-5 * total(gain * lacunarity),
            "{lacunarity}: {gradient:e}"
        );
    }
}

#[test]
fn other_sums_and_warps_do_not_drift_either() {
    let mut random = Random(3);
    // About four times the largest seen. Rounded crests multiply the error of n by up to 32 in
    // the gradient, erosion by its second derivatives, a warp adds its displacement's error times
    // the slope.
    for (sum, warp, value_limit, gradient_limit) in [
        (Sum::Billow, None, 2.5e-6, 1e-4),
        (Sum::Ridged, None, 2.5e-6, 1e-4),
        (Sum::Eroded, None, 1e-6, 5e-5),
        (Sum::Fbm, Some(WARP), 1e-6, 3e-5),
        (Sum::Eroded, Some(WARP), 1e-6, 1.5e-4),
    ] {
        let fractal = Fractal {
            sum,
            warp,
            octaves: 8,
            ..Fractal::default()
        };
        for distance in [1e2, 1e4, 1e7] {
            let (value, gradient) = errors(&fractal, distance, &mut random);
            println!(
                "{sum:?} warped {}: {distance:e}: value {value:.2e}, gradient {gradient:.2e}",
                warp.is_some()
            );
            assert!(value <= value_limit, "{sum:?} {distance}: {value:e}");
            assert!(
                gradient <= gradient_limit,
                "{sum:?} {distance}: {gradient:e}"
            );
        }
    }
}

#[test]
fn classic_is_as_accurate() {
    let mut random = Random(4);
    let classic = PermutationNoise::default();
    let prepared = classic.prepare().expect("valid");
    for distance in DISTANCES {
        for _ in 0..2000 {
            let xz = random.place(distance);
            let exact = prepared.sample_f64(xz);
            let near = prepared.sample(support::point(xz));
            assert!((f64::from(near.value) - exact.height).abs() <= 1e-5 * 90.0);
            assert!((near.gradient.as_dvec2() - exact.gradient).length() <= 1e-4 * 90.0 / 200.0);
        }
    }
}

#[test]
fn gradients_are_the_derivatives_of_the_values() {
    let mut random = Random(5);
    for sum in SUMS {
        for warp in [None, Some(WARP)] {
            let fractal = Fractal {
                sum,
                warp,
                octaves: 5,
                lacunarity: 2.13,
                wavelength: 300.0,
                erosion: 2.0,
                ..Fractal::default()
            };
            let prepared = fractal.prepare().expect("valid");
            for _ in 0..300 {
                let xz = random.place(1000.0);
                let h = 1e-4;
                let at = |d: DVec2| prepared.sample_f64(xz + d).height;
                let slope = DVec2::new(
                    (at(DVec2::X * h) - at(DVec2::X * -h)) / (2.0 * h),
                    (at(DVec2::Y * h) - at(DVec2::Y * -h)) / (2.0 * h),
                );
                let gradient = prepared.sample_f64(xz).gradient;
                // Truncation h²/6 × third derivative (100 m over (15 m)³ × a few hundred), rounding
                // 1e-13 / h: some 1e-8; slopes are of the order of 1.
                let error = (slope - gradient).length();
                assert!(
                    error < 1e-6 * (1.0 + gradient.length()),
                    "{sum:?} {warp:?}: {error:e}"
                );
            }
        }
    }
}

#[test]
fn a_wrong_octave_is_seen() {
    // The harness must be able to fail: another seed is another function.
    let fractal = Fractal {
        seed: 1,
        ..Fractal::default()
    };
    let other = Fractal { seed: 2, ..fractal }.prepare().expect("valid");
    let xz = Random(6).place(1000.0);
    let exact = fractal.sample_f64(xz).expect("valid");
    let near = other.sample(support::point(xz));
    assert!((f64::from(near.value) - exact.height).abs() > 1e-3 * 100.0);
}
