//! Parry, as `bevy_rapier3d` has it.

use super::{SweepMethod, Touch};
use bevy::math::{DVec3, Vec3};
use dolomite_collision::Ray;
use dolomite_testkit::sweeps::Sweep;
use parry3d::math::{Pose, Vector};
use parry3d::query::{RayCast, ShapeCastOptions, cast_shapes};
use parry3d::shape::{Ball, TriMesh, Triangle};

/// Casts of shapes.
pub const SWEEPS: &[SweepMethod] = &[("parry", sweep)];

fn vector(v: DVec3) -> Vector {
    Vector::new(v.x as f32, v.y as f32, v.z as f32)
}

/// In the space of the ellipsoid: what somebody who scales the world would ask.
fn sweep(case: &Sweep) -> Touch {
    let (center, radii) = (DVec3::from(case.center), DVec3::from(case.radii));
    let [a, b, c] = case
        .corners
        .map(|corner| vector((DVec3::from(corner) - center) / radii));
    let hit = cast_shapes(
        &Pose::IDENTITY,
        vector(DVec3::from(case.way) / radii),
        &Ball::new(1.0),
        &Pose::IDENTITY,
        Vector::ZERO,
        &Triangle::new(a, b, c),
        ShapeCastOptions {
            max_time_of_impact: 1.0,
            stop_at_penetration: true,
            ..ShapeCastOptions::default()
        },
    )
    .ok()??;
    let n = hit.normal2;
    let normal = DVec3::new(f64::from(n.x), f64::from(n.y), f64::from(n.z)) / radii;
    Some((f64::from(hit.time_of_impact), normal.normalize_or_zero()))
}

/// A mesh of triangles in its tree.
pub struct Mesh(TriMesh);

impl Mesh {
    /// Of these triangles; `None` of none.
    pub fn new(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Option<Self> {
        let vertices = vertices.iter().map(|v| Vector::new(v.x, v.y, v.z));
        TriMesh::new(vertices.collect(), triangles.to_vec())
            .ok()
            .map(Self)
    }

    /// When a ray hits; NaN if it does not.
    pub fn first(&self, ray: &Ray) -> f64 {
        let cast = parry3d::query::Ray::new(vector(ray.origin), vector(ray.direction));
        self.0
            .cast_local_ray(&cast, f32::MAX, false)
            .map_or(f64::NAN, f64::from)
    }
}
