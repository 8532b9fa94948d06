//! Rays, one or many: watertight.
//!
//! S. Woop, C. Benthin, I. Wald, Watertight Ray/Triangle Intersection, JCGT 2(1), 2013: vertices are sheared so that
//! the ray is an axis, and the signs of three edge functions say whether it passes inside. Both triangles at an edge
//! compute the same number for it but for the sign; a difference of two rounded products has the right sign unless
//! it is 0, and then the products of f32 are taken in f64, where they are exact. Edges belong to both sides, so
//! that no ray passes between.
//!
//! Which triangle is hit is decided for the ray in f32. When is worked out in f64, from the triangle's plane.

use super::cast::{Slabs, walk};
use super::{RayHit, TriangleTree};
use crate::roots::enter_box;
use crate::volume::Ray;
use bevy::math::{DVec3, Vec3};
use bevy::tasks::{ComputeTaskPool, ParallelSliceMut, TaskPool};

/// A ray as triangles of one mesh see it.
#[derive(Clone, Copy, Debug)]
struct Woop {
    /// The axis that the ray is longest along, last, and the two others.
    axes: [usize; 3],
    origin: Vec3,
    /// How much x and y are sheared for each metre of z.
    shear: [f32; 2],
    /// The same start in f64, the direction as it was given, and the time at this start.
    start: DVec3,
    direction: DVec3,
    passed: f64,
    end: f64,
}

/// How much the box around a mesh is widened before a distant ray is brought to it, as a part of its extent: the
/// start in f32 is rounded by far less.
const MARGIN: f64 = 1e-3;

impl Woop {
    /// Also gives what is traversed; `None` if the ray passes by.
    fn new(tree: &TriangleTree, ray: &Ray) -> Option<(Self, Slabs, f32)> {
        if ray.check().is_err() {
            return None;
        }
        let bounds = tree.bounds()?;
        let origin = ray.origin - tree.mesh.origin();
        let (min, max) = (
            bounds.min - tree.mesh.origin(),
            bounds.max - tree.mesh.origin(),
        );
        let size = min.abs().max(max.abs()).max_element();
        let margin = size * MARGIN + f64::from(f32::MIN_POSITIVE);
        // Only a start outside is moved: times from inside stay exact.
        let (passed, leave) =
            enter_box(min - margin - origin, max + margin - origin, ray.direction)?;
        if passed > ray.end || leave < 0.0 {
            return None;
        }
        let start = origin + ray.direction * passed;
        let longest = ray.direction.abs().max_element();
        let direction = (ray.direction / longest).as_vec3();
        let along = |axis: usize| direction[axis].abs();
        let z = (0..3).fold(0, |best, axis| {
            if along(axis) > along(best) {
                axis
            } else {
                best
            }
        });
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let woop = Self {
            axes: [x, y, z],
            origin: start.as_vec3(),
            shear: [direction[x] / direction[z], direction[y] / direction[z]],
            start,
            direction: ray.direction,
            passed,
            end: ray.end,
        };
        // The start was rounded: boxes just behind it may hold what is at it.
        let slack = (size * 1e-6) as f32 + f32::MIN_POSITIVE;
        let slabs = Slabs::new(woop.origin, direction, Vec3::ZERO, -slack);
        let end = ((ray.end - passed) * longest) as f32 * 1.000_001 + slack;
        Some((woop, slabs, end))
    }

    /// The three edge functions of a triangle, all of one sign where the ray passes it; their sum is not 0.
    #[inline(always)]
    fn weights(&self, corners: &[Vec3; 3]) -> Option<[f64; 3]> {
        let [x, y, z] = self.axes;
        let sheared = corners.map(|corner| {
            let p = corner - self.origin;
            [p[x] - self.shear[0] * p[z], p[y] - self.shear[1] * p[z]]
        });
        let [a, b, c] = sheared;
        let edge = |p: [f32; 2], q: [f32; 2]| p[0] * q[1] - p[1] * q[0];
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        let mut weights = [f64::from(u), f64::from(v), f64::from(w)];
        if u == 0.0 || v == 0.0 || w == 0.0 {
            let exact = |p: [f32; 2], q: [f32; 2]| {
                f64::from(p[0]) * f64::from(q[1]) - f64::from(p[1]) * f64::from(q[0])
            };
            weights = [exact(c, b), exact(a, c), exact(b, a)];
        }
        let [u, v, w] = weights;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let sum = u + v + w;
        (sum != 0.0 && sum.is_finite()).then_some(weights)
    }

    /// When the ray meets a triangle that it passes, and where.
    #[inline]
    fn hit(&self, corners: &[Vec3; 3], triangle: u32) -> Option<RayHit> {
        let weights = self.weights(corners)?;
        let places = corners.map(|corner| corner.as_dvec3() - self.start);
        let [a, b, c] = places;
        let normal = (b - a).cross(c - b);
        let longest = self.direction.length_squared();
        let along = places.map(|place| place.dot(self.direction) / longest);
        let (first, last) = (
            along[0].min(along[1]).min(along[2]),
            along[0].max(along[1]).max(along[2]),
        );
        // Seen nearly end on, a plane is met anywhere; the triangle is not.
        let met = a.dot(normal) / self.direction.dot(normal);
        let sum: f64 = weights.iter().sum();
        let barycentric = weights.map(|weight| weight / sum);
        let met = if met.is_finite() {
            met.clamp(first, last)
        } else {
            (0..3).map(|i| barycentric[i] * along[i]).sum()
        };
        let time = self.passed + met;
        (time >= 0.0 && time <= self.end).then_some(RayHit {
            time,
            triangle,
            barycentric,
        })
    }
}

impl TriangleTree {
    /// The first triangle that a ray hits, from either side. A ray that is not valid ([`Ray::check`]) hits nothing.
    #[must_use]
    pub fn first_hit(&self, ray: &Ray) -> Option<RayHit> {
        let (woop, slabs, last) = Woop::new(self, ray)?;
        let mut best: Option<RayHit> = None;
        let longest = ray.direction.abs().max_element();
        walk(&self.nodes, &slabs, last, |range| {
            for (corners, &triangle) in self.corners[range.clone()].iter().zip(&self.order[range]) {
                let Some(hit) = woop.hit(corners, triangle) else {
                    continue;
                };
                if best.is_none_or(|known| {
                    hit.time < known.time || (hit.time == known.time && triangle < known.triangle)
                }) {
                    best = Some(hit);
                }
            }
            // Rounded up, as above: a triangle at the same time may have a lower number.
            best.map_or(last, |hit| {
                let end = ((hit.time - woop.passed) * longest) as f32;
                last.min(end + end.abs() * 1e-6 - slabs.begin())
            })
        });
        best
    }

    /// Whether a ray hits anything: sooner known than what it hits first.
    #[must_use]
    pub fn blocked(&self, ray: &Ray) -> bool {
        let Some((woop, slabs, last)) = Woop::new(self, ray) else {
            return false;
        };
        let mut found = false;
        walk(&self.nodes, &slabs, last, |range| {
            found = found
                || self.corners[range]
                    .iter()
                    .any(|corners| woop.hit(corners, 0).is_some());
            if found { f32::NEG_INFINITY } else { last }
        });
        found
    }

    /// Many rays, on all cores; an answer for each, the same as of [`Self::first_hit`]. As many rays as answers are
    /// looked at: of different numbers the smaller.
    pub fn first_hits(&self, rays: &[Ray], hits: &mut [Option<RayHit>]) {
        // Some 100 µs a task.
        const TASK: usize = 512;
        let count = rays.len().min(hits.len());
        let (rays, mut hits) = (&rays[..count], &mut hits[..count]);
        let answer = |first: usize, part: &mut [Option<RayHit>]| {
            for (hit, ray) in part.iter_mut().zip(&rays[first..]) {
                *hit = self.first_hit(ray);
            }
        };
        if count <= TASK {
            return answer(0, hits);
        }
        let pool = ComputeTaskPool::get_or_init(TaskPool::default);
        hits.par_chunk_map_mut(pool, TASK, |chunk, part| answer(chunk * TASK, part));
    }
}
