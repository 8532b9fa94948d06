//! An image of linear radiance.

use glam::DVec3;

/// What each pixel receives, linear, row by row from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width · height` values.
    pub pixels: Vec<DVec3>,
}

/// Why something is no image, or two images cannot be compared.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ImageError {
    /// The number of values is not that of the pixels.
    #[error("{values} values for {width}x{height} pixels")]
    Values {
        /// How many there are.
        values: usize,
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// There is no pixel.
    #[error("an image of {width}x{height} pixels holds nothing")]
    Empty {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// Two images of one frame have different sizes.
    #[error("the test image has {test:?} pixels, the reference {reference:?}")]
    Sizes {
        /// Width and height of what is tested.
        test: [u32; 2],
        /// Width and height of the reference.
        reference: [u32; 2],
    },
}

impl Image {
    /// An image of given values.
    ///
    /// # Errors
    /// [`ImageError::Empty`] without pixels, [`ImageError::Values`] if there are too few or too many values.
    pub fn new(width: u32, height: u32, pixels: Vec<DVec3>) -> Result<Self, ImageError> {
        if width == 0 || height == 0 {
            return Err(ImageError::Empty { width, height });
        }
        if pixels.len() as u64 != u64::from(width) * u64::from(height) {
            return Err(ImageError::Values {
                values: pixels.len(),
                width,
                height,
            });
        }
        Ok(Self {
            width,
            height,
            pixels,
        })
    }

    /// Four f32 a pixel, as a target of that format is read back; the fourth is left out.
    ///
    /// # Errors
    /// As [`Image::new`].
    pub fn from_rgba(width: u32, height: u32, rgba: &[[f32; 4]]) -> Result<Self, ImageError> {
        let pixels = rgba.iter().map(|p| {
            let [r, g, b, _] = p.map(f64::from);
            DVec3::new(r, g, b)
        });
        Self::new(width, height, pixels.collect())
    }

    /// The pixel in column `x`, row `y`.
    pub fn at(&self, x: u32, y: u32) -> DVec3 {
        self.pixels[(y * self.width + x) as usize]
    }

    /// Whether `other` has the same size.
    ///
    /// # Errors
    /// [`ImageError::Sizes`] if not.
    pub fn same_size(&self, reference: &Self) -> Result<(), ImageError> {
        let (test, reference) = (
            [self.width, self.height],
            [reference.width, reference.height],
        );
        if test == reference {
            Ok(())
        } else {
            Err(ImageError::Sizes { test, reference })
        }
    }

    /// 8-bit sRGB (IEC 61966-2-1) of the radiance times `exposure`, cut to `0..=1`; what is no number is 0.
    pub fn to_srgb8(&self, exposure: f64) -> Vec<[u8; 3]> {
        let encode = |x: f64| {
            let x = (x * exposure).clamp(0.0, 1.0);
            let s = if x <= 0.003_130_8 {
                12.92 * x
            } else {
                1.055 * x.powf(1.0 / 2.4) - 0.055
            };
            (255.0 * s).round() as u8
        };
        self.pixels
            .iter()
            .map(|p| [encode(p.x), encode(p.y), encode(p.z)])
            .collect()
    }
}
