//! LDR-FLIP.

use glam::DVec3;

use super::colour::{Spaces, hyab};
use super::filter::{Planes, contrast, features};
use crate::image::{Image, ImageError};
use crate::rows::in_parallel;

/// The exponent of the difference of colours.
const QC: f64 = 0.7;
/// Which share of the largest difference of colours is mapped to [`PT`].
const PC: f64 = 0.4;
/// Where that share is mapped to.
const PT: f64 = 0.95;
/// The exponent of the difference of features.
const QF: f64 = 0.5;

/// The error of each pixel, `0..=1`: 0 is the same, 1 is black against white.
#[derive(Debug, Clone, PartialEq)]
pub struct Flip {
    /// Row by row from the top left.
    pub errors: Vec<f64>,
}

impl Flip {
    /// Mean over the pixels.
    pub fn mean(&self) -> f64 {
        self.errors.iter().sum::<f64>() / self.errors.len() as f64
    }

    /// The largest.
    pub fn max(&self) -> f64 {
        self.errors.iter().copied().fold(0.0, f64::max)
    }
}

/// LDR-FLIP of two images of linear light, which is cut to `0..=1`.
///
/// # Errors
/// [`ImageError::Sizes`] if they have different sizes.
pub fn ldr(test: &Image, reference: &Image, pixels_per_degree: f64) -> Result<Flip, ImageError> {
    test.same_size(reference)?;
    let spaces = Spaces::new();
    let seen = |image: &Image| Seen::new(image, &spaces, pixels_per_degree);
    let (a, b) = (seen(test), seen(reference));
    let lab = |rgb: DVec3| spaces.hunt_lab(rgb);
    // The largest difference of colours is that of green and blue.
    let largest = hyab(lab(DVec3::Y), lab(DVec3::Z)).powf(QC);
    let error = |k: usize| {
        if !(test.pixels[k].is_finite() && reference.pixels[k].is_finite()) {
            return 1.0;
        }
        let colour = hyab(a.colours[k], b.colours[k]).powf(QC);
        let most = PC * largest;
        let colour = if colour < most {
            colour * PT / most
        } else {
            PT + (colour - most) / (largest - most) * (1.0 - PT)
        };
        let [edge, point] = [0, 1].map(|f| (a.features[k][f] - b.features[k][f]).abs());
        let feature = (edge.max(point) / 2.0_f64.sqrt()).powf(QF);
        colour.powf(1.0 - feature)
    };
    let (w, h) = (reference.width, reference.height);
    let errors = in_parallel(h, |y| {
        (0..w)
            .map(|x| error(y as usize * w as usize + x as usize))
            .collect()
    });
    Ok(Flip { errors })
}

/// An image as it is seen.
struct Seen {
    /// Lightness and two colours, after the contrast sensitivity of the eye.
    colours: Vec<DVec3>,
    /// How much of an edge and of a point there is.
    features: Vec<[f64; 2]>,
}

impl Seen {
    fn new(image: &Image, spaces: &Spaces, pixels_per_degree: f64) -> Self {
        let (width, height) = (image.width as usize, image.height as usize);
        let opponent: Vec<DVec3> = image
            .pixels
            .iter()
            .map(|p| {
                let good = if p.is_finite() { *p } else { DVec3::ZERO };
                spaces.opponent(good.clamp(DVec3::ZERO, DVec3::ONE))
            })
            .collect();
        let colours = Planes {
            width,
            height,
            values: opponent.iter().map(|p| [p.x, p.y, p.z, p.z]).collect(),
        };
        let kernels = contrast(pixels_per_degree);
        let colours = colours.filtered(&kernels, &kernels);
        let colour = |[y, cx, cz1, cz2]: &[f64; 4]| {
            let rgb = spaces.linear_of(DVec3::new(*y, *cx, cz1 + cz2));
            spaces.hunt_lab(rgb.clamp(DVec3::ZERO, DVec3::ONE))
        };
        // Lightness of 0 to 1, along x and y by the Gaussian and by each derivative.
        let lightness = Planes {
            width,
            height,
            values: opponent.iter().map(|p| [(p.x + 16.0) / 116.0; 4]).collect(),
        };
        let [g, d, dd] = features(pixels_per_degree);
        let along_x = [d.clone(), g.clone(), dd.clone(), g.clone()];
        let along_y = [g.clone(), d, g, dd];
        let lengths = |[dx, dy, ddx, ddy]: &[f64; 4]| [dx.hypot(*dy), ddx.hypot(*ddy)];
        Self {
            colours: colours.values.iter().map(colour).collect(),
            features: lightness
                .filtered(&along_x, &along_y)
                .values
                .iter()
                .map(lengths)
                .collect(),
        }
    }
}
