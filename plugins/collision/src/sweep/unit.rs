//! The sphere of radius 1 around the origin against one triangle: when it touches, and where.
//!
//! Conventions: everything is in the space where the ellipsoid is that sphere, relative to its centre at the start.
//! A time is a part of the way, 0 to 1. A normal points from the triangle to the sphere's centre.
//!
//! The places of a centre that touches are the triangle made rounder by 1: two faces, three cylinders, three
//! spheres. It is convex, so the distance to the triangle is a convex function of time: once a centre moves away
//! it never comes back, and the first of all parts that are entered is where it touches.

use crate::geometry::{Feature, nearest_on_triangle, scaled_normal};
use crate::roots::{enter_cylinder, enter_sphere};
use bevy::math::{DMat3, DVec3};

/// Moving along a surface by less than this part of the way into it is moving along it: rounding of a direction
/// that was made to lie in a plane is some 1e-16.
pub const PARALLEL: f64 = 1e-13;

/// A triangle, relative to the sphere's centre.
#[derive(Clone, Copy, Debug)]
pub struct UnitTriangle {
    /// Its corners.
    pub corners: [DVec3; 3],
    /// From each corner to the next, of the differences of the places as given: those of short edges far away
    /// would lose their digits here.
    pub edges: [DVec3; 3],
}

impl UnitTriangle {
    /// Of corners as they are given, a centre there, and the map to unit space.
    #[inline]
    #[must_use]
    pub fn new(corners: [DVec3; 3], center: DVec3, to_unit: &DMat3) -> Self {
        let [a, b, c] = corners;
        Self {
            corners: corners.map(|corner| *to_unit * (corner - center)),
            edges: [*to_unit * (b - a), *to_unit * (c - b), *to_unit * (a - c)],
        }
    }
}

/// A sphere that touches a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitTouch {
    /// When.
    pub time: f64,
    /// From the triangle to the centre, of length 1.
    pub normal: DVec3,
    /// Where.
    pub point: DVec3,
    /// What part of the triangle.
    pub feature: Feature,
    /// How far the sphere reaches over it at the start, 0 of one that did not touch.
    pub depth: f64,
}

/// When the sphere touches the triangle on its `way`, if it moves into it.
///
/// One that touches or overlaps at the start does so at time 0, unless it moves along the surface or away.
#[inline]
#[must_use]
pub fn sweep(triangle: &UnitTriangle, way: DVec3) -> Option<UnitTouch> {
    let corners = triangle.corners;
    let normal = scaled_normal(triangle.edges);
    let area = normal.length_squared();
    let mut up = DVec3::ZERO;
    let (mut height, mut climb) = (0.0, 0.0);
    if area > 0.0 {
        // The triangle's plane, seen from the side of the start.
        up = normal / area.sqrt();
        height = -lowest(corners).dot(up);
        climb = way.dot(up);
        if height < 0.0 {
            (up, height, climb) = (-up, -height, -climb);
        }
        // All of the way on one side and too far from it. What rounding may do to a height is far below 1e-6, for corners
        // of needles too; segments have no plane.
        if height.min(height + climb) > 1.0 + 1e-6 {
            return None;
        }
    }
    if let Some(touch) = start(triangle, way, up, height) {
        return touch;
    }
    if area > 0.0 && height >= 1.0 - 1e-12 && climb < 0.0 {
        // Below 1 only by rounding: otherwise it would have touched at the start.
        let time = (height - 1.0).max(0.0) / -climb;
        if time > 1.0 {
            return None;
        }
        let point = way * time - up;
        let inside = (0..3).all(|i| {
            let side = triangle.edges[i].cross(point - corners[i]);
            side.dot(normal) >= 0.0
        });
        if inside {
            return Some(UnitTouch {
                time,
                normal: up,
                point,
                feature: Feature::Face,
                depth: 0.0,
            });
        }
    }
    rim(triangle, way)
}

/// The corner from which a plane's height loses the least: that nearest to the origin.
#[inline]
fn lowest([a, b, c]: [DVec3; 3]) -> DVec3 {
    let nearer = if a.length_squared() <= b.length_squared() {
        a
    } else {
        b
    };
    if nearer.length_squared() <= c.length_squared() {
        nearer
    } else {
        c
    }
}

/// What is decided at the start: a touch at once, or that there is none at all; `None` if the sphere is apart.
#[inline]
fn start(triangle: &UnitTriangle, way: DVec3, up: DVec3, height: f64) -> Option<Option<UnitTouch>> {
    if height > 1.0 {
        return None;
    }
    let (point, feature) = nearest_on_triangle(DVec3::ZERO, triangle.corners);
    let distance = point.length();
    if distance > 1.0 {
        return None;
    }
    // A centre in the triangle is pushed back to where it came from.
    let back = if way.dot(up) > 0.0 { -up } else { up };
    let normal = (-point / distance).try_normalize().unwrap_or(back);
    let into = way.dot(normal) < -PARALLEL * way.length();
    Some(into.then_some(UnitTouch {
        time: 0.0,
        normal,
        point,
        feature,
        depth: 1.0 - distance,
    }))
}

/// The first of edges and corners.
#[inline]
fn rim(triangle: &UnitTriangle, way: DVec3) -> Option<UnitTouch> {
    let corners = triangle.corners;
    let mut best: Option<(f64, Feature, DVec3)> = None;
    let mut first = |time: f64, feature: Feature, point: DVec3| {
        if time <= 1.0 && best.is_none_or(|(known, ..)| time < known) {
            best = Some((time, feature, point));
        }
    };
    for i in 0..3_u8 {
        let (corner, edge) = (corners[usize::from(i)], triangle.edges[usize::from(i)]);
        if let Some((time, along)) = enter_cylinder(corner, edge, way, 1.0)
            && (0.0..=1.0).contains(&along)
        {
            first(time, Feature::Edge(i), corner + edge * along);
        }
        if let Some(time) = enter_sphere(corner, way, 1.0) {
            first(time, Feature::Vertex(i), corner);
        }
    }
    let (time, feature, point) = best?;
    let normal = (way * time - point).normalize_or_zero();
    // Entering means moving in, but for rounding where it only grazes.
    (normal != DVec3::ZERO).then_some(UnitTouch {
        time,
        normal,
        point,
        feature,
        depth: 0.0,
    })
}
