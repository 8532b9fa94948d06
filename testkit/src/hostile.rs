//! Sweeps that are hard to get right.

use crate::places::{direction, place, size};
use crate::random::Random;
use crate::sweeps::Sweep;
use bevy::math::DVec3;

const NAMES: [&str; 9] = [
    "random",
    "needles",
    "grazing",
    "touching at the start",
    "edges seen end on",
    "1e5 m away",
    "long ways",
    "flat ellipsoids",
    "segments and points",
];

/// How many kinds there are.
pub const KINDS: usize = NAMES.len();

/// What a kind is called.
pub fn name(kind: usize) -> &'static str {
    NAMES[kind]
}

/// One of a kind. Most of them hit.
pub fn sweep(random: &mut Random, kind: usize) -> Sweep {
    let mut radii = DVec3::new(
        size(random, 0.1, 2.0),
        size(random, 0.1, 2.0),
        size(random, 0.1, 2.0),
    );
    let mut corners = [(); 3].map(|()| place(random, 2.0));
    let mut origin = DVec3::ZERO;
    match kind {
        1 => {
            // A million times as long as wide, one short side or three points nearly in a line.
            let along = direction(random) * size(random, 1.0, 100.0);
            let width = along.length() * 1e-6;
            corners[1] = corners[0] + along;
            let part = [0.0, 1.0, random.unit()][random.below(3)];
            corners[2] = corners[0] + along * part + direction(random) * width;
        }
        5 => origin = place(random, 1e5),
        7 => radii[random.below(3)] *= 1e-3,
        8 => {
            // A segment with an end twice, a point, or three corners in a line but for rounding.
            match random.below(3) {
                0 => corners[1] = corners[0],
                1 => corners = [corners[0]; 3],
                _ => corners[2] = corners[0] + (corners[1] - corners[0]) * random.unit(),
            }
        }
        _ => {}
    }
    // A point of it that is aimed at: a corner, on an edge, or inside.
    let (u, v) = (random.unit(), random.unit());
    let (u, v) = match random.below(4) {
        0 => (0.0, 0.0),
        1 => (u, 0.0),
        _ => (u.min(1.0 - v), v.min(1.0 - u)),
    };
    let aim = corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v;
    let normal = (corners[1] - corners[0])
        .cross(corners[2] - corners[0])
        .normalize_or(DVec3::Y);
    let out = match random.below(3) {
        0 => normal,
        1 => -normal,
        _ => direction(random),
    };
    // The place where the ellipsoid touches a plane of that normal through the point.
    let weighted = out * radii;
    let touching = aim + radii * weighted / weighted.length();
    let mut way = direction(random) * size(random, 0.01, 10.0);
    if way.dot(out) > 0.0 {
        way = -way;
    }
    let mut center = touching - way * random.unit();
    match kind {
        2 => {
            // Past the plane that touches, above or below it by little.
            let side = way.reject_from(out);
            let depth = size(random, 1e-8, 1e-3) * if random.below(4) == 0 { -1.0 } else { 1.0 };
            way = side;
            center = touching - out * depth - side * random.unit();
        }
        3 => {
            center = touching;
            way -= out * way.length() * 0.1;
            if random.below(2) == 0 {
                center += out * size(random, 1e-15, 1e-6);
            }
        }
        4 => {
            // Along an edge, or in the plane of the triangle.
            let edge = corners[1] - corners[0];
            way = edge.normalize_or(DVec3::X) * (0.1 + random.unit() * 9.0);
            let beside = direction(random) * radii.min_element() * random.unit();
            center = corners[0] + beside * 0.999 - way * (0.2 + random.unit() * 0.7);
            if random.below(2) == 0 {
                center = aim + beside.reject_from(normal) - way * random.unit();
            }
        }
        6 => {
            // An hour at up to 100 m/s.
            way = way.normalize_or(DVec3::X) * size(random, 100.0, 360_000.0);
            center = touching - way * random.unit();
        }
        _ => {}
    }
    Sweep {
        center: (center + origin).to_array(),
        radii: radii.to_array(),
        way: way.to_array(),
        corners: corners.map(|corner| (corner + origin).to_array()),
    }
}
