//! Ambient occlusion by rays.
//!
//! ```text
//! A(p, n) = 1/π ∫_{n·l > 0} V(p, l) (n·l) dl
//! ```
//!
//! `V` is 1 where a ray from `p` along `l` meets nothing within a distance. Rays that are distributed as the cosine
//! (Malley's method: a uniform disc, lifted to the sphere) make it the share of them that get away.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use glam::DVec3;

use crate::random::{Random, hammersley};
use crate::trace::{Ray, Tracer};

/// How occlusion is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Occlusion {
    /// Rays a point. The standard deviation of independent rays is `√(A (1 − A) / rays)`, at most 0.0078 for 4096.
    pub rays: u32,
    /// What is further away blocks nothing, in metres.
    pub distance: f64,
    /// Of the rays; each point has its own.
    pub seed: u64,
    /// Rays of a Hammersley set, whose error falls nearly as 1/n; else independent ones, whose error falls as 1/√n.
    pub even: bool,
}

impl Default for Occlusion {
    fn default() -> Self {
        Self {
            rays: 4096,
            distance: f64::INFINITY,
            seed: 0,
            even: true,
        }
    }
}

/// The share `0..=1` of the light from everywhere that reaches a point with this unit normal; the face's normal says on
/// which side of the surface the rays start.
pub fn occlusion(
    tracer: &Tracer,
    position: DVec3,
    normal: DVec3,
    face: DVec3,
    how: &Occlusion,
) -> f64 {
    let seed = [position.x, position.y, position.z]
        .iter()
        .fold(how.seed, |seed, x| Random::new(seed ^ x.to_bits()).bits());
    let mut random = Random::new(seed);
    let shift = [random.unit(), random.unit()];
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let lift = 1e-9 * position.abs().max_element().max(1.0);
    let origin = position + lift.copysign(face.dot(normal)) * face;
    let mut free = 0_u32;
    for i in 0..how.rays {
        let square = if how.even {
            hammersley(i, how.rays, shift)
        } else {
            [random.unit(), random.unit()]
        };
        let [x, y] = disc(square);
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        let direction = x * tangent + y * bitangent + z * normal;
        free += u32::from(!tracer.blocked(&Ray::new(origin, direction), 0.0, how.distance));
    }
    f64::from(free) / f64::from(how.rays)
}

/// A point of the unit square as one of the unit disc, areas kept, neighbours kept (Shirley and Chiu, "A low distortion
/// map between disk and square", 1997).
pub fn disc(square: [f64; 2]) -> [f64; 2] {
    let [a, b] = square.map(|x| 2.0 * x - 1.0);
    let (r, angle) = if a.abs() > b.abs() {
        (a, FRAC_PI_4 * (b / a))
    } else if b != 0.0 {
        (b, FRAC_PI_2 - FRAC_PI_4 * (a / b))
    } else {
        return [0.0; 2];
    };
    let (sin, cos) = angle.sin_cos();
    [r * cos, r * sin]
}

/// A point of the unit square as a direction of the unit sphere about +Z, evenly: z is uniform, and the angle.
pub fn sphere(square: [f64; 2]) -> DVec3 {
    let z = 1.0 - 2.0 * square[0];
    let (sin, cos) = (TAU * square[1]).sin_cos();
    let r = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(r * cos, r * sin, z)
}
