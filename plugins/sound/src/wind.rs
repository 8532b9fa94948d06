//! How loud wind is.
//!
//! Wind is heard because air tears at the ears: the pressure of that grows with the square of the speed, so its
//! amplitude does, up to what is bearable. Two copies of one loop at different pitches, which go out of step, sound like
//! air: one low and always there, one that whistles when it is fast.

use bevy::math::Vec3;

use crate::built_in::WIND;
use crate::parts::{Bus, Loudness, SoundEmitter};

/// A calm day at the sea, and what a thousand metres add to it, metres a second.
const CALM: f32 = 2.0;
const HEIGHT: f32 = 7.0 / 1000.0;

/// The speed at which wind is as loud as it gets here, metres a second.
const STORM: f32 = 24.0;

/// Speed of the air at a height above the sea, metres and metres a second, where nobody says otherwise.
#[must_use]
pub fn speed_at(height: f32) -> f32 {
    CALM + HEIGHT * height.clamp(0.0, 3000.0)
}

/// Two emitters for somebody who moves by `velocity` through air of `speed` metres a second: a low one and a high one.
/// `share` is the volume of both, 0 to 1. What is not finite counts as 0.
#[must_use]
pub fn emitters(speed: f32, velocity: Vec3, share: f32) -> [SoundEmitter; 2] {
    let finite = |number: f32| {
        if number.is_finite() {
            number.max(0.0)
        } else {
            0.0
        }
    };
    let relative = finite(speed) + finite(velocity.length());
    let part = (relative / STORM).min(1.0);
    let volume = finite(share).min(1.0);
    let emitter = |volume: f32, rate: f32| SoundEmitter {
        sound: WIND,
        everywhere: true,
        loudness: Loudness {
            volume,
            rate,
            // Wind is always there, and would take the voice of whatever is less loud.
            priority: 50,
            bus: Bus::Ambience,
            ..Loudness::default()
        },
    };
    [
        emitter(
            volume * (0.08 + 0.92 * part) * (0.25 + 0.75 * part),
            0.62 + 0.2 * part,
        ),
        emitter(volume * part * part * 0.7, 1.0 + 0.45 * part),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faster_and_higher_is_louder() {
        let loud = |speed: f32| emitters(speed, Vec3::ZERO, 1.0).map(|one| one.loudness.volume);
        for speed in 0..40 {
            let (slow, fast) = (loud(speed as f32), loud(speed as f32 + 1.0));
            assert!(slow[0] <= fast[0] && slow[1] <= fast[1], "{speed}");
        }
        assert!(loud(0.0)[0] < 0.03 && loud(24.0)[0] > 0.99);
        assert!(speed_at(1500.0) > speed_at(10.0) + 10.0 && speed_at(-50.0) == CALM);
        let still = emitters(5.0, Vec3::ZERO, 1.0)[0].loudness.volume;
        assert!(emitters(5.0, Vec3::X * 5.0, 1.0)[0].loudness.volume > still);
    }

    #[test]
    fn what_is_no_number_is_calm() {
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            let [low, high] = emitters(bad, Vec3::splat(bad), 0.5);
            assert!(low.loudness.checked().is_some() && high.loudness.checked().is_some());
        }
        assert_eq!(emitters(9.0, Vec3::ZERO, f32::NAN)[0].loudness.volume, 0.0);
    }
}
