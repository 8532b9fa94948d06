//! Bloom in views of any shape.
//!
//! Bevy's bloom works in a texture of a fixed height, [`Bloom::max_mip_dimension`] (512), and as many times
//! as wide as the view is. From 32:1 on that is wider than the 16 384 pixels that most devices can hold in
//! a texture, the device refuses it, and the program ends. A lower texture fits, and bloom looks the same
//! to within its blur.

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

/// Height of the texture: Bevy's own where it fits, else the greatest power of two with which it is not
/// wider than `widest`.
fn highest(view: UVec2, widest: u32) -> u32 {
    let own = Bloom::NATURAL.max_mip_dimension;
    let fits = u64::from(widest) * u64::from(view.y.max(1)) / u64::from(view.x.max(1));
    let fits = u32::try_from(fits).unwrap_or(u32::MAX).max(1);
    own.min(1 << fits.ilog2())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_views_that_would_not_fit_are_changed() {
        for (view, widest, height) in [
            ((1920, 1080), 16_384, 512),
            ((1, 1), 16_384, 512),
            ((1, 4000), 16_384, 512),
            ((320, 10), 16_384, 512),
            ((320, 9), 16_384, 256),
            ((330, 10), 16_384, 256),
            ((16_384, 1), 16_384, 1),
            ((4096, 1), 4096, 1),
            // No view has these; what must not happen is a division by 0.
            ((0, 0), 16_384, 512),
        ] {
            let view = UVec2::from(view);
            assert_eq!(highest(view, widest), height, "{view}");
            assert!(height * view.x <= widest * view.y.max(1));
        }
    }
}
