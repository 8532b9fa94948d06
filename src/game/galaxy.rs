//! The Milky Way: how bright its clouds are in a direction. Faint stars are denser there, and the
//! sky behind them glows.

use bevy::math::{Vec3, ops};

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

fn smooth(low: f32, high: f32, x: f32) -> f32 {
    super::twilight::smooth(low, high, x)
}

/// Four octaves of value noise, 0 to 1.
fn fbm(at: Vec3) -> f32 {
    let octave = |k: i32| {
        let k = k as f32;
        value_noise(at * ops::exp2(k) + Vec3::splat(k * 17.0)) * ops::exp2(-k)
    };
    (0..4).map(octave).sum::<f32>() / 1.875
}

fn value_noise(at: Vec3) -> f32 {
    let cell = at.floor();
    let f = at - cell;
    let w = f * f * (Vec3::splat(3.0) - 2.0 * f);
    let cell = cell.as_ivec3();
    let corner = |x: i32, y: i32, z: i32| {
        let hash = pcg(
            pcg(pcg((cell.x + x) as u32).wrapping_add((cell.y + y) as u32))
                .wrapping_add((cell.z + z) as u32),
        );
        hash as f32 / u32::MAX as f32
    };
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let row = |y, z| mix(corner(0, y, z), corner(1, y, z), w.x);
    let plane = |z| mix(row(0, z), row(1, z), w.y);
    mix(plane(0), plane(1), w.z)
}

/// One step of PCG as a hash (O'Neill 2014; Jarzynski and Olano 2020).
pub fn pcg(input: u32) -> u32 {
    let state = input.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
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
