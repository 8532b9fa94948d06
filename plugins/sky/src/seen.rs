//! What the sky of a camera is at present.

use bevy::prelude::*;

use crate::components::{Sky, Sun};
use crate::heavens::Heavens;
use crate::twilight;

/// The sky of a camera at present: written by [`SkySystems::See`](crate::SkySystems::See) beside each
/// [`Sky`], when the sun or the sky changes, with a renderer or without.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct SeenSky {
    /// The sun that lights it.
    pub sun: Sun,
    /// What it was asked to be, every number in its range.
    pub sky: Sky,
    /// Sun, moon, stars: where they are and what light they give.
    pub heavens: Heavens,
    /// Exposure that suits the light, EV at ISO 100, between [`Sky::night_ev100`] and
    /// [`Sky::day_ev100`].
    pub ev100: f32,
}

impl SeenSky {
    /// The sky for a place of the sun; `None` where that is not finite.
    #[must_use]
    pub fn new(sun: Sun, sky: &Sky) -> Option<Self> {
        let sky = sky.clamped();
        let heavens = Heavens::new(sun.towards()?, &sky);
        let ev100 = twilight::ev100(heavens.elevation, sky.day_ev100, sky.night_ev100);
        Some(Self {
            sun,
            sky,
            heavens,
            ev100,
        })
    }

    /// Whether it is that of a sun and a sky.
    pub(crate) fn is_of(&self, sun: Sun, sky: &Sky) -> bool {
        self.sun == sun && self.sky == sky.clamped()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(elevation: f32) -> SeenSky {
        let sun = Sun {
            elevation,
            ..Sun::default()
        };
        SeenSky::new(sun, &Sky::default()).expect("a place")
    }

    #[test]
    fn the_exposure_goes_from_that_of_the_day_to_that_of_the_night() {
        let sky = Sky::default();
        assert_eq!(seen(90.0).ev100, sky.day_ev100);
        assert_eq!(seen(-90.0).ev100, sky.night_ev100);
        let dusk = seen(-5.0).ev100;
        assert!(dusk > sky.night_ev100 && dusk < sky.day_ev100, "{dusk}");
    }

    #[test]
    fn at_the_zenith_and_at_the_nadir_all_is_finite() {
        for elevation in [90.0, -90.0, 89.999_99, -89.999_99, 0.0, -0.0] {
            let seen = seen(elevation);
            let key = seen.heavens.key();
            assert!(key.illuminance.is_finite() && key.towards.is_normalized());
            assert!(key.towards.y >= -1e-6, "light comes from above: {key:?}");
            for direction in [Vec3::Y, Vec3::NEG_Y, Vec3::X, Vec3::new(0.0, 0.6, -0.8)] {
                let light = seen.heavens.radiance(direction);
                assert!(light.is_finite() && light.min_element() >= 0.0, "{light}");
            }
        }
    }

    #[test]
    fn it_is_kept_while_sun_and_sky_are_the_same() {
        let sky = Sky {
            dust: f32::NAN,
            ..Sky::default()
        };
        let sun = Sun::default();
        let seen = SeenSky::new(sun, &sky).expect("a place");
        assert!(
            seen.is_of(sun, &sky),
            "a number that is none does not count as a change"
        );
        let later = Sun {
            azimuth: sun.azimuth + 1.0,
            ..sun
        };
        assert!(!seen.is_of(later, &sky) && !seen.is_of(sun, &Sky { sea: true, ..sky }));
    }
}
