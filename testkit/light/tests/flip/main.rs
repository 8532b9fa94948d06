//! FLIP against the reference implementation: values of `flip-evaluator` 1.7 that `reference.py` wrote down, and the
//! crate `nv-flip`, which is version 1.2 of it.

#![expect(clippy::disallowed_methods, reason = "colours in f64")]

use dolomite_light_oracle::Image;
use dolomite_light_oracle::flip::{
    Exposures, PIXELS_PER_DEGREE, ToneMap, exposures, hdr, hdr_with, ldr,
};
use glam::DVec3;

const VALUES: &str = include_str!("values.txt");

/// Integers of 0 to 255, as `reference.py` has them.
fn noise(seed: u64, n: usize) -> Vec<u32> {
    let mut state = seed;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 56) as u32
    };
    (0..n).map(|_| next()).collect()
}

/// The two images of `reference.py`, in integers.
fn images(seed: u32, width: u32, height: u32) -> [Vec<u32>; 2] {
    let n = 3 * width * height;
    let values = noise(u64::from(seed), 2 * n as usize);
    let (mut first, mut second) = (Vec::new(), Vec::new());
    for y in 0..height {
        for x in 0..width {
            for c in 0..3 {
                let k = 3 * (y * width + x) + c;
                let stripe = if (x / 4 + y / 3 + c) % 2 == 1 { 40 } else { 0 };
                let base = (x * 200 / width + stripe + values[k as usize] / 16) % 256;
                let in_part = (x + 2 * y) % 3 == seed % 3;
                let off = if in_part {
                    values[(n + k) as usize] / 8
                } else {
                    0
                };
                first.push(base);
                second.push((base + off).min(255));
            }
        }
    }
    [first, second]
}

fn image(width: u32, height: u32, values: &[u32], of: impl Fn(f64) -> f64) -> Image {
    let pixels = values
        .chunks_exact(3)
        .map(|p| DVec3::from_array([0, 1, 2].map(|c| of(f64::from(p[c])))))
        .collect();
    Image::new(width, height, pixels).expect("three values a pixel")
}

/// Linear light of an 8-bit sRGB level (IEC 61966-2-1).
fn linear(level: f64) -> f64 {
    let s = level / 255.0;
    if s <= 0.04045 {
        s / 12.92
    } else {
        ((s + 0.055) / 1.055).powf(2.4)
    }
}

fn radiance(v: f64) -> f64 {
    ((v / 16.0).floor() - 12.0).exp2() * (1.0 + (v % 16.0) / 16.0)
}

/// The reference is in f32, has its white and its matrices to some nine digits, and its values are written with six.
/// Measured: 3.5e-6.
const BOUND: f64 = 5e-6;

#[test]
fn every_pixel_has_the_error_of_the_reference() {
    let mut pixels = 0;
    let mut worst: f64 = 0.0;
    for line in VALUES.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let number = |k: usize| words[k].parse::<f64>().unwrap();
        let [seed, width, height] = [1, 2, 3].map(|k| number(k) as u32);
        let of: &dyn Fn(f64) -> f64 = if words[0] == "LDR" {
            &linear
        } else {
            &radiance
        };
        let [reference, test] =
            images(seed, width, height).map(|values| image(width, height, &values, of));
        let flip = if words[0] == "LDR" {
            ldr(&test, &reference, PIXELS_PER_DEGREE).unwrap()
        } else {
            let curve = if words[4] == "ACES" {
                ToneMap::Aces
            } else {
                ToneMap::Reinhard
            };
            let looked = exposures(&reference, curve);
            let theirs = Exposures {
                start: number(5),
                stop: number(6),
                count: number(7) as u32,
            };
            assert_eq!(looked.count, theirs.count, "{line:.80}");
            assert!(
                (looked.start - theirs.start).abs() < 1e-5,
                "{looked:?} {theirs:?}"
            );
            assert!(
                (looked.stop - theirs.stop).abs() < 1e-5,
                "{looked:?} {theirs:?}"
            );
            hdr_with(&test, &reference, curve, looked, PIXELS_PER_DEGREE)
                .unwrap()
                .flip
        };
        let mean = (flip.mean() - number(8)).abs();
        assert!(mean < BOUND, "{line:.80}: mean {}", flip.mean());
        assert_eq!(words.len() - 9, flip.errors.len());
        for (k, error) in flip.errors.iter().enumerate() {
            pixels += 1;
            worst = worst.max((error - number(9 + k)).abs());
        }
    }
    println!("{pixels} pixels, worst {worst:e}");
    assert!(pixels > 2000);
    assert!(worst < BOUND, "{worst:e}");
}

#[test]
fn it_is_what_nv_flip_says() {
    for (seed, width, height) in [(11, 64, 40), (12, 33, 70)] {
        let [a, b] = images(seed, width, height);
        let theirs = |values: &[u32]| {
            let bytes: Vec<u8> = values.iter().map(|v| *v as u8).collect();
            nv_flip::FlipImageRgb8::with_data(width, height, &bytes)
        };
        let degree = PIXELS_PER_DEGREE as f32;
        let theirs = nv_flip::flip(theirs(&a), theirs(&b), degree).to_vec();
        let [a, b] = [a, b].map(|values| image(width, height, &values, linear));
        let ours = ldr(&b, &a, PIXELS_PER_DEGREE).unwrap();
        let worst = ours
            .errors
            .iter()
            .zip(theirs)
            .map(|(ours, theirs)| (ours - f64::from(theirs)).abs())
            .fold(0.0, f64::max);
        println!("{worst:e}");
        assert!(worst < BOUND, "{worst:e}");
    }
}

#[test]
fn equal_images_are_equal_and_black_against_white_is_1() {
    let [a, _] = images(1, 20, 20);
    let a = image(20, 20, &a, radiance);
    assert_eq!(hdr(&a, &a).unwrap().flip.max(), 0.0);
    let flat = |x: f64| Image::new(9, 9, vec![DVec3::splat(x); 81]).unwrap();
    let error = ldr(&flat(0.0), &flat(1.0), PIXELS_PER_DEGREE).unwrap();
    assert!(error.mean() > 0.95 && error.max() <= 1.0);
    // Nothing to see is nothing to see.
    assert_eq!(hdr(&flat(0.0), &flat(0.0)).unwrap().flip.max(), 0.0);
}

#[test]
fn a_pixel_that_is_no_number_is_an_error_of_1_and_of_no_other_pixel_more_than_black() {
    let [values, _] = images(1, 20, 20);
    let good = image(20, 20, &values, radiance);
    for bad in [f64::NAN, f64::INFINITY] {
        let mut test = good.clone();
        test.pixels[210].y = bad;
        let flip = hdr(&test, &good).unwrap().flip;
        assert_eq!(flip.errors[210], 1.0);
        assert!(flip.errors.iter().all(|e| (0.0..=1.0).contains(e)));
        test.pixels[210] = DVec3::ZERO;
        let black = hdr(&test, &good).unwrap().flip;
        for (k, error) in flip.errors.iter().enumerate() {
            assert!(k == 210 || *error == black.errors[k]);
        }
    }
}

#[test]
fn images_of_two_sizes_are_refused() {
    let flat = |w: u32, h: u32| Image::new(w, h, vec![DVec3::ONE; (w * h) as usize]).unwrap();
    let error = hdr(&flat(3, 4), &flat(4, 3)).unwrap_err().to_string();
    assert!(
        error.contains("[3, 4]") && error.contains("[4, 3]"),
        "{error}"
    );
}
