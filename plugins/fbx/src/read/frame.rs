//! What of the world a camera takes in. ufbx works it out; not so for pixels that are no squares, which it
//! does not read, and for film that a lens squeezes, whose height it multiplies. FBX's own programs, Alembic
//! and Maya make what such a lens takes in wider.

use glam::DVec2;
use ufbx::{ApertureMode, AspectMode, Camera, GateFit};

/// Millimetres of an inch.
const INCH: f64 = 25.4;

/// The frame of a camera's picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    /// Width over height; 0 or no number where the file does not say.
    pub(super) aspect: f64,
    /// The vertical angle of a perspective, degrees.
    pub(super) vertical_degrees: f64,
    /// Width and height without a perspective, metres.
    pub(super) orthographic: [f64; 2],
}

impl Frame {
    pub(super) fn of(camera: &Camera) -> Self {
        let plain = Self {
            aspect: camera.aspect_ratio,
            vertical_degrees: camera.field_of_view_deg.y,
            orthographic: [camera.orthographic_size.x, camera.orthographic_size.y],
        };
        let (pixel, squeeze) = (pixel(camera), camera.squeeze_ratio);
        let is_squeezed = squeeze > 0.0 && squeeze.is_finite() && squeeze != 1.0;
        match pixel != 1.0 || is_squeezed {
            true => plain.widened(camera, pixel, if is_squeezed { squeeze } else { 1.0 }),
            false => plain,
        }
    }

    /// For pixels that are `pixel` times as wide as high, and film of which a lens makes `squeeze` times its
    /// width.
    fn widened(self, camera: &Camera, pixel: f64, squeeze: f64) -> Self {
        let aspect = self.aspect * pixel;
        let film = DVec2::new(
            camera.film_size_inch.x * squeeze,
            camera.film_size_inch.y / squeeze,
        );
        let is_wider = aspect > film.x / film.y;
        let fit = match camera.gate_fit {
            GateFit::Fill if is_wider => GateFit::Horizontal,
            GateFit::Overscan if !is_wider => GateFit::Horizontal,
            GateFit::Fill | GateFit::Overscan => GateFit::Vertical,
            fit => fit,
        };
        let extent = camera.orthographic_extent;
        let (height, orthographic) = match fit {
            GateFit::Horizontal => (film.x / aspect, [extent, extent / aspect]),
            GateFit::Vertical => (film.y, [extent * aspect, extent]),
            _ => (film.y, [extent, extent]),
        };
        let degrees = |tangent: f64| 2.0 * DVec2::new(1.0, tangent).to_angle().to_degrees();
        let vertical_degrees = match camera.aperture_mode {
            ApertureMode::Horizontal => degrees(camera.field_of_view_tan.x / aspect),
            ApertureMode::FocalLength => degrees(height * INCH / camera.focal_length_mm / 2.0),
            ApertureMode::Vertical | ApertureMode::HorizontalAndVertical => self.vertical_degrees,
        };
        Self {
            aspect,
            vertical_degrees,
            orthographic,
        }
    }
}

/// How much wider than high pixels are, where the file counts in pixels: else its ratio is the picture's.
fn pixel(camera: &Camera) -> f64 {
    let counts = matches!(
        camera.aspect_mode,
        AspectMode::FixedResolution | AspectMode::FixedWidth | AspectMode::FixedHeight
    );
    let prop = ufbx::find_prop(&camera.element.props, "PixelAspectRatio");
    let ratio = prop.map_or(1.0, |prop| prop.value_vec4.x);
    match counts && ratio > 0.0 && ratio.is_finite() {
        true => ratio,
        false => 1.0,
    }
}
