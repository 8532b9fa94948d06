//! Bloom in views of any size and shape.
//!
//! Bevy's bloom works in a texture of a fixed height, [`Bloom::max_mip_dimension`] (512), and as many times
//! as wide as the view is: about half of a picture of 1080 rows, but twice as many pixels as a picture of 360 rows has.
//! So a view gets no more than half its rows: bloom of a small picture looks as that of a large one does, for an eighth
//! of its pixels there.
//!
//! From 32:1 on the texture would be wider than the 16 384 pixels that most devices can hold, the device
//! refuses it, and the program ends. A lower texture fits, and bloom looks the same to within its blur.

use bevy::camera::CameraUpdateSystems;
use bevy::post_process::bloom::Bloom;
use bevy::prelude::*;
use bevy::render::renderer::RenderDevice;

/// Keeps the bloom of every camera within the device's textures.
pub struct BloomFitPlugin;

impl Plugin for BloomFitPlugin {
    fn build(&self, app: &mut App) {
        // The size of the view is brought up to date there, in the frame in which it changes.
        app.add_systems(PostUpdate, fit.after(CameraUpdateSystems));
    }
}

/// Rows of the texture at least, where it fits: Bevy makes three levels of these, and of fewer than 8 rows one, whose share
/// is not a number then.
const LEAST: u32 = 16;

fn fit(device: Option<Res<RenderDevice>>, mut views: Query<(&Camera, &mut Bloom)>) {
    let Some(device) = device else { return };
    let widest = device.limits().max_texture_dimension_2d;
    for (camera, mut bloom) in &mut views {
        let Some(size) = camera.physical_viewport_size() else {
            continue;
        };
        let height = highest(size, widest);
        if bloom.max_mip_dimension != height {
            bloom.max_mip_dimension = height;
        }
    }
}

/// Height of the texture: half of the view's, Bevy's own at most; less where it would not fit, the greatest power of two
/// with which it is not wider than `widest`.
fn highest(view: UVec2, widest: u32) -> u32 {
    let half = view.y.div_ceil(2).max(LEAST);
    let own = Bloom::NATURAL.max_mip_dimension.min(half);
    let fits = u64::from(widest) * u64::from(view.y.max(1)) / u64::from(view.x.max(1));
    let fits = u32::try_from(fits).unwrap_or(u32::MAX).max(1);
    own.min(1 << fits.ilog2())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_a_view_that_fits() {
        for (view, widest, height) in [
            ((1920, 1080), 16_384, 512),
            ((1280, 720), 16_384, 360),
            ((640, 360), 16_384, 180),
            ((160, 90), 16_384, 45),
            ((1, 1), 16_384, LEAST),
            ((1, 4000), 16_384, 512),
            ((320, 9), 16_384, LEAST),
            ((16_384, 400), 16_384, 200),
            ((16_384, 9), 16_384, 8),
            ((16_384, 1), 16_384, 1),
            ((16_384, 2), 16_384, 2),
            ((4096, 1), 4096, 1),
            // No view has these; what must not happen is a division by 0.
            ((0, 0), 16_384, LEAST),
        ] {
            let view = UVec2::from(view);
            assert_eq!(highest(view, widest), height, "{view}");
            assert!(height * view.x <= widest * view.y.max(1));
        }
    }
}
