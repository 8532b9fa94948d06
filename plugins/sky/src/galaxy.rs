//! The Milky Way: how bright its clouds are in a direction. Faint stars are denser there, and the
//! sky behind them glows.

use bevy::math::{Vec3, ops};

use crate::math::{fbm, smooth};

/// Two directions on the middle of the band: its brightest part, low in the north-east, and its
/// height in the west. East is +x, north −z, +y up.
const CENTRE: Vec3 = Vec3::new(0.700, 0.292, -0.652);
const HEIGHT: Vec3 = Vec3::new(-0.52, 0.80, 0.298);

/// Half widths of the band, radians: far from its centre, and how much is added there.
const WIDTH: f32 = 0.11;
const BULGE: f32 = 0.10;

/// Brightness in a direction of length 1, from 0 to about 1: a band with a bulge, clouds in it, and
/// lanes of dust along its middle.
pub fn brightness(direction: Vec3) -> f32 {
    let pole = CENTRE.cross(HEIGHT).normalize();
    let latitude = ops::asin(direction.dot(pole).clamp(-1.0, 1.0));
    let along = (direction - pole * direction.dot(pole)).normalize_or_zero();
    let inwards = along.dot(CENTRE.normalize());
    let bulge = smooth(0.2, 1.0, inwards);
    let width = WIDTH + BULGE * bulge;
    let clouds = fbm(direction * 5.0);
    let band = gauss(latitude / width) * (0.42 + 0.58 * bulge) * (0.35 + 1.1 * clouds);
    // The lanes wander about the middle.
    let middle = 0.07 * (fbm(direction * 3.0 + Vec3::splat(7.0)) - 0.5);
    let torn = smooth(0.38, 0.6, fbm(direction * 7.0 + Vec3::splat(31.0)));
    let lane = gauss((latitude - middle) / 0.05) * torn * smooth(-0.4, 0.4, inwards);
    band * (1.0 - 0.8 * lane)
}

fn gauss(x: f32) -> f32 {
    ops::exp(-x * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_band_is_bright_and_its_poles_are_dark() {
        let pole = CENTRE.cross(HEIGHT).normalize();
        assert!(brightness(pole) < 1e-3 && brightness(-pole) < 1e-3);
        let around = |turn: f32, lift: f32| {
            let (sin, cos) = ops::sin_cos(turn);
            let start = CENTRE.normalize();
            (start * cos + pole.cross(start) * sin + pole * lift).normalize()
        };
        let mean = |lift: f32| {
            (0..360_u16)
                .map(|k| brightness(around(f32::from(k).to_radians(), lift)))
                .sum::<f32>()
                / 360.0
        };
        assert!(
            mean(0.0) > 0.2 && mean(0.06) > 10.0 * mean(0.6),
            "{} {}",
            mean(0.06),
            mean(0.6)
        );
        for k in 0..2000_u16 {
            let value = brightness(around(f32::from(k), f32::from(k % 40) * 0.1 - 2.0));
            assert!((0.0..1.5).contains(&value), "{value}");
        }
    }
}
