//! Where the legend of a picture lies: the functions of `shaders/src/inspector/legend.wgsl`, in Rust.

use bevy::math::{IVec2, UVec2};

/// Dots between the corner of the view and the box.
const MARGIN: i32 = 4;
/// The box of a ramp and of levels, dots.
const RAMP_BOX: IVec2 = IVec2::new(112, 21);
const LEVEL_BOX: IVec2 = IVec2::new(106, 32);
/// The ramp in its box, the swatch of what is beyond it, and a swatch of a level.
const RAMP_FIRST: IVec2 = IVec2::new(6, 3);
const RAMP_WIDTH: u32 = 64;
const MORE_FIRST: IVec2 = IVec2::new(82, 3);
const SWATCH: IVec2 = IVec2::new(13, 10);

/// Pixels a dot, along each side, in a view of this height.
#[must_use]
pub const fn dot_pixels(height: u32) -> u32 {
    if height < 480 { 1 } else { height / 240 }
}

/// The first pixel of a dot of a box, in a view of `size` pixels.
fn pixel(dot: IVec2, of: IVec2, size: UVec2) -> UVec2 {
    let scale = dot_pixels(size.y) as i32;
    let x = (MARGIN + dot.x) * scale;
    let y = size.y as i32 - (MARGIN + of.y - dot.y) * scale;
    IVec2::new(x, y).as_uvec2()
}

/// Pixel of the ramp, column `at` of 64; it shows a share of (`at` + ½) / 64.
#[must_use]
pub fn ramp_at(at: u32, size: UVec2) -> UVec2 {
    let column = at.min(RAMP_WIDTH - 1) as i32;
    pixel(RAMP_FIRST + IVec2::new(column, 0), RAMP_BOX, size)
}

/// Pixel of what is beyond the ramp.
#[must_use]
pub fn more_at(size: UVec2) -> UVec2 {
    pixel(MORE_FIRST, RAMP_BOX, size)
}

/// Pixel of the swatch of a level.
#[must_use]
pub fn level_at(level: u32, size: UVec2) -> UVec2 {
    let swatch = UVec2::new(level % 8, level / 8).as_ivec2() * SWATCH;
    pixel(IVec2::ONE + swatch, LEVEL_BOX, size)
}

/// Whether a legend may cover a pixel.
#[must_use]
pub fn may_cover(at: UVec2, size: UVec2) -> bool {
    let scale = dot_pixels(size.y);
    let most = RAMP_BOX.max(LEVEL_BOX).as_uvec2() + MARGIN as u32;
    at.x < most.x * scale && at.y + most.y * scale >= size.y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_legend_lies_in_the_lower_left_corner() {
        let size = UVec2::new(320, 160);
        assert_eq!(ramp_at(0, size), UVec2::new(10, 160 - 4 - 21 + 3));
        assert_eq!(level_at(0, size), UVec2::new(5, 160 - 4 - 32 + 1));
        assert_eq!(level_at(9, size), UVec2::new(18, 160 - 4 - 32 + 11));
        let large = UVec2::new(1280, 720);
        assert_eq!(ramp_at(1, large), UVec2::new(33, 720 - 3 * 22));
        for at in [ramp_at(63, size), more_at(size), level_at(23, size)] {
            assert!(may_cover(at, size), "{at}");
        }
        assert!(!may_cover(UVec2::new(160, 150), size));
        assert!(!may_cover(UVec2::new(5, 80), size));
    }
}
