//! Points nearest to each other, in f64: what volumes, sweeps and queries are made of.
//!
//! Metres. Every function takes finite numbers; of others it returns something, and never panics.

use bevy::math::DVec3;

/// The part of a triangle that is nearest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Feature {
    /// The inside.
    Face,
    /// The edge from corner `i` to corner `(i + 1) % 3`.
    Edge(u8),
    /// A corner.
    Vertex(u8),
}

/// The point of a segment that is nearest to `p`, as the fraction of the way from `a` to `b`.
///
/// A segment of no length answers 0. Exact up to rounding: relative error 4 ulp of the products.
#[inline]
#[must_use]
pub fn nearest_on_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let length = along.length_squared();
    if length > 0.0 {
        ((p - a).dot(along) / length).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// The sine of the two shorter edges up to which a triangle is a segment. A normal is off by rounding, 1e-16, over
/// this sine, and so is the answer whether a point lies over such a triangle, in parts of its length; without a face
/// the answer is off by its width. Both are then some 1e-8 of its length.
const SEGMENT: f64 = 1e-8;

/// The sine below which a normal is set upright on the longest edge: above it rounding tilts it by less than 1e-13.
const NEEDLE: f64 = 1e-2;

/// The normal of a triangle times twice its area, of the two shorter of its edges: the error is that of one
/// product of them, so that it stays small where one edge is much longer than another.
///
/// A triangle whose width is 1e-8 of its length or less is a segment: its normal is zero, for rounding would turn it
/// anywhere. That of a needle is at right angles to its longest edge up to rounding, so that all its corners lie in one
/// plane.
#[inline]
#[must_use]
pub fn scaled_normal(edges: [DVec3; 3]) -> DVec3 {
    let [ab, bc, ca] = edges;
    let [one, two, three] = [ab, bc, ca].map(DVec3::length_squared);
    // Each product of neighbouring edges is the same vector; the longest edge is left out.
    let (normal, longest, shorter) = if three >= one && three >= two {
        (ab.cross(bc), ca, one * two)
    } else if one >= two {
        (bc.cross(ca), ab, two * three)
    } else {
        (ca.cross(ab), bc, three * one)
    };
    if normal.length_squared() > NEEDLE * NEEDLE * shorter {
        normal
    } else {
        of_needle(normal, longest, shorter)
    }
}

/// The normal of a triangle that is long and thin; `shorter` is the product of the squares of its shorter edges.
fn of_needle(normal: DVec3, longest: DVec3, shorter: f64) -> DVec3 {
    if normal.length_squared() <= SEGMENT * SEGMENT * shorter {
        return DVec3::ZERO;
    }
    // Rounding tilts the normal in any direction. About the long axis that moves no point of so thin a triangle; along it
    // one end would come to lie above the other.
    normal - longest * (normal.dot(longest) / longest.length_squared())
}

/// The normal of a triangle, of length 1; zero of one that is a segment or a point.
#[inline]
#[must_use]
pub fn unit_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    scaled_normal([b - a, c - b, a - c]).normalize_or_zero()
}

/// The point of a triangle that is nearest to `p`, and the part that it lies on.
///
/// Holds for needles and for triangles that are segments or points: the face only counts where `p` lies over
/// it, and the edges always do.
#[inline]
#[must_use]
pub fn nearest_on_triangle(p: DVec3, corners: [DVec3; 3]) -> (DVec3, Feature) {
    let [a, b, c] = corners;
    let edges = [b - a, c - b, a - c];
    let normal = scaled_normal(edges);
    let area = normal.length_squared();
    if area > 0.0 {
        let inside = (0..3).all(|i| edges[i].cross(p - corners[i]).dot(normal) >= 0.0);
        if inside {
            let from = nearest_corner(p, corners);
            let point = p - normal * ((p - from).dot(normal) / area);
            return (point, Feature::Face);
        }
    }
    let mut best = (a, Feature::Vertex(0), f64::INFINITY);
    for i in 0..3_u8 {
        let (from, to) = (corners[usize::from(i)], corners[usize::from((i + 1) % 3)]);
        let at = nearest_on_segment(p, from, to);
        let (point, feature) = if at <= 0.0 {
            (from, Feature::Vertex(i))
        } else if at >= 1.0 {
            (to, Feature::Vertex((i + 1) % 3))
        } else {
            (from + (to - from) * at, Feature::Edge(i))
        };
        let distance = p.distance_squared(point);
        if distance < best.2 {
            best = (point, feature, distance);
        }
    }
    (best.0, best.1)
}

/// The corner from which a distance to the plane loses the least.
#[inline]
fn nearest_corner(p: DVec3, corners: [DVec3; 3]) -> DVec3 {
    let [a, b, c] = corners;
    let nearer = if p.distance_squared(a) <= p.distance_squared(b) {
        a
    } else {
        b
    };
    if p.distance_squared(nearer) <= p.distance_squared(c) {
        nearer
    } else {
        c
    }
}

/// The square of the distance of two segments.
///
/// The least of the four distances from an end to the other segment and of the one between the insides (C.
/// Ericson, Real-Time Collision Detection, 2005, 5.1.9), so that parallel segments need no case of their own.
#[must_use]
pub fn segment_segment_squared(a: [DVec3; 2], b: [DVec3; 2]) -> f64 {
    let to_segment = |p: DVec3, s: [DVec3; 2]| {
        let at = nearest_on_segment(p, s[0], s[1]);
        p.distance_squared(s[0] + (s[1] - s[0]) * at)
    };
    let mut least = to_segment(a[0], b)
        .min(to_segment(a[1], b))
        .min(to_segment(b[0], a))
        .min(to_segment(b[1], a));
    let (along_a, along_b) = (a[1] - a[0], b[1] - b[0]);
    let normal = along_a.cross(along_b);
    let area = normal.length_squared();
    if area > 0.0 {
        let between = b[0] - a[0];
        let at_a = between.cross(along_b).dot(normal) / area;
        let at_b = between.cross(along_a).dot(normal) / area;
        if (0.0..=1.0).contains(&at_a) && (0.0..=1.0).contains(&at_b) {
            let apart = between.dot(normal);
            least = least.min(apart * apart / area);
        }
    }
    least
}

/// The square of the distance of a segment to a triangle; 0 where they cross.
#[must_use]
pub fn segment_triangle_squared(segment: [DVec3; 2], corners: [DVec3; 3]) -> f64 {
    let [from, to] = segment;
    if segment_crosses(from, to, corners) {
        return 0.0;
    }
    let mut least = f64::INFINITY;
    for p in segment {
        least = least.min(p.distance_squared(nearest_on_triangle(p, corners).0));
    }
    for i in 0..3 {
        let edge = [corners[i], corners[(i + 1) % 3]];
        least = least.min(segment_segment_squared(segment, edge));
    }
    least
}

/// Whether a segment goes through the inside of a triangle.
fn segment_crosses(from: DVec3, to: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let normal = scaled_normal([b - a, c - b, a - c]);
    let (before, after) = ((from - a).dot(normal), (to - a).dot(normal));
    if before * after > 0.0 || before == after {
        return false;
    }
    let p = from + (to - from) * (before / (before - after));
    let corners = [a, b, c];
    (0..3).all(|i| {
        let edge = corners[(i + 1) % 3] - corners[i];
        edge.cross(p - corners[i]).dot(normal) >= 0.0
    })
}

/// The square of the distance of a point to a box.
#[inline]
#[must_use]
pub fn point_box_squared(p: DVec3, min: DVec3, max: DVec3) -> f64 {
    p.distance_squared(p.clamp(min, max))
}

/// The square of the distance of a segment to a box.
///
/// Along the segment it is convex and piecewise quadratic, and bends where a coordinate enters or leaves the
/// box: the root of its derivative lies in one of at most seven pieces, and is found exactly there.
#[must_use]
pub fn segment_box_squared([from, to]: [DVec3; 2], min: DVec3, max: DVec3) -> f64 {
    let along = to - from;
    let mut bends = [0.0; 8];
    let mut count = 1;
    for axis in 0..3 {
        for wall in [min[axis], max[axis]] {
            let at = (wall - from[axis]) / along[axis];
            if at > 0.0 && at < 1.0 {
                bends[count] = at;
                count += 1;
            }
        }
    }
    bends[count] = 1.0;
    let bends = &mut bends[..=count];
    bends.sort_by(f64::total_cmp);
    let slope = |at: f64| {
        let p = from + along * at;
        (p - p.clamp(min, max)).dot(along)
    };
    let mut best = bends[0];
    for pair in bends.windows(2) {
        let (low, high) = (slope(pair[0]), slope(pair[1]));
        if low >= 0.0 {
            best = pair[0];
            break;
        }
        best = pair[1];
        if high >= 0.0 {
            best = pair[0] + (pair[1] - pair[0]) * (low / (low - high));
            break;
        }
    }
    point_box_squared(from + along * best, min, max)
}
