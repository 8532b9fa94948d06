//! Whether two volumes overlap.
//!
//! Each pair has its own formula. Pairs with an ellipsoid are worked out where it is a unit sphere, except for
//! spheres and capsules, which would not stay what they are: there the distance to the ellipsoid counts.

use super::ellipsoid::{Ellipsoid, half_axes};
use super::shape::{Aabb, Capsule, Sphere, Volume};
use crate::geometry::{point_box_squared, segment_box_squared, segment_segment_squared};
use bevy::math::{DMat3, DVec3};

impl Volume {
    /// Whether two volumes have a point in common; touching counts. A volume that is not valid overlaps nothing.
    ///
    /// Decided in f64: right where the gap or the depth is more than some 1e-14 of the sizes and distances.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        use Volume::{Aabb as B, Capsule as C, Ellipsoid as E, Sphere as S};
        if !self.is_valid() || !other.is_valid() {
            return false;
        }
        match (self, other) {
            (S(a), S(b)) => within(a.center.distance_squared(b.center), a.radius + b.radius),
            (S(s), B(b)) | (B(b), S(s)) => {
                within(point_box_squared(s.center, b.min, b.max), s.radius)
            }
            (S(s), C(c)) | (C(c), S(s)) => {
                within(c.distance_squared(s.center), s.radius + c.radius)
            }
            (S(s), E(e)) | (E(e), S(s)) => e.distance(s.center) <= s.radius,
            (B(a), B(b)) => a.min.cmple(b.max).all() && b.min.cmple(a.max).all(),
            (B(b), C(c)) | (C(c), B(b)) => {
                within(segment_box_squared(c.segment, b.min, b.max), c.radius)
            }
            (B(b), E(e)) | (E(e), B(b)) => ellipsoid_box(e, b),
            (C(a), C(b)) => within(
                segment_segment_squared(a.segment, b.segment),
                a.radius + b.radius,
            ),
            (C(c), E(e)) | (E(e), C(c)) => ellipsoid_capsule(e, c),
            (E(a), E(b)) => ellipsoid_ellipsoid(a, b),
        }
    }
}

impl Sphere {
    /// Whether it overlaps another volume.
    #[must_use]
    pub fn overlaps(&self, other: &Volume) -> bool {
        Volume::Sphere(*self).overlaps(other)
    }
}

fn within(squared: f64, distance: f64) -> bool {
    squared <= distance * distance
}

/// Where the first is a unit sphere the second is an ellipsoid still.
fn ellipsoid_ellipsoid(a: &Ellipsoid, b: &Ellipsoid) -> bool {
    let to_unit = a.to_unit();
    let (radii, rotation) = half_axes(to_unit * b.axes());
    let image = Ellipsoid {
        center: to_unit * (b.center - a.center),
        radii,
        rotation,
    };
    image.distance(DVec3::ZERO) <= 1.0
}

/// The distance to the ellipsoid is convex along the segment: its least value is found by halving where its slope
/// changes sign. Each half of 60 is a factor 2 of the place, of which the value depends in the square.
fn ellipsoid_capsule(e: &Ellipsoid, c: &Capsule) -> bool {
    let [from, to] = c.segment;
    let along = to - from;
    let at = |time: f64| e.outward(from + along * time);
    let reached = |out: DVec3| out.length_squared() <= c.radius * c.radius;
    let (mut low, mut high) = (0.0, 1.0);
    let (first, last) = (at(low), at(high));
    if reached(first) || reached(last) {
        return true;
    }
    if first.dot(along) >= 0.0 || last.dot(along) <= 0.0 {
        return false;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let out = at(middle);
        if reached(out) {
            return true;
        }
        if out.dot(along) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    false
}

/// The least |U (x − c)| over the box: at its inside, on one of its faces or edges, or at a corner. For each of
/// these 27 the place is found where the box is not limited, and then taken into the box: none is nearer than the
/// nearest, and one of them is it.
fn ellipsoid_box(e: &Ellipsoid, b: &Aabb) -> bool {
    let to_unit = e.to_unit();
    let (min, max) = (b.min - e.center, b.max - e.center);
    if min.cmple(DVec3::ZERO).all() && max.cmpge(DVec3::ZERO).all() {
        return true;
    }
    let squares = to_unit.transpose() * to_unit;
    for code in 0..26 {
        let choice = [code % 3, code / 3 % 3, code / 9];
        let mut place = DVec3::ZERO;
        for axis in 0..3 {
            place[axis] = [min[axis], max[axis], 0.0][choice[axis]];
        }
        let free = choice.map(|kind| kind == 2);
        let place = least_along(&squares, place, free).clamp(min, max);
        if (to_unit * place).length_squared() <= 1.0 {
            return true;
        }
    }
    false
}

/// Where xᵀ H x is least if the coordinates that are `free` may move.
fn least_along(h: &DMat3, mut x: DVec3, free: [bool; 3]) -> DVec3 {
    let axes: Vec3Axes = free_axes(free);
    match axes {
        (Some(i), None) => {
            x[i] = 0.0;
            x[i] = -(h.row(i).dot(x)) / h.col(i)[i];
        }
        (Some(i), Some(j)) => {
            (x[i], x[j]) = (0.0, 0.0);
            let (p, q) = (-h.row(i).dot(x), -h.row(j).dot(x));
            let (a, b, d) = (h.col(i)[i], h.col(i)[j], h.col(j)[j]);
            let determinant = a * d - b * b;
            x[i] = (p * d - q * b) / determinant;
            x[j] = (q * a - p * b) / determinant;
        }
        _ => {}
    }
    x
}

/// One or two free axes.
type Vec3Axes = (Option<usize>, Option<usize>);

fn free_axes(free: [bool; 3]) -> Vec3Axes {
    let mut axes = (0..3).filter(|&axis| free[axis]);
    (axes.next(), axes.next())
}
