//! What the air is made of, and how far light goes through it.
//!
//! Coefficients of Hillaire, "A scalable and production ready sky and atmosphere rendering
//! technique" (2020), table 1. Lengths metres, positions from the centre of the Earth, +Y up at the
//! observer.

use bevy::math::{Vec3, ops};

/// Radius of the ground and of the top of the air, metres.
pub(crate) const GROUND: f32 = 6_360_000.0;
pub(crate) const TOP: f32 = 6_460_000.0;
/// Where the sky is seen from, metres above the sea.
pub(crate) const OBSERVER: f32 = 600.0;
/// Scattering of air at sea level, 1/m (red, green, blue), and its scale height, m.
const AIR: Vec3 = Vec3::new(5.802e-6, 13.558e-6, 33.1e-6);
const AIR_HEIGHT: f32 = 8_000.0;
/// Scattering and extinction of dust at sea level, 1/m, and its scale height, m. The density is
/// that of the source: a clear day.
const DUST: f32 = 3.996e-6;
const DUST_EXTINCTION: f32 = 4.44e-6;
const DUST_HEIGHT: f32 = 1_200.0;
/// Absorption of ozone, 1/m, in a layer from 10 to 40 km.
pub(crate) const OZONE: Vec3 = Vec3::new(0.650e-6, 1.881e-6, 0.085e-6);
/// The same where light grazes the Earth. The red above is that of 680 nm; the red of a display is
/// some 605 nm, where ozone absorbs most (Chappuis: 1.45 times as much as at 550 nm). Through 30
/// times the air that is what makes the zenith of dusk blue.
pub(crate) const OZONE_LOW: Vec3 = Vec3::new(2.727e-6, 1.881e-6, 0.085e-6);
/// Steps to the zenith.
const STEPS: u32 = 8;
/// Steps along a ray through dust, short ones first: midpoints are within 3 % of the whole.
const DUST_STEPS: u32 = 24;

/// Air with so much dust in it, and so much ozone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Air {
    /// Dust against that of a clear day.
    pub dust: f32,
    /// Absorption in the middle of the layer, 1/m.
    pub ozone: Vec3,
}

/// Per metre: scattering by air, scattering by dust, extinction by both and ozone.
pub(crate) struct Density {
    pub air: Vec3,
    pub dust: f32,
    pub extinction: Vec3,
}

impl Air {
    /// What there is at an altitude, metres.
    pub fn at(&self, altitude: f32) -> Density {
        let air = AIR * ops::exp(-altitude / AIR_HEIGHT);
        let dust = self.dust * ops::exp(-altitude / DUST_HEIGHT);
        let ozone = self.ozone * (1.0 - (altitude - 25_000.0).abs() / 15_000.0).max(0.0);
        Density {
            air,
            dust: DUST * dust,
            extinction: air + ozone + DUST_EXTINCTION * dust,
        }
    }

    /// Share of light that comes to a point along a ray from outside, in so many steps, the Earth not
    /// being in its way.
    ///
    /// The steps are much longer than the layer of dust is high. What there is more of it than on a clear
    /// day, or less, is therefore taken in steps of its own.
    pub fn transmittance(&self, from: Vec3, towards: Vec3, steps: u32) -> Vec3 {
        let clear = Self { dust: 1.0, ..*self };
        let length = to_sphere(from, towards, TOP).unwrap_or(0.0);
        let step = length / steps as f32;
        let mut depth = Vec3::ZERO;
        for i in 0..steps {
            let at = from + towards * (step * (i as f32 + 0.5));
            depth += clear.at((at.length() - GROUND).max(0.0)).extinction * step;
        }
        if self.dust != 1.0 {
            depth += Vec3::splat((self.dust - 1.0) * dust_depth(from, towards, length));
        }
        exp(-depth)
    }
}

/// Optical depth of the dust of a clear day along so much of a ray.
fn dust_depth(from: Vec3, towards: Vec3, length: f32) -> f32 {
    let mut before = 0.0;
    let metres: f32 = (1..=DUST_STEPS)
        .map(|i| {
            let share = i as f32 / DUST_STEPS as f32;
            let end = length * share * share;
            let step = end - before;
            let at = from + towards * (before + step * 0.5);
            before = end;
            ops::exp(-(at.length() - GROUND).max(0.0) / DUST_HEIGHT) * step
        })
        .sum();
    DUST_EXTINCTION * metres
}

/// Distance along a ray to a sphere around the centre of the Earth, if it is ahead.
pub(crate) fn to_sphere(from: Vec3, direction: Vec3, radius: f32) -> Option<f32> {
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

/// `exp` of each part.
pub(crate) fn exp(v: Vec3) -> Vec3 {
    Vec3::new(ops::exp(v.x), ops::exp(v.y), ops::exp(v.z))
}

/// Extinction of the air near the ground, 1/m: how fast things fade with distance. `dust` is that in
/// the air against that of a clear day.
pub fn ground_extinction(dust: f32) -> Vec3 {
    Air { dust, ozone: OZONE }.at(OBSERVER).extinction
}

/// Optical depth of the air above the observer: light from the zenith fades by exp of minus this.
/// `dust` is that in the air against that of a clear day.
pub fn zenith_depth(dust: f32) -> Vec3 {
    let clear = Air {
        dust: 1.0,
        ozone: OZONE,
    };
    let step = (TOP - GROUND - OBSERVER) / STEPS as f32;
    let depth: Vec3 = (0..STEPS)
        .map(|i| clear.at(OBSERVER + step * (i as f32 + 0.5)).extinction * step)
        .sum();
    // A layer whose density falls by a factor e in its height is as deep as that height.
    let more = DUST_EXTINCTION * DUST_HEIGHT * ops::exp(-OBSERVER / DUST_HEIGHT);
    depth + Vec3::splat((dust - 1.0) * more)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_from_the_zenith_fades_by_the_depth_above() {
        for dust in [0.0, 1.0, 20.0] {
            let air = Air { dust, ozone: OZONE };
            let through = air.transmittance(Vec3::Y * (GROUND + OBSERVER), Vec3::Y, STEPS);
            let expected = exp(-zenith_depth(dust));
            // Altitudes are differences of numbers whose unit in the last place is half a metre, of
            // densities that fall by a factor e in 1200 m or more; 3 % of the dust's depth is lost.
            let tolerance = 1e-3 + 0.03 * dust * 0.0053;
            let off = (through - expected).abs().max_element();
            assert!(off < tolerance, "{dust}: {through} {expected}");
        }
        // A clear zenith passes some 80 to 95 % of what is seen (Allen 1973), red more than blue.
        let clear = exp(-zenith_depth(1.0));
        assert!(clear.x > clear.y && clear.y > clear.z, "{clear}");
        assert!((0.8..0.97).contains(&clear.y), "{clear}");
    }

    #[test]
    fn spheres_are_met_ahead_alone() {
        let at = Vec3::Y * (GROUND + 1_000.0);
        assert_eq!(to_sphere(at, Vec3::Y, GROUND), None, "it lies behind");
        assert_eq!(to_sphere(at, Vec3::NEG_Y, GROUND), Some(1_000.0));
        assert_eq!(to_sphere(at, Vec3::Y, TOP), Some(99_000.0));
    }
}
