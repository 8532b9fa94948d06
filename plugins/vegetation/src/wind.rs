//! Wind and swell as a field: a function of place and time that is stored nowhere.
//!
//! **Gusts** are a sum of plane waves that the wind carries along (Taylor's hypothesis of frozen turbulence, G. I.
//! Taylor, *The spectrum of turbulence*, Proc. R. Soc. A 164, 1938): the field at a place is that of a second ago
//! upwind. **Swell** is the linear theory of waves in deep water (G. B. Airy, 1845): ω² = g·k, and water goes around
//! circles whose radius falls by e^(k·z) with depth.
//!
//! Phases are computed in f64 at an anchor near the camera, and only what is left of a place, relative to the anchor,
//! is f32: the field is as smooth 10 000 km from the origin as at it.

use bevy::math::{DVec2, Vec2, Vec3, ops};
use bevy::prelude::*;
use bytemuck::{Pod, Zeroable};
use dolomite_terrain::GroundPoint;

/// Waves of the gusts: wavelength in metres, angle to the wind in radians, weight. Weights sum to 1; wavelengths have
/// no common multiple below a kilometre.
const GUSTS: [[f64; 3]; 4] = [
    [61.0, 0.18, 0.38],
    [37.0, -0.41, 0.27],
    [17.3, 0.52, 0.2],
    [9.1, -0.11, 0.15],
];

/// Waves of the swell: period in seconds, angle to the wind, share of the height.
const SWELL: [[f64; 3]; 3] = [[8.7, 0.1, 0.5], [6.1, -0.5, 0.3], [4.3, 0.6, 0.2]];

/// How far blades flutter beside the wind's push, as a share of it.
const FLUTTER: f32 = 0.18;

/// Turns a second of that flutter at the slowest blade.
const FLUTTER_RATE: f64 = 1.3;

/// Standard gravity, m/s².
const GRAVITY: f64 = 9.806_65;

/// Wind over the terrain of the same entity, and the swell of its water.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct Wind {
    /// Where it blows to: angle from +x towards +z, radians.
    pub towards: f64,
    /// Mean speed, m/s, 0 to 40.
    pub speed: f32,
    /// How much gusts differ from the mean, as a share of it, 0 to 1.
    pub gusts: f32,
    /// Height of the swell from trough to crest, metres, 0 to 10.
    pub swell: f32,
}

impl Default for Wind {
    /// A breeze to the north-east with a swell of 0.8 m.
    fn default() -> Self {
        Self {
            towards: -0.7,
            speed: 4.0,
            gusts: 0.7,
            swell: 0.8,
        }
    }
}

/// The field at one time about an anchor, for shaders too: 144 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct WindField {
    /// Waves of the gusts: wave vector (x, z) in radians a metre, phase at the anchor, weight.
    pub gusts: [[f32; 4]; 4],
    /// Waves of the swell: wave vector, phase at the anchor, radius at the surface in metres.
    pub swell: [[f32; 4]; 3],
    /// Mean wind (x, z), m/s.
    pub mean: [f32; 2],
    /// Share of the mean by which gusts differ.
    pub share: f32,
    /// Phase of the flutter, radians.
    pub flutter: f32,
    /// Rates of the flutter's two halves have phases of their own: that of the faster one.
    pub flutter_fast: f32,
    /// To fill 16 bytes.
    pub rest: [f32; 3],
}

/// Within ±π of 0.
fn wrapped(phase: f64) -> f32 {
    let turn = std::f64::consts::TAU;
    (phase - turn * (phase / turn).round()) as f32
}

#[expect(
    clippy::disallowed_methods,
    reason = "phases are f64, and only smooth to look at"
)]
fn direction(angle: f64) -> DVec2 {
    DVec2::new(angle.cos(), angle.sin())
}

impl WindField {
    /// At `time`, seconds. Numbers outside of their ranges are brought into them; NaN is no wind.
    #[must_use]
    pub fn new(wind: &Wind, anchor: GroundPoint, time: f64) -> Self {
        let number = |x: f32, most: f32| if x > 0.0 { x.min(most) } else { 0.0 };
        let towards = if wind.towards.is_finite() {
            wind.towards
        } else {
            0.0
        };
        let time = if time.is_finite() { time } else { 0.0 };
        let mean = direction(towards) * f64::from(number(wind.speed, 40.0));
        let place = anchor.to_dvec2();
        let gusts = GUSTS.map(|[length, angle, weight]| {
            let k = direction(towards + angle) * (std::f64::consts::TAU / length);
            let phase = k.dot(place - mean * time);
            [k.x as f32, k.y as f32, wrapped(phase), weight as f32]
        });
        let height = f64::from(number(wind.swell, 10.0));
        let swell = SWELL.map(|[period, angle, share]| {
            let rate = std::f64::consts::TAU / period;
            let k = direction(towards + angle) * (rate * rate / GRAVITY);
            let phase = k.dot(place) - rate * time;
            [
                k.x as f32,
                k.y as f32,
                wrapped(phase),
                (0.5 * height * share) as f32,
            ]
        });
        Self {
            gusts,
            swell,
            mean: mean.as_vec2().to_array(),
            share: number(wind.gusts, 1.0),
            flutter: wrapped(std::f64::consts::TAU * FLUTTER_RATE * time),
            flutter_fast: wrapped(std::f64::consts::TAU * 2.0 * FLUTTER_RATE * time),
            rest: [0.0; 3],
        }
    }

    /// The wind's strength as a multiple of the mean, at a place relative to the anchor: 1 − share to 1 + share.
    #[inline]
    #[must_use]
    pub fn strength(&self, at: Vec2) -> f32 {
        let sum: f32 = self
            .gusts
            .iter()
            .map(|[x, z, phase, weight]| weight * ops::sin(x * at.x + z * at.y + phase))
            .sum();
        // Fronts are steeper than waves.
        let part = 0.5 + 0.5 * sum;
        let steep = part * part * (3.0 - 2.0 * part);
        1.0 + self.share * (2.0 * steep - 1.0)
    }

    /// What a blade feels, m/s along x and z: the wind, and a flutter of its own, by a number of its own (0 up to 1), at one
    /// of two rates.
    #[inline]
    #[must_use]
    pub fn on_blade(&self, at: Vec2, own: f32, fast: bool) -> Vec2 {
        let strength = self.strength(at);
        let mean = Vec2::from(self.mean);
        let phase = if fast {
            self.flutter_fast
        } else {
            self.flutter
        } + std::f32::consts::TAU * own;
        // Along the wind and across it, a quarter of a turn apart.
        let flutter = FLUTTER * strength;
        mean * (strength + flutter * ops::sin(phase)) + mean.perp() * (flutter * ops::cos(phase))
    }

    /// How far water is from its place at rest, metres, at a height below the surface (`depth` above 0).
    #[inline]
    #[must_use]
    pub fn in_water(&self, at: Vec2, depth: f32) -> Vec3 {
        let mut moved = Vec3::ZERO;
        for [x, z, phase, radius] in self.swell {
            let k = Vec2::new(x, z);
            let length = k.length();
            let angle = k.dot(at) + phase;
            let radius = radius * ops::exp(-length * depth.max(0.0));
            let along = k * (-radius * ops::sin(angle) / length.max(1e-9));
            moved += Vec3::new(along.x, radius * ops::cos(angle), along.y);
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, z: f64) -> GroundPoint {
        GroundPoint::new(DVec2::new(x, z))
    }

    /// The field is the same whichever anchor it is told from, near the origin and 10 000 km away.
    #[test]
    fn anchors_do_not_matter() {
        for far in [0.0, 1e7] {
            let [a, b] = [at(far, -far), at(far + 96.0, -far - 64.0)];
            for k in 0..50 {
                let time = 1000.0 + 0.37 * f64::from(k);
                let [one, other] =
                    [a, b].map(|anchor| WindField::new(&Wind::default(), anchor, time));
                let place = Vec2::new(3.0 + k as f32, 20.0 - k as f32);
                let moved = place - Vec2::new(96.0, -64.0);
                // An f32 sum of products of up to 80 radians: an ulp of 80 is 7.6e-6, over four waves.
                let same = one.on_blade(place, 0.77, true) - other.on_blade(moved, 0.77, true);
                assert!(same.length() < 4.0 * 4.0 * 7.6e-6 * 4.0, "{same}");
                let same = one.in_water(place, 3.0) - other.in_water(moved, 3.0);
                assert!(same.length() < 1e-4, "{same}");
            }
        }
    }

    /// Gusts travel with the wind: what is here now is a second later where the wind blows to.
    #[test]
    fn gusts_travel() {
        let wind = Wind::default();
        let way = direction(wind.towards) * f64::from(wind.speed);
        let [now, later] = [5.0, 8.0].map(|time| WindField::new(&wind, at(0.0, 0.0), time));
        let mut spread = (f32::MAX, f32::MIN);
        for k in 0..200 {
            let place = Vec2::new(k as f32 * 1.7, k as f32 * -2.3);
            let carried = place + (way * 3.0).as_vec2();
            let strength = now.strength(place);
            assert!((strength - later.strength(carried)).abs() < 1e-3);
            assert!((0.3..=1.7).contains(&strength), "1 ± share: {strength}");
            spread = (spread.0.min(strength), spread.1.max(strength));
        }
        assert!(spread.1 - spread.0 > 0.8, "gusts are there: {spread:?}");
    }

    /// Water goes around circles: the surface by half of the swell's height at most, and less below.
    #[test]
    fn swell_fades_with_depth() {
        let field = WindField::new(&Wind::default(), at(0.0, 0.0), 12.5);
        for k in 0..100 {
            let place = Vec2::new(k as f32, 0.3 * k as f32);
            let [top, deep] = [0.0, 20.0].map(|depth| field.in_water(place, depth).length());
            assert!(top <= 0.4 + 1e-5, "half of 0.8 m: {top}");
            // The longest wave has a period of 8.7 s: k = 0.0532, e^(−20 k) = 0.345 of its share.
            assert!(deep <= 0.4 * 0.345, "{deep}");
        }
    }

    #[test]
    fn any_number_is_taken() {
        let wind = Wind {
            towards: f64::NAN,
            speed: f32::INFINITY,
            gusts: f32::NAN,
            swell: -1.0,
        };
        let field = WindField::new(&wind, at(f64::NAN, f64::INFINITY), f64::NAN);
        assert!(field.on_blade(Vec2::ONE, 0.5, false).is_finite());
        assert_eq!(field.in_water(Vec2::ONE, 1.0), Vec3::ZERO);
    }
}
