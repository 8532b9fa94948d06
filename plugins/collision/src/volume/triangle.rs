//! Whether a volume overlaps a triangle.

use super::ellipsoid::Ellipsoid;
use super::shape::{Aabb, Volume};
use crate::geometry::{nearest_on_triangle, segment_triangle_squared};
use bevy::math::DVec3;

impl Volume {
    /// Whether a triangle has a point in the volume; touching counts. A triangle may be a segment or a point.
    #[must_use]
    pub fn overlaps_triangle(&self, corners: [DVec3; 3]) -> bool {
        match self {
            _ if !self.is_valid() || !corners.iter().all(|corner| corner.is_finite()) => false,
            Self::Sphere(sphere) => {
                let (point, _) = nearest_on_triangle(sphere.center, corners);
                point.distance_squared(sphere.center) <= sphere.radius * sphere.radius
            }
            Self::Aabb(aabb) => box_triangle(aabb, corners),
            Self::Ellipsoid(ellipsoid) => ellipsoid_triangle(ellipsoid, corners),
            Self::Capsule(capsule) => {
                segment_triangle_squared(capsule.segment, corners)
                    <= capsule.radius * capsule.radius
            }
        }
    }
}

/// Where the ellipsoid is a unit sphere.
fn ellipsoid_triangle(ellipsoid: &Ellipsoid, corners: [DVec3; 3]) -> bool {
    let to_unit = ellipsoid.to_unit();
    let corners = corners.map(|corner| to_unit * (corner - ellipsoid.center));
    let (point, _) = nearest_on_triangle(DVec3::ZERO, corners);
    point.length_squared() <= 1.0
}

/// No axis of thirteen separates them: the box's three, the triangle's normal, and the products of their edges
/// (T. Akenine-Möller, Fast 3D Triangle-Box Overlap Testing, 2001).
fn box_triangle(aabb: &Aabb, corners: [DVec3; 3]) -> bool {
    let half = aabb.half_size();
    let corners = corners.map(|corner| corner - aabb.center());
    let separated = |axis: DVec3| {
        let [a, b, c] = corners.map(|corner| corner.dot(axis));
        let reach = half.dot(axis.abs());
        a.min(b).min(c) > reach || a.max(b).max(c) < -reach
    };
    let edges = [
        corners[1] - corners[0],
        corners[2] - corners[1],
        corners[0] - corners[2],
    ];
    if DVec3::AXES.into_iter().any(&separated) || separated(edges[0].cross(edges[1])) {
        return false;
    }
    !edges.iter().any(|edge| {
        DVec3::AXES
            .into_iter()
            .any(|axis| separated(axis.cross(*edge)))
    })
}
