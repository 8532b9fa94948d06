//! When a point that moves in a straight line comes within a distance of a point or of a line: the roots of
//! quadratic equations, without the cancellation of the usual formula.
//!
//! With a the centre relative to the start, d the way and r the distance, |t d − a| = r has the discriminant
//! d² (r² − h²), where h = |a × d| / |d| is how far the line passes by. Written with the cross product it keeps its
//! digits where b² − 4ac loses them: for long ways and for those that graze. The root is taken as c / (b + √…), whose
//! terms have the same sign.

use bevy::math::DVec3;

/// What starts inside by less than this part of the squared distance starts on the surface: whether it is inside was
/// decided before, by other formulas, and rounding must not let it fall between both.
const ON: f64 = 1e-12;

/// When, in parts of the way `d`, a point that starts at the origin enters the sphere around `a`; `None` if it
/// never does, or starts inside.
#[inline]
#[must_use]
pub fn enter_sphere(a: DVec3, d: DVec3, radius: f64) -> Option<f64> {
    let toward = a.dot(d);
    let outside = (a.length() - radius) * (a.length() + radius);
    if toward <= 0.0 || outside < -ON * radius * radius {
        return None;
    }
    let discriminant = d.length_squared() * radius * radius - a.cross(d).length_squared();
    if discriminant < 0.0 {
        return None;
    }
    Some(outside.max(0.0) / (toward + discriminant.sqrt()))
}

/// When it enters the endless cylinder around the line through `a` along `e`, and where on the line that is, in
/// parts of `e`; `None` if it never does, starts inside, or moves along it.
#[inline]
#[must_use]
pub fn enter_cylinder(a: DVec3, e: DVec3, d: DVec3, radius: f64) -> Option<(f64, f64)> {
    let length = e.length_squared();
    if length <= 0.0 {
        return None;
    }
    // The parts across the line.
    let along_d = d.dot(e) / length;
    let across = d - e * along_d;
    let along_a = a.dot(e) / length;
    let start = a - e * along_a;
    let toward = start.dot(across);
    let far = start.length();
    let outside = (far - radius) * (far + radius);
    if toward <= 0.0 || outside < -ON * radius * radius {
        return None;
    }
    let discriminant =
        across.length_squared() * radius * radius - start.cross(across).length_squared();
    if discriminant < 0.0 {
        return None;
    }
    let t = outside.max(0.0) / (toward + discriminant.sqrt());
    Some((t, t * along_d - along_a))
}

/// When it enters a box that is given relative to the start, and when it leaves it; `None` if it does not meet it.
/// From inside it enters at once.
#[inline]
#[must_use]
pub fn enter_box(min: DVec3, max: DVec3, d: DVec3) -> Option<(f64, f64)> {
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        if d[axis] == 0.0 {
            if min[axis] > 0.0 || max[axis] < 0.0 {
                return None;
            }
            continue;
        }
        let (one, two) = (min[axis] / d[axis], max[axis] / d[axis]);
        enter = enter.max(one.min(two));
        leave = leave.min(one.max(two));
    }
    (enter <= leave).then_some((enter, leave))
}
