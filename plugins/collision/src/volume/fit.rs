//! The smallest volumes around points; ellipsoids by `fit_ellipsoid.rs`.
//!
//! | volume | how small |
//! |---|---|
//! | box | smallest |
//! | sphere | smallest, up to rounding |
//! | ellipsoid | volume within 0.2 % of the smallest |
//! | capsule | for its direction, the smallest radius and then the shortest; of the directions tried the one of least volume |
//!
//! All of them hold every point: what rounding left outside is taken in at the end.

use super::ellipsoid::half_axes;
use super::shape::{Aabb, Capsule, Sphere};
use bevy::math::{DMat3, DVec3};
use thiserror::Error;

/// Points that nothing is put around.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum FitError {
    /// None at all.
    #[error("there are no points to be put into a volume")]
    Empty,
    /// One is no place.
    #[error("point {0} is not finite")]
    NotFinite(usize),
}

pub(super) fn check(points: &[DVec3]) -> Result<(), FitError> {
    if points.is_empty() {
        return Err(FitError::Empty);
    }
    match points.iter().position(|point| !point.is_finite()) {
        Some(index) => Err(FitError::NotFinite(index)),
        None => Ok(()),
    }
}

/// A little more than `x`: room for the rounding of the test by which points are found inside.
pub(super) fn grown(x: f64) -> f64 {
    x * (1.0 + 4.0 * f64::EPSILON)
}

impl Aabb {
    /// The box around points.
    ///
    /// # Errors
    /// [`FitError`].
    pub fn fit(points: &[DVec3]) -> Result<Self, FitError> {
        check(points)?;
        let first = Self {
            min: points[0],
            max: points[0],
        };
        Ok(points.iter().fold(first, |all, &point| Self {
            min: all.min.min(point),
            max: all.max.max(point),
        }))
    }
}

impl Sphere {
    /// The smallest sphere around points.
    ///
    /// The point that is farthest outside is taken into the few on which the sphere rests, until none is outside
    /// (B. Gärtner, Fast and Robust Smallest Enclosing Balls, 1999): some ten passes over the points.
    ///
    /// # Errors
    /// [`FitError`].
    pub fn fit(points: &[DVec3]) -> Result<Self, FitError> {
        check(points)?;
        // Relative to one of them, so that small sets far away keep their digits.
        let origin = points[0];
        let near: Vec<DVec3> = points.iter().map(|&point| point - origin).collect();
        let center = origin + smallest(&near).center;
        let (_, distance) = farthest_from(center, points);
        let radius = grown(distance);
        Ok(Self { center, radius })
    }
}

/// The smallest sphere, but for points that rounding left outside.
fn smallest(points: &[DVec3]) -> Sphere {
    let mut support = vec![points[0]];
    let mut sphere = Sphere {
        center: points[0],
        radius: 0.0,
    };
    loop {
        let (farthest, distance) = farthest_from(sphere.center, points);
        if distance <= sphere.radius {
            return sphere;
        }
        support.push(farthest);
        let found = smallest_around(&mut support);
        // Its radius grows with each point, until rounding ends that.
        if found.radius <= sphere.radius {
            return sphere;
        }
        sphere = found;
    }
}

fn farthest_from(center: DVec3, points: &[DVec3]) -> (DVec3, f64) {
    let mut best = (center, 0.0);
    for &point in points {
        let squared = center.distance_squared(point);
        if squared > best.1 {
            best = (point, squared);
        }
    }
    (best.0, best.1.sqrt())
}

/// The smallest sphere around at most five points, which are reduced to those that it rests on: the smallest of
/// those through two, three or four of them that hold the others.
fn smallest_around(points: &mut Vec<DVec3>) -> Sphere {
    let mut best: Option<(Sphere, u32)> = None;
    for chosen in 1..1_u32 << points.len() {
        if !(2..=4).contains(&chosen.count_ones()) {
            continue;
        }
        let some: Vec<DVec3> = (0..points.len())
            .filter(|i| chosen >> i & 1 == 1)
            .map(|i| points[i])
            .collect();
        let Some(sphere) = through(&some) else {
            continue;
        };
        // Points that it was not made of may stand on it.
        let room = sphere.radius * (1.0 + 1e-12);
        let holds = points
            .iter()
            .all(|point| point.distance(sphere.center) <= room);
        if holds && best.is_none_or(|(known, _)| sphere.radius < known.radius) {
            best = Some((sphere, chosen));
        }
    }
    let Some((sphere, chosen)) = best else {
        // Points that are all but one: around their box.
        let (mut min, mut max) = (points[0], points[0]);
        for &point in points.iter() {
            (min, max) = (min.min(point), max.max(point));
        }
        points.truncate(4);
        return Sphere {
            center: (min + max) * 0.5,
            radius: min.distance(max) * 0.5,
        };
    };
    let mut index = 0;
    points.retain(|_| {
        index += 1;
        chosen >> (index - 1) & 1 == 1
    });
    sphere
}

/// The sphere through two to four points with its centre in their hull's plane; `None` where they are in a line or
/// a plane too many.
fn through(points: &[DVec3]) -> Option<Sphere> {
    let origin = points[0];
    let mut arms = [DVec3::ZERO; 3];
    for (arm, point) in arms.iter_mut().zip(&points[1..]) {
        *arm = *point - origin;
    }
    let count = points.len() - 1;
    // Where |x|² = |x − arm|², x being a sum of the arms. Axes without an arm stay 0.
    let entry = |i: usize, j: usize| match (i < count && j < count, i == j) {
        (true, _) => 2.0 * arms[i].dot(arms[j]),
        (false, same) => f64::from(u8::from(same)),
    };
    let column = |j: usize| DVec3::new(entry(0, j), entry(1, j), entry(2, j));
    let matrix = DMat3::from_cols(column(0), column(1), column(2));
    let right = DVec3::from_array(arms.map(DVec3::length_squared));
    // The determinant is the square of a volume; below rounding the arms lie in a plane.
    let size = (0..count).fold(1.0, |size, i| size * matrix.col(i)[i]);
    let determinant = matrix.determinant();
    if determinant.abs() <= 1e-13 * size || size == 0.0 {
        return None;
    }
    let parts = matrix.inverse() * right;
    let center = (0..3).fold(DVec3::ZERO, |sum, i| sum + arms[i] * parts[i]);
    Some(Sphere {
        center: origin + center,
        radius: center.length(),
    })
}

impl Capsule {
    /// A small capsule around points: see the head of this file.
    ///
    /// # Errors
    /// [`FitError`].
    pub fn fit(points: &[DVec3]) -> Result<Self, FitError> {
        check(points)?;
        let middle = points.iter().sum::<DVec3>() / points.len() as f64;
        let mut tried = DVec3::AXES.to_vec();
        let spread = spread(points, middle);
        let (_, turn) = half_axes(spread);
        tried.extend(DVec3::AXES.map(|axis| turn * axis));
        let (one, _) = farthest_from(middle, points);
        let (two, _) = farthest_from(one, points);
        tried.push((two - one).normalize_or(DVec3::X));
        let volume = |direction: DVec3| {
            let capsule = along(points, direction);
            (capsule.volume(), capsule)
        };
        let mut best = (f64::INFINITY, DVec3::X);
        for direction in tried {
            let (size, _) = volume(direction);
            if size < best.0 {
                best = (size, direction);
            }
        }
        // Turned by less and less while that makes it smaller: 0.25 rad to 2⁻¹⁴.
        let mut step = 0.25;
        while step > 1e-4 {
            let (u, v) = best.1.any_orthonormal_pair();
            let turned = [u, v, -u, -v].map(|side| (best.1 + side * step).normalize());
            let better = turned
                .into_iter()
                .map(|direction| (volume(direction).0, direction))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            match better {
                Some(found) if found.0 < best.0 => best = found,
                _ => step *= 0.5,
            }
        }
        let mut capsule = along(points, best.1);
        let outside = points
            .iter()
            .map(|&point| capsule.distance_squared(point))
            .fold(0.0, f64::max)
            .sqrt();
        capsule.radius = capsule.radius.max(grown(outside));
        Ok(capsule)
    }

    /// Cubic metres.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let [a, b] = self.segment;
        let section = std::f64::consts::PI * self.radius * self.radius;
        section * (a.distance(b) + self.radius * (4.0 / 3.0))
    }
}

/// The sum of squares of points about their middle.
pub(super) fn spread(points: &[DVec3], middle: DVec3) -> DMat3 {
    points.iter().fold(DMat3::ZERO, |sum, &point| {
        let p = point - middle;
        sum + DMat3::from_cols(p * p.x, p * p.y, p * p.z)
    })
}

/// The capsule along a direction: the smallest circle around the points as seen along it, and then the caps pushed
/// together until they meet a point.
fn along(points: &[DVec3], direction: DVec3) -> Capsule {
    let (u, v) = direction.any_orthonormal_pair();
    let seen: Vec<DVec3> = points
        .iter()
        .map(|point| DVec3::new(point.dot(u), point.dot(v), 0.0))
        .collect();
    let circle = Sphere::fit(&seen).unwrap_or(Sphere {
        center: DVec3::ZERO,
        radius: 0.0,
    });
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (point, flat) in points.iter().zip(&seen) {
        let cap = circle.radius * circle.radius - flat.distance_squared(circle.center);
        let (cap, at) = (cap.max(0.0).sqrt(), point.dot(direction));
        low = low.min(at + cap);
        high = high.max(at - cap);
    }
    if low > high {
        low = (low + high) * 0.5;
        high = low;
    }
    let foot = u * circle.center.x + v * circle.center.y;
    Capsule {
        segment: [foot + direction * low, foot + direction * high],
        radius: circle.radius,
    }
}
