//! How far apart two pictures are: plain differences of the samples, and FLIP.
//!
//! FLIP (Andersson, Nilsson, Akenine-Möller et al., "FLIP: A Difference Evaluator for Alternating
//! Images", HPG 2020) gives each pixel an error in `0..=1` for what a person sees who flips between
//! the pictures, at 67 pixels to a degree of the field of view: 0 is the same, 1 is black against
//! white. It forgives noise of one level and sub-pixel differences in fine texture, and sees what is
//! moved, missing, or of another colour.
//!
//! Samples are 8-bit sRGB, as they lie in the PNG files; FLIP turns them into linear light itself.

use image::RgbImage;

/// How far a picture is from its reference. Everything is 0 for equal pictures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Largest difference of two samples, in levels, `0..=255`.
    pub max_abs: u8,
    /// Root of the mean square difference over all samples of all three channels, in levels.
    pub rmse: f64,
    /// Mean of the FLIP error over the pixels, `0..=1`.
    pub flip_mean: f64,
    /// The FLIP error that 99 % of the pixels stay at or below, `0..=1`. It sees a small part of the
    /// picture that is badly wrong, which the mean would hide.
    pub flip_p99: f64,
}

/// What a [`Difference`] may be at most, in the same units.
#[derive(Debug, Clone, Copy)]
pub struct Limit {
    /// See [`Difference::rmse`].
    pub rmse: f64,
    /// See [`Difference::flip_mean`].
    pub flip_mean: f64,
    /// See [`Difference::flip_p99`].
    pub flip_p99: f64,
}

/// Compares `test` with `reference`.
///
/// # Errors
/// In words, when the sizes differ or a side is 0: such pictures have no difference in numbers.
pub fn compare(test: &RgbImage, reference: &RgbImage) -> Result<Difference, String> {
    let (width, height) = reference.dimensions();
    if test.dimensions() != (width, height) {
        let (w, h) = test.dimensions();
        return Err(format!(
            "the picture is {w}x{h}, its reference {width}x{height}"
        ));
    }
    if width == 0 || height == 0 {
        return Err(format!(
            "there is nothing to compare in {width}x{height} pixels"
        ));
    }
    let mut max_abs = 0;
    let mut squares = 0.0;
    for (a, b) in test.as_raw().iter().zip(reference.as_raw()) {
        let levels = a.abs_diff(*b);
        max_abs = max_abs.max(levels);
        squares += f64::from(levels) * f64::from(levels);
    }
    let mut errors = flip_errors(test, reference);
    let mean = errors.iter().map(|e| f64::from(*e)).sum::<f64>() / errors.len() as f64;
    errors.sort_by(f32::total_cmp);
    let rank = (errors.len() * 99).div_ceil(100) - 1;
    Ok(Difference {
        max_abs,
        rmse: (squares / test.as_raw().len() as f64).sqrt(),
        flip_mean: mean,
        flip_p99: f64::from(errors[rank]),
    })
}

/// FLIP error of each pixel, row by row from the top left. Both pictures have the same size.
fn flip_errors(test: &RgbImage, reference: &RgbImage) -> Vec<f32> {
    let flip_image =
        |i: &RgbImage| nv_flip::FlipImageRgb8::with_data(i.width(), i.height(), i.as_raw());
    let degree = nv_flip::DEFAULT_PIXELS_PER_DEGREE;
    nv_flip::flip(flip_image(reference), flip_image(test), degree).to_vec()
}

/// The FLIP error as a picture, 0 black to 1 white, to look at when a comparison failed.
pub fn error_picture(test: &RgbImage, reference: &RgbImage) -> RgbImage {
    let errors = flip_errors(test, reference);
    RgbImage::from_fn(reference.width(), reference.height(), |x, y| {
        let error = errors[(y * reference.width() + x) as usize];
        image::Rgb([(error * 255.0).round() as u8; 3])
    })
}

impl Difference {
    /// Whether nothing is beyond `limit`.
    ///
    /// # Errors
    /// In words: every number that is beyond it, with its limit. A number that is not one (NaN) is.
    pub fn within(&self, limit: &Limit) -> Result<(), String> {
        let beyond: Vec<String> = [
            ("rmse in levels", self.rmse, limit.rmse),
            ("FLIP mean", self.flip_mean, limit.flip_mean),
            ("FLIP p99", self.flip_p99, limit.flip_p99),
        ]
        .iter()
        .filter(|(_, is, may_be)| is.is_nan() || is > may_be)
        .map(|(name, is, may_be)| format!("{name} is {is:.4}, the limit {may_be}"))
        .collect();
        if beyond.is_empty() {
            Ok(())
        } else {
            Err(beyond.join("; "))
        }
    }
}

/// `picture`, `pixels` further to the right; the left border is repeated.
pub fn shifted(picture: &RgbImage, pixels: u32) -> RgbImage {
    RgbImage::from_fn(picture.width(), picture.height(), |x, y| {
        *picture.get_pixel(x.saturating_sub(pixels), y)
    })
}

/// `picture` with every sample multiplied by `factor` (`0..=1`) and rounded.
pub fn darker(picture: &RgbImage, factor: f32) -> RgbImage {
    let mut out = picture.clone();
    for sample in out.iter_mut() {
        *sample = (f32::from(*sample) * factor).round() as u8;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stripes and a ramp: something in every frequency, far from both ends of the range.
    fn pattern(width: u32, height: u32) -> RgbImage {
        RgbImage::from_fn(width, height, |x, y| {
            let stripe = if (x / 12 + y / 20) % 2 == 0 { 60 } else { 0 };
            let ramp = (y * 80 / height) as u8;
            image::Rgb([80 + stripe, 60 + ramp, 100 + stripe / 2])
        })
    }

    #[test]
    fn equal_pictures_differ_by_nothing() {
        let picture = pattern(96, 64);
        let none = Difference {
            max_abs: 0,
            rmse: 0.0,
            flip_mean: 0.0,
            flip_p99: 0.0,
        };
        assert_eq!(compare(&picture, &picture), Ok(none));
    }

    #[test]
    fn one_changed_sample_is_counted_exactly() {
        let picture = pattern(50, 40);
        let mut changed = picture.clone();
        changed.get_pixel_mut(7, 9).0[1] += 30;
        let difference = compare(&changed, &picture).unwrap();
        assert_eq!(difference.max_abs, 30);
        // One sample of 50 * 40 * 3 is off by 30 levels.
        assert_eq!(difference.rmse, (900.0_f64 / 6000.0).sqrt());
        assert!(difference.flip_mean > 0.0);
    }

    #[test]
    fn black_against_white_is_the_largest_difference() {
        let black = RgbImage::new(64, 64);
        let white = RgbImage::from_pixel(64, 64, image::Rgb([255; 3]));
        let difference = compare(&black, &white).unwrap();
        assert_eq!((difference.max_abs, difference.rmse), (255, 255.0));
        // FLIP sets its scale so that the largest colour difference, of green and blue, is 1; black
        // and white come close to it.
        assert!(
            difference.flip_mean > 0.95 && difference.flip_mean <= 1.0,
            "{difference:?}"
        );
    }

    #[test]
    fn more_damage_is_a_larger_difference() {
        let picture = pattern(120, 80);
        let mean = |factor| {
            compare(&darker(&picture, factor), &picture)
                .unwrap()
                .flip_mean
        };
        let (slight, plain, strong) = (mean(0.97), mean(0.9), mean(0.7));
        assert!(
            0.0 < slight && slight < plain && plain < strong,
            "{slight} {plain} {strong}"
        );
        let moved = |pixels| {
            compare(&shifted(&picture, pixels), &picture)
                .unwrap()
                .flip_mean
        };
        assert!(
            0.0 < moved(1) && moved(1) < moved(6),
            "{} {}",
            moved(1),
            moved(6)
        );
    }

    #[test]
    fn a_small_wrong_part_shows_in_the_percentile() {
        let picture = pattern(100, 100);
        let mut spoiled = picture.clone();
        // 4 % of the pixels.
        for (x, y) in (0..20).flat_map(|x| (0..20).map(move |y| (x, y))) {
            spoiled.put_pixel(40 + x, 40 + y, image::Rgb([255, 0, 255]));
        }
        let difference = compare(&spoiled, &picture).unwrap();
        assert!(difference.flip_p99 > 0.5, "{difference:?}");
        assert!(difference.flip_mean < 0.1, "{difference:?}");
    }

    #[test]
    fn sizes_that_do_not_fit_are_refused() {
        let refusal = compare(&pattern(30, 20), &pattern(20, 30)).unwrap_err();
        assert!(
            refusal.contains("30x20") && refusal.contains("20x30"),
            "{refusal}"
        );
        assert!(compare(&RgbImage::new(0, 4), &RgbImage::new(0, 4)).is_err());
    }

    #[test]
    fn each_number_is_held_to_its_own_limit() {
        let limit = Limit {
            rmse: 2.0,
            flip_mean: 0.02,
            flip_p99: 0.2,
        };
        let good = Difference {
            max_abs: 255,
            rmse: 2.0,
            flip_mean: 0.02,
            flip_p99: 0.2,
        };
        assert_eq!(good.within(&limit), Ok(()));
        for bad in [
            Difference { rmse: 2.1, ..good },
            Difference {
                flip_mean: 0.021,
                ..good
            },
            Difference {
                flip_p99: 0.21,
                ..good
            },
            Difference {
                flip_mean: f64::NAN,
                ..good
            },
        ] {
            assert!(bad.within(&limit).is_err(), "{bad:?}");
        }
    }
}
