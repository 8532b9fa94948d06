//! HDR-FLIP: at each pixel the largest LDR-FLIP over exposures from one at which the brightest pixel of the reference is
//! not yet cut, to one at which its median is bright.

use glam::DVec3;

use super::PIXELS_PER_DEGREE;
use super::ldr::{Flip, ldr};
use crate::image::{Image, ImageError};

/// A curve from `0..` to `0..1`: `(c₀ x² + c₁ x + c₂) / (c₃ x² + c₄ x + c₅)`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ToneMap {
    /// Narkowicz's fit of ACES (2015) after an exposure of 0.6, a channel at a time.
    #[default]
    Aces,
    /// Reinhard's of the luminance (2002): `x / (1 + x)`; the colour is kept.
    Reinhard,
}

/// The exposures that HDR-FLIP looks at, in stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exposures {
    /// The first.
    pub start: f64,
    /// The last.
    pub stop: f64,
    /// How many, evenly spaced, both ends among them.
    pub count: u32,
}

/// HDR-FLIP of two images.
#[derive(Debug, Clone, PartialEq)]
pub struct HdrFlip {
    /// The largest error of each pixel.
    pub flip: Flip,
    /// What was looked at.
    pub exposures: Exposures,
}

impl ToneMap {
    fn coefficients(self) -> [f64; 6] {
        match self {
            Self::Aces => {
                let e = 0.6;
                [2.51 * e * e, 0.03 * e, 0.0, 2.43 * e * e, 0.59 * e, 0.14]
            }
            Self::Reinhard => [0.0, 1.0, 0.0, 0.0, 1.0, 1.0],
        }
    }

    fn curve(self, x: f64) -> f64 {
        let [a, b, c, d, e, f] = self.coefficients();
        ((a * x + b) * x + c) / ((d * x + e) * x + f)
    }

    /// Where the curve is 0.85.
    fn bright(self) -> f64 {
        let k = self.coefficients();
        let [a, b, c] = [0, 1, 2].map(|i| k[i] - 0.85 * k[i + 3]);
        if a == 0.0 {
            return -c / b;
        }
        let half = -0.5 * b / a;
        half + (half * half - c / a).sqrt()
    }

    fn apply(self, rgb: DVec3) -> DVec3 {
        let rgb = rgb.max(DVec3::ZERO);
        let mapped = match self {
            Self::Aces => DVec3::new(self.curve(rgb.x), self.curve(rgb.y), self.curve(rgb.z)),
            Self::Reinhard => rgb / (1.0 + luminance(rgb)),
        };
        mapped.clamp(DVec3::ZERO, DVec3::ONE)
    }
}

/// Of Rec. 709.
fn luminance(rgb: DVec3) -> f64 {
    rgb.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

/// The exposures for a reference: `log₂(x₈₅ / Y_max)` to `log₂(x₈₅ / Y_median)`, where the curve is 0.85 at `x₈₅`, about one
/// a stop and at least two. Where the median is 0, as in an image that is black for the most part, it is that of the
/// pixels that are not; an image without light has the exposure 0.
pub fn exposures(reference: &Image, curve: ToneMap) -> Exposures {
    let light = |p: &DVec3| luminance(*p);
    let mut all: Vec<f64> = reference.pixels.iter().map(light).collect();
    all.retain(|y| y.is_finite());
    // Of an even number the upper of the two, as the reference implementation has it.
    let median = |sorted: &[f64]| sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    all.sort_by(f64::total_cmp);
    let mut middle = median(&all);
    if middle <= 0.0 {
        all.retain(|y| *y > 0.0);
        middle = median(&all);
    }
    let most = all.last().copied().unwrap_or(0.0);
    if most <= 0.0 || middle <= 0.0 {
        return Exposures {
            start: 0.0,
            stop: 0.0,
            count: 1,
        };
    }
    let bright = curve.bright();
    let (start, stop) = ((bright / most).log2(), (bright / middle).log2());
    Exposures {
        start,
        stop,
        count: (stop - start).ceil().max(2.0) as u32,
    }
}

/// HDR-FLIP with the curve of ACES, the exposures of the reference, and [`PIXELS_PER_DEGREE`].
///
/// # Errors
/// [`ImageError::Sizes`] if the images have different sizes.
pub fn hdr(test: &Image, reference: &Image) -> Result<HdrFlip, ImageError> {
    let curve = ToneMap::Aces;
    let exposures = exposures(reference, curve);
    hdr_with(test, reference, curve, exposures, PIXELS_PER_DEGREE)
}

/// HDR-FLIP with these settings.
///
/// # Errors
/// [`ImageError::Sizes`] if the images have different sizes.
pub fn hdr_with(
    test: &Image,
    reference: &Image,
    curve: ToneMap,
    exposures: Exposures,
    pixels_per_degree: f64,
) -> Result<HdrFlip, ImageError> {
    test.same_size(reference)?;
    let mut errors = vec![0.0_f64; reference.pixels.len()];
    for k in 0..exposures.count {
        let share = f64::from(k) / f64::from(exposures.count.max(2) - 1);
        let stop = exposures.start + share * (exposures.stop - exposures.start);
        let mapped = |image: &Image| Image {
            pixels: image
                .pixels
                .iter()
                // What is no number stays so, to be counted.
                .map(|p| if p.is_finite() { curve.apply(stop.exp2() * *p) } else { *p })
                .collect(),
            ..*image
        };
        let flip = ldr(&mapped(test), &mapped(reference), pixels_per_degree)?;
        for (error, new) in errors.iter_mut().zip(flip.errors) {
            *error = error.max(new);
        }
    }
    Ok(HdrFlip {
        flip: Flip { errors },
        exposures,
    })
}
