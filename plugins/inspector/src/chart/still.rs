//! The picture at a value of a setting, and how far it is from that at the first one.

use std::sync::{Arc, Mutex};

use bevy::camera::RenderTarget;
use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::time::Virtual;

/// Frames within which a picture comes back from the device.
const PATIENCE: u32 = 600;

/// A picture that was asked for.
pub(super) struct Still {
    slot: Arc<Mutex<Option<Image>>>,
    left: u32,
}

/// Takes pictures of what a 3D camera draws, while virtual time stands still.
#[derive(Default)]
pub(super) struct Pictures {
    target: Option<RenderTarget>,
    paused: bool,
    first: Option<Vec<u8>>,
}

impl Pictures {
    /// Of the first active 3D camera, where pictures are wanted.
    ///
    /// # Errors
    /// Why none can be taken.
    pub fn new(world: &mut World, wanted: bool) -> Result<Self, String> {
        if !wanted {
            return Ok(Self::default());
        }
        if !world.contains_resource::<crate::picture::PictureRenders>() {
            return Err("this app has no renderer".to_owned());
        }
        let mut cameras = world.query_filtered::<(&Camera, &RenderTarget), With<Camera3d>>();
        let found = cameras.iter(world).find(|(camera, _)| camera.is_active);
        let Some((_, target)) = found else {
            return Err("there is no active 3D camera".to_owned());
        };
        let target = Some(target.clone());
        let mut paused = false;
        if let Some(mut time) = world.get_resource_mut::<Time<Virtual>>()
            && !time.is_paused()
        {
            time.pause();
            paused = true;
        }
        Ok(Self {
            target,
            paused,
            first: None,
        })
    }

    /// Lets time go on, where it did.
    pub fn end(&mut self, world: &mut World) {
        veil(world, false);
        if std::mem::take(&mut self.paused)
            && let Some(mut time) = world.get_resource_mut::<Time<Virtual>>()
        {
            time.unpause();
        }
    }

    /// Asks for the picture of the next frame.
    pub fn ask(&self, world: &mut World) -> Still {
        veil(world, true);
        let slot = Arc::new(Mutex::new(None));
        if let Some(target) = &self.target {
            let answer = Arc::clone(&slot);
            world.spawn(Screenshot(target.clone())).observe(
                move |captured: On<ScreenshotCaptured>| {
                    if let Ok(mut slot) = answer.lock() {
                        *slot = Some(captured.image.clone());
                    }
                },
            );
        }
        Still {
            slot,
            left: PATIENCE,
        }
    }

    /// How far the picture is from the first one, 0 to 1; `None` while it is not there.
    ///
    /// # Errors
    /// It does not come, or is not of the first one's size.
    pub fn take(&mut self, world: &mut World, still: &mut Still) -> Result<Option<f64>, String> {
        let image = still.slot.lock().ok().and_then(|mut slot| slot.take());
        let Some(image) = image else {
            still.left -= 1;
            return match still.left {
                0 => Err("none came back from the device".to_owned()),
                _ => Ok(None),
            };
        };
        veil(world, false);
        let picture = image
            .try_into_dynamic()
            .map_err(|error| error.to_string())?;
        let now = picture.into_rgb8().into_raw();
        let first = self.first.get_or_insert_with(|| now.clone());
        match difference(first, &now) {
            Some(error) => Ok(Some(error)),
            None => Err("the picture's size has changed".to_owned()),
        }
    }
}

/// The root of the mean square difference of channels, of 1; `None` where there are not as many.
fn difference(a: &[u8], b: &[u8]) -> Option<f64> {
    if a.len() != b.len() || a.is_empty() {
        return None;
    }
    let squares = a.iter().zip(b).map(|(a, b)| {
        let off = u64::from(a.abs_diff(*b));
        off * off
    });
    let mean = squares.sum::<u64>() as f64 / a.len() as f64;
    Some(mean.sqrt() / 255.0)
}

/// Keeps the inspector from being drawn, or draws it again.
#[cfg(feature = "panel")]
fn veil(world: &mut World, hidden: bool) {
    let mut cameras = world.query_filtered::<&mut Camera, With<crate::panel::InspectorCamera>>();
    for mut camera in cameras.iter_mut(world) {
        camera.is_active = !hidden;
    }
}

#[cfg(not(feature = "panel"))]
const fn veil(_: &mut World, _: bool) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_is_the_root_of_the_mean_square() {
        assert_eq!(difference(&[1, 2, 3], &[1, 2, 3]), Some(0.0));
        assert_eq!(difference(&[0, 0], &[255, 255]), Some(1.0));
        let off = difference(&[0, 0, 0, 0], &[0, 0, 0, 51]).unwrap();
        assert!((off - 0.1).abs() < 1e-12, "{off}");
        assert_eq!(difference(&[0], &[0, 0]), None);
        assert_eq!(difference(&[], &[]), None);
    }
}
