//! Leaks, and times beside brute force.

use super::meshes::Triangles;
use super::method::Method;
use bevy::math::DVec3;
use dolomite_collision::Ray;
use dolomite_testkit::mesh::bumpy_sphere;
use dolomite_testkit::places::{direction, place};
use dolomite_testkit::random::Random;

/// Closed meshes of both measurements.
pub const MESHES: usize = 10;

/// What each method got wrong.
#[derive(Clone, Default)]
pub struct Wrong {
    /// Rays that passed through a closed surface.
    pub leaks: u64,
    /// Errors of the place that was hit, metres, on meshes of 2 m.
    pub errors: Vec<f64>,
    /// Hits where brute force has none, and the other way round.
    pub disagree: u64,
}

/// From inside through a vertex, or through a point of an edge: the surface must be met.
fn through(random: &mut Random, (vertices, triangles): &Triangles, vertex: bool) -> Ray {
    let [a, b, _] = triangles[random.below(triangles.len())];
    let [a, b] = [a, b].map(|corner| vertices[corner as usize].as_dvec3());
    let along = if vertex { 0.0 } else { random.unit() };
    // A start and a direction that f32 holds, so that all are asked the same.
    let from = place(random, 0.05).as_vec3().as_dvec3();
    Ray::new(from, (a.lerp(b, along) - from).as_vec3().as_dvec3())
}

/// A place where a ray passes a triangle less far inside than this part of it is in doubt.
const DOUBT: f64 = 1e-4;

/// When a ray meets the mesh, by Cramer's rule in f64 over all triangles; `None` where an edge is near enough for f32
/// to see it on either side.
fn brute(ray: &Ray, corners: &[[DVec3; 3]]) -> Option<f64> {
    let mut first = f64::INFINITY;
    let mut doubt = f64::INFINITY;
    for [a, b, c] in corners {
        let (ab, ac, from) = (*b - *a, *c - *a, ray.origin - *a);
        let across = ray.direction.cross(ac);
        let volume = ab.dot(across);
        let (u, v) = (
            from.dot(across) / volume,
            from.cross(ab).dot(ray.direction) / volume,
        );
        let inside = u.min(v).min(1.0 - u - v);
        let time = from.cross(ab).dot(ac) / volume;
        if time < 0.0 || inside.is_nan() || inside < -DOUBT {
            continue;
        }
        if inside < DOUBT {
            doubt = doubt.min(time);
        } else {
            first = first.min(time);
        }
    }
    (doubt > first || doubt.is_infinite()).then_some(first)
}

/// Rays at vertices and edges of closed meshes, `count` in all, and a few at random beside brute force.
pub fn wrong(random: &mut Random, count: usize, names: usize) -> Vec<Wrong> {
    let mut wrong = vec![Wrong::default(); names];
    for mesh in 0..MESHES as u32 {
        eprintln!("rays: closed mesh {mesh}");
        let mesh = bumpy_sphere(random, 8 + 4 * mesh);
        let methods = Method::all(&mesh);
        for number in 0..count.div_ceil(MESHES) {
            let ray = through(random, &mesh, number % 2 == 0);
            for ((_, method, _), wrong) in methods.iter().zip(&mut wrong) {
                wrong.leaks += u64::from(method.first(&ray).is_nan());
            }
        }
        let (vertices, triangles) = &mesh;
        let corners: Vec<[DVec3; 3]> = triangles
            .iter()
            .map(|corners| corners.map(|i| vertices[i as usize].as_dvec3()))
            .collect();
        for _ in 0..(count / 100).clamp(100, 2000) {
            let from = (direction(random) * 4.0).as_vec3().as_dvec3();
            let to = place(random, 1.5);
            let ray = Ray::new(from, (to - from).as_vec3().as_dvec3());
            let Some(truth) = brute(&ray, &corners) else {
                continue;
            };
            for ((_, method, _), wrong) in methods.iter().zip(&mut wrong) {
                let found = method.first(&ray);
                if found.is_nan() != truth.is_infinite() {
                    wrong.disagree += 1;
                } else if truth.is_finite() {
                    let error = (found - truth).abs() * ray.direction.length();
                    wrong.errors.push(error);
                }
            }
        }
    }
    wrong
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brute_force_knows_a_triangle_and_its_edge() {
        let triangle = [[DVec3::ZERO, DVec3::X, DVec3::Z]];
        let down = |x: f64, z: f64| Ray::new(DVec3::new(x, 2.0, z), DVec3::NEG_Y);
        assert_eq!(brute(&down(0.25, 0.25), &triangle), Some(2.0));
        assert_eq!(brute(&down(0.75, 0.75), &triangle), Some(f64::INFINITY));
        assert_eq!(brute(&down(0.0, 0.5), &triangle), None);
    }
}
