//! Sunlight and moonlight scattered by the air: what the sky looks like, and what light arrives.
//!
//! Single scattering by air and dust, integrated along the view ray (Nishita et al. 1993); light
//! scattered more than once is taken as coming evenly from everywhere. Lengths metres, radiance
//! cd/m², directions unit vectors, +Y up.
//!
//! At dusk three things are added, which are nothing while the source stands above `LOW`: what the
//! ozone takes of red light, the source's disc behind the horizon, and the light that the sky itself
//! sends into the shadow of the Earth.

use bevy::math::{Vec3, ops};

use crate::air::{Air, Density, GROUND, OBSERVER, OZONE, OZONE_LOW, TOP, exp, to_sphere};
use crate::math::smooth;
use crate::twilight;

/// How much dust scatters forward (Cornette and Shanks).
const DUST_FORWARD: f32 = 0.8;
/// Illuminance of the sun above the air, lux.
const SUN: f32 = 130_000.0;
/// The same of the full moon: 14.0 magnitudes less (−26.74 against −12.74).
const MOON: f32 = SUN / 398_107.0;
/// Angle that sun and moon fill in the sky, radians.
const DISC: f32 = 0.009_25;
/// Sines of the elevations from which dusk sets in (10 degrees), and at which it is full (2).
const LOW: f32 = 0.173_65;
const LOWEST: f32 = 0.034_9;
/// Below this the sun lights no air that can be seen: 20 degrees under the horizon.
const GONE: f32 = -0.342_02;
/// Colour of the light in the Earth's shadow, of luminance 1: that of the blue hour, some 15 000 K.
const DUSK: Vec3 = Vec3::new(0.66, 1.01, 1.9);
/// Light scattered more than once, as a share of the sunlight at each point and in each direction:
/// chosen so that the horizontal illuminance of a clear sky is the 15 to 20 klx that is measured at
/// a sun of 30 degrees.
const MULTIPLE: f32 = 0.12;
/// How far waves lift what they mirror (twice their slope), and which part of it they give back.
const SLOPE: f32 = 0.2;
const SEA: f32 = 0.6;
/// Steps along a view ray and along a ray to the sun; and where the edge of the Earth's shadow lies
/// in the sky.
const STEPS: [u32; 2] = [20, 8];
const STEPS_LOW: [u32; 2] = [48, 12];

/// What lights the air: the sun, or the moon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    towards: Vec3,
    /// Illuminance above the air, lux.
    above: f32,
    air: Air,
    /// Light that the sky sends into the shadow of the Earth, cd/m² from everywhere.
    dusk: Vec3,
    steps: [u32; 2],
    /// Whether its disc may be cut by the horizon.
    low: bool,
    /// Share of the sea in what lies below the horizon; the rest is land.
    sea: f32,
}

impl Source {
    /// The sun, in the direction `towards` (of length 1).
    pub fn sun(towards: Vec3) -> Self {
        let elevation = ops::asin(towards.y.clamp(-1.0, 1.0)).to_degrees();
        // An even hemisphere of illuminance E has the radiance E/π; it fills half of the sphere.
        let even = twilight::illuminance(elevation) / std::f32::consts::TAU;
        let share = 1.0 - smooth(-LOWEST, LOWEST, towards.y);
        Self {
            dusk: DUSK * (even * share),
            ..Self::new(towards, SUN)
        }
    }

    /// The full moon, in the direction `towards` (of length 1).
    pub fn moon(towards: Vec3) -> Self {
        Self::new(towards, MOON)
    }

    fn new(towards: Vec3, above: f32) -> Self {
        let low = 1.0 - smooth(LOWEST, LOW, towards.y);
        Self {
            towards,
            above,
            air: Air {
                dust: 1.0,
                ozone: OZONE + (OZONE_LOW - OZONE) * low,
            },
            dusk: Vec3::ZERO,
            steps: if low == 1.0 { STEPS_LOW } else { STEPS },
            low: low == 1.0,
            sea: 0.0,
        }
    }

    /// The same over the sea: as it sinks, what lies below the horizon gives back the sky above it.
    pub fn over_sea(self) -> Self {
        let low = 1.0 - smooth(LOWEST, LOW, self.towards.y);
        let night = if self.above < SUN { 1.0 } else { low };
        Self { sea: night, ..self }
    }

    /// The same through air with `dust` times the dust of a clear day.
    pub fn through_dust(self, dust: f32) -> Self {
        Self {
            air: Air { dust, ..self.air },
            ..self
        }
    }

    /// Share of its light that comes to a point from outside the air.
    fn transmittance(&self, from: Vec3) -> Vec3 {
        let seen = if self.low {
            self.disc_seen(from)
        } else {
            f32::from(u8::from(to_sphere(from, self.towards, GROUND).is_none()))
        };
        if seen == 0.0 {
            return Vec3::ZERO;
        }
        let [_, steps] = self.steps;
        self.air.transmittance(from, self.towards, steps) * seen
    }

    /// Share of its disc above the horizon, taken as a square.
    fn disc_seen(&self, from: Vec3) -> f32 {
        let radius = from.length();
        let elevation = ops::asin((from.dot(self.towards) / radius).clamp(-1.0, 1.0));
        let dip = ops::acos((GROUND / radius).min(1.0));
        (0.5 + (elevation + dip) / DISC).clamp(0.0, 1.0)
    }

    /// Radiance that it gives the sky in a direction, cd/m². Below the horizon: lit ground behind
    /// haze.
    pub fn sky(&self, direction: Vec3) -> Vec3 {
        if self.towards.y < GONE {
            return Vec3::ZERO;
        }
        let origin = Vec3::Y * (GROUND + OBSERVER);
        let ground = to_sphere(origin, direction, GROUND);
        let length = ground
            .or_else(|| to_sphere(origin, direction, TOP))
            .unwrap_or(0.0);
        let cos = direction.dot(self.towards);
        let air_phase = 3.0 / (16.0 * std::f32::consts::PI) * (1.0 + cos * cos);
        let g = DUST_FORWARD;
        let spread = 1.0 + g * g - 2.0 * g * cos;
        let dust_phase = 3.0 / (8.0 * std::f32::consts::PI) * (1.0 - g * g) * (1.0 + cos * cos)
            / ((2.0 + g * g) * spread * spread.sqrt());
        let even = 1.0 / (4.0 * std::f32::consts::PI);
        let [steps, _] = self.steps;
        let mut light = Vec3::ZERO;
        let mut dusk = Vec3::ZERO;
        let mut through = Vec3::ONE;
        let mut before = 0.0;
        for i in 1..=steps {
            // Squared spacing: short steps where the air is dense.
            let share = i as f32 / steps as f32;
            let end = length * share * share;
            let step = end - before;
            let at = origin + direction * (before + step * 0.5);
            before = end;
            let Density {
                air,
                dust,
                extinction,
            } = self.air.at((at.length() - GROUND).max(0.0));
            let sun = self.transmittance(at);
            let up = at.normalize().dot(self.towards).max(0.0);
            let everywhere = (sun * 0.5 + Vec3::splat(0.5 * up)) * MULTIPLE;
            let scattered = sun * (air * air_phase + Vec3::splat(dust * dust_phase))
                + everywhere * (air + Vec3::splat(dust)) * (even * 4.0);
            let passed = exp(-extinction * step);
            let held = (Vec3::ONE - passed) / extinction.max(Vec3::splat(1e-12));
            light += through * scattered * held;
            dusk += through * (air + Vec3::splat(dust)) * held;
            through *= passed;
        }
        let mut sky = light * self.above + dusk * self.dusk;
        if ground.is_some() {
            // Green-brown ground of albedo 0.12.
            let lit =
                self.illuminance() * self.towards.y.max(0.0) + self.dusk * std::f32::consts::TAU;
            let mut below = lit * Vec3::new(0.12, 0.13, 0.09) / std::f32::consts::PI;
            if self.sea > 0.0 {
                below = below.lerp(self.mirrored(direction) * SEA, self.sea);
            }
            sky += through * below;
        }
        sky
    }

    /// The sky that waves mirror towards the observer from below the horizon: the facets that are
    /// seen lean towards them.
    fn mirrored(&self, direction: Vec3) -> Vec3 {
        let up = Vec3::new(direction.x, SLOPE - direction.y, direction.z);
        self.sky(up.normalize())
    }

    /// Illuminance on a plane that faces it, below the air, lux (red, green, blue).
    pub fn illuminance(&self) -> Vec3 {
        self.passed() * self.above
    }

    /// Share of its light that the air lets through to the observer (red, green, blue).
    pub fn passed(&self) -> Vec3 {
        self.transmittance(Vec3::Y * (GROUND + OBSERVER))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(elevation: f32) -> Vec3 {
        let (sin, cos) = ops::sin_cos(elevation.to_radians());
        Vec3::new(0.0, sin, -cos)
    }

    fn luminance(light: Vec3) -> f32 {
        light.dot(Vec3::new(0.2126, 0.7152, 0.0722))
    }

    #[test]
    fn a_clear_sky_is_blue_and_brightest_near_the_sun() {
        let sun = Source::sun(Vec3::new(0.6, 0.6, 0.53).normalize());
        let zenith = sun.sky(Vec3::Y);
        assert!(zenith.z > 1.5 * zenith.x, "{zenith}");
        let near = sun.sky(Vec3::new(0.62, 0.6, 0.5).normalize());
        assert!(near.element_sum() > 2.0 * zenith.element_sum());
        // Measured clear skies have 2 to 8 kcd/m² at the zenith.
        assert!((1_000.0..10_000.0).contains(&zenith.y), "{zenith}");
    }

    #[test]
    fn a_low_sun_is_dim_and_red_and_sets() {
        let high = Source::sun(Vec3::Y).illuminance();
        let low = Source::sun(at(3.0)).illuminance();
        assert!(low.x < 0.6 * high.x && low.z < 0.4 * low.x, "{high} {low}");
        // The observer's horizon lies 0.8 degrees below the level.
        assert_eq!(Source::sun(at(-1.2)).illuminance(), Vec3::ZERO, "night");
        let mut before = Source::sun(at(3.0)).illuminance().x;
        for tenth in (-12..30).rev() {
            let now = Source::sun(at(tenth as f32 * 0.1)).illuminance().x;
            // A tenth of a degree is a fifth of the disc, of some 8 klx: no more than that goes at
            // once at the horizon.
            let most = if tenth < 0 { 2_600.0 } else { 4_000.0 };
            assert!(
                now <= before && before - now < most,
                "{tenth}: {before} {now}"
            );
            before = now;
        }
    }

    #[test]
    fn after_sunset_the_sky_darkens_as_it_does_outside() {
        let mut before = f32::INFINITY;
        for depth in 0..=18_u8 {
            let sun = Source::sun(at(-f32::from(depth)));
            // The mean over a hemisphere, weighted by the cosine, times π.
            let lux: f32 = (0..400_u16)
                .map(|i| {
                    let y = ((f32::from(i) + 0.5) / 400.0).sqrt();
                    let (sin, cos) = ops::sin_cos(f32::from(i) * 2.399_963);
                    let level = (1.0 - y * y).sqrt();
                    luminance(sun.sky(Vec3::new(sin * level, y, cos * level)))
                })
                .sum::<f32>()
                * std::f32::consts::PI
                / 400.0;
            // Single scattering is up to twice as bright as what is measured, and dies out sooner.
            let measured = twilight::illuminance(-f32::from(depth));
            let share = lux / measured;
            assert!((0.05..3.0).contains(&share), "{depth}: {lux} of {measured}");
            assert!(lux < before, "{depth}: {before} {lux}");
            before = lux;
        }
    }

    #[test]
    fn the_shadow_of_the_earth_rises_opposite_to_the_sun_and_the_zenith_is_blue() {
        let sun = Source::sun(at(-5.0));
        let opposite = |elevation: f32| sun.sky(at(elevation) * Vec3::new(1.0, 1.0, -1.0));
        // Inside the shadow it is darker and bluer than at the same height above the sun.
        let (shadow, glow) = (opposite(3.0), sun.sky(at(3.0)));
        assert!(
            luminance(glow) > 20.0 * luminance(shadow),
            "{glow} {shadow}"
        );
        assert!(luminance(shadow) > 0.0 && shadow.z > shadow.x, "{shadow}");
        let zenith = sun.sky(Vec3::Y);
        assert!(zenith.z > zenith.y && zenith.z > 1.3 * zenith.x, "{zenith}");
    }

    #[test]
    fn dusk_adds_nothing_to_a_day() {
        let day = Source::sun(at(10.0)).over_sea();
        assert!(!day.low && day.sea == 0.0);
        assert_eq!(
            (day.air.ozone, day.dusk, day.steps),
            (OZONE, Vec3::ZERO, STEPS)
        );
    }

    #[test]
    fn dust_dims_the_sun_and_whitens_the_sky_about_it() {
        let clear = Source::sun(at(30.0));
        assert_eq!(clear.through_dust(1.0), clear);
        let dusty = clear.through_dust(40.0);
        let [before, after] = [clear, dusty].map(|sun| luminance(sun.illuminance()));
        // 40 times 0.0053 of optical depth at sea level, 0.61 of it above the observer, twice the way
        // of the zenith: a quarter goes.
        let share = after / before;
        assert!((0.72..0.82).contains(&share), "{before} {after}");
        let [before, after] = [clear, dusty].map(|sun| sun.sky(at(33.0)));
        assert!(
            luminance(after) > 2.0 * luminance(before),
            "{before} {after}"
        );
        assert!(after.z / after.x < before.z / before.x, "{before} {after}");
    }

    #[test]
    fn the_sky_is_finite_everywhere() {
        for towards in [
            Vec3::new(0.3, 0.2, -0.5),
            Vec3::new(0.3, 0.0, -0.5),
            Vec3::NEG_Y,
        ] {
            let sun = Source::sun(towards.normalize());
            for i in 0..200 {
                let y = i as f32 / 100.0 - 1.0;
                let direction = Vec3::new((1.0 - y * y).max(0.0).sqrt(), y, 0.0);
                let light = sun.sky(direction);
                assert!(
                    light.is_finite() && light.min_element() >= 0.0,
                    "{direction}: {light}"
                );
            }
        }
    }
}
