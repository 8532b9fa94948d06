//! Periodic gradient noise and periodic Voronoi cells over the unit tile.
//!
//! `u` runs right and `v` down, both in tiles; every function has period 1 in
//! each, because lattice cells are hashed by their number modulo the period.

use crate::hash::{hash_cell, pcg, unit};

/// A lattice cell's number modulo its period (`period > 0`).
#[must_use]
pub const fn wrap(cell: i32, period: i32) -> u32 {
    cell.rem_euclid(period).unsigned_abs()
}

/// Hermite step: 0 below `low`, 1 above `high`, smooth between.
#[must_use]
pub fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Linear interpolation, `a` at 0 and `b` at 1.
#[must_use]
pub fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

fn corner(cell: [i32; 2], period: [i32; 2], seed: u32, d: [f32; 2]) -> f32 {
    let h = hash_cell(wrap(cell[0], period[0]), wrap(cell[1], period[1]), seed);
    // Sixteen-bit halves of the hash, to the square [-1, 1)^2.
    let gx = unit(h & 0xffff_0000) * 2.0 - 1.0;
    let gy = unit(h << 16) * 2.0 - 1.0;
    gx * d[0] + gy * d[1]
}

/// Gradient noise, standard deviation about 0.3, mean 0, range within -1..1.
///
/// `period` is the number of lattice cells per tile along u and v, each at
/// least 1.
#[must_use]
pub fn gradient(u: f32, v: f32, period: [i32; 2], seed: u32) -> f32 {
    let (x, y) = (u * period[0] as f32, v * period[1] as f32);
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = (x - x0, y - y0);
    let (cx, cy) = (x0 as i32, y0 as i32);
    let fade = |t: f32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (wx, wy) = (fade(fx), fade(fy));
    let a = corner([cx, cy], period, seed, [fx, fy]);
    let b = corner([cx + 1, cy], period, seed, [fx - 1.0, fy]);
    let c = corner([cx, cy + 1], period, seed, [fx, fy - 1.0]);
    let d = corner([cx + 1, cy + 1], period, seed, [fx - 1.0, fy - 1.0]);
    mix(mix(a, b, wx), mix(c, d, wx), wy)
}

/// Sum of `octaves` gradient noises, each of twice the frequency and `gain`
/// times the amplitude of the one before; scaled so that amplitudes sum to 1.
///
/// Each octave is shifted by its own offset, so that lattices do not line up;
/// a shift keeps the period.
#[must_use]
pub fn fbm(u: f32, v: f32, period: [i32; 2], octaves: u32, gain: f32, seed: u32) -> f32 {
    let (mut sum, mut total, mut amplitude) = (0.0, 0.0, 1.0);
    for k in 0..octaves {
        let s = pcg(seed.wrapping_add(k.wrapping_mul(0x9e37_79b9)));
        let p = [period[0] << k, period[1] << k];
        sum += amplitude * gradient(u + unit(s), v + unit(pcg(s)), p, s);
        total += amplitude;
        amplitude *= gain;
    }
    sum / total
}

/// As [`fbm`], of `1 - 2|noise|`: sharp crests at 1, valleys towards -1.
#[must_use]
pub fn ridged(u: f32, v: f32, period: [i32; 2], octaves: u32, gain: f32, seed: u32) -> f32 {
    let (mut sum, mut total, mut amplitude) = (0.0, 0.0, 1.0);
    for k in 0..octaves {
        let s = pcg(seed.wrapping_add(k.wrapping_mul(0x9e37_79b9)));
        let p = [period[0] << k, period[1] << k];
        let n = gradient(u + unit(s), v + unit(pcg(s)), p, s);
        sum += amplitude * (1.0 - 2.0 * n.abs());
        total += amplitude;
        amplitude *= gain;
    }
    sum / total
}

/// What [`voronoi`] finds at a point. Lengths are in lattice cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Hash that names the cell; equal all over it.
    pub id: u32,
    /// From the cell's centre to the point.
    pub offset: [f32; 2],
    /// Distance to the nearest border with another cell (0 on the border).
    pub border: f32,
    /// Hash of the cell across that border.
    pub neighbour: u32,
}

/// Voronoi cell of the point (u, v), of `period` lattice cells per tile, one
/// centre in each, moved at random by up to half of `jitter` (0..=1) cells.
#[must_use]
pub fn voronoi(u: f32, v: f32, period: [i32; 2], jitter: f32, seed: u32) -> Cell {
    let (x, y) = (u * period[0] as f32, v * period[1] as f32);
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = (x - x0, y - y0);
    // Centres of the 5x5 cells about the point, relative to the point: the
    // nearest lies in the middle 3x3, its borders may be with any of the 25.
    let mut centres = [(0.0_f32, 0.0_f32, 0_u32); 25];
    let (mut nearest, mut best) = (0, f32::MAX);
    for (n, centre) in centres.iter_mut().enumerate() {
        let (i, j) = (n as i32 % 5 - 2, n as i32 / 5 - 2);
        let h = hash_cell(
            wrap(x0 as i32 + i, period[0]),
            wrap(y0 as i32 + j, period[1]),
            seed,
        );
        let dx = i as f32 + 0.5 + jitter * (unit(h) - 0.5) - fx;
        let dy = j as f32 + 0.5 + jitter * (unit(pcg(h)) - 0.5) - fy;
        *centre = (dx, dy, h);
        let d = dx * dx + dy * dy;
        if d < best {
            (best, nearest) = (d, n);
        }
    }
    let (nx, ny, id) = centres[nearest];
    let (mut border, mut neighbour) = (f32::MAX, id);
    for (n, &(dx, dy, h)) in centres.iter().enumerate() {
        if n == nearest {
            continue;
        }
        // Distance to the bisector of the two centres.
        let (ex, ey) = (dx - nx, dy - ny);
        let length = (ex * ex + ey * ey).sqrt().max(1e-9);
        let d = (0.5 * (dx + nx) * ex + 0.5 * (dy + ny) * ey) / length;
        if d < border {
            (border, neighbour) = (d, h);
        }
    }
    Cell {
        id,
        offset: [-nx, -ny],
        border,
        neighbour,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples() -> impl Iterator<Item = (f32, f32)> {
        (0..400_u32).map(|i| (unit(pcg(i)), unit(pcg(i + 1000))))
    }

    #[test]
    fn gradient_noise_has_period_one_and_the_documented_range() {
        let (mut squares, mut n) = (0.0_f64, 0.0_f64);
        for (u, v) in samples() {
            let a = gradient(u, v, [7, 5], 9);
            assert!(a.abs() <= 1.0);
            // u + 1 rounds u by 6e-8 of a tile = 4e-7 of a cell.
            assert!((a - gradient(u + 1.0, v, [7, 5], 9)).abs() < 1e-5);
            assert!((a - gradient(u, v - 1.0, [7, 5], 9)).abs() < 1e-5);
            squares += f64::from(a * a);
            n += 1.0;
        }
        let deviation = (squares / n).sqrt();
        assert!((0.15..0.45).contains(&deviation), "{deviation}");
    }

    #[test]
    fn sums_have_period_one() {
        for (u, v) in samples() {
            let a = fbm(u, v, [4, 3], 5, 0.5, 2);
            assert!((a - fbm(u + 1.0, v + 1.0, [4, 3], 5, 0.5, 2)).abs() < 1e-4);
            let b = ridged(u, v, [4, 3], 5, 0.5, 2);
            assert!((b - ridged(u + 1.0, v + 1.0, [4, 3], 5, 0.5, 2)).abs() < 1e-4);
        }
    }

    #[test]
    fn voronoi_has_period_one_and_matches_a_search_of_all_centres() {
        let period = [6, 4];
        for (u, v) in samples() {
            let c = voronoi(u, v, period, 1.0, 11);
            let d = voronoi(u + 1.0, v, period, 1.0, 11);
            // On a border the rounding of u + 1 may choose the other cell.
            if c.border > 1e-4 {
                assert_eq!(c.id, d.id);
                assert!((c.border - d.border).abs() < 1e-4);
            }
            let mut best = f32::MAX;
            for j in -8..12_i32 {
                for i in -8..14_i32 {
                    let h = hash_cell(wrap(i, period[0]), wrap(j, period[1]), 11);
                    let dx = u * 6.0 - (i as f32 + unit(h));
                    let dy = v * 4.0 - (j as f32 + unit(pcg(h)));
                    best = best.min(dx * dx + dy * dy);
                }
            }
            let own = c.offset[0] * c.offset[0] + c.offset[1] * c.offset[1];
            assert!((own - best).abs() < 1e-4, "{own} {best}");
            assert!(c.border >= 0.0);
        }
    }
}
