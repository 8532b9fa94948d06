//! Where the ground is asked for, and what it answers.
//!
//! Conventions: +Y up, −Z forward (north), metres, right-handed. The ground plane is (x, z); a
//! two-component vector here is always (x, z), never (x, y). A gradient is (∂height/∂x,
//! ∂height/∂z), rise over run, without unit.

use bevy::math::{DVec2, DVec3, IVec2, UVec2, Vec2, Vec3};
use bevy::reflect::Reflect;
use bytemuck::{Pod, Zeroable};
use core::any::Any;

/// 2³², the number of fixed-point steps in one metre.
const STEPS_PER_METRE: f64 = 4_294_967_296.0;

/// A place on the ground plane in 32.32 fixed point: whole metres and a fraction.
///
/// Range ±2³¹ m on each axis, resolution 2⁻³² m everywhere; arithmetic wraps. The noise takes its
/// coordinates from these integers, so its error does not grow with the distance from the origin.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Pod, Zeroable)]
pub struct GroundPoint {
    /// Whole metres, rounded down: x, z.
    pub cell: IVec2,
    /// The rest, in steps of 2⁻³² m: x, z.
    pub frac: UVec2,
}

impl GroundPoint {
    /// The fixed-point place nearest below `xz` (metres). Exact for every `f64` whose steps are
    /// no finer than 2⁻³² m (all of |x| ≥ 2²⁰ m); else it is rounded down by less than 2⁻³² m.
    /// Beyond ±2³¹ m the nearest end of the range is returned; a NaN gives 0.
    #[must_use]
    pub fn new(xz: DVec2) -> Self {
        let (x, z) = (fixed(xz.x), fixed(xz.y));
        Self::from_fixed([x, z])
    }

    /// From 32.32 fixed-point metres: x, z.
    #[must_use]
    pub const fn from_fixed(xz: [i64; 2]) -> Self {
        Self {
            cell: IVec2::new((xz[0] >> 32) as i32, (xz[1] >> 32) as i32),
            frac: UVec2::new(xz[0] as u32, xz[1] as u32),
        }
    }

    /// 32.32 fixed-point metres: x, z.
    #[must_use]
    pub const fn to_fixed(self) -> [i64; 2] {
        [
            ((self.cell.x as i64) << 32) | self.frac.x as i64,
            ((self.cell.y as i64) << 32) | self.frac.y as i64,
        ]
    }

    /// Metres as `f64`, rounded to the nearest (error at most 2⁻²² m at the end of the range,
    /// none below 2²⁰ m).
    #[must_use]
    pub fn to_dvec2(self) -> DVec2 {
        let [x, z] = self.to_fixed();
        DVec2::new(x as f64 / STEPS_PER_METRE, z as f64 / STEPS_PER_METRE)
    }

    /// The place `metres` further on, in fixed point (the offset is rounded down to 2⁻³² m).
    #[must_use]
    pub fn offset(self, metres: DVec2) -> Self {
        let [x, z] = self.to_fixed();
        Self::from_fixed([
            x.wrapping_add(fixed(metres.x)),
            z.wrapping_add(fixed(metres.y)),
        ])
    }

    /// `self − origin` in metres as `f32`: exact subtraction first, one rounding after, so that it
    /// serves as a camera-relative position. Relative error at most 2⁻²³.
    #[must_use]
    pub fn relative_to(self, origin: Self) -> Vec2 {
        let [x, z] = self.to_fixed();
        let [ox, oz] = origin.to_fixed();
        Vec2::new(
            (x.wrapping_sub(ox) as f64 / STEPS_PER_METRE) as f32,
            (z.wrapping_sub(oz) as f64 / STEPS_PER_METRE) as f32,
        )
    }
}

impl From<DVec2> for GroundPoint {
    fn from(xz: DVec2) -> Self {
        Self::new(xz)
    }
}

/// The nearest place that positions can express: within ±2³¹ m, NaN as 0.
pub(crate) fn in_range(xz: DVec2) -> DVec2 {
    let limit = DVec2::splat(2_147_483_648.0);
    DVec2::select(xz.is_nan_mask(), DVec2::ZERO, xz).clamp(-limit, limit)
}

/// Metres to 32.32 fixed point, rounded down, ends clamped, NaN to 0. The product with 2³² is
/// exact (a power of two) and Rust's float-to-int cast saturates.
pub(crate) fn fixed(metres: f64) -> i64 {
    (metres * STEPS_PER_METRE).floor() as i64
}

/// A rectangle of the ground plane, metres, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
pub struct GroundRect {
    /// Smallest x and z.
    pub min: DVec2,
    /// Largest x and z.
    pub max: DVec2,
}

impl GroundRect {
    /// The rectangle between two corners, which must be given smallest first; see
    /// [`GroundRect::is_valid`].
    #[must_use]
    pub const fn new(min: DVec2, max: DVec2) -> Self {
        Self { min, max }
    }

    /// A square centred on `centre` with sides of `side` metres.
    #[must_use]
    pub fn square(centre: DVec2, side: f64) -> Self {
        Self::new(
            centre - DVec2::splat(side / 2.0),
            centre + DVec2::splat(side / 2.0),
        )
    }

    /// Extent along x and z, metres.
    #[must_use]
    pub fn size(&self) -> DVec2 {
        self.max - self.min
    }

    /// The middle, metres.
    #[must_use]
    pub fn centre(&self) -> DVec2 {
        (self.min + self.max) * 0.5
    }

    /// Whether a point lies inside or on the border.
    #[must_use]
    pub fn contains(&self, xz: DVec2) -> bool {
        xz.cmpge(self.min).all() && xz.cmple(self.max).all()
    }

    /// How far a point lies from the rectangle, metres; 0 inside and on the border.
    #[must_use]
    pub fn distance(&self, xz: DVec2) -> f64 {
        (self.min - xz).max(xz - self.max).max(DVec2::ZERO).length()
    }

    /// Whether all four numbers are finite and min ≤ max.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.min.is_finite() && self.max.is_finite() && self.min.cmple(self.max).all()
    }
}

/// The ground at one place, in `f64`: what gameplay stands on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
pub struct GroundSample {
    /// Height above y = 0, metres.
    pub height: f64,
    /// (∂height/∂x, ∂height/∂z), rise over run.
    pub gradient: DVec2,
}

impl GroundSample {
    /// The upward unit normal (−∂h/∂x, 1, −∂h/∂z) / |·|.
    #[must_use]
    pub fn normal(&self) -> DVec3 {
        DVec3::new(-self.gradient.x, 1.0, -self.gradient.y).normalize()
    }
}

/// The ground at one place, in `f32`: the value that the WGSL computes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Height {
    /// Height, metres (for a [`Terrain`](crate::Terrain): above y = 0).
    pub value: f32,
    /// (∂height/∂x, ∂height/∂z), rise over run.
    pub gradient: Vec2,
}

impl Height {
    /// The upward unit normal (−∂h/∂x, 1, −∂h/∂z) / |·|.
    #[must_use]
    pub fn normal(&self) -> Vec3 {
        Vec3::new(-self.gradient.x, 1.0, -self.gradient.y).normalize()
    }
}

/// Anything that can be stood on: a height and its gradient at every place of the ground plane.
pub trait Ground: Send + Sync {
    /// Height and gradient at (x, z), metres.
    fn sample(&self, xz: DVec2) -> GroundSample;

    /// Height at (x, z), metres.
    fn height(&self, xz: DVec2) -> f64 {
        self.sample(xz).height
    }

    /// Upward unit normal at (x, z).
    fn normal(&self, xz: DVec2) -> DVec3 {
        self.sample(xz).normal()
    }

    /// Rectangles beyond which this ground is the same as another, metres; `None` where that is not known: all of it may
    /// be another. A [`Terrain`](crate::Terrain) knows of another one with other edits.
    fn changed_rects(&self, _before: &dyn Ground) -> Option<Vec<GroundRect>> {
        None
    }

    /// Itself, for grounds that know each other.
    fn as_any(&self) -> Option<&dyn Any> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_point_rounds_down_and_returns() {
        for xz in [
            DVec2::new(-0.25, 1.5),
            DVec2::new(1e7 + 0.125, -1e7 - 0.625),
            DVec2::ZERO,
        ] {
            let point = GroundPoint::new(xz);
            assert_eq!(point.to_dvec2(), xz, "multiples of 2^-32 m are exact");
            assert_eq!(point.cell.as_dvec2(), xz.floor());
        }
        let below = GroundPoint::new(DVec2::splat(-1e-12));
        assert_eq!((below.cell.x, below.frac.x), (-1, u32::MAX));
    }

    #[test]
    fn hostile_numbers_do_not_panic() {
        let point = GroundPoint::new(DVec2::new(f64::NAN, f64::INFINITY));
        assert_eq!((point.cell.x, point.frac.x), (0, 0));
        assert_eq!((point.cell.y, point.frac.y), (i32::MAX, u32::MAX));
        let wrapped = point.offset(DVec2::new(f64::NEG_INFINITY, 1.0));
        assert_eq!(wrapped.cell.y, i32::MIN, "arithmetic wraps");
    }

    #[test]
    fn relative_position_keeps_millimetres_far_away() {
        let origin = GroundPoint::new(DVec2::new(9_999_999.0, -9_999_999.0));
        let offset = origin.offset(DVec2::new(0.001, -0.001)).relative_to(origin);
        assert!((offset - Vec2::new(0.001, -0.001)).abs().max_element() < 1e-9);
    }

    #[test]
    fn normal_points_up_and_against_the_slope() {
        let sample = GroundSample {
            height: 0.0,
            gradient: DVec2::new(1.0, 0.0),
        };
        let half = 0.5_f64.sqrt();
        assert!((sample.normal() - DVec3::new(-half, half, 0.0)).length() < 1e-15);
    }
}
