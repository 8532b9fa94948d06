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

/// No ground, or nothing else that is to be seen: a grey, which no ramp or level has.
pub const NOTHING: Vec3 = Vec3::splat(0.25);

/// The frame of a map that was drawn in this frame.
pub const DRAWN: Vec3 = Vec3::new(0.902, 0.624, 0.0);

/// The frame of a map that holds what an earlier frame drew.
pub const KEPT: Vec3 = Vec3::new(0.0, 0.447, 0.698);

/// What is beyond a ramp.
pub const MORE: Vec3 = Vec3::new(0.3, 0.65, 1.0);

/// 0 is black, then indigo, orange, and pale yellow at 1: ever brighter, so that it is read without its hues. [`MORE`]
/// above 1.
#[must_use]
pub fn ramp(share: f32) -> Vec3 {
    if share > 1.0 {
        return MORE;
    }
    let x = share.clamp(0.0, 1.0) * 3.0;
    let step = |from: f32| (x - from).clamp(0.0, 1.0);
    Vec3::ZERO
        .lerp(Vec3::new(0.35, 0.0, 0.55), step(0.0))
        .lerp(Vec3::new(0.9, 0.35, 0.1), step(1.0))
        .lerp(Vec3::new(1.0, 1.0, 0.6), step(2.0))
}

/// Levels that have a colour of their own.
pub const LEVELS: u32 = 24;

/// The count at the end of the ramp of overdraw.
pub const MOST_OVERDRAW: f32 = 8.0;

/// A hue each of eight levels, chosen by Okabe and Ito (2008, *Color Universal Design*) for those who see colours
/// otherwise, in an order in which neighbours differ in brightness too; three brightnesses, the coarsest levels darkest.
/// What is finer is as the last.
#[must_use]
pub fn level_colour(level: u32) -> Vec3 {
    const HUES: [[f32; 3]; 8] = [
        [0.337, 0.706, 0.914],
        [0.0, 0.447, 0.698],
        [0.902, 0.624, 0.0],
        [0.835, 0.369, 0.0],
        [0.941, 0.894, 0.259],
        [0.8, 0.475, 0.655],
        [1.0, 1.0, 1.0],
        [0.0, 0.62, 0.451],
    ];
    let own = level.min(LEVELS - 1);
    let hue = Vec3::from_array(HUES[(own % 8) as usize]);
    hue * (0.5 + 0.25 * (own / 8) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE Y of a colour as a file keeps it (IEC 61966-2-1).
    fn brightness(colour: Vec3) -> f32 {
        let linear = colour.to_array().map(|encoded| match encoded {
            low if low <= 0.040_45 => low / 12.92,
            high => ops::powf((high + 0.055) / 1.055, 2.4),
        });
        Vec3::from_array(linear).dot(Vec3::new(0.2126, 0.7152, 0.0722))
    }

    #[test]
    fn a_ramp_gets_ever_brighter_and_tells_a_hundredth_of_its_length() {
        let at = |k: u32| ramp(k as f32 / 100.0);
        for k in 1..=100 {
            assert!(brightness(at(k)) > brightness(at(k - 1)), "{k}");
            // Two levels of a byte and more.
            let apart = (at(k) - at(k - 1)).abs().max_element();
            assert!(apart > 2.0 / 255.0, "{k}: {apart}");
            assert!(at(k).distance(NOTHING) > 0.1 && at(k).distance(MORE) > 0.1);
        }
        assert_eq!((ramp(-1.0), ramp(1.001)), (Vec3::ZERO, MORE));
        assert_eq!(ramp(f32::INFINITY), MORE);
    }

    #[test]
    fn every_level_has_a_colour_and_neighbours_differ_in_brightness() {
        for level in 0..LEVELS {
            for other in 0..level {
                let apart = level_colour(level).distance(level_colour(other));
                assert!(apart > 0.1, "{level} {other}: {apart}");
            }
            assert!(level_colour(level).distance(NOTHING) > 0.1);
            let next = brightness(level_colour(level + 1));
            let ratio = (brightness(level_colour(level)) + 0.05) / (next + 0.05);
            let is_last = level + 1 == LEVELS;
            assert!(is_last || !(0.72..1.4).contains(&ratio), "{level}: {ratio}");
        }
        assert_eq!(level_colour(99), level_colour(LEVELS - 1));
    }

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
