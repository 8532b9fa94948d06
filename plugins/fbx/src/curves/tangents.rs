//! Tangents as ufbx reads them, and as the file means them.

use ufbx::{Interpolation, Keyframe, Tangent};

/// The part of the time between two keys that a tangent reaches over where the file says no weight, as
/// ufbx has it; it means a third.
pub(super) const THIRD: f32 = 0.333_333;

/// By how large a share ufbx's rounding may have a slope off another: its own and those of both parts of a tangent are halves of
/// units of f32.
const ROUNDING: f64 = 4e-7;

/// It reaches over as much of the time as ufbx has where the file says nothing.
fn is_usual(tangent: Tangent, length: f64) -> bool {
    // ufbx keeps reaches in f32.
    tangent.dx == (f64::from(THIRD) * length) as f32
}

/// A tangent's reach as a share of the time between the two keys, and its slope over that time.
pub(super) fn reach(tangent: ufbx::Tangent, length: f64) -> (f64, f64) {
    let (dx, dy) = (f64::from(tangent.dx), f64::from(tangent.dy));
    if dx == 0.0 {
        return (0.0, 0.0);
    }
    match is_usual(tangent, length) {
        true => (1.0 / 3.0, dy / dx * length),
        false => (dx / length, dy / dx * length),
    }
}

/// What a slope of key `at` is to be multiplied by.
///
/// A slope that is held back so that the curve stays between its keys (progressively clamped) is such that an inner point is as
/// high as the key that it looks to. ufbx takes its reach for [`THIRD`] there too, so that such slopes are a millionth too large, on
/// both sides of the key, where the reach is a third.
pub(super) fn mended(keys: &[Keyframe], at: usize, tangent: Tangent) -> f64 {
    let slope = f64::from(tangent.dy) / f64::from(tangent.dx);
    let Some(key) = keys.get(at).filter(|_| slope.is_finite() && slope != 0.0) else {
        return 1.0;
    };
    // Whether the inner point on this side is as high as the key there.
    let looks = |before: &Keyframe, next: &Keyframe, own: Tangent| {
        let (length, way) = (next.time - before.time, next.value - before.value);
        let is_third = before.interpolation != Interpolation::Cubic || is_usual(own, length);
        is_third && (slope * f64::from(THIRD) * length - way).abs() <= ROUNDING * way.abs()
    };
    let before = at.checked_sub(1).and_then(|before| keys.get(before));
    let is_held = before.is_some_and(|before| looks(before, key, key.left))
        || keys
            .get(at + 1)
            .is_some_and(|next| looks(key, next, key.right));
    match is_held {
        true => 3.0 * f64::from(THIRD),
        false => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::curve::Curve;

    #[test]
    fn slopes_that_are_held_back_keep_the_curve_between_its_keys() {
        // A line, then a cubic whose slope is the most that either side lets it have, as ufbx gives it.
        let key = |time: f64, value: f64, interpolation| Keyframe {
            time,
            value,
            interpolation,
            ..Keyframe::default()
        };
        for (second, third, free) in [
            (0.4, 616.0, 5000.0),
            (0.1, 2000.0, 7000.0),
            (0.4, 2000.0, 2900.0_f64),
        ] {
            let mut keys = [
                key(0.0, 0.0, Interpolation::Linear),
                key(0.25, 500.0, Interpolation::Cubic),
                key(0.25 + second, 500.0 + third, Interpolation::Linear),
            ];
            let chords = [500.0 / 0.25, third / second];
            let slope = free
                .min(chords[0] / f64::from(THIRD))
                .min(chords[1] / f64::from(THIRD));
            let is_held = slope < free;
            assert_eq!(is_held, free > 4000.0);
            let dx = (f64::from(THIRD) * second) as f32;
            keys[1].right = Tangent {
                dx,
                dy: dx * slope as f32,
            };
            keys[2].left = Tangent { dx, dy: 0.0 };
            let right = if is_held {
                3.0 * chords[0].min(chords[1])
            } else {
                free
            };
            let points = [
                500.0,
                500.0 + right * second / 3.0,
                500.0 + third,
                500.0 + third,
            ];
            let mut curve = Curve::with_keys(&keys);
            for share in [0.1, 0.3, 0.5, 0.9] {
                let value = crate::curves::part(points, share, share)[0];
                let off = (curve.at(0.25 + second * share) - value).abs();
                // Half of the way that a millionth of the slope would make, which f32 is below.
                let way = 0.5e-6 * right * second * share * (1.0 - share) * (1.0 - share);
                assert!(off <= way, "{second} {share}: {off} of {way}");
            }
        }
    }
}
