//! An oracle of swept ellipsoids: when one first touches a triangle, by halving, in double-double numbers.
//!
//! Where the ellipsoid is a unit sphere the distance of its centre to the triangle is a convex function of time.
//! Its least value is found by halving where its slope changes sign, and then the time at which it is 1 before
//! that. Nothing is solved in closed form, and the nearest point is sought by another way than plugins do.

use crate::double_double::{Dd, Dd3};

/// What the oracle says of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swept {
    /// The distance at the start, in radii.
    pub start: f64,
    /// The least distance on the way, in radii: below 1 it is hit.
    pub least: f64,
    /// When it touches, in parts of the way; of one that does not, when it is nearest.
    pub time: f64,
    /// Normal of the ellipsoid at the contact, in the world, of length 1; zero where the centre is on the triangle.
    pub normal: [f64; 3],
    /// How fast the distance falls there, in parts of the way's length: 1 straight on, 0 where it grazes.
    pub rate: f64,
}

/// An upright ellipsoid of these radii that moves from a place along a way, and a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Sweep {
    /// Where its centre starts.
    pub center: [f64; 3],
    /// Along the coordinate axes.
    pub radii: [f64; 3],
    /// Where it moves.
    pub way: [f64; 3],
    /// The triangle's corners.
    pub corners: [[f64; 3]; 3],
}

/// The nearest point of a triangle to `p`: of its edges, and of its plane where the three parts by area are above 0.
fn nearest(p: Dd3, corners: &[Dd3; 3]) -> Dd3 {
    let mut best: Option<(Dd, Dd3)> = None;
    let mut offer = |point: Dd3| {
        let apart = point - p;
        let squared = apart.dot(apart);
        if best.is_none_or(|(known, _)| squared < known) {
            best = Some((squared, point));
        }
    };
    for i in 0..3 {
        let (from, to) = (corners[i], corners[(i + 1) % 3]);
        let edge = to - from;
        let length = edge.dot(edge);
        offer(from);
        if length.0 > 0.0 {
            let at = (p - from).dot(edge) / length;
            if at.0 > 0.0 && at < Dd::ONE {
                offer(from + edge.times(at));
            }
        }
    }
    // Barycentric coordinates by the normal equations.
    let (u, v) = (corners[1] - corners[0], corners[2] - corners[0]);
    let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
    let determinant = uu * vv - uv * uv;
    if determinant.0 > 0.0 {
        let w = p - corners[0];
        let (pu, pv) = (w.dot(u), w.dot(v));
        let (s, t) = (
            (vv * pu - uv * pv) / determinant,
            (uu * pv - uv * pu) / determinant,
        );
        if s.0 >= 0.0 && t.0 >= 0.0 && s + t <= Dd::ONE {
            offer(corners[0] + u.times(s) + v.times(t));
        }
    }
    best.map_or(corners[0], |(_, point)| point)
}

/// Asks the oracle. All numbers have to be finite and radii above 0.
#[must_use]
pub fn swept(sweep: &Sweep) -> Swept {
    let radii = Dd3::new(sweep.radii);
    let center = Dd3::new(sweep.center);
    let corners = sweep
        .corners
        .map(|corner| (Dd3::new(corner) - center).over(radii));
    let way = Dd3::new(sweep.way).over(radii);
    let out = |time: Dd| {
        let p = way.times(time);
        p - nearest(p, &corners)
    };
    let distance = |time: Dd| {
        let out = out(time);
        out.dot(out).sqrt()
    };
    let half = Dd::from(0.5);
    // Where it is nearest.
    let falls = |time: Dd| out(time).dot(way).0 < 0.0;
    let mut nearest_time = Dd::ZERO;
    if falls(Dd::ZERO) {
        let (mut low, mut high) = (Dd::ZERO, Dd::ONE);
        if falls(high) {
            low = high;
        }
        for _ in 0..90 {
            let middle = (low + high) * half;
            if falls(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        nearest_time = high;
    }
    let (start, least) = (distance(Dd::ZERO), distance(nearest_time));
    let mut time = nearest_time;
    if least < Dd::ONE {
        let (mut low, mut high) = (Dd::ZERO, nearest_time);
        if start <= Dd::ONE {
            high = Dd::ZERO;
        }
        for _ in 0..90 {
            let middle = (low + high) * half;
            if distance(middle) > Dd::ONE {
                low = middle;
            } else {
                high = middle;
            }
        }
        time = high;
    }
    let out = out(time);
    let length = out.dot(out).sqrt();
    let world = out.over(radii);
    let size = world.dot(world).sqrt();
    let normal = if size.0 > 0.0 {
        world.over(Dd3([size; 3])).to_f64()
    } else {
        [0.0; 3]
    };
    let way_length = way.dot(way).sqrt();
    let rate = if length.0 > 0.0 && way_length.0 > 0.0 {
        -(out.dot(way) / (length * way_length)).0
    } else {
        0.0
    };
    Swept {
        start: start.0,
        least: least.0,
        time: time.0,
        normal,
        rate,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_is_found() {
        // A sphere of 2 m falls 10 m onto a floor 5 m below its centre: after 3 m.
        let floor = [[-9.0, -5.0, 9.0], [9.0, -5.0, 9.0], [0.0, -5.0, -9.0]];
        let mut sweep = Sweep {
            center: [0.0; 3],
            radii: [2.0; 3],
            way: [0.0, -10.0, 0.0],
            corners: floor,
        };
        let found = swept(&sweep);
        assert!((found.time - 0.3).abs() < 1e-15 && found.normal == [0.0, 1.0, 0.0]);
        assert!((found.start - 2.5).abs() < 1e-15 && found.rate == 1.0);
        // Past a corner 3 m to the side: a triangle of 3, 4, 5.
        sweep.radii = [5.0; 3];
        sweep.way = [0.0, -20.0, 0.0];
        sweep.corners = [[3.0, -14.0, 0.0], [9.0, -14.0, 1.0], [9.0, -14.0, -1.0]];
        let found = swept(&sweep);
        assert!((found.time - 0.5).abs() < 1e-15, "{found:?}");
        assert!((found.normal[0] + 0.6).abs() < 1e-15);
        // It never comes nearer than 6 m beside it.
        sweep.corners = sweep.corners.map(|[x, y, z]| [x + 3.0, y, z]);
        assert!((swept(&sweep).least - 1.2).abs() < 1e-15);
    }
}
