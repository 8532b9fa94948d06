//! Small functions that several files of the sky share: a smooth step, an integer hash, value noise.

use bevy::math::{Vec3, ops};

/// 0 up to `low`, 1 from `high` on, smooth between.
pub(crate) fn smooth(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// One step of PCG as a hash (O'Neill 2014; Jarzynski and Olano 2020).
pub(crate) fn pcg(input: u32) -> u32 {
    let state = input.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// Four octaves of value noise, 0 to 1.
pub(crate) fn fbm(at: Vec3) -> f32 {
    let octave = |k: i32| {
        let k = k as f32;
        value_noise(at * ops::exp2(k) + Vec3::splat(k * 17.0)) * ops::exp2(-k)
    };
    (0..4).map(octave).sum::<f32>() / 1.875
}

/// Random values at whole places, smooth between; 0 to 1.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_step_is_held_at_its_ends_and_half_in_the_middle() {
        let at = |x| smooth(-2.0, 4.0, x);
        assert_eq!(
            [at(-9.0), at(-2.0), at(1.0), at(4.0), at(9.0)],
            [0.0, 0.0, 0.5, 1.0, 1.0]
        );
    }

    #[test]
    fn noise_is_continuous_and_fills_its_range() {
        let (mut least, mut greatest) = (1.0_f32, 0.0_f32);
        for k in 0..4_000_u16 {
            let at = Vec3::new(0.37, -0.21, 0.11) * (0.05 * f32::from(k));
            let here = fbm(at);
            // The slope of an octave is at most 1.5 along each axis, whatever its scale: four of
            // them over three axes, 1.875 together.
            let near = fbm(at + Vec3::splat(1e-3));
            assert!((here - near).abs() < 0.01, "{at}: {here} {near}");
            (least, greatest) = (least.min(here), greatest.max(here));
        }
        assert!(
            least > 0.0 && least < 0.3 && greatest < 1.0 && greatest > 0.7,
            "{least} {greatest}"
        );
    }
}
