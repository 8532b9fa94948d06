//! What a strip of one segment makes up for: it is straight, and the blade that it stands for is bent. The functions of
//! `shaders/src/vegetation/straight.wgsl`, in Rust.
//!
//! Its tip is where its area is right as a vector ([`crate::blade::Curve::drawn_tip`]). Two things are left.
//!
//! **A blade that hangs over** turns its back to some eyes with a part of its length. That part hides too, where the vector's
//! area has it with the other sign: so the strip is a little [`wider`] at elevations in between.
//!
//! **Colours** go by the way along the blade, and the same way lies elsewhere on a straight one. A place t of the strip is at
//! t + b·t·(1 − t) of the blade, with a [`bow`] b that depends on what is seen. Where nothing is hidden by others, each
//! part shows by its area across the view: the mean of the way over (1 − t²)·|c′ × across · view| is
//! (0.25 − 0.017 d)/(0.667 + 0.167 d) from the side and (0.25 + 0.017 d)/(0.667 − 0.167 d) from above, at a droop d; that of a
//! triangle is 1/3 + b/6. To first order in d this is b = 0.25 − 0.63 d and 0.25 + 0.8 d. Deep in others only tips are seen,
//! and what counts is how high a part is: (1 + d)·t − d·t² of the height, which gives −0.5 d. The steps from one to the other
//! are fitted to brute force ([`crate::reference`]), as is the width.

use bevy::math::ops;

/// How much wider a strip of one segment is, for a blade of a droop (0 to 1) that is seen under an elevation with such a
/// sine, 0 to 1.
#[inline]
#[must_use]
pub fn wider(droop: f32, sine: f32) -> f32 {
    let square = sine * sine;
    1.0 + 0.4 * droop * square * (1.0 - square)
}

/// By how much the middle of the strip is farther along the blade, times 4. `depth` is the optical depth of all blades from the
/// side: density · width · mean length · 2/3.
#[inline]
#[must_use]
pub fn bow(droop: f32, sine: f32, depth: f32) -> f32 {
    let square = sine * sine;
    let side = 0.25 - 0.63 * droop;
    let above = 0.25 + 0.8 * droop;
    let deep = -0.5 * droop;
    let hidden = (0.25 * (ops::log2((depth / sine).max(1e-6)) - 2.0)).clamp(0.0, 1.0);
    side + (above - side) * 0.5 * (square + square * square) + (deep - side) * hidden
}

/// Where along the blade a place of the strip is.
#[inline]
#[must_use]
pub fn along(place: f32, bow: f32) -> f32 {
    place + bow * place * (1.0 - place)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where all is seen the mean way along is that of the bent blade: from the side, and from above.
    #[test]
    fn mean_way_is_that_of_the_bent_blade() {
        for droop in [0.0, 0.2, 0.5, 0.7] {
            for (sine, steep) in [(1e-3, -1.0), (1.0, 1.0)] {
                let (mut way, mut area, mut ours, mut all) = (0.0, 0.0, 0.0, 0.0);
                for k in 0..1000 {
                    let t = (k as f32 + 0.5) / 1000.0;
                    // Of the curve's step across the view.
                    let step = 1.0 - steep * droop + 2.0 * steep * droop * t;
                    let bent = (1.0 - t * t) * step;
                    way += bent * t;
                    area += bent;
                    ours += (1.0 - t) * along(t, bow(droop, sine, 1e-6));
                    all += 1.0 - t;
                }
                let (expected, found) = (way / area, ours / all);
                // The bow is of first order in the droop, and its square at 0.7 is some 2 % of the way.
                assert!(
                    (expected - found).abs() < 0.012,
                    "{droop} {sine}: {expected} {found}"
                );
            }
        }
    }

    #[test]
    fn ends_stay_and_nothing_is_wider_from_the_side() {
        assert_eq!((along(0.0, 0.6), along(1.0, -0.3)), (0.0, 1.0));
        assert_eq!(
            (wider(0.5, 0.0), wider(0.5, 1.0), wider(0.0, 0.6)),
            (1.0, 1.0, 1.0)
        );
        assert!(bow(0.5, 0.0, 1.0).is_finite() && bow(0.5, 0.5, 0.0).is_finite());
    }
}
