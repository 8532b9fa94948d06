//! Sunlight scattered by the air: what the sky looks like, what light arrives, what haze there is.
//!
//! Single scattering by air and dust, integrated along the view ray (Nishita et al. 1993), with the
//! coefficients of Hillaire, "A scalable and production ready sky and atmosphere rendering
//! technique" (2020), table 1; light scattered more than once is taken as coming evenly from
//! everywhere. Lengths metres, radiance cd/m², directions unit vectors, +Y up.

use bevy::math::{Vec3, ops};

/// Radius of the ground and of the top of the air, metres.
const GROUND: f32 = 6_360_000.0;
const TOP: f32 = 6_460_000.0;
/// Scattering of air at sea level, 1/m (red, green, blue), and its scale height, m.
const AIR: Vec3 = Vec3::new(5.802e-6, 13.558e-6, 33.1e-6);
const AIR_HEIGHT: f32 = 8_000.0;
/// Scattering and extinction of dust at sea level, 1/m, and its scale height, m. The density is
/// that of the source: a clear day.
const DUST: f32 = 3.996e-6;
const DUST_EXTINCTION: f32 = 4.44e-6;
const DUST_HEIGHT: f32 = 1_200.0;
/// How much dust scatters forward (Cornette and Shanks).
const DUST_FORWARD: f32 = 0.8;
/// Absorption of ozone, 1/m, in a layer from 10 to 40 km.
const OZONE: Vec3 = Vec3::new(0.650e-6, 1.881e-6, 0.085e-6);
/// Illuminance of the sun above the air, lux.
const SUN: f32 = 130_000.0;
/// Light scattered more than once, as a share of the sunlight at each point and in each direction:
/// chosen so that the horizontal illuminance of a clear sky is the 15 to 20 klx that is measured at
/// a sun of 30 degrees.
const MULTIPLE: f32 = 0.12;
/// Where the sky is seen from, metres above the sea.
const OBSERVER: f32 = 600.0;
/// Steps along a view ray and along a ray to the sun.
const VIEW_STEPS: u32 = 20;
const SUN_STEPS: u32 = 8;

/// Optical depth per metre at an altitude: scattering by air, scattering by dust, extinction.
fn densities(altitude: f32) -> (Vec3, f32, Vec3) {
    let air = AIR * ops::exp(-altitude / AIR_HEIGHT);
    let dust = ops::exp(-altitude / DUST_HEIGHT);
    let ozone = OZONE * (1.0 - (altitude - 25_000.0).abs() / 15_000.0).max(0.0);
    (air, DUST * dust, air + ozone + DUST_EXTINCTION * dust)
}

/// Distance along a ray to a sphere around the centre of the Earth, if it is ahead.
fn to_sphere(from: Vec3, direction: Vec3, radius: f32) -> Option<f32> {
    // f64: the squares differ by a hundred-thousandth of themselves.
    let (from, direction) = (from.as_dvec3(), direction.as_dvec3());
    let b = from.dot(direction);
    let c = from.length_squared() - f64::from(radius) * f64::from(radius);
    let root = b * b - c;
    if root < 0.0 {
        return None;
    }
    let root = root.sqrt();
    let near = -b - root;
    let far = -b + root;
    let distance = if near > 0.0 { near } else { far };
    (distance > 0.0).then_some(distance as f32)
}

/// Share of light that comes through from outside the air.
fn transmittance(from: Vec3, towards: Vec3) -> Vec3 {
    if to_sphere(from, towards, GROUND).is_some() {
        return Vec3::ZERO;
    }
    let length = to_sphere(from, towards, TOP).unwrap_or(0.0);
    let step = length / SUN_STEPS as f32;
    let mut depth = Vec3::ZERO;
    for i in 0..SUN_STEPS {
        let at = from + towards * (step * (i as f32 + 0.5));
        depth += densities((at.length() - GROUND).max(0.0)).2 * step;
    }
    exp(-depth)
}

fn exp(v: Vec3) -> Vec3 {
    Vec3::new(ops::exp(v.x), ops::exp(v.y), ops::exp(v.z))
}

/// Radiance of the sky in a direction, cd/m². Below the horizon: sunlit ground behind haze.
pub fn sky_radiance(direction: Vec3, towards_sun: Vec3) -> Vec3 {
    let origin = Vec3::Y * (GROUND + OBSERVER);
    let ground = to_sphere(origin, direction, GROUND);
    let length = ground
        .or_else(|| to_sphere(origin, direction, TOP))
        .unwrap_or(0.0);
    let cos = direction.dot(towards_sun);
    let air_phase = 3.0 / (16.0 * std::f32::consts::PI) * (1.0 + cos * cos);
    let g = DUST_FORWARD;
    let spread = 1.0 + g * g - 2.0 * g * cos;
    let dust_phase = 3.0 / (8.0 * std::f32::consts::PI) * (1.0 - g * g) * (1.0 + cos * cos)
        / ((2.0 + g * g) * spread * spread.sqrt());
    let even = 1.0 / (4.0 * std::f32::consts::PI);
    let mut light = Vec3::ZERO;
    let mut through = Vec3::ONE;
    let mut before = 0.0;
    for i in 1..=VIEW_STEPS {
        // Squared spacing: short steps where the air is dense.
        let share = i as f32 / VIEW_STEPS as f32;
        let end = length * share * share;
        let step = end - before;
        let at = origin + direction * (before + step * 0.5);
        before = end;
        let (air, dust, extinction) = densities((at.length() - GROUND).max(0.0));
        let sun = transmittance(at, towards_sun);
        let up = at.normalize().dot(towards_sun).max(0.0);
        let everywhere = (sun * 0.5 + Vec3::splat(0.5 * up)) * MULTIPLE;
        let scattered = sun * (air * air_phase + Vec3::splat(dust * dust_phase))
            + everywhere * (air + Vec3::splat(dust)) * (even * 4.0);
        let passed = exp(-extinction * step);
        light += through * scattered * ((Vec3::ONE - passed) / extinction.max(Vec3::splat(1e-12)));
        through *= passed;
    }
    if ground.is_some() {
        // Green-brown ground of albedo 0.12.
        let lit = sun_illuminance(towards_sun) / SUN * towards_sun.y.max(0.0);
        light += through * lit * Vec3::new(0.12, 0.13, 0.09) / std::f32::consts::PI;
    }
    light * SUN
}

/// Illuminance of the sun on a plane that faces it, below the air, lux (red, green, blue).
pub fn sun_illuminance(towards_sun: Vec3) -> Vec3 {
    transmittance(Vec3::Y * (GROUND + OBSERVER), towards_sun) * SUN
}

/// Extinction of the air near the ground, 1/m: how fast things fade with distance.
pub fn ground_extinction() -> Vec3 {
    let (_, _, extinction) = densities(OBSERVER);
    extinction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clear_sky_is_blue_and_brightest_near_the_sun() {
        let sun = Vec3::new(0.6, 0.6, 0.53).normalize();
        let zenith = sky_radiance(Vec3::Y, sun);
        assert!(zenith.z > 1.5 * zenith.x, "{zenith}");
        let near = sky_radiance(Vec3::new(0.62, 0.6, 0.5).normalize(), sun);
        assert!(near.element_sum() > 2.0 * zenith.element_sum());
        // Measured clear skies have 2 to 8 kcd/m² at the zenith.
        assert!((1_000.0..10_000.0).contains(&zenith.y), "{zenith}");
    }

    #[test]
    fn a_low_sun_is_dim_and_red() {
        let high = sun_illuminance(Vec3::Y);
        let low = sun_illuminance(Vec3::new(1.0, 0.05, 0.0).normalize());
        assert!(low.x < 0.6 * high.x && low.z < 0.4 * low.x, "{high} {low}");
        assert_eq!(
            sun_illuminance(Vec3::new(1.0, -0.2, 0.0).normalize()),
            Vec3::ZERO,
            "night"
        );
    }

    #[test]
    fn the_sky_is_finite_everywhere() {
        let sun = Vec3::new(0.3, 0.2, -0.5).normalize();
        for i in 0..200 {
            let y = i as f32 / 100.0 - 1.0;
            let direction = Vec3::new((1.0 - y * y).max(0.0).sqrt(), y, 0.0);
            let light = sky_radiance(direction, sun);
            assert!(
                light.is_finite() && light.min_element() >= 0.0,
                "{direction}: {light}"
            );
        }
    }
}
