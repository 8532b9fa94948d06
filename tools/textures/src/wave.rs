//! Sine and cosine by polynomials, and phasor noise (wind ripples).
//!
//! The standard library's `sin` may differ in its last bits from one platform
//! to the next; these use additions and multiplications only, so the textures
//! are the same bytes everywhere.

use crate::hash::{hash_cell, pcg, unit};
use crate::noise::wrap;

/// `sin(2 pi turns)`; error below 1e-6 over that of rounding `turns`.
#[must_use]
pub fn sin_turns(turns: f32) -> f32 {
    // To [-1/2, 1/2], then by symmetry to [-1/4, 1/4].
    let mut t = turns - (turns + 0.5).floor();
    if t > 0.25 {
        t = 0.5 - t;
    } else if t < -0.25 {
        t = -0.5 - t;
    }
    let x = t * std::f32::consts::TAU;
    let q = x * x;
    // Taylor series to x^11; at pi/2 the next term is 6e-8.
    x * (1.0
        + q * (-1.0 / 6.0
            + q * (1.0 / 120.0 + q * (-1.0 / 5040.0 + q * (1.0 / 362_880.0 - q / 39_916_800.0)))))
}

/// `cos(2 pi turns)`; error as [`sin_turns`].
#[must_use]
pub fn cos_turns(turns: f32) -> f32 {
    sin_turns(turns + 0.25)
}

/// Parameters of [`phasor`].
#[derive(Clone, Copy, Debug)]
pub struct Phasor {
    /// Waves per tile along u and v; integers keep neighbouring kernels in
    /// phase, also across the tile's border.
    pub waves: [i32; 2],
    /// Kernels per tile along each axis (the grid of kernels).
    pub kernels: i32,
    /// Random phase per kernel, turns (0 = straight parallel crests; 0.5 =
    /// wholly random, many forks and ends of crests).
    pub disorder: f32,
    /// Seed of the kernels.
    pub seed: u32,
}

/// Phasor noise (Tricard et al., "Procedural Phasor Noise", ACM TOG 38(4),
/// 2019): a sum of waves under compact windows, reduced to its phase. Gives
/// crests of an even height that wander, fork and end as wind ripples do.
///
/// `u`, `v` are in tiles. Returns (cosine, sine) of the phase and the
/// coherence (0 where crests end or fork, 1 where kernels agree). Periodic.
#[must_use]
pub fn phasor(u: f32, v: f32, p: &Phasor) -> [f32; 3] {
    const REACH: i32 = 2;
    let k = p.kernels as f32;
    let (x, y) = (u * k, v * k);
    let (cx, cy) = (x.floor() as i32, y.floor() as i32);
    let (fu, fv) = (p.waves[0] as f32 / k, p.waves[1] as f32 / k);
    let (mut cosine, mut sine, mut weight) = (0.0, 0.0, 0.0);
    for j in -REACH..=REACH {
        for i in -REACH..=REACH {
            let (gx, gy) = (cx + i, cy + j);
            let h = hash_cell(wrap(gx, p.kernels), wrap(gy, p.kernels), p.seed);
            let (dx, dy) = (
                x - gx as f32 - unit(h),
                y - gy as f32 - unit(pcg(h ^ 0x9e37)),
            );
            let r = (dx * dx + dy * dy) * (1.0 / (REACH * REACH) as f32);
            if r >= 1.0 {
                continue;
            }
            let window = (1.0 - r) * (1.0 - r) * (1.0 - r);
            let jitter = 2.0 * unit(pcg(h ^ 0x51ed)) - 1.0;
            // The crest turns a little from kernel to kernel.
            let turn = 0.25 * p.disorder * (2.0 * unit(pcg(h ^ 0x7f4a)) - 1.0);
            // The wave's own phase at this point: x and y count from the
            // kernel, whose phase is that of the straight wave train there.
            let phase = fu * x + fv * y + p.disorder * jitter + turn * (fu * dy - fv * dx);
            cosine += window * cos_turns(phase);
            sine += window * sin_turns(phase);
            weight += window;
        }
    }
    let length = (cosine * cosine + sine * sine).sqrt();
    let inverse = 1.0 / length.max(1e-6);
    let coherence = length / weight.max(1e-6);
    [cosine * inverse, sine * inverse, coherence]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[expect(clippy::disallowed_methods, reason = "the oracle of this test")]
    fn sine_matches_the_standard_library() {
        for i in -4000..4000_i16 {
            let t = f64::from(i) / 1000.0;
            let expected = (t * std::f64::consts::TAU).sin();
            let got = f64::from(sin_turns(t as f32));
            // 4 turns in f32 carry 2e-7 turns = 1.5e-6 radians of rounding.
            assert!((got - expected).abs() < 3e-6, "{t}: {got} {expected}");
        }
    }

    #[test]
    fn phasor_is_periodic() {
        let p = Phasor {
            waves: [5, 20],
            kernels: 8,
            disorder: 0.3,
            seed: 3,
        };
        for i in 0..64_u8 {
            let t = f32::from(i) / 64.0;
            let (a, b) = (phasor(0.0, t, &p), phasor(1.0, t, &p));
            let (c, d) = (phasor(t, 0.0, &p), phasor(t, 1.0, &p));
            for n in 0..3 {
                // Phases of up to 25 turns in f32: 1e-5 radians.
                assert!((a[n] - b[n]).abs() < 1e-3);
                assert!((c[n] - d[n]).abs() < 1e-3);
            }
        }
    }
}
