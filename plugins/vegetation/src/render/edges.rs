//! Which triangle holds a place: the functions of `shaders/src/vegetation/edges.wgsl`, in Rust. Corners and places are
//! whole steps of 2⁻¹² m seen from above.

use bevy::math::{DVec3, Vec2};

use super::layout::STEPS;

/// Farthest that a corner counts, metres.
const FARTHEST: f32 = 131_072.0;

/// Steps of a place relative to the anchor.
#[must_use]
pub fn to_steps(metres: Vec2) -> [i32; 2] {
    let part = |x: f32| (x.clamp(-FARTHEST, FARTHEST) * STEPS as f32).round_ties_even() as i32;
    [part(metres.x), part(metres.y)]
}

/// Twice the signed area of (a, b, p).
#[must_use]
pub fn side_of(a: [i32; 2], b: [i32; 2], p: [i32; 2]) -> i128 {
    let of = |k: [i32; 2], axis: usize| i128::from(k[axis]) - i128::from(a[axis]);
    of(b, 0) * of(p, 1) - of(b, 1) * of(p, 0)
}

/// Whether a place on the line from a to b belongs to this side.
const fn owns(a: [i32; 2], b: [i32; 2]) -> bool {
    b[1] > a[1] || (b[1] == a[1] && b[0] < a[0])
}

/// Whether a triangle, whichever way round it goes, holds a place.
#[must_use]
pub fn holds([a, mut b, mut c]: [[i32; 2]; 3], p: [i32; 2]) -> bool {
    match side_of(a, b, c) {
        0 => return false,
        1.. => {}
        _ => (b, c) = (c, b),
    }
    [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| {
        let side = side_of(from, to, p);
        side > 0 || (side == 0 && owns(from, to))
    })
}

/// Height of the triangle's plane at a place, f64.
#[must_use]
pub fn height_at([a, b, c]: [DVec3; 3], x: f64, z: f64) -> f64 {
    let normal = (b - a).cross(c - a);
    a.y - (normal.x * (x - a.x) + normal.z * (z - a.z)) / normal.y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_on_a_shared_edge_or_corner_is_in_one_triangle() {
        // A fan about the origin whose corners are multiples of what lies on its edges.
        let corners = [
            [8, 0],
            [8, 8],
            [0, 8],
            [-8, 8],
            [-8, 0],
            [-8, -8],
            [0, -8],
            [8, -8],
        ];
        for x in -6..=6 {
            for z in -6..=6 {
                let found = (0..8)
                    .filter(|&k| holds([[0, 0], corners[k], corners[(k + 1) % 8]], [x, z]))
                    .count();
                assert_eq!(found, 1, "({x}, {z})");
            }
        }
    }
}
