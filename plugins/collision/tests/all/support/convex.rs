//! An oracle that knows of a convex body only how far it reaches in a direction.
//!
//! Two bodies whose farthest points against each other coincide touch in one point and have a plane between them:
//! moved apart by any distance they are separate, pushed together by any distance they overlap. No formula of the
//! library is used for that.

use bevy::math::DVec3;
use dolomite_collision::{Aabb, Volume};

/// The point of a volume that is farthest along a direction.
pub fn farthest(volume: &Volume, along: DVec3) -> DVec3 {
    match volume {
        Volume::Sphere(sphere) => sphere.center + along.normalize() * sphere.radius,
        Volume::Aabb(aabb) => {
            let corner = |axis: usize| {
                if along[axis] >= 0.0 {
                    aabb.max[axis]
                } else {
                    aabb.min[axis]
                }
            };
            DVec3::new(corner(0), corner(1), corner(2))
        }
        Volume::Ellipsoid(ellipsoid) => {
            // The gradient of the support function: A Aᵀ n / |Aᵀ n|.
            let turned = ellipsoid.rotation.inverse() * along;
            let weighted = turned * ellipsoid.radii;
            let point = ellipsoid.radii * weighted / weighted.length();
            ellipsoid.center + ellipsoid.rotation * point
        }
        Volume::Capsule(capsule) => {
            let [a, b] = capsule.segment;
            let end = if a.dot(along) >= b.dot(along) { a } else { b };
            end + along.normalize() * capsule.radius
        }
    }
}

/// The corner of a triangle that is farthest along a direction.
pub fn farthest_corner(corners: [DVec3; 3], along: DVec3) -> DVec3 {
    corners
        .into_iter()
        .max_by(|a, b| a.dot(along).total_cmp(&b.dot(along)))
        .expect("three corners")
}

/// The same volume elsewhere.
pub fn moved(volume: &Volume, by: DVec3) -> Volume {
    let mut volume = *volume;
    match &mut volume {
        Volume::Sphere(sphere) => sphere.center += by,
        Volume::Aabb(aabb) => {
            *aabb = Aabb {
                min: aabb.min + by,
                max: aabb.max + by,
            }
        }
        Volume::Ellipsoid(ellipsoid) => ellipsoid.center += by,
        Volume::Capsule(capsule) => capsule.segment = capsule.segment.map(|end| end + by),
    }
    volume
}
