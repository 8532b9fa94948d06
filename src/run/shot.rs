//! One picture, without a window.

use std::path::Path;

use bevy::math::ops;
use bevy::prelude::*;

use super::offscreen::{Offscreen, OffscreenError, STEP};
use super::{GameError, Setup};
use crate::input::PlayerInput;

/// Renders `setup` into a PNG of `size` pixels: settles, plays `frames` steps of a sixtieth of a
/// second, in which the figure walks `walk` radians to the left of where the camera looks, if it is to,
/// and takes the picture. Returns the name of the device that drew it.
///
/// The same setup on the same device gives the same picture.
///
/// # Errors
/// [`GameError`]: no device, a wrong size, a failed pipeline, a file that cannot be written.
pub fn shot(
    setup: Setup,
    size: UVec2,
    frames: u32,
    walk: Option<f32>,
    file: &Path,
) -> Result<String, GameError> {
    let mut offscreen = Offscreen::new(setup, size)?;
    offscreen.settle()?;
    if let Some(walk) = walk {
        let (sin, cos) = ops::sin_cos(walk);
        offscreen.app.world_mut().resource_mut::<PlayerInput>().walk = Vec2::new(-sin, cos);
    }
    for _ in 0..frames {
        offscreen.step(STEP)?;
    }
    // The steps may have moved what the ground's detail follows.
    offscreen.settle()?;
    let picture = offscreen.capture()?;
    picture
        .save_with_format(file, image::ImageFormat::Png)
        .map_err(|source| OffscreenError::Write {
            path: file.to_owned(),
            source,
        })?;
    Ok(offscreen.device.name)
}
