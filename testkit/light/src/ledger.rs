//! What a frame is off by.

use glam::DVec3;

use crate::flip::{PIXELS_PER_DEGREE, hdr, ldr};
use crate::image::{Image, ImageError};

/// The error of a frame against its reference.
///
/// The relative error of a pixel is `max_c |test − reference| / max(max_c reference, floor)` over the channels `c`: of the
/// pixel's brightest channel, so that a colour of which one channel is nearly 0 does not count for more than it is seen.
/// A pixel that is no number counts as an infinite error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ledger {
    /// Relative error that half of the pixels stay at or below.
    pub p50: f64,
    /// That 999 of 1000 pixels do.
    pub p999: f64,
    /// The largest.
    pub max: f64,
    /// Pixels with more than the floor in the reference, and not half of it in the frame.
    pub missed: usize,
    /// Pixels with more than the floor in the reference.
    pub lit: usize,
    /// Pixels of the frame with a channel that is no number or infinite.
    pub not_finite: usize,
    /// Mean of LDR-FLIP, of the radiance cut to `0..=1`.
    pub ldr_flip_mean: f64,
    /// The largest.
    pub ldr_flip_max: f64,
    /// Mean of HDR-FLIP.
    pub hdr_flip_mean: f64,
    /// The largest.
    pub hdr_flip_max: f64,
}

impl Ledger {
    /// Compares. `floor` is the radiance below which a pixel is not lit, above 0: what a target of the frame cannot hold,
    /// or nobody can see.
    ///
    /// # Errors
    /// [`ImageError::Sizes`] for two sizes, [`ImageError::Empty`] without a pixel.
    pub fn new(test: &Image, reference: &Image, floor: f64) -> Result<Self, ImageError> {
        let (errors, counts) = relative_errors(test, reference, floor)?;
        let flip = ldr(test, reference, PIXELS_PER_DEGREE)?;
        let high = hdr(test, reference)?.flip;
        Ok(Self {
            p50: rank(&errors, 0.5),
            p999: rank(&errors, 0.999),
            max: rank(&errors, 1.0),
            ldr_flip_mean: flip.mean(),
            ldr_flip_max: flip.max(),
            hdr_flip_mean: high.mean(),
            hdr_flip_max: high.max(),
            ..counts
        })
    }
}

/// Sorted relative errors of the pixels, and a ledger with the counts.
fn relative_errors(
    test: &Image,
    reference: &Image,
    floor: f64,
) -> Result<(Vec<f64>, Ledger), ImageError> {
    test.same_size(reference)?;
    let (width, height) = (reference.width, reference.height);
    if reference.pixels.is_empty() {
        return Err(ImageError::Empty { width, height });
    }
    let (mut missed, mut lit, mut not_finite) = (0, 0, 0);
    let mut errors: Vec<f64> = Vec::with_capacity(test.pixels.len());
    for (a, b) in test.pixels.iter().zip(&reference.pixels) {
        let finite = a.is_finite();
        not_finite += usize::from(!finite);
        let bright = b.max_element();
        lit += usize::from(bright > floor);
        missed += usize::from(bright > floor && !(finite && 2.0 * a.max_element() >= bright));
        errors.push(if finite && b.is_finite() {
            (*a - *b).abs().max_element() / bright.max(floor)
        } else {
            f64::INFINITY
        });
    }
    errors.sort_by(f64::total_cmp);
    let counts = Ledger {
        p50: 0.0,
        p999: 0.0,
        max: 0.0,
        missed,
        lit,
        not_finite,
        ldr_flip_mean: 0.0,
        ldr_flip_max: 0.0,
        hdr_flip_mean: 0.0,
        hdr_flip_max: 0.0,
    };
    Ok((errors, counts))
}

/// The value that a share of the sorted ones stay at or below.
fn rank(sorted: &[f64], share: f64) -> f64 {
    let k = (share * sorted.len() as f64).ceil() as usize;
    sorted[k.saturating_sub(1).min(sorted.len() - 1)]
}

/// The parts that an error is made of, from images between the truth and a frame.
///
/// ```text
/// truth -> + occlusion -> + shadow -> + packing -> + arithmetic = frame
/// ```
///
/// Each image takes one more approximation than the one before it; its part is the difference of the two. The parts of
/// a pixel add up to its whole error exactly, whatever their order; the roots of their mean squares do not, where parts
/// cancel or add up.
#[derive(Debug, Clone, PartialEq)]
pub struct Parts {
    /// Names, and the root of the mean square of each part over pixels and channels, in units of radiance.
    pub parts: Vec<(String, f64)>,
    /// The same of the whole error.
    pub whole: f64,
    /// The same of what the parts of each pixel leave of its error: rounding.
    pub rest: f64,
}

impl Parts {
    /// `steps` are named images from the first approximation to the frame. Pixels where any of them is no number are left
    /// out; [`Ledger::not_finite`] counts them.
    ///
    /// # Errors
    /// [`ImageError::Sizes`] for two sizes.
    pub fn new(truth: &Image, steps: &[(&str, &Image)]) -> Result<Self, ImageError> {
        let mut good: Vec<bool> = truth.pixels.iter().map(|p| p.is_finite()).collect();
        for (_, image) in steps {
            image.same_size(truth)?;
            for (good, p) in good.iter_mut().zip(&image.pixels) {
                *good &= p.is_finite();
            }
        }
        let count = 3 * good.iter().filter(|g| **g).count().max(1);
        let rms = |values: &mut dyn Iterator<Item = DVec3>| {
            let squares: f64 = values
                .zip(&good)
                .filter(|(_, good)| **good)
                .map(|(d, _)| d.length_squared())
                .sum();
            (squares / count as f64).sqrt()
        };
        let mut before = truth;
        let mut sum = vec![DVec3::ZERO; truth.pixels.len()];
        let mut parts = Vec::new();
        for (name, image) in steps {
            let difference = |k: usize| image.pixels[k] - before.pixels[k];
            for (k, sum) in sum.iter_mut().enumerate() {
                *sum += difference(k);
            }
            let all = 0..truth.pixels.len();
            parts.push(((*name).to_owned(), rms(&mut all.map(difference))));
            before = image;
        }
        let all = || truth.pixels.iter().zip(&before.pixels);
        let whole = rms(&mut all().map(|(truth, frame)| *frame - *truth));
        let left = all()
            .zip(&sum)
            .map(|((truth, frame), sum)| *frame - *truth - *sum);
        Ok(Self {
            parts,
            whole,
            rest: rms(&mut { left }),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(pixels: &[f64]) -> Image {
        let pixels: Vec<DVec3> = pixels
            .iter()
            .map(|x| DVec3::new(*x, 0.5 * x, 0.0))
            .collect();
        Image::new(pixels.len() as u32, 1, pixels).unwrap()
    }

    #[test]
    fn a_perfect_frame_is_off_by_nothing() {
        let frame = image(&[1.0, 2.0, 0.0, 0.5]);
        let ledger = Ledger::new(&frame, &frame, 1e-6).unwrap();
        assert_eq!((ledger.p50, ledger.p999, ledger.max), (0.0, 0.0, 0.0));
        assert_eq!((ledger.missed, ledger.lit, ledger.not_finite), (0, 3, 0));
        assert_eq!((ledger.ldr_flip_max, ledger.hdr_flip_max), (0.0, 0.0));
    }

    #[test]
    fn each_kind_of_damage_is_seen() {
        let mut pixels = vec![1.0; 1000];
        let truth = image(&pixels);
        pixels[3] = 1.25;
        let off = Ledger::new(&image(&pixels), &truth, 1e-6).unwrap();
        assert_eq!(
            (off.p50, off.p999, off.max, off.missed),
            (0.0, 0.0, 0.25, 0)
        );
        assert!(off.ldr_flip_mean > 0.0 && off.hdr_flip_mean > 0.0);
        pixels[5] = 0.0;
        let dark = Ledger::new(&image(&pixels), &truth, 1e-6).unwrap();
        assert_eq!((dark.p999, dark.max, dark.missed), (0.25, 1.0, 1));
        pixels[7] = f64::NAN;
        let bad = Ledger::new(&image(&pixels), &truth, 1e-6).unwrap();
        assert_eq!((bad.not_finite, bad.missed), (1, 2));
        assert_eq!(
            (bad.p50, bad.max, bad.ldr_flip_max),
            (0.0, f64::INFINITY, 1.0)
        );
        assert!(Ledger::new(&image(&[1.0]), &truth, 1e-6).is_err());
    }

    #[test]
    fn light_where_there_is_none_counts_against_the_floor() {
        let ledger = Ledger::new(&image(&[1e-3, 1.0]), &image(&[0.0, 1.0]), 1e-2).unwrap();
        assert!((ledger.max - 0.1).abs() < 1e-15);
        assert_eq!((ledger.lit, ledger.missed), (1, 0));
    }

    #[test]
    fn parts_add_up_to_the_whole() {
        let truth = image(&[1.0, 2.0]);
        let packed = image(&[1.5, 2.0]);
        let frame = image(&[1.5, 1.0]);
        let ledger = Parts::new(&truth, &[("packing", &packed), ("arithmetic", &frame)]).unwrap();
        let rms = |squares: f64| (squares * 1.25 / 6.0_f64).sqrt();
        assert!((ledger.parts[0].1 - rms(0.25)).abs() < 1e-15);
        assert!((ledger.parts[1].1 - rms(1.0)).abs() < 1e-15);
        assert!((ledger.whole - rms(1.25)).abs() < 1e-15);
        assert_eq!(ledger.rest, 0.0);
        assert_eq!(ledger.parts[1].0, "arithmetic");
    }
}
