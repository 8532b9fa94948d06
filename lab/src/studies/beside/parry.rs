//! Parry, as `bevy_rapier3d` has it.

use super::{SweepMethod, Touch};
use bevy::math::{DVec3, Vec3};
use dolomite_collision::Ray;
use dolomite_testkit::sweeps::Sweep;
use parry3d::math::{Pose, Vector};
use parry3d::query::sweep_toi::{
    Sweep as ParrySweep, SweepToiStatus, ToiProxy, sweep_time_of_impact,
};
use parry3d::query::{RayCast, ShapeCastOptions, cast_shapes};
use parry3d::shape::{Ball, TriMesh, Triangle};

/// Casts of shapes, and sweeps of points with a radius.
pub const SWEEPS: &[SweepMethod] = &[("parry", sweep), ("parry_toi", sweep_toi)];

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

/// How far, in radii, the sweep of points may be from touching: a quarter of it is its tolerance. f32 holds no less at
/// ways of some hundred radii.
const SLOP: f32 = 1e-4;

/// By what Rapier sweeps fast bodies by: made for a ball and a triangle.
fn sweep_toi(case: &Sweep) -> Touch {
    let (center, radii) = (DVec3::from(case.center), DVec3::from(case.radii));
    let corners = case
        .corners
        .map(|corner| vector((DVec3::from(corner) - center) / radii));
    let end = Pose::from_translation(vector(DVec3::from(case.way) / radii));
    let hit = sweep_time_of_impact(
        &ToiProxy::from_array(corners, 0.0),
        &ParrySweep::constant(&Pose::IDENTITY, Vector::ZERO),
        // It stops a slop before the radii touch.
        &ToiProxy::point(Vector::ZERO, 1.0 + SLOP),
        &ParrySweep::from_poses(&Pose::IDENTITY, &end, Vector::ZERO),
        1.0,
        SLOP,
    );
    let n = hit.normal;
    let normal = DVec3::new(f64::from(n.x), f64::from(n.y), f64::from(n.z)) / radii;
    let touches = !matches!(hit.status, SweepToiStatus::Separated);
    touches.then(|| (f64::from(hit.fraction), normal.normalize_or_zero()))
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
