//! Value noise on a lattice, with a quintic fade.

use glam::{IVec3, Vec3};

fn value(cell: IVec3) -> f32 {
    let pcg = |word: u32| {
        let state = word.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let mixed = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
        (mixed >> 22) ^ mixed
    };
    let [x, y, z] = cell.to_array().map(i32::cast_unsigned);
    let hash = pcg(pcg(pcg(x).wrapping_add(y)).wrapping_add(z));
    (hash >> 8) as f32 / 8_388_608.0 - 1.0
}

/// One octave, −1 to 1.
fn octave(at: Vec3) -> f32 {
    let cell = at.floor();
    let t = at - cell;
    let fade = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let cell = cell.as_ivec3();
    let corner = |k: i32| value(cell + IVec3::new(k & 1, (k >> 1) & 1, k >> 2));
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let row = |k: i32| mix(corner(k), corner(k + 1), fade.x);
    let plane = |k: i32| mix(row(k), row(k + 2), fade.y);
    mix(plane(0), plane(4), fade.z)
}

/// A sum of octaves, each twice as fine and `gain` times as strong as the one before; within −1 to 1.
#[must_use]
pub fn fractal(at: Vec3, octaves: u32, gain: f32) -> f32 {
    let (mut sum, mut weight, mut all) = (0.0, 1.0, 0.0);
    let mut at = at;
    for _ in 0..octaves {
        sum += weight * octave(at);
        all += weight;
        weight *= gain;
        at = at * 2.03 + Vec3::splat(7.3);
    }
    sum / all
}
