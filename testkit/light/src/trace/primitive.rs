//! What rays hit, in the world's space.

use glam::{DAffine3, DMat3, DVec3};

use super::Ray;
use super::bounds::Bounds;
use crate::scene::{Object, Scene, Shape};

/// A triangle of an object.
#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    pub corners: [DVec3; 3],
    /// Unit normals at the corners.
    pub normals: [DVec3; 3],
    pub object: u32,
}

/// An ellipsoid or a plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Exact {
    to_local: DAffine3,
    /// Of normals, to the world.
    normals: DMat3,
    pub bounds: Bounds,
    pub object: u32,
}

/// Triangles, ellipsoids and planes of a scene. What has no area, or a number that is none, is left out.
pub(super) fn primitives(scene: &Scene) -> (Vec<Triangle>, Vec<Exact>, Vec<Exact>) {
    let (mut triangles, mut spheres, mut planes) = (Vec::new(), Vec::new(), Vec::new());
    for (object, id) in scene.objects.iter().zip(0..) {
        let to_world = object.pose.affine();
        let normals = to_world.matrix3.inverse().transpose();
        match object.shape {
            Shape::Mesh(_) => triangles_of(scene, object, id, &to_world, normals, &mut triangles),
            Shape::Sphere | Shape::Plane => {
                let sphere = object.shape == Shape::Sphere;
                let to_local = to_world.inverse();
                if !to_local.is_finite() || !to_world.is_finite() {
                    continue;
                }
                // The support of an ellipsoid along an axis is the length of that row of its matrix.
                let rows = to_world.matrix3.transpose();
                let half = DVec3::new(
                    rows.x_axis.length(),
                    rows.y_axis.length(),
                    rows.z_axis.length(),
                );
                let half = half * (1.0 + 8.0 * f64::EPSILON);
                let exact = Exact {
                    to_local,
                    normals,
                    bounds: Bounds {
                        low: to_world.translation - half,
                        high: to_world.translation + half,
                    },
                    object: id,
                };
                if sphere { &mut spheres } else { &mut planes }.push(exact);
            }
        }
    }
    (triangles, spheres, planes)
}

fn triangles_of(
    scene: &Scene,
    object: &Object,
    id: u32,
    to_world: &DAffine3,
    normals: DMat3,
    triangles: &mut Vec<Triangle>,
) {
    let Shape::Mesh(mesh) = object.shape else {
        return;
    };
    let Some(mesh) = scene.meshes.get(mesh) else {
        return;
    };
    for triangle in &mesh.triangles {
        let indices = triangle.map(|k| k as usize);
        if indices.iter().any(|k| *k >= mesh.positions.len()) {
            continue;
        }
        let corners = indices.map(|k| to_world.transform_point3(mesh.positions[k]));
        let face = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let Some(face) = face.try_normalize().filter(|n| n.is_finite()) else {
            continue;
        };
        let normal = |k: usize| {
            let own = mesh
                .normals
                .get(k)
                .and_then(|n| (normals * *n).try_normalize());
            own.unwrap_or(face)
        };
        triangles.push(Triangle {
            corners,
            normals: indices.map(normal),
            object: id,
        });
    }
}

impl Triangle {
    pub fn bounds(&self) -> Bounds {
        Bounds::of(&self.corners)
    }

    /// Unit normal of its plane, to the side from which the corners are counter-clockwise.
    pub fn face(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a).normalize()
    }

    /// The interpolated normal for the weights of the second and third corner.
    pub fn normal(&self, weights: [f64; 2]) -> DVec3 {
        let [a, b, c] = self.normals;
        let [v, w] = weights;
        let sum = (1.0 - v - w) * a + v * b + w * c;
        sum.try_normalize().unwrap_or_else(|| self.face())
    }
}

impl Exact {
    fn local(&self, ray: &Ray) -> (DVec3, DVec3) {
        (
            self.to_local.transform_point3(ray.origin),
            self.to_local.transform_vector3(ray.direction),
        )
    }

    /// The two t at which the ray meets the unit sphere.
    ///
    /// `|o|² − 1` and the discriminant are taken from the point of the ray that is nearest to the middle, so that a
    /// sphere far away loses nothing (Haines, Günther, Akenine-Möller, "Precision improvements for ray/sphere
    /// intersection", Ray Tracing Gems 2019).
    pub fn sphere(&self, ray: &Ray) -> Option<[f64; 2]> {
        let (o, d) = self.local(ray);
        let dd = d.length_squared();
        let b = -o.dot(d);
        let nearest = o + (b / dd) * d;
        let inside = 1.0 - nearest.length_squared();
        // A ray that touches is a hit of no width: none.
        if inside <= 0.0 || !inside.is_finite() {
            return None;
        }
        let root = (inside * dd).sqrt();
        let q = b + root.copysign(b);
        let c = (o.length() - 1.0) * (o.length() + 1.0);
        let (t, u) = (q / dd, c / q);
        Some([t.min(u), t.max(u)])
    }

    /// The t at which the ray meets the plane y = 0.
    pub fn plane(&self, ray: &Ray) -> Option<f64> {
        let (o, d) = self.local(ray);
        let t = -o.y / d.y;
        t.is_finite().then_some(t)
    }

    /// Unit normal of the ellipsoid at a point of it.
    pub fn sphere_normal(&self, point: DVec3) -> DVec3 {
        (self.normals * self.to_local.transform_point3(point)).normalize()
    }

    /// Unit normal of the plane.
    pub fn plane_normal(&self) -> DVec3 {
        (self.normals * DVec3::Y).normalize()
    }
}
