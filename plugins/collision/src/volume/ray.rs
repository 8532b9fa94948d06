//! Rays, and where they enter volumes.

use super::ellipsoid::Ellipsoid;
use super::shape::{Aabb, Capsule, Sphere, Volume};
use crate::roots::{enter_box, enter_cylinder, enter_sphere};
use bevy::math::DVec3;
use thiserror::Error;

/// A ray, or a part of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, metres.
    pub origin: DVec3,
    /// Where it goes, of any length but 0: times are in parts of it.
    pub direction: DVec3,
    /// The time at which it ends; infinite for a whole ray.
    pub end: f64,
}

/// A ray that is none.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RayError {
    /// Not a place.
    #[error("a ray starts at {0}, which is no place")]
    Origin(DVec3),
    /// Not a direction.
    #[error("a ray goes along {0}, which is no direction")]
    Direction(DVec3),
    /// Ends before it starts.
    #[error("a ray ends at time {0}, before it starts")]
    End(f64),
}

impl Ray {
    /// A whole ray.
    #[must_use]
    pub const fn new(origin: DVec3, direction: DVec3) -> Self {
        Self {
            origin,
            direction,
            end: f64::INFINITY,
        }
    }

    /// From one place to another, at times 0 and 1.
    #[must_use]
    pub fn between(from: DVec3, to: DVec3) -> Self {
        Self {
            origin: from,
            direction: to - from,
            end: 1.0,
        }
    }

    /// The place at a time.
    #[inline]
    #[must_use]
    pub fn at(&self, time: f64) -> DVec3 {
        self.origin + self.direction * time
    }

    /// Whether it can meet anything.
    ///
    /// # Errors
    /// [`RayError`]. Queries answer such rays with no hit.
    pub fn check(&self) -> Result<(), RayError> {
        if !self.origin.is_finite() {
            return Err(RayError::Origin(self.origin));
        }
        // Squares of its length stay finite and above 0.
        let length = self.direction.length_squared();
        if !(length.is_finite() && length >= f64::MIN_POSITIVE) {
            return Err(RayError::Direction(self.direction));
        }
        if self.end.is_nan() || self.end < 0.0 {
            return Err(RayError::End(self.end));
        }
        Ok(())
    }
}

impl Sphere {
    /// When a ray enters; 0 if it starts inside.
    #[must_use]
    pub fn enter(&self, ray: &Ray) -> Option<f64> {
        let a = self.center - ray.origin;
        if a.length_squared() <= self.radius * self.radius {
            return Some(0.0);
        }
        enter_sphere(a, ray.direction, self.radius)
    }
}

impl Aabb {
    /// When a ray enters; 0 if it starts inside.
    #[must_use]
    pub fn enter(&self, ray: &Ray) -> Option<f64> {
        enter_box(self.min - ray.origin, self.max - ray.origin, ray.direction)
            .map(|(enter, _)| enter)
    }
}

impl Ellipsoid {
    /// When a ray enters; 0 if it starts inside. Times are the same where the ellipsoid is a unit sphere.
    #[must_use]
    pub fn enter(&self, ray: &Ray) -> Option<f64> {
        let to_unit = self.to_unit();
        Sphere {
            center: DVec3::ZERO,
            radius: 1.0,
        }
        .enter(&Ray {
            origin: to_unit * (ray.origin - self.center),
            direction: to_unit * ray.direction,
            end: ray.end,
        })
    }
}

impl Capsule {
    /// When a ray enters; 0 if it starts inside.
    #[must_use]
    pub fn enter(&self, ray: &Ray) -> Option<f64> {
        if self.distance_squared(ray.origin) <= self.radius * self.radius {
            return Some(0.0);
        }
        let [a, b] = self.segment.map(|end| end - ray.origin);
        let side = enter_cylinder(a, b - a, ray.direction, self.radius);
        let side = side.filter(|(_, along)| (0.0..=1.0).contains(along));
        let ends = [a, b].map(|end| enter_sphere(end, ray.direction, self.radius));
        [side.map(|(time, _)| time), ends[0], ends[1]]
            .into_iter()
            .flatten()
            .min_by(f64::total_cmp)
    }
}

impl Volume {
    /// When a ray enters, in parts of its direction; 0 if it starts inside, `None` if it does not before its end,
    /// or one of both is not valid.
    #[must_use]
    pub fn enter(&self, ray: &Ray) -> Option<f64> {
        if ray.check().is_err() || !self.is_valid() {
            return None;
        }
        match self {
            Self::Sphere(sphere) => sphere.enter(ray),
            Self::Aabb(aabb) => aabb.enter(ray),
            Self::Ellipsoid(ellipsoid) => ellipsoid.enter(ray),
            Self::Capsule(capsule) => capsule.enter(ray),
        }
        .filter(|&time| time <= ray.end)
    }
}
