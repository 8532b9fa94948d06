//! Noise that repeats, for textures that are made: pure functions of (u, v) with period 1.

use bevy::math::{IVec2, Vec2};

/// PCG as a hash (Jarzynski and Olano, 2020).
fn pcg(value: u32) -> u32 {
    let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

fn hash(cell: IVec2, period: i32, seed: u32) -> u32 {
    let cell = cell.rem_euclid(IVec2::splat(period));
    pcg(cell.x as u32 ^ pcg(cell.y as u32 ^ pcg(seed)))
}

/// 0 to 1.
fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 / 16_777_216.0
}

/// Gradient noise of `period` cells a tile, some −0.7 to 0.7.
fn gradient_noise(at: Vec2, period: i32, seed: u32) -> f32 {
    let p = at * period as f32;
    let cell = p.floor().as_ivec2();
    let f = p - p.floor();
    let t = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let corner = |x: i32, y: i32| {
        let bits = hash(cell + IVec2::new(x, y), period, seed);
        // Anywhere in a square, of a mean length near 1.
        let gradient = Vec2::new(unit(bits), unit(pcg(bits))) * 2.6 - 1.3;
        gradient.dot(f - Vec2::new(x as f32, y as f32))
    };
    let low = corner(0, 0) + (corner(1, 0) - corner(0, 0)) * t.x;
    let high = corner(0, 1) + (corner(1, 1) - corner(0, 1)) * t.x;
    low + (high - low) * t.y
}

/// A sum of octaves from `period` cells a tile on, each with twice the cells and half the amplitude; some
/// −1 to 1.
pub(super) fn fbm(at: Vec2, period: i32, octaves: u32, seed: u32) -> f32 {
    let mut sum = 0.0;
    let (mut period, mut amplitude) = (period, 1.0);
    for octave in 0..octaves {
        sum += amplitude * gradient_noise(at, period, seed.wrapping_add(octave.wrapping_mul(101)));
        period *= 2;
        amplitude *= 0.5;
    }
    sum
}

/// What is near a place among one point in each of `period`² cells (Worley, 1996).
#[derive(Clone, Copy, Debug)]
pub(super) struct Cells {
    /// Distance to the nearest point, cells.
    pub first: f32,
    /// To the second nearest.
    pub second: f32,
    /// A number from 0 to 1 of the nearest.
    pub own: f32,
}

pub(super) fn cells(at: Vec2, period: i32, seed: u32) -> Cells {
    let p = at * period as f32;
    let cell = p.floor().as_ivec2();
    let mut found = Cells {
        first: f32::INFINITY,
        second: f32::INFINITY,
        own: 0.0,
    };
    for y in -1..=1 {
        for x in -1..=1 {
            let there = cell + IVec2::new(x, y);
            let bits = hash(there, period, seed);
            let point = there.as_vec2() + Vec2::new(unit(bits), unit(pcg(bits)));
            let distance = p.distance(point);
            if distance < found.first {
                found.second = found.first;
                found.first = distance;
                found.own = unit(pcg(bits ^ 0x5bd1_e995));
            } else {
                found.second = found.second.min(distance);
            }
        }
    }
    found
}
