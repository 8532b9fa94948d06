//! A depth pyramid: what lies behind what is drawn, told from few texels.
//!
//! The functions of `shaders/src/deferred/pyramid.wgsl`, in Rust. Depth is reversed, 0 at infinity; a texel is the
//! least, that is the farthest, of the 2 × 2 below it. Sizes are rounded *up*, so that each pixel lies below one
//! texel of every level at any size: a pyramid that is rounded down, as to powers of two, loses the last rows and
//! hides what can be seen through them.
//!
//! A box is hidden if its nearest corner is farther than the farthest pixel of the rectangle that it covers. That is
//! never wrong, since the rectangle and the corner are rounded towards being seen.

use bevy::math::{Mat4, UVec2, Vec2, Vec3};

/// The levels of a view.
#[derive(Clone, Debug, PartialEq)]
pub struct Pyramid {
    size: UVec2,
    texels: Vec<f32>,
}

/// A level in the array of all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level {
    /// Its texels.
    pub size: UVec2,
    /// Of its first texel.
    pub first: u32,
}

/// What a box covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// The first pixel.
    pub low: UVec2,
    /// The last one.
    pub high: UVec2,
    /// Depth of what of it is nearest.
    pub nearest: f32,
    /// It reaches before the near plane, and is seen.
    pub cut: bool,
}

const fn half(size: UVec2) -> UVec2 {
    UVec2::new(size.x.div_ceil(2), size.y.div_ceil(2))
}

/// Level `index`, from 1 on, of a view of `size` pixels.
#[must_use]
pub fn level(size: UVec2, index: u32) -> Level {
    let mut level = Level {
        size: half(size),
        first: 0,
    };
    for _ in 1..index {
        level.first += level.size.x * level.size.y;
        level.size = half(level.size);
    }
    level
}

/// How many levels there are above the view itself; the last one has one texel.
#[must_use]
pub fn levels(size: UVec2) -> u32 {
    (32 - (size.max_element().max(1) - 1).leading_zeros()).max(1)
}

/// Texels of all levels.
#[must_use]
pub fn texels(size: UVec2) -> u32 {
    let last = level(size, levels(size));
    last.first + last.size.x * last.size.y
}

impl Pyramid {
    /// Of depths, row by row; `None` unless there are as many as the size says, and at least one.
    #[must_use]
    pub fn new(depths: &[f32], size: UVec2) -> Option<Self> {
        if size.min_element() == 0 || depths.len() as u64 != u64::from(size.x) * u64::from(size.y) {
            return None;
        }
        let mut texels = Vec::with_capacity(self::texels(size) as usize);
        let mut below = (depths.to_vec(), size);
        for _ in 0..levels(size) {
            let next = half(below.1);
            let row = |y: u32| y.min(below.1.y - 1) * below.1.x;
            let mut made = Vec::with_capacity((next.x * next.y) as usize);
            for y in 0..next.y {
                for x in 0..next.x {
                    let x2 = (2 * x + 1).min(below.1.x - 1);
                    let at = [
                        row(2 * y) + 2 * x,
                        row(2 * y) + x2,
                        row(2 * y + 1) + 2 * x,
                        row(2 * y + 1) + x2,
                    ];
                    let least = at.into_iter().map(|at| below.0[at as usize]);
                    made.push(least.fold(f32::MAX, f32::min));
                }
            }
            texels.extend_from_slice(&made);
            below = (made, next);
        }
        Some(Self { size, texels })
    }

    /// All levels, one after the other.
    #[must_use]
    pub fn texels(&self) -> &[f32] {
        &self.texels
    }

    /// Whether nothing of what has this footprint can be seen.
    #[must_use]
    pub fn hides(&self, footprint: &Footprint) -> bool {
        if footprint.cut {
            return false;
        }
        let index = level_of(footprint);
        let level = level(self.size, index);
        let low = footprint.low >> index;
        let high = footprint.high >> index;
        let texel = |x: u32, y: u32| {
            let at = level.first + y * level.size.x + x;
            self.texels.get(at as usize).copied().unwrap_or(0.0)
        };
        let farthest = texel(low.x, low.y)
            .min(texel(high.x, low.y))
            .min(texel(low.x, high.y))
            .min(texel(high.x, high.y));
        footprint.nearest < farthest
    }
}

/// The first level at which a footprint lies on at most 2 × 2 texels.
#[must_use]
pub fn level_of(footprint: &Footprint) -> u32 {
    let span = footprint.high.saturating_sub(footprint.low);
    (32 - span.max_element().leading_zeros()).max(1)
}

impl Footprint {
    /// Of the box between two corners, in a view of `size` pixels. `clip_from_box` should have no large translation.
    #[must_use]
    pub fn of_box(low: Vec3, high: Vec3, clip_from_box: Mat4, size: UVec2) -> Self {
        let pixels = size.as_vec2();
        let mut least = Vec2::splat(1e30);
        let mut most = Vec2::splat(-1e30);
        let mut nearest = 0.0_f32;
        let mut cut = false;
        for k in 0..8_u32 {
            let pick = |bit: u32, low: f32, high: f32| if k & bit == 0 { low } else { high };
            let corner = Vec3::new(
                pick(1, low.x, high.x),
                pick(2, low.y, high.y),
                pick(4, low.z, high.z),
            );
            let clip = clip_from_box * corner.extend(1.0);
            // False for what is no number.
            let within = clip.w > 0.0 && clip.z <= clip.w;
            cut |= !within;
            let ndc = clip.truncate() / clip.w;
            let place = (ndc.truncate() * Vec2::new(0.5, -0.5) + 0.5) * pixels;
            least = least.min(place);
            most = most.max(place);
            nearest = nearest.max(ndc.z);
        }
        // More than the sums above round by.
        let slack = 0.01 + 1e-5 * pixels;
        let pixel = |place: Vec2| place.floor().clamp(Vec2::ZERO, pixels - 1.0).as_uvec2();
        Self {
            low: pixel(least - slack),
            high: pixel(most + slack),
            nearest: nearest * 1.000_002,
            cut,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_rounded_up_and_the_last_level_is_one_texel() {
        for size in [[1, 1], [2, 1], [3, 5], [257, 1], [256, 255], [4097, 3]] {
            let size = UVec2::from(size);
            let last = level(size, levels(size));
            assert_eq!(last.size, UVec2::ONE, "{size}");
            let depths: Vec<f32> = (0..size.x * size.y)
                .map(|k| 1.0 / (1.0 + k as f32))
                .collect();
            let pyramid = Pyramid::new(&depths, size).expect("a view");
            assert_eq!(pyramid.texels().len() as u32, texels(size));
            assert_eq!(
                pyramid.texels().last(),
                depths.last(),
                "the farthest of all"
            );
        }
        assert_eq!(Pyramid::new(&[], UVec2::ZERO), None);
        assert_eq!(Pyramid::new(&[0.5; 3], UVec2::new(2, 2)), None);
    }

    #[test]
    fn a_box_of_nonsense_or_before_the_near_plane_is_seen() {
        let clip = Mat4::perspective_infinite_reverse_rh(1.0, 1.0, 0.1);
        let size = UVec2::new(64, 64);
        let pyramid = Pyramid::new(&[1.0; 64 * 64], size).expect("a view");
        let hidden =
            |low: Vec3, high: Vec3| pyramid.hides(&Footprint::of_box(low, high, clip, size));
        assert!(hidden(
            Vec3::new(-1.0, -1.0, -9.0),
            Vec3::new(1.0, 1.0, -8.0)
        ));
        assert!(!hidden(
            Vec3::new(-1.0, -1.0, -9.0),
            Vec3::new(1.0, 1.0, 1.0)
        ));
        assert!(!hidden(Vec3::splat(f32::NAN), Vec3::ONE));
        assert!(!hidden(
            Vec3::splat(f32::NEG_INFINITY),
            Vec3::splat(f32::INFINITY)
        ));
    }
}
