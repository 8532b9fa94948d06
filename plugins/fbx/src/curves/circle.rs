//! Sines and cosines of angles in degrees, the same on every machine.
//!
//! The nearest whole number of quarter turns is taken away first, which is exact in degrees and is not in radians. What is left is at
//! most an eighth of a turn, where the series to the 15th and 16th power are off by less than half of what f64 rounds by:
//! (pi/4)^17 / 17! = 5e-17 and (pi/4)^18 / 18! = 2e-18.

use glam::DVec2;

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Beside this f64 has whole numbers alone: adding it rounds to the nearest one, which its last bits then are.
const WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;

/// Angles up to here are taken apart exactly: 90 times a whole number is one of f64, and so is what it leaves.
const EXACT: f64 = 1e9;

/// 1 over n (n + 1) and over n (n - 1), for n = 14, 12 and so on: each term of both series over the one before it.
const FACTORS: [(f64, f64); 7] = {
    let mut out = [(0.0, 0.0); 7];
    let mut i = 0;
    while i < 7 {
        let n = 14.0 - 2.0 * i as f64;
        out[i] = (1.0 / (n * (n + 1.0)), 1.0 / (n * (n - 1.0)));
        i += 1;
    }
    out
};

/// The sine and the cosine of an angle, degrees: within 3e-16. What is no number gives none.
pub(super) fn sin_cos(degrees: f64) -> (f64, f64) {
    if degrees == 0.0 {
        return (0.0, 1.0);
    }
    if degrees.is_nan() || degrees.abs() > EXACT {
        let there = DVec2::from_angle(degrees.to_radians());
        return (there.y, there.x);
    }
    let rounded = degrees * (1.0 / 90.0) + WHOLE;
    let x = (degrees - (rounded - WHOLE) * 90.0) * DEGREE;
    let x2 = x * x;
    let mut sine = 1.0;
    // The term of the 16th power.
    let mut cosine = 1.0 - x2 * (1.0 / 240.0);
    for (of_sine, of_cosine) in FACTORS {
        sine = 1.0 - sine * x2 * of_sine;
        cosine = 1.0 - cosine * x2 * of_cosine;
    }
    let sine = x * sine;
    match rounded.to_bits() & 3 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_and_cosines_are_those_of_radians() {
        for i in -20_000..20_000 {
            let degrees = f64::from(i) * 0.037_1;
            let (sine, cosine) = sin_cos(degrees);
            let there = DVec2::from_angle(degrees.to_radians());
            // An angle of some 700 degrees is rounded in radians by up to 1e-15.
            assert!((sine - there.y).abs() < 2e-15, "{degrees}: {sine}");
            assert!((cosine - there.x).abs() < 2e-15, "{degrees}: {cosine}");
            assert!((sine * sine + cosine * cosine - 1.0).abs() < 6e-16);
        }
    }

    #[test]
    fn quarter_turns_are_exact_however_many() {
        for turns in [0.0, 1.0, -7.0, 1e6, 1e12] {
            let of = |degrees: f64| sin_cos(360.0 * turns + degrees);
            if turns < 1e9 {
                assert_eq!(of(90.0), (1.0, 0.0));
                assert_eq!(of(180.0), (0.0, -1.0));
                assert_eq!(of(-90.0), (-1.0, 0.0));
            }
            assert!((of(30.0).0 - 0.5).abs() < 1e-3, "{turns}");
        }
        assert!(sin_cos(f64::NAN).0.is_nan() && sin_cos(f64::INFINITY).1.is_nan());
    }
}
