//! Loudness, panning and delay of a sound by where it is.

use bevy::math::{Affine3A, Vec3};
use bevy::reflect::Reflect;

use crate::parts::Loudness;

/// Nearer than this, metres, directions lose their meaning: what is at the listener is in the middle.
const NEAR: f32 = 0.5;

/// Most panning, so that the far ear hears something too: 11.6 dB less.
const MOST_PAN: f32 = 0.87;

/// Part that is lost of what is straight behind: 1.9 dB.
const BEHIND: f32 = 0.2;

/// Longest delay, seconds: some 1.7 km of air.
pub const MOST_DELAY: f32 = 5.0;

/// How a sound is heard.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
pub struct Heard {
    /// Amplitude, 0 and more.
    pub gain: f32,
    /// −1 left to 1 right.
    pub pan: f32,
    /// Metres away.
    pub distance: f32,
}

/// The ears: where they are, and their right and their front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ears {
    /// Where.
    pub place: Vec3,
    /// To the right, of length 1.
    pub right: Vec3,
    /// To the front, of length 1.
    pub front: Vec3,
}

impl Ears {
    /// Of a transform; `None` where it is not finite or flat.
    #[must_use]
    pub fn new(transform: &Affine3A) -> Option<Self> {
        let right = Vec3::from(transform.matrix3.x_axis).try_normalize()?;
        let front = -Vec3::from(transform.matrix3.z_axis).try_normalize()?;
        let place = Vec3::from(transform.translation);
        place.is_finite().then_some(Self {
            place,
            right,
            front,
        })
    }

    /// How a sound at `place` is heard: its amplitude is inverse to the distance beyond [`Loudness::reference`]
    /// (6 dB less for twice the distance, as of a point in open air), and goes over into silence towards
    /// [`Loudness::reach`] by the window (1 − (d/reach)⁴)².
    #[must_use]
    pub fn hear(&self, place: Vec3, loudness: &Loudness) -> Heard {
        let way = place - self.place;
        let distance = way.length();
        if distance.is_nan() || distance >= loudness.reach {
            return Heard {
                distance,
                ..Heard::default()
            };
        }
        let part = distance / loudness.reach;
        let square = part * part;
        let window = (1.0 - square * square) * (1.0 - square * square);
        let fall = loudness.reference / distance.max(loudness.reference);
        // Towards the listener it goes to the middle, from all sides alike.
        let direction = way / distance.max(NEAR);
        let behind = 1.0 - BEHIND * (-direction.dot(self.front)).clamp(0.0, 1.0);
        Heard {
            gain: loudness.volume * fall * window * behind,
            pan: (MOST_PAN * direction.dot(self.right)).clamp(-MOST_PAN, MOST_PAN),
            distance,
        }
    }
}

/// Seconds that a sound takes over a distance, at most [`MOST_DELAY`]; 0 where the speed is not above 0.
#[must_use]
pub fn delay(distance: f32, speed: f32) -> f32 {
    if speed > 0.0 && distance.is_finite() {
        (distance / speed).clamp(0.0, MOST_DELAY)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ears() -> Ears {
        Ears::new(&Affine3A::IDENTITY).unwrap()
    }

    fn loud() -> Loudness {
        Loudness {
            reference: 2.0,
            reach: 400.0,
            ..Loudness::default()
        }
    }

    #[test]
    fn twice_the_distance_is_half_as_loud() {
        let at = |z: f32| ears().hear(Vec3::new(0.0, 0.0, -z), &loud()).gain;
        assert_eq!(at(0.0), 1.0);
        assert!((at(1.0) - 1.0).abs() < 1e-6 && (at(4.0) - 0.5).abs() < 1e-6);
        assert!((at(40.0) / at(20.0) - 0.5).abs() < 1e-3);
        assert!(at(399.0) < 1e-5 && at(400.0) == 0.0 && at(1e9) == 0.0);
        // It falls with every metre.
        assert!((1..400).all(|z| at(z as f32) >= at(z as f32 + 1.0)));
    }

    #[test]
    fn right_is_right_and_the_middle_is_smooth() {
        let pan = |x: f32, z: f32| ears().hear(Vec3::new(x, 0.0, z), &loud()).pan;
        assert!(pan(10.0, 0.0) > 0.86 && pan(-10.0, 0.0) < -0.86);
        assert_eq!((pan(0.0, -10.0), pan(0.0, 0.0)), (0.0, 0.0));
        // Whoever passes through the listener does not jump from one ear to the other.
        let worst = (-100..100)
            .map(|k| (pan((k + 1) as f32 * 0.01, 0.0) - pan(k as f32 * 0.01, 0.0)).abs())
            .fold(0.0, f32::max);
        assert!(worst < 0.02, "{worst}");
        let front = ears().hear(Vec3::NEG_Z * 9.0, &loud()).gain;
        let back = ears().hear(Vec3::Z * 9.0, &loud()).gain;
        assert!((back / front - 0.8).abs() < 1e-6);
    }

    #[test]
    fn what_is_no_number_is_not_heard() {
        for place in [Vec3::NAN, Vec3::INFINITY, Vec3::MAX] {
            assert_eq!(ears().hear(place, &loud()).gain, 0.0);
        }
        assert_eq!(Ears::new(&Affine3A::from_scale(Vec3::ZERO)), None);
        assert_eq!(Ears::new(&Affine3A::from_translation(Vec3::NAN)), None);
        assert!((delay(343.0, 343.0) - 1.0).abs() < 1e-6);
        for (distance, speed) in [(f32::NAN, 343.0), (1.0, 0.0), (1.0, f32::NAN), (1.0, -1.0)] {
            assert_eq!(delay(distance, speed), 0.0);
        }
        assert_eq!(delay(1e9, 343.0), MOST_DELAY);
    }
}
