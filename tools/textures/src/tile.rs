//! From a painted surface to the bytes of one layer: flattening, supersampled
//! reduction, normals, roughness and occlusion.

use crate::colour::{Rgb, encode_byte};
use crate::plane::{Plane, rows};
use crate::surface::{Look, Surface, TILE_METRES};

/// Standard deviation, in tiles, of the low-pass that albedo is divided by:
/// a wave as long as a quarter of a tile loses 3/4 of its contrast, a longer one more, so
/// that no blotch betrays the repetition (the terrain's shader adds the
/// variation at large).
const FLATTEN_ALBEDO: f32 = 0.03;

/// Fractions of the texels that are clipped at the bottom and the top of the
/// height, so that a few outliers do not use up the 8 bits.
const CLIP: f64 = 0.0005;

/// One finished layer, row by row downwards.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Texels along a side.
    pub size: usize,
    /// sRGB albedo, and height in a (0..=255 is 0..=relief).
    pub albedo_height: Vec<[u8; 4]>,
    /// Linear: normal x (along +u, right) and y (along +v, down) as
    /// (n + 1) / 2, perceptual roughness, ambient occlusion (255 = open); the
    /// last two in 32 levels.
    pub normal_roughness: Vec<[u8; 4]>,
}

/// The numbers behind a [`Tile`], before rounding to bytes.
#[derive(Clone, Debug)]
pub struct Fields {
    /// Linear albedo, one plane for each of r, g, b.
    pub albedo: [Plane; 3],
    /// Height in reliefs, 0..=1 but for the clipped outliers.
    pub height: Plane,
    /// Rise over run along +u and +v (metres per metre).
    pub slope: [Plane; 2],
    /// Perceptual roughness.
    pub roughness: Plane,
    /// Ambient occlusion, 1 where the whole sky is seen.
    pub occlusion: Plane,
}

/// Finishes a surface of twice the size.
#[must_use]
pub fn finish(surface: &Surface, look: &Look) -> Fields {
    let fine = surface.size() as f32;
    let mut height = surface.plane(|t| t.height);
    subtract(&mut height, look.flatten_height * fine);
    let [low, high] = height.halved().quantiles(CLIP, 1.0 - CLIP);
    let span = (high - low).max(1e-6);
    for h in height.values_mut() {
        *h = (*h - low) / span;
    }

    // Slopes at the fine size, then their mean and variance over 2x2: the
    // mean makes the normal, the variance widens the highlight.
    let per_texel = look.relief * fine / TILE_METRES;
    let fine_slope = slopes(&height, per_texel);
    let slope = [fine_slope[0].halved(), fine_slope[1].halved()];
    let spread = Plane::from_index(height.size(), |i| {
        let (x, y) = (fine_slope[0].values()[i], fine_slope[1].values()[i]);
        x * x + y * y
    })
    .halved();
    let rough = surface.plane(|t| t.roughness).halved();
    let roughness = Plane::from_index(rough.size(), |i| {
        let (x, y) = (slope[0].values()[i], slope[1].values()[i]);
        let variance = (spread.values()[i] - x * x - y * y).max(0.0);
        widened(rough.values()[i], variance)
    });

    let height = height.halved();
    let occlusion = occlude(&height, look.relief * height.size() as f32 / TILE_METRES);
    let mut albedo = [0, 1, 2]
        .map(|c| flattened(&surface.plane(|t| t.albedo[c]), FLATTEN_ALBEDO * fine).halved());
    for (plane, mean) in albedo.iter_mut().zip(look.mean_albedo) {
        for (a, open) in plane.values_mut().iter_mut().zip(occlusion.values()) {
            *a *= 1.0 - look.occlusion * (1.0 - open);
        }
        set_mean(plane, mean);
    }
    Fields {
        albedo,
        height,
        slope,
        roughness,
        occlusion,
    }
}

impl Fields {
    /// Rounds to bytes.
    #[must_use]
    pub fn to_tile(&self) -> Tile {
        let byte = |x: f32| (x.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        // Roughness and occlusion keep 32 levels: their steps do not show, and
        // the noise of three more bits is a tenth of the file.
        let coarse = |x: f32| byte((x * 31.0).round() / 31.0);
        let count = self.height.values().len();
        let albedo_height = (0..count)
            .map(|i| {
                let [r, g, b] = [0, 1, 2].map(|c| encode_byte(self.albedo[c].values()[i]));
                [r, g, b, byte(self.height.values()[i])]
            })
            .collect();
        let normal_roughness = (0..count)
            .map(|i| {
                let (x, y) = (self.slope[0].values()[i], self.slope[1].values()[i]);
                let inverse = 1.0 / (1.0 + x * x + y * y).sqrt();
                [
                    byte(0.5 - 0.5 * x * inverse),
                    byte(0.5 - 0.5 * y * inverse),
                    coarse(self.roughness.values()[i]),
                    coarse(self.occlusion.values()[i]),
                ]
            })
            .collect();
        Tile {
            size: self.height.size(),
            albedo_height,
            normal_roughness,
        }
    }

    /// Mean linear albedo.
    #[must_use]
    pub fn mean_albedo(&self) -> Rgb {
        [0, 1, 2].map(|c| self.albedo[c].mean())
    }
}

/// Central differences of a periodic height times `per_texel`.
#[must_use]
pub fn slopes(height: &Plane, per_texel: f32) -> [Plane; 2] {
    let n = height.size();
    let difference = |dx: isize, dy: isize| {
        Plane::from_index(n, |i| {
            let (x, y) = ((i % n).cast_signed(), (i / n).cast_signed());
            let rise = height.wrapped(x + dx, y + dy) - height.wrapped(x - dx, y - dy);
            0.5 * rise * per_texel
        })
    };
    [difference(1, 0), difference(0, 1)]
}

/// Perceptual roughness of a facet of roughness `rough` whose slopes vary by
/// `variance` (both axes together) within the texel: squared widths add. The
/// variance counts up to 0.18, so that an edge does not become quite matt.
fn widened(rough: f32, variance: f32) -> f32 {
    let alpha = rough * rough;
    let wide = (alpha * alpha + variance.min(0.18)).min(1.0);
    wide.sqrt().sqrt()
}

/// Subtracts the low-pass of `sigma` texels.
fn subtract(plane: &mut Plane, sigma: f32) {
    let low = plane.blurred(sigma);
    for (value, low) in plane.values_mut().iter_mut().zip(low.values()) {
        *value -= low;
    }
}

/// Divides by the low-pass of `sigma` texels and restores the mean.
fn flattened(plane: &Plane, sigma: f32) -> Plane {
    let (low, mean) = (plane.blurred(sigma), plane.mean());
    Plane::from_index(plane.size(), |i| {
        plane.values()[i] * mean / low.values()[i].max(1e-4)
    })
}

/// Scales to a mean, within the reflectances that matter has (1% to 97%).
fn set_mean(plane: &mut Plane, mean: f32) {
    // What is clamped moves the mean again, so a few rounds.
    for _ in 0..4 {
        let factor = mean / plane.mean().max(1e-6);
        for value in plane.values_mut() {
            *value = (*value * factor).clamp(0.01, 0.97);
        }
    }
}

/// Share of a uniformly bright sky that a texel sees, weighted by cosine:
/// horizons in 8 directions out to 24 texels; a horizon of slope t hides
/// t^2 / (1 + t^2) of its sector.
fn occlude(height: &Plane, per_texel: f32) -> Plane {
    const DIRECTIONS: [(isize, isize); 8] = [
        (1, 0),
        (1, 1),
        (0, 1),
        (-1, 1),
        (-1, 0),
        (-1, -1),
        (0, -1),
        (1, -1),
    ];
    const STEPS: [isize; 8] = [1, 2, 3, 5, 8, 12, 17, 24];
    let n = height.size();
    let values = rows(n, |y| {
        (0..n)
            .map(|x| {
                let here = height.values()[y * n + x];
                let mut open = 0.0;
                for (dx, dy) in DIRECTIONS {
                    let stride = if dx != 0 && dy != 0 {
                        std::f32::consts::SQRT_2
                    } else {
                        1.0
                    };
                    let mut slope = 0.0_f32;
                    for step in STEPS {
                        let there = height
                            .wrapped(x.cast_signed() + dx * step, y.cast_signed() + dy * step);
                        slope = slope.max((there - here) * per_texel / (stride * step as f32));
                    }
                    open += 1.0 / (1.0 + slope * slope);
                }
                open / DIRECTIONS.len() as f32
            })
            .collect()
    });
    Plane::from_index(n, |i| values[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Texel;
    use crate::wave::sin_turns;

    #[test]
    fn slopes_are_those_of_a_sine() {
        let n = 256;
        let wave = Plane::from_index(n, |i| sin_turns(2.0 * ((i % n) as f32 + 0.5) / n as f32));
        let [x, y] = slopes(&wave, n as f32);
        for i in 0..n * n {
            let expected = 2.0
                * std::f32::consts::TAU
                * crate::wave::cos_turns(2.0 * ((i % n) as f32 + 0.5) / n as f32);
            // Central differences err by (2 pi k / n)^2 / 6 = 0.04% here.
            assert!((x.values()[i] - expected).abs() < 0.01);
            assert!(y.values()[i].abs() < 1e-6);
        }
    }

    #[test]
    fn a_pit_is_darker_than_a_plain() {
        let n = 64;
        let pit = Plane::from_index(n, |i| {
            let (x, y) = ((i % n) as f32 - 32.0, (i / n) as f32 - 32.0);
            if x * x + y * y < 16.0 { 0.0 } else { 1.0 }
        });
        let open = occlude(&pit, 8.0);
        assert!(open.wrapped(32, 32) < 0.4, "{}", open.wrapped(32, 32));
        assert_eq!(open.wrapped(5, 5), 1.0);
    }

    #[test]
    fn flattening_removes_wide_waves_and_keeps_narrow_ones() {
        let n = 256;
        let contrast = |waves: f32| {
            let plane = Plane::from_index(n, |i| {
                0.4 + 0.1 * sin_turns(waves * ((i % n) as f32 + 0.5) / n as f32)
            });
            let flat = flattened(&plane, FLATTEN_ALBEDO * n as f32);
            let [low, high] = flat.quantiles(0.0, 1.0);
            (high - low) / 0.2
        };
        assert!(contrast(1.0) < 0.05, "{}", contrast(1.0));
        assert!(contrast(12.0) > 0.9, "{}", contrast(12.0));
    }

    #[test]
    fn roughness_only_widens() {
        assert!((widened(0.5, 0.0) - 0.5).abs() < 1e-6);
        assert!(widened(0.5, 0.1) > 0.55);
        assert!(widened(0.9, 100.0) <= 1.0);
    }

    #[test]
    fn normals_of_a_painted_wave_are_those_of_its_height_in_metres() {
        let (size, waves, relief) = (128_u16, 8.0_f32, 0.05);
        let surface = Surface::paint(2 * usize::from(size), |u, _| Texel {
            height: 40.0 * sin_turns(waves * u),
            albedo: [0.2; 3],
            roughness: 0.5,
        });
        let look = Look {
            mean_albedo: [0.2; 3],
            relief,
            flatten_height: 0.2,
            occlusion: 0.0,
        };
        let tile = finish(&surface, &look).to_tile();
        for x in 0..size {
            let u = (f32::from(x) + 0.5) / f32::from(size);
            let slope = 0.5 * relief * std::f32::consts::TAU * waves / TILE_METRES
                * crate::wave::cos_turns(waves * u);
            let expected = 0.5 - 0.5 * slope / (1.0 + slope * slope).sqrt();
            let [nx, ny, ..] = tile.normal_roughness[usize::from(x)].map(|b| f32::from(b) / 255.0);
            // Half a byte, and 2% of the slope (0.42) by the averages over
            // the texel.
            assert!(
                (nx - expected).abs() < 0.002 + 0.004,
                "{x}: {nx} {expected}"
            );
            assert!((ny - 0.5).abs() < 0.0021, "{ny}");
        }
    }
}
