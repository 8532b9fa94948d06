//! Ellipsoids that move in a straight line against triangles.
//!
//! The time of contact is worked out where the ellipsoid is a unit sphere, in f64; normals are those of the world,
//! of the plane that touches the ellipsoid at the contact. Triangles have two sides.

mod unit;

pub use unit::{PARALLEL, UnitTouch, UnitTriangle, sweep as sweep_unit};

use crate::geometry::Feature;
use crate::volume::Ellipsoid;
use bevy::math::{DMat3, DVec3};
use thiserror::Error;

/// Places and ways of more radii than this are not swept: products of five such numbers are numbers in f64, and none
/// of more is needed.
pub const FARTHEST: f64 = 1e60;

/// Whether a place or a way of unit space is one that can be swept.
#[inline]
#[must_use]
pub fn within_reach(unit: DVec3) -> bool {
    // A comparison with NaN is false, where `max_element` would pass it over.
    unit.abs().cmple(DVec3::splat(FARTHEST)).all()
}

/// A sweep that cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SweepError {
    /// Not an ellipsoid.
    #[error(
        "radii of {radii} m at {center} are no ellipsoid: all have to be finite, radii above 0, and the centre within {FARTHEST:e} radii of the origin"
    )]
    Ellipsoid {
        /// Its centre.
        center: DVec3,
        /// Its radii.
        radii: DVec3,
    },
    /// Not a way.
    #[error("a way of {0} m is not finite, or longer than {FARTHEST:e} radii")]
    Way(DVec3),
}

/// Where a moving ellipsoid touches a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// When, as a part of the way: 0 to 1.
    pub time: f64,
    /// Which triangle.
    pub triangle: u32,
    /// What part of it.
    pub feature: Feature,
    /// Where, in the space that triangles are given in.
    pub point: DVec3,
    /// Of the plane between both, away from the triangle; of length 1.
    pub normal: DVec3,
    /// How deep the ellipsoid lay in the triangle at the start, metres; 0 of one that was apart.
    pub depth: f64,
}

/// Between an ellipsoid's place and the space where it is the unit sphere.
#[derive(Clone, Copy, Debug)]
pub struct UnitSpace {
    /// Its centre at the start.
    pub center: DVec3,
    /// To the unit sphere.
    pub to_unit: DMat3,
    /// Back: its columns are the half axes.
    pub axes: DMat3,
}

impl UnitSpace {
    /// Of an ellipsoid.
    ///
    /// # Errors
    /// [`SweepError::Ellipsoid`].
    pub fn new(ellipsoid: &Ellipsoid) -> Result<Self, SweepError> {
        if !(ellipsoid.is_valid() && within_reach(ellipsoid.to_unit() * ellipsoid.center)) {
            return Err(SweepError::Ellipsoid {
                center: ellipsoid.center,
                radii: ellipsoid.radii,
            });
        }
        Ok(Self {
            center: ellipsoid.center,
            to_unit: ellipsoid.to_unit(),
            axes: ellipsoid.axes(),
        })
    }

    /// Whether the ellipsoid can be swept along a way.
    ///
    /// # Errors
    /// [`SweepError::Way`].
    pub fn check_way(&self, way: DVec3) -> Result<(), SweepError> {
        if within_reach(self.to_unit * way) {
            Ok(())
        } else {
            Err(SweepError::Way(way))
        }
    }

    /// Half of the size of the box around the ellipsoid.
    #[inline]
    #[must_use]
    pub fn half_size(&self) -> DVec3 {
        let row = |i: usize| self.axes.row(i).length();
        DVec3::new(row(0), row(1), row(2))
    }

    /// A triangle there.
    #[inline]
    #[must_use]
    pub fn triangle(&self, corners: [DVec3; 3]) -> UnitTriangle {
        UnitTriangle::new(corners, self.center, &self.to_unit)
    }

    /// A normal of unit space as one of the world: normals go by the inverse transpose of what places go by.
    #[inline]
    #[must_use]
    pub fn normal(&self, unit: DVec3) -> DVec3 {
        (self.to_unit.transpose() * unit).normalize_or(unit)
    }

    /// What touched, in the world. `way` is that of the world.
    #[inline]
    #[must_use]
    pub fn contact(&self, touch: &UnitTouch, triangle: u32, way: DVec3) -> Contact {
        // Near the centre first, so that the point has the digits of the ellipsoid and not those of the way.
        let unit_way = self.to_unit * way;
        let from_center = self.axes * (touch.point - unit_way * touch.time);
        Contact {
            time: touch.time,
            triangle,
            feature: touch.feature,
            point: self.center + way * touch.time + from_center,
            normal: self.normal(touch.normal),
            depth: (self.axes * touch.normal).length() * touch.depth,
        }
    }
}

/// The first triangle of a list that an ellipsoid touches on its way; of several at the same time, the first of the
/// list. Triangles with a number that is not finite, or more than [`FARTHEST`] radii away, are passed over.
///
/// ```
/// use bevy::math::DVec3;
/// use dolomite_collision::{Ellipsoid, Feature, sweep};
///
/// let floor = [[DVec3::new(-9.0, 0.0, 9.0), DVec3::new(9.0, 0.0, 9.0), DVec3::new(0.0, 0.0, -9.0)]];
/// let figure = Ellipsoid::upright(DVec3::new(0.0, 2.0, 0.0), DVec3::new(0.3, 0.9, 0.3));
/// let contact = sweep(&figure, DVec3::new(0.0, -2.2, 0.0), &floor)?.expect("it falls onto the floor");
/// assert!((contact.time - 0.5).abs() < 1e-12 && contact.normal.y > 0.999_999);
/// assert_eq!(contact.feature, Feature::Face);
/// # Ok::<(), dolomite_collision::SweepError>(())
/// ```
///
/// # Errors
/// [`SweepError`].
pub fn sweep(
    ellipsoid: &Ellipsoid,
    way: DVec3,
    triangles: &[[DVec3; 3]],
) -> Result<Option<Contact>, SweepError> {
    let space = UnitSpace::new(ellipsoid)?;
    space.check_way(way)?;
    let unit_way = space.to_unit * way;
    let mut best: Option<(UnitTouch, u32)> = None;
    for (index, corners) in (0..).zip(triangles) {
        let triangle = space.triangle(*corners);
        if !triangle.corners.iter().all(|corner| within_reach(*corner)) {
            continue;
        }
        if let Some(touch) = sweep_unit(&triangle, unit_way)
            && best.is_none_or(|(known, _)| touch.time < known.time)
        {
            best = Some((touch, index));
        }
    }
    Ok(best.map(|(touch, index)| space.contact(&touch, index, way)))
}
