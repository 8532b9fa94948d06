//! The whole sky for a place of the sun: sun, moon, airglow, Milky Way.
//!
//! The moon is full and stands opposite to the sun: it rises as the sun sets, and is high when the
//! sun is deep. Luminance in cd/m², directions of length 1, +Y up.

use bevy::math::{Vec3, ops};

use crate::components::Sky;
use crate::galaxy;
use crate::scattering::Source;
use crate::twilight;

/// Luminance of the airglow at the zenith, and its colour: half of it is the green line of oxygen.
const AIRGLOW: f32 = 3e-4;
const AIRGLOW_COLOUR: Vec3 = Vec3::new(0.75, 1.05, 1.2);
/// The shell that glows: its height over the radius of the Earth (90 km).
const AIRGLOW_SHELL: f32 = 90.0 / 6_360.0;
/// Greatest luminance of the Milky Way: that of a dark sky, six times over, since under a full moon
/// nothing would be left of it.
const MILKY_WAY: f32 = 2.4e-3;
const MILKY_WAY_COLOUR: Vec3 = Vec3::new(0.72, 1.02, 1.6);
/// Share of the moonlit sky that is shown. The true one has the blue of day, and next to the ground
/// it is as bright as by day: a picture of it is one of a day that was exposed too little. Held
/// back by a stop and a half it is night, and the stars stand out of it.
const MOON_SKY: f32 = 0.35;
/// What the eye makes of moonlight, which is a little redder than sunlight: in so little light its
/// rods prevail, and all looks blue (Purkinje). Luminance 1.
const MOON_COLOUR: Vec3 = Vec3::new(0.54, 1.03, 2.06);

/// The sky of one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heavens {
    /// Towards the sun.
    pub towards_sun: Vec3,
    /// Elevation of the sun, degrees.
    pub elevation: f32,
    sun: Source,
    /// Only while the sun is down.
    moon: Option<Source>,
    /// Share of the stars' light that is seen, 0 by day to 1.
    pub stars: f32,
    /// Brightness of the Milky Way, as [`Sky::milky_way`].
    milky_way: f32,
}

/// The light that casts shadows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyLight {
    /// Direction to it.
    pub towards: Vec3,
    /// Illuminance of a plane that faces it, lux (red, green, blue).
    pub illuminance: Vec3,
}

impl Heavens {
    /// The sky for a direction to the sun, of length 1, as `sky` describes it: its sea, its dust and
    /// its Milky Way.
    pub fn new(towards_sun: Vec3, sky: &Sky) -> Self {
        let over = |source: Source| {
            let source = source.through_dust(sky.dust);
            if sky.sea { source.over_sea() } else { source }
        };
        let elevation = ops::asin(towards_sun.y.clamp(-1.0, 1.0)).to_degrees();
        Self {
            towards_sun,
            elevation,
            sun: over(Source::sun(towards_sun)),
            moon: (towards_sun.y < 0.0).then(|| over(Source::moon(-towards_sun))),
            stars: twilight::stars(elevation),
            milky_way: sky.milky_way,
        }
    }

    /// Direction to the moon while it is up.
    pub fn towards_moon(&self) -> Option<Vec3> {
        self.moon.map(|_| -self.towards_sun)
    }

    /// Light of the moon, lux (red, green, blue); none while the sun is up.
    pub fn moonlight(&self) -> Vec3 {
        self.moon
            .map_or(Vec3::ZERO, |moon| moon.illuminance() * MOON_COLOUR)
    }

    /// Share of the moon's light that the air lets through (red, green, blue).
    pub fn through_air_to_moon(&self) -> Vec3 {
        self.moon.map_or(Vec3::ZERO, |moon| moon.passed())
    }

    /// Sun or moon, whichever gives more light.
    pub fn key(&self) -> KeyLight {
        let (sun, moon) = (self.sun.illuminance(), self.moonlight());
        if moon.element_sum() > sun.element_sum() {
            KeyLight {
                towards: -self.towards_sun,
                illuminance: moon,
            }
        } else {
            KeyLight {
                towards: self.towards_sun,
                illuminance: sun,
            }
        }
    }

    /// Radiance in a direction, cd/m² (red, green, blue); without sun, moon and stars themselves.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let sun = self.sun.sky(direction);
        let Some(moon) = self.moon else {
            return sun;
        };
        let glow = glow(direction, self.milky_way);
        sun + moon.sky(direction) * MOON_COLOUR * MOON_SKY + glow * self.stars
    }
}

/// Airglow and Milky Way. Below the horizon: what the ground gives back of them.
fn glow(direction: Vec3, milky_way: f32) -> Vec3 {
    if direction.y < 0.0 {
        return AIRGLOW_COLOUR * (0.1 * AIRGLOW);
    }
    // Light of the stars is dimmed by the air as they are.
    let greatest = MILKY_WAY * milky_way;
    let stars = greatest * galaxy::brightness(direction) * ops::exp(-0.2 / (direction.y + 0.03));
    AIRGLOW_COLOUR * airglow(direction.y) + MILKY_WAY_COLOUR * stars
}

/// Luminance of the airglow at a sine of elevation from 0 to 1: the farther down, the longer the way
/// through the shell that glows (van Rhijn 1921).
fn airglow(sine: f32) -> f32 {
    let shell = 1.0 + AIRGLOW_SHELL;
    AIRGLOW / (1.0 - (1.0 - sine * sine) / (shell * shell)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(azimuth: f32, elevation: f32) -> Vec3 {
        let (sin, cos) = ops::sin_cos(elevation.to_radians());
        let (east, north) = ops::sin_cos(azimuth.to_radians());
        Vec3::new(east * cos, sin, -north * cos)
    }

    fn sky(towards: Vec3, sea: bool) -> Heavens {
        Heavens::new(
            towards,
            &Sky {
                sea,
                ..Sky::default()
            },
        )
    }

    #[test]
    fn by_day_the_sky_is_the_suns_alone() {
        for elevation in [0.0, 3.0, 24.0, 90.0] {
            let towards = at(130.0, elevation);
            let (found, sun) = (sky(towards, false), Source::sun(towards));
            for direction in [Vec3::Y, at(20.0, 4.0), at(200.0, -30.0)] {
                assert_eq!(found.radiance(direction), sun.sky(direction));
            }
            assert_eq!(
                (found.key().towards, found.towards_moon(), found.stars),
                (towards, None, 0.0)
            );
        }
    }

    #[test]
    fn a_moonlit_night_is_as_bright_as_it_is_outside() {
        let sky = sky(at(300.0, -40.0), true);
        let zenith = sky.radiance(Vec3::Y);
        // Measured under a full moon: 2 to 10 mcd/m² (17.5 to 19 magnitudes a square second), of
        // which a third is shown.
        assert!((7e-4..5e-3).contains(&zenith.y), "{zenith}");
        assert!(zenith.z > 1.3 * zenith.x, "{zenith}");
        let key = sky.key();
        assert_eq!(key.towards, at(300.0, -40.0) * -1.0);
        // A full moon at 40 degrees gives a plane that faces it 0.15 to 0.3 lux.
        assert!((0.1..0.35).contains(&key.illuminance.y), "{key:?}");
    }

    #[test]
    fn airglow_grows_towards_the_horizon() {
        let mut before = airglow(1.0);
        assert!((2e-4..1e-3).contains(&before), "{before}");
        for hundredth in (0..100_u8).rev() {
            let now = airglow(f32::from(hundredth) / 100.0);
            assert!(now > before, "{hundredth}: {before} {now}");
            before = now;
        }
        // Along the horizon the way through a shell at 90 km is six times that to the zenith.
        assert!((5.0..7.0).contains(&(before / airglow(1.0))), "{before}");
    }

    #[test]
    fn as_the_sun_sets_the_sky_goes_on_darkening_until_the_moon_lights_it() {
        let mut before = f32::INFINITY;
        for tenth in 0..=80_u8 {
            let zenith = sky(at(300.0, -0.1 * f32::from(tenth)), true)
                .radiance(Vec3::Y)
                .y;
            assert!(zenith < before, "{tenth}: {before} {zenith}");
            // No more than a twelfth in a tenth of a degree: no jump as the moon rises.
            assert!(
                zenith > before.min(1e9) * 0.7 || before == f32::INFINITY,
                "{tenth}"
            );
            before = zenith;
        }
    }
}
