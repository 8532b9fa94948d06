//! What volumes are, the boxes around them, and their images under affine maps.

use super::ellipsoid::{Ellipsoid, half_axes};
use crate::geometry::nearest_on_segment;
use bevy::math::{DAffine3, DVec3};

/// All points within a distance of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub center: DVec3,
    /// Not negative.
    pub radius: f64,
}

/// A box along the coordinate axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The corner with the least coordinates.
    pub min: DVec3,
    /// The corner with the greatest.
    pub max: DVec3,
}

/// All points within a distance of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// The ends of the segment.
    pub segment: [DVec3; 2],
    /// Not negative.
    pub radius: f64,
}

/// One of them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "each is what its name says")]
pub enum Volume {
    Sphere(Sphere),
    Aabb(Aabb),
    Ellipsoid(Ellipsoid),
    Capsule(Capsule),
}

macro_rules! into_volume {
    ($($name:ident),*) => {$(
        impl From<$name> for Volume {
            fn from(volume: $name) -> Self {
                Self::$name(volume)
            }
        }
    )*};
}
into_volume!(Sphere, Aabb, Ellipsoid, Capsule);

/// The most that a map stretches a length.
fn stretch(by: &DAffine3) -> f64 {
    half_axes(by.matrix3).0.max_element()
}

impl Sphere {
    /// Whether it is one.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.center.is_finite() && self.radius.is_finite() && self.radius >= 0.0
    }

    /// The smallest sphere around its image with the image's centre; exact where the map stretches all
    /// directions alike.
    #[must_use]
    pub fn transformed(&self, by: &DAffine3) -> Self {
        Self {
            center: by.transform_point3(self.center),
            radius: self.radius * stretch(by),
        }
    }
}

impl Aabb {
    /// Around a place.
    #[must_use]
    pub fn around(center: DVec3, half_size: DVec3) -> Self {
        Self {
            min: center - half_size,
            max: center + half_size,
        }
    }

    /// Around both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Its middle.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        (self.min + self.max) * 0.5
    }

    /// Half of its size.
    #[must_use]
    pub fn half_size(&self) -> DVec3 {
        (self.max - self.min) * 0.5
    }

    /// Whether it is one.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.min.is_finite() && self.max.is_finite() && self.min.cmple(self.max).all()
    }

    /// The box around its image: tight around the image (J. Arvo, Transforming Axis-Aligned Bounding Boxes,
    /// Graphics Gems, 1990).
    #[must_use]
    pub fn transformed(&self, by: &DAffine3) -> Self {
        let (mut min, mut max) = (by.translation, by.translation);
        for axis in 0..3 {
            let column = by.matrix3.col(axis);
            let (one, two) = (column * self.min[axis], column * self.max[axis]);
            min += one.min(two);
            max += one.max(two);
        }
        Self { min, max }
    }
}

impl Capsule {
    /// Whether it is one.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let [a, b] = self.segment;
        a.is_finite() && b.is_finite() && self.radius.is_finite() && self.radius >= 0.0
    }

    /// The capsule around its image with the image's segment; exact where the map stretches all directions alike.
    #[must_use]
    pub fn transformed(&self, by: &DAffine3) -> Self {
        Self {
            segment: self.segment.map(|end| by.transform_point3(end)),
            radius: self.radius * stretch(by),
        }
    }

    /// The square of the distance of a point to its segment.
    #[must_use]
    pub fn distance_squared(&self, point: DVec3) -> f64 {
        let [a, b] = self.segment;
        point.distance_squared(a + (b - a) * nearest_on_segment(point, a, b))
    }
}

impl Volume {
    /// Whether it is one: finite, and no radius below 0 (see the head of this module).
    #[must_use]
    pub fn is_valid(&self) -> bool {
        match self {
            Self::Sphere(sphere) => sphere.is_valid(),
            Self::Aabb(aabb) => aabb.is_valid(),
            Self::Ellipsoid(ellipsoid) => ellipsoid.is_valid(),
            Self::Capsule(capsule) => capsule.is_valid(),
        }
    }

    /// The box around it: tight.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Sphere(sphere) => Aabb::around(sphere.center, DVec3::splat(sphere.radius)),
            Self::Aabb(aabb) => *aabb,
            Self::Ellipsoid(ellipsoid) => Aabb::around(ellipsoid.center, ellipsoid.half_size()),
            Self::Capsule(capsule) => {
                let [a, b] = capsule.segment;
                Aabb {
                    min: a.min(b) - capsule.radius,
                    max: a.max(b) + capsule.radius,
                }
            }
        }
    }

    /// Its image, or for boxes and for maps that stretch a sphere or a capsule, a volume around its image.
    #[must_use]
    pub fn transformed(&self, by: &DAffine3) -> Self {
        match self {
            Self::Sphere(sphere) => Self::Sphere(sphere.transformed(by)),
            Self::Aabb(aabb) => Self::Aabb(aabb.transformed(by)),
            Self::Ellipsoid(ellipsoid) => Self::Ellipsoid(ellipsoid.transformed(by)),
            Self::Capsule(capsule) => Self::Capsule(capsule.transformed(by)),
        }
    }

    /// Whether a point lies in it.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        match self {
            _ if !self.is_valid() => false,
            Self::Sphere(sphere) => {
                sphere.center.distance_squared(point) <= sphere.radius * sphere.radius
            }
            Self::Aabb(aabb) => point.cmpge(aabb.min).all() && point.cmple(aabb.max).all(),
            Self::Ellipsoid(ellipsoid) => ellipsoid.distance(point) == 0.0 && point.is_finite(),
            Self::Capsule(capsule) => {
                capsule.distance_squared(point) <= capsule.radius * capsule.radius
            }
        }
    }
}
