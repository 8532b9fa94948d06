//! Numbers as colours: the functions of `shaders/src/inspector/colours.wgsl`, in Rust.
//!
//! All are as a picture file keeps them (encoded by sRGB, 0 to 1), so that who reads a pixel of a picture reads the
//! number.

use bevy::math::{Vec2, Vec3, ops};

/// A linear channel as sRGB keeps it (IEC 61966-2-1).
#[must_use]
pub fn encoded_of(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        linear * 12.92
    } else {
        1.055 * ops::powf(linear, 1.0 / 2.4) - 0.055
    }
}

/// White at `near`, black at `far` and beyond; every power of ten has as much room. Distances are metres; both ends are
/// above 0 and differ.
#[must_use]
pub fn distance_grey(distance: f32, near: f32, far: f32) -> f32 {
    let share = ops::log2(distance.max(1e-30) / near) / ops::log2(far / near);
    1.0 - share.clamp(0.0, 1.0)
}

/// Grey at rest; red to the right, green downwards, full at `fastest` pixels a frame.
#[must_use]
pub fn motion_colour(pixels: Vec2, fastest: f32) -> Vec3 {
    (0.5 + 0.5 * pixels / fastest)
        .extend(0.5)
        .clamp(Vec3::ZERO, Vec3::ONE)
}

/// 0 is black, then blue, green, yellow; 1 and more is red.
#[must_use]
pub fn heat(share: f32) -> Vec3 {
    let x = share.clamp(0.0, 1.0) * 4.0;
    let from = |start: f32| (x - start).clamp(0.0, 1.0);
    Vec3::new(from(2.0), from(1.0) - from(3.0), from(0.0) - from(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heat_has_five_stops_and_is_straight_between_them() {
        for (share, colour) in [
            (-1.0, [0.0, 0.0, 0.0]),
            (0.0, [0.0, 0.0, 0.0]),
            (0.125, [0.0, 0.0, 0.5]),
            (0.25, [0.0, 0.0, 1.0]),
            (0.5, [0.0, 1.0, 0.0]),
            (0.75, [1.0, 1.0, 0.0]),
            (1.0, [1.0, 0.0, 0.0]),
            (7.0, [1.0, 0.0, 0.0]),
        ] {
            assert_eq!(heat(share), Vec3::from_array(colour), "{share}");
        }
    }

    #[test]
    fn distances_have_as_much_room_a_power_of_ten() {
        let grey = |distance| distance_grey(distance, 0.1, 1000.0);
        assert_eq!((grey(0.1), grey(1e5), grey(0.0)), (1.0, 0.0, 1.0));
        for (distance, expected) in [(1.0, 0.75), (10.0, 0.5), (100.0, 0.25)] {
            assert!((grey(distance) - expected).abs() < 1e-6, "{distance}");
        }
    }

    #[test]
    fn motion_is_grey_at_rest_and_full_at_the_fastest() {
        assert_eq!(motion_colour(Vec2::ZERO, 8.0), Vec3::splat(0.5));
        let colour = motion_colour(Vec2::new(8.0, -16.0), 8.0);
        assert_eq!(colour, Vec3::new(1.0, 0.0, 0.5));
    }

    #[test]
    fn channels_are_encoded_as_the_standard_says() {
        // Of the standard's own table: 0.5 is 187.516 of 255.
        assert!((encoded_of(0.5) * 255.0 - 187.516).abs() < 1e-2);
        assert!((encoded_of(1.0) - 1.0).abs() < 1e-6);
        assert_eq!(encoded_of(0.0), 0.0);
    }
}
