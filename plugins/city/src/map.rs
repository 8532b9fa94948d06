//! Displacement maps: periodic texels under a biquadratic B-spline, and what bounds them.
//!
//! The spline has a continuous slope, and its weights are positive and sum to 1: no value exceeds the greatest of
//! the nine texels that it is made of, so a maximum of texels is an exact bound of the surface. Coordinates are in
//! texels; the knots lie at whole numbers, texel `k` counts most at `k + ½`.

use thiserror::Error;

/// Height and slopes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// The height.
    pub height: f32,
    /// Its derivatives along x and y.
    pub slope: [f32; 2],
}

/// Texels a metre of every map.
pub const TEXELS_PER_METRE: f32 = 32.0;

/// Why texels are no map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum MapError {
    /// A side that no map has.
    #[error(
        "a displacement map of {side} × {side} texels; the side is a power of two from 4 to 1024"
    )]
    Side {
        /// Texels along it.
        side: usize,
    },
    /// Not as many texels as the side asks for.
    #[error("a displacement map of side {side} has {side} · {side} texels, not {texels}")]
    Texels {
        /// Texels along a side.
        side: usize,
        /// Texels given.
        texels: usize,
    },
}

/// A periodic displacement map; 255 means 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DisplacementMap {
    side: usize,
    texels: Vec<u8>,
    /// Greatest of 2 × 2, of 4 × 4, … texels.
    pyramid: Vec<Vec<u8>>,
    differences: [u32; 4],
}

/// What bounds a map of height 1, a texel long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapBounds {
    /// Greatest slope along an axis.
    pub slope: f32,
    /// Greatest second derivative in any direction.
    pub curvature: f32,
}

impl DisplacementMap {
    /// A map of `side` × `side` texels, row by row.
    ///
    /// # Errors
    /// [`MapError`].
    pub fn new(side: usize, texels: Vec<u8>) -> Result<Self, MapError> {
        if !side.is_power_of_two() || !(4..=1024).contains(&side) {
            return Err(MapError::Side { side });
        }
        if texels.len() != side * side {
            return Err(MapError::Texels {
                side,
                texels: texels.len(),
            });
        }
        let mut pyramid = Vec::new();
        let mut below = texels.clone();
        let mut n = side;
        while n > 1 {
            n /= 2;
            let four = |k: usize| {
                let at = 2 * (k % n) + 4 * n * (k / n);
                [at, at + 1, at + 2 * n, at + 2 * n + 1]
                    .map(|t| below[t])
                    .into_iter()
                    .fold(0, u8::max)
            };
            let level: Vec<u8> = (0..n * n).map(four).collect();
            pyramid.push(level.clone());
            below = level;
        }
        let mut map = Self {
            side,
            texels,
            pyramid,
            differences: [0; 4],
        };
        map.differences = map.greatest_differences();
        Ok(map)
    }

    /// Greatest |first|, |second along x|, |second along y| and |mixed| differences of texels.
    fn greatest_differences(&self) -> [u32; 4] {
        let mut greatest = [0; 4];
        for y in 0..self.side as i32 {
            for x in 0..self.side as i32 {
                let at = |dx: i32, dy: i32| i32::from(self.texel(x + dx, y + dy));
                let (here, east, south) = (at(0, 0), at(1, 0), at(0, 1));
                for (k, difference) in [
                    (0, east - here),
                    (0, south - here),
                    (1, at(-1, 0) - 2 * here + east),
                    (2, at(0, -1) - 2 * here + south),
                    (3, at(1, 1) - east - south + here),
                ] {
                    greatest[k] = greatest[k].max(difference.unsigned_abs());
                }
            }
        }
        greatest
    }

    /// Texels along a side.
    #[must_use]
    pub const fn side(&self) -> usize {
        self.side
    }

    /// All texels, row by row.
    #[must_use]
    pub fn texels(&self) -> &[u8] {
        &self.texels
    }

    /// A texel; both numbers go round.
    #[must_use]
    pub fn texel(&self, x: i32, y: i32) -> u8 {
        let mask = self.side as i32 - 1;
        self.texels[(y & mask) as usize * self.side + (x & mask) as usize]
    }

    /// Height and slopes a texel at a place in texels, in the operations of `city/map.wgsl`.
    #[must_use]
    pub fn sample(&self, x: f32, y: f32) -> Sample {
        let (fx, fy) = (x.floor(), y.floor());
        let (wx, dx) = weights(x - fx);
        let (wy, dy) = weights(y - fy);
        let mut sum = [0.0_f32; 3];
        for j in 0..3_i32 {
            let row =
                (0..3_i32).map(|i| f32::from(self.texel(fx as i32 + i - 1, fy as i32 + j - 1)));
            let (mut value, mut slope) = (0.0, 0.0);
            for (i, texel) in row.enumerate() {
                value += wx[i] * texel;
                slope += dx[i] * texel;
            }
            sum[0] += wy[j as usize] * value;
            sum[1] += wy[j as usize] * slope;
            sum[2] += dy[j as usize] * value;
        }
        Sample {
            height: sum[0] / 255.0,
            slope: [sum[1] / 255.0, sum[2] / 255.0],
        }
    }

    /// The same in f64, by the kernel's distance form: the reference.
    #[must_use]
    pub fn exact(&self, x: f64, y: f64) -> [f64; 3] {
        let (kx, ky) = (x.floor() as i32, y.floor() as i32);
        let mut sum = [0.0; 3];
        for j in ky - 1..=ky + 1 {
            for i in kx - 1..=kx + 1 {
                let texel = f64::from(self.texel(i, j)) / 255.0;
                let [ax, bx] = kernel(x - f64::from(i) - 0.5);
                let [ay, by] = kernel(y - f64::from(j) - 0.5);
                sum[0] += ax * ay * texel;
                sum[1] += bx * ay * texel;
                sum[2] += ax * by * texel;
            }
        }
        sum
    }

    /// The greatest texel that counts anywhere in a rectangle of places, as a height: no height in it is greater.
    #[must_use]
    pub fn greatest(&self, [x0, x1]: [f32; 2], [y0, y1]: [f32; 2]) -> f32 {
        let n = self.side as i32;
        let range = |low: f32, high: f32| {
            let (low, high) = (low.floor() as i32 - 1, high.floor() as i32 + 1);
            if high - low + 1 >= n {
                return [(0, n), (0, 0)];
            }
            let first = low & (n - 1);
            let end = first + high - low + 1;
            [(first, end.min(n)), (0, (end - n).max(0))]
        };
        let mut greatest = 0;
        for (top, bottom) in range(y0, y1) {
            for (left, right) in range(x0, x1) {
                if top < bottom && left < right {
                    let part = [left, right, top, bottom];
                    self.descend(self.pyramid.len(), [0, 0], part, &mut greatest);
                }
            }
        }
        f32::from(greatest) / 255.0
    }

    /// Raises `greatest` to the greatest texel of node (x, y) of a level within a rectangle of texels.
    fn descend(&self, level: usize, [x, y]: [i32; 2], part: [i32; 4], greatest: &mut u8) {
        let size = 1_i32 << level;
        let [left, right, top, bottom] = part;
        let (x0, y0) = (x * size, y * size);
        if x0 >= right || y0 >= bottom || x0 + size <= left || y0 + size <= top {
            return;
        }
        let across = self.side >> level;
        let index = y as usize * across + x as usize;
        let own = match level {
            0 => self.texels[index],
            _ => self.pyramid[level - 1][index],
        };
        if own <= *greatest {
            return;
        }
        if x0 >= left && y0 >= top && x0 + size <= right && y0 + size <= bottom {
            *greatest = own;
            return;
        }
        for child in 0..4 {
            let at = [2 * x + (child & 1), 2 * y + (child >> 1)];
            self.descend(level - 1, at, part, greatest);
        }
    }

    /// Bounds of slope and curvature: both are means, with weights that are positive and sum to 1, of differences of
    /// texels. A second derivative along (cos a, sin a) is xx cos² a + 2 xy sin a cos a + yy sin² a, which is at most
    /// max(xx, yy) + xy.
    #[must_use]
    pub fn bounds(&self) -> MapBounds {
        let [first, xx, yy, xy] = self.differences.map(|d| d as f32 / 255.0);
        MapBounds {
            slope: first,
            curvature: xx.max(yy) + xy,
        }
    }
}

/// Weights of three texels, and their derivatives, at a fraction behind the middle one's edge.
fn weights(f: f32) -> ([f32; 3], [f32; 3]) {
    let g = 1.0 - f;
    (
        [0.5 * g * g, 0.5 + f * g, 0.5 * f * f],
        [-g, 1.0 - 2.0 * f, f],
    )
}

/// The quadratic B-spline and its derivative at a distance from its middle.
fn kernel(d: f64) -> [f64; 2] {
    let a = d.abs();
    if a <= 0.5 {
        [0.75 - d * d, -2.0 * d]
    } else if a <= 1.5 {
        [0.5 * (1.5 - a) * (1.5 - a), (a - 1.5) * d.signum()]
    } else {
        [0.0, 0.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::{pcg, unit};

    fn noise(side: usize) -> DisplacementMap {
        let texels = (0..side * side)
            .map(|k| (pcg(k as u32) >> 24) as u8)
            .collect();
        DisplacementMap::new(side, texels).expect("a map")
    }

    #[test]
    fn maps_that_are_none_are_refused() {
        assert_eq!(
            DisplacementMap::new(1, vec![7]),
            Err(MapError::Side { side: 1 })
        );
        assert!(DisplacementMap::new(12, vec![0; 144]).is_err());
        let error = DisplacementMap::new(8, vec![0; 63]).expect_err("one is missing");
        assert!(error.to_string().contains("63"), "{error}");
    }

    #[test]
    fn samples_are_those_of_f64_and_slopes_those_of_differences() {
        let map = noise(16);
        for k in 0..20_000 {
            let [x, y] = [pcg(k), pcg(k ^ 0xabcd)].map(|h| unit(h) * 40.0 - 12.0);
            let found = map.sample(x, y);
            let exact = map.exact(f64::from(x), f64::from(y));
            // Nine products of weights up to ¾ and texels up to 255, each rounded to 2⁻²⁴: below 1e-6.
            assert!((f64::from(found.height) - exact[0]).abs() < 1e-6);
            assert!((f64::from(found.slope[0]) - exact[1]).abs() < 2e-6);
            assert!((f64::from(found.slope[1]) - exact[2]).abs() < 2e-6);
            let step = 1e-6;
            let ahead = map.exact(f64::from(x) + step, f64::from(y));
            assert!(((ahead[0] - exact[0]) / step - exact[1]).abs() < 1e-5);
        }
    }

    #[test]
    fn the_greatest_of_a_rectangle_is_that_of_its_texels() {
        let map = noise(32);
        for k in 0..3000 {
            let [x, y, w, h] = [1, 2, 3, 4].map(|salt| unit(pcg(k ^ (salt << 20))));
            let (x, y) = (x * 90.0 - 30.0, y * 90.0 - 30.0);
            let (w, h) = (w * w * 40.0, h * h * 40.0);
            let found = map.greatest([x, x + w], [y, y + h]);
            let mut slow = 0;
            for j in y.floor() as i32 - 1..=(y + h).floor() as i32 + 1 {
                for i in x.floor() as i32 - 1..=(x + w).floor() as i32 + 1 {
                    slow = slow.max(map.texel(i, j));
                }
            }
            assert_eq!(found, f32::from(slow) / 255.0, "{x} {y} {w} {h}");
        }
    }

    #[test]
    fn bounds_hold_and_are_not_loose() {
        let map = noise(16);
        let bounds = map.bounds();
        let (mut slope, mut curvature) = (0.0_f64, 0.0_f64);
        for k in 0..200_000 {
            let [x, y] = [pcg(k), pcg(k ^ 0xabcd)].map(|h| f64::from(unit(h)) * 16.0);
            let [_, sx, sy] = map.exact(x, y);
            slope = slope.max(sx.abs()).max(sy.abs());
            // Along a diagonal too, within a cell of knots.
            let step = 1e-3;
            let [bx, by] = [x.fract(), y.fract()].map(|f| f > 0.01 && f < 0.99);
            if bx && by {
                for (dx, dy) in [
                    (step, 0.0),
                    (0.0, step),
                    (step * 0.5_f64.sqrt(), step * 0.5_f64.sqrt()),
                ] {
                    let at = |k: f64| map.exact(x + k * dx, y + k * dy)[0];
                    curvature =
                        curvature.max(((at(1.0) - 2.0 * at(0.0) + at(-1.0)) / (step * step)).abs());
                }
            }
        }
        let (slope_bound, curvature_bound) = (f64::from(bounds.slope), f64::from(bounds.curvature));
        assert!(
            slope <= slope_bound && slope > 0.6 * slope_bound,
            "{slope} {slope_bound}"
        );
        // Second differences over a step of 1e-3 cancel to 1e-10 or so.
        assert!(
            curvature <= curvature_bound + 1e-6,
            "{curvature} {curvature_bound}"
        );
        assert!(
            curvature > 0.4 * curvature_bound,
            "{curvature} {curvature_bound}"
        );
    }
}
