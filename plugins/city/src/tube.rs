//! Posts of lamps: tubes along Catmull-Rom curves, and the globes at their ends.
//!
//! A post stands in a plane: foot, top, top of the short leg, its end. Its curve has three pieces, each through four
//! points, of which the first and the last repeat an end; tangents come from the derivative, which does not vanish
//! there, and not from differences of points, which do. Frames that turn as little as possible along a plane curve
//! have the plane's normal as one axis: exact, and no branch. [`double_reflection`] gives such frames of any curve.
//!
//! Places are metres: out from the post towards the light, up, and across.

use bevy::math::{Vec2, Vec3, ops};

use crate::rules::CityRules;

/// Most sides of a tube: 96 vertices a segment.
pub const MOST_SIDES: u32 = 16;

/// Pieces of a post's curve.
pub const PIECES: u32 = 3;

/// The four points of a post, out and up.
#[must_use]
pub fn post_points(rules: &CityRules, height: f32) -> [Vec2; 4] {
    let lamp = &rules.lamp;
    [
        Vec2::ZERO,
        Vec2::new(0.0, height),
        Vec2::new(lamp.reach, height),
        Vec2::new(lamp.reach, height * (1.0 - lamp.drop)),
    ]
}

/// The four points of a piece: ends are repeated.
#[must_use]
pub fn piece_points(points: [Vec2; 4], piece: u32) -> [Vec2; 4] {
    let [a, b, c, d] = points;
    match piece {
        0 => [a, a, b, c],
        1 => [a, b, c, d],
        _ => [b, c, d, d],
    }
}

/// Place between the second and the third of four points, and its derivative (E. Catmull, R. Rom 1974, uniform,
/// tension ½).
#[must_use]
pub fn catmull_rom([a, b, c, d]: [Vec2; 4], t: f32) -> (Vec2, Vec2) {
    let first = c - a;
    let second = a * 2.0 - b * 5.0 + c * 4.0 - d;
    let third = (b - c) * 3.0 + d - a;
    (
        b + (first + (second + third * t) * t) * (0.5 * t),
        (first + (second * 2.0 + third * (3.0 * t)) * t) * 0.5,
    )
}

/// Segments of a piece whose chords are off by at most `allowed` metres: |P″| w² / 8, and P″ is linear in t. The
/// tube's outside bends more than its middle by the radius over the radius of the bend; this has the allowance for
/// the middle alone, so give it half.
#[must_use]
pub fn segments([a, b, c, d]: [Vec2; 4], allowed: f32) -> f32 {
    let start = a * 2.0 - b * 5.0 + c * 4.0 - d;
    let end = start + ((b - c) * 3.0 + d - a) * 3.0;
    let bend = start.length().max(end.length());
    (bend / (8.0 * allowed)).sqrt().clamp(1.0, 64.0)
}

/// Sides of a tube whose flats are within `allowed` metres of the circle: r (1 − cos(π / n)) ≤ ½ r (π / n)².
#[must_use]
pub fn sides(radius: f32, allowed: f32) -> u32 {
    let n = core::f32::consts::PI * (radius / (2.0 * allowed)).sqrt();
    (n.ceil().clamp(3.0, MOST_SIDES as f32)) as u32
}

/// Level of an octant of a globe whose triangles are within `allowed` metres of the sphere. The largest of the n²
/// triangles of a face is that in its middle: its corners are √2 / n apart on the octahedron, which is 1/√3 from the
/// centre there, so its circumradius is √2 / n radians, and 1 − cos(√2 / n) ≤ 1 / n².
#[must_use]
pub fn globe_level(radius: f32, allowed: f32) -> f32 {
    (radius / allowed).sqrt().clamp(1.0, 64.0)
}

/// A corner of the ring around a place of a plane curve: `across` is the plane's normal, `along` the curve's
/// direction (of any length).
#[must_use]
pub fn ring(along: Vec3, across: Vec3, share: f32) -> Vec3 {
    let up = across.cross(along.normalize());
    let (sin, cos) = ops::sin_cos(core::f32::consts::TAU * share);
    across * cos + up * sin
}

/// Frames that do not turn about a curve: for each place and its unit tangent the axis that `first` becomes, by two
/// reflections a step (W. Wang, B. Jüttler, D. Zheng, Y. Liu, *Computation of rotation minimizing frames*, ACM TOG
/// 27(1), 2008); an error of fourth order in the step. Places that repeat are allowed: such a step keeps its axis,
/// turned with the tangent.
#[must_use]
pub fn double_reflection(places: &[Vec3], tangents: &[Vec3], first: Vec3) -> Vec<Vec3> {
    let mut axes = Vec::with_capacity(places.len());
    let mut axis = first;
    let mirror = |v: Vec3, n: Vec3| {
        let square = n.length_squared();
        // A reflection by no direction: none.
        if square > 0.0 {
            v - n * (2.0 * n.dot(v) / square)
        } else {
            v
        }
    };
    for k in 0..places.len().min(tangents.len()) {
        if k > 0 {
            let step = places[k] - places[k - 1];
            let turned = mirror(axis, step);
            let tangent = mirror(tangents[k - 1], step);
            axis = mirror(turned, tangents[k] - tangent);
        }
        axes.push(axis);
    }
    axes
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::DVec3;

    /// Double reflection in f64: the reference.
    fn exact(places: &[DVec3], tangents: &[DVec3], first: DVec3) -> DVec3 {
        let mirror = |v: DVec3, n: DVec3| v - n * (2.0 * n.dot(v) / n.length_squared());
        (1..places.len()).fold(first, |axis, k| {
            let step = places[k] - places[k - 1];
            let tangent = mirror(tangents[k - 1], step);
            mirror(mirror(axis, step), tangents[k] - tangent)
        })
    }

    fn degrees(a: DVec3, b: DVec3) -> f64 {
        let sine = a.cross(b).length();
        bevy::math::ops::atan2(sine as f32, a.dot(b) as f32)
            .to_degrees()
            .into()
    }

    #[test]
    fn frames_of_posts_do_not_twist() {
        let rules = CityRules::default();
        for height in [1.0, 4.0, 20.0] {
            let points = post_points(&rules, height);
            let mut places = Vec::new();
            let mut tangents = Vec::new();
            for piece in 0..PIECES {
                for k in 0..=2000 {
                    if k == 0 && piece > 0 {
                        continue;
                    }
                    let (p, t) = catmull_rom(piece_points(points, piece), k as f32 / 2000.0);
                    places.push(DVec3::new(f64::from(p.x), f64::from(p.y), 0.0));
                    tangents.push(DVec3::new(f64::from(t.x), f64::from(t.y), 0.0).normalize());
                }
            }
            // From an axis that is not the plane's normal, so that a turn would show.
            let start = tangents[0].cross(DVec3::Z);
            let end = exact(&places, &tangents, start);
            let ours = tangents[tangents.len() - 1].cross(DVec3::Z);
            assert!(degrees(end, ours) <= 0.1, "{} degrees", degrees(end, ours));
        }
    }

    #[test]
    fn repeated_points_give_no_nan() {
        for (points, piece) in [
            ([Vec2::ZERO; 4], 1),
            (post_points(&CityRules::default(), 4.0), 0),
        ] {
            for k in 0..=64 {
                let (place, along) = catmull_rom(piece_points(points, piece), k as f32 / 64.0);
                assert!(place.is_finite() && along.is_finite());
                assert!(
                    piece == 1 || along.length() > 0.01,
                    "a direction everywhere"
                );
            }
            let n = segments(piece_points(points, piece), 0.001);
            assert!((1.0..=64.0).contains(&n));
        }
        let same = [Vec3::ONE; 3];
        let axes = double_reflection(&same, &[Vec3::X, Vec3::X, Vec3::Y], Vec3::Z);
        assert!(
            axes.iter()
                .all(|a| a.is_finite() && (a.length() - 1.0).abs() < 1e-6)
        );
    }

    #[test]
    fn frames_of_a_helix_are_those_of_fine_steps() {
        // A helix turns: its rotation minimizing frame turns back by its torsion, 1/2 a metre here.
        let curve = |n: usize| {
            let at = move |k: usize| {
                let (sin, cos) = ops::sin_cos(6.0 * k as f32 / n as f32);
                (
                    Vec3::new(cos, 6.0 * k as f32 / n as f32, sin),
                    Vec3::new(-sin, 1.0, cos).normalize(),
                )
            };
            (0..=n).map(at).unzip::<_, _, Vec<_>, Vec<_>>()
        };
        let last = |n: usize| {
            let (places, tangents) = curve(n);
            let first = tangents[0].cross(Vec3::X).normalize();
            double_reflection(&places, &tangents, first)[n]
        };
        // From x to z is clockwise seen from above: a left-handed helix.
        let torsion = -0.5_f32;
        // The normal (−cos, 0, −sin) and the binormal; the frame goes back by the torsion times the length.
        let (_, tangents) = curve(40);
        let (sin, cos) = ops::sin_cos(6.0);
        let normal = Vec3::new(-cos, 0.0, -sin);
        let binormal = tangents[40].cross(normal);
        let first = tangents[0].cross(Vec3::X).normalize();
        let start = first.dot(Vec3::new(-1.0, 0.0, 0.0));
        let begin = ops::atan2(first.dot(tangents[0].cross(Vec3::NEG_X)), start);
        let length = 6.0 * core::f32::consts::SQRT_2;
        let found = last(40);
        let angle = ops::atan2(found.dot(binormal), found.dot(normal));
        let full = core::f32::consts::TAU;
        let off = (angle - (begin - torsion * length)).rem_euclid(full);
        // 40 steps of 0.15: the fourth order leaves some 10⁻⁵; 0.1 degrees are 1.7e-3.
        assert!(off.min(full - off) < 1.7e-3, "{off}");
        assert!(last(40).distance(last(400)) < 1.7e-3);
    }

    #[test]
    fn what_is_drawn_of_a_globe_and_of_a_tube_is_within_what_is_allowed() {
        for allowed in [0.05, 0.01, 0.002_f32, 0.000_8] {
            let n = globe_level(0.2, allowed).ceil() as i32;
            let on = |i: i32, j: i32| {
                Vec3::new(i as f32, j as f32, (n - i - j) as f32).normalize() * 0.2
            };
            let mut worst = 0.0_f32;
            for i in 0..n {
                for j in 0..n - i {
                    let mut faces = vec![[on(i, j), on(i + 1, j), on(i, j + 1)]];
                    if i + j + 2 <= n {
                        faces.push([on(i + 1, j), on(i + 1, j + 1), on(i, j + 1)]);
                    }
                    for [a, b, c] in faces {
                        // The plane's distance from the centre is the least of the triangle's.
                        let normal = (b - a).cross(c - a).normalize();
                        worst = worst.max(0.2 - a.dot(normal).abs());
                    }
                }
            }
            assert!(worst <= allowed, "{n}: {worst} > {allowed}");
            let n = sides(0.05, allowed);
            let flat = 0.05 * (1.0 - ops::cos(core::f32::consts::PI / n as f32));
            assert!(
                flat <= allowed || n == MOST_SIDES,
                "{n}: {flat} > {allowed}"
            );
        }
    }

    #[test]
    fn segments_keep_to_what_is_allowed() {
        let points = post_points(&CityRules::default(), 4.0);
        for allowed in [0.05, 0.01, 0.002_f32] {
            for piece in 0..PIECES {
                let points = piece_points(points, piece);
                let n = segments(points, allowed).ceil() as usize;
                let at = |t: f32| catmull_rom(points, t).0;
                for k in 0..n {
                    let (a, b) = (at(k as f32 / n as f32), at((k + 1) as f32 / n as f32));
                    for m in 1..20 {
                        let s = m as f32 / 20.0;
                        let on = at((k as f32 + s) / n as f32);
                        assert!(
                            on.distance(a.lerp(b, s)) <= allowed,
                            "{allowed} {piece} {k}"
                        );
                    }
                }
            }
        }
    }
}
