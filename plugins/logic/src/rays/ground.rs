//! Ground by its heights.

use super::answer::{Rays, Stop};
use bevy::math::{Vec2, Vec3, Vec3Swizzles};

/// Ground by a function of x and z, looked at every so many metres of a way.
pub struct GroundRays<F> {
    height: F,
    spacing: f32,
}

impl<F: Fn(Vec2) -> f32 + Send + Sync + 'static> GroundRays<F> {
    /// Looks every `spacing` metres: a ridge that is narrower may be missed. What is not above 0 is 1 m.
    #[must_use]
    pub fn new(height: F, spacing: f32) -> Self {
        let spacing = if spacing > 0.0 && spacing.is_finite() {
            spacing
        } else {
            1.0
        };
        Self { height, spacing }
    }

    fn is_below(&self, place: Vec3) -> bool {
        place.y < (self.height)(place.xz())
    }
}

impl<F: Fn(Vec2) -> f32 + Send + Sync + 'static> Rays for GroundRays<F> {
    fn cast(&self, from: Vec3, to: Vec3) -> Option<Stop> {
        let way = to - from;
        let length = way.xz().length();
        if !(length.is_finite() && from.y.is_finite() && to.y.is_finite()) {
            return None;
        }
        // A way of an hour is looked at a million times at most.
        let count = ((length / self.spacing).ceil() as u32).clamp(1, 1 << 20);
        let number =
            (0..=count).find(|&n| self.is_below(from + way * (n as f32 / count as f32)))?;
        // Between the last place above and the first below, by halving to a 4096th.
        let (mut above, mut below) = (number.saturating_sub(1) as f32, number as f32);
        for _ in 0..if number == 0 { 0 } else { 12 } {
            let middle = (above + below) / 2.0;
            if self.is_below(from + way * (middle / count as f32)) {
                below = middle;
            } else {
                above = middle;
            }
        }
        let time = number as f32 / count as f32;
        let at = (from + way * time).xz();
        let bits = |x: f32| u64::from((x / self.spacing).round() as i32 as u32);
        Some(Stop {
            time: below / count as f32,
            // 28 bits a coordinate, so that a set has room for its own.
            blocker: (bits(at.x) & 0x0fff_ffff) << 28 | (bits(at.y) & 0x0fff_ffff),
        })
    }

    /// Looks at the place of the way that is nearest to where the ground stopped another: below the ground there is
    /// below the ground.
    fn still_blocks(&self, blocker: u64, from: Vec3, to: Vec3) -> bool {
        let number = |bits: u64| ((bits as u32) << 4) as i32 >> 4;
        let at = Vec2::new(
            number(blocker >> 28 & 0x0fff_ffff) as f32,
            number(blocker & 0x0fff_ffff) as f32,
        ) * self.spacing;
        let way = to - from;
        let length = way.xz().length_squared();
        if !(length > 0.0 && length.is_finite()) {
            return false;
        }
        let time = (at - from.xz()).dot(way.xz()) / length;
        (0.0..=1.0).contains(&time) && self.is_below(from + way * time)
    }
}
