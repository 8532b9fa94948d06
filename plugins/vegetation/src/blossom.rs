//! The head of a flower: petals around a middle, as triangles, and from afar a hexagon of the same area and mean colour. The
//! functions of `shaders/src/vegetation/blossom.wgsl`, in Rust. Lengths are shares of the head's radius.

use bevy::math::{Vec2, Vec3, ops};

/// Vertices of a petal: three triangles.
pub const PETAL: u32 = 9;
/// Vertices of the middle, and of a head from afar: the four triangles of a hexagon.
pub const MIDDLE: u32 = 12;

/// Where petals begin,
const PETAL_FROM: f32 = 0.15;
/// where they are widest,
const PETAL_WIDE: f32 = 0.55;
/// and where they end.
const PETAL_TO: f32 = 0.97;
/// How wide they are at the end, as a share of the widest.
const PETAL_END: f32 = 0.6;
/// Radius of the middle.
const MIDDLE_RADIUS: f32 = 0.28;
/// Share of the middle that no petal is below: of 3 petals 0.72, of 12 petals 0.56.
const MIDDLE_ALONE: f32 = 0.65;
/// Area of a hexagon of radius 1: 3√3/2.
const HEXAGON: f32 = 2.598_076;

/// A vertex of a head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadPoint {
    /// In its plane.
    pub at: Vec2,
    /// Above it.
    pub rise: f32,
    /// 0 in the middle, 1 in a petal; between, a mean of both.
    pub petal: f32,
}

/// The axes of a head, unit vectors at right angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadFrame {
    /// Out of its plane.
    pub axis: Vec3,
    /// In it.
    pub right: Vec3,
    /// In it.
    pub ahead: Vec3,
}

/// Half the greatest width of one of so many petals, 3 or more: they touch their neighbours.
#[must_use]
pub fn petal_half(petals: f32) -> f32 {
    (1.05 * PETAL_WIDE * ops::tan(std::f32::consts::PI / petals)).min(0.45)
}

/// Area of all petals, each by itself.
#[must_use]
pub fn petals_area(petals: f32) -> f32 {
    let lower = PETAL_WIDE - PETAL_FROM;
    let upper = (1.0 + PETAL_END) * (PETAL_TO - PETAL_WIDE);
    petals * petal_half(petals) * (lower + upper)
}

fn hexagon_corner(number: u32) -> Vec2 {
    let corner = if number.is_multiple_of(3) {
        0
    } else {
        number / 3 + number % 3
    };
    let (sin, cos) = ops::sin_cos(std::f32::consts::FRAC_PI_3 * corner as f32);
    Vec2::new(cos, sin)
}

/// Vertex of a head that is seen from near by: first all petals, then the middle. Beyond them one point.
#[must_use]
pub fn head_near(number: u32, petals: u32) -> HeadPoint {
    if number >= PETAL * petals {
        let rest = number - PETAL * petals;
        let [at, rise] = if rest < MIDDLE {
            [MIDDLE_RADIUS * hexagon_corner(rest), Vec2::splat(0.08)]
        } else {
            [Vec2::ZERO; 2]
        };
        return HeadPoint {
            at,
            rise: rise.x,
            petal: 0.0,
        };
    }
    let corner = number % PETAL / 3 + number % 3;
    let half = petal_half(petals as f32);
    let sign = if corner % 2 == 1 { -1.0 } else { 1.0 };
    let (out, side, rise) = match corner {
        0 => (PETAL_FROM, 0.0, 0.0),
        1 | 2 => (PETAL_WIDE, half * sign, 0.12),
        _ => (PETAL_TO, half * PETAL_END * sign, 0.16),
    };
    let angle = std::f32::consts::TAU * (number / PETAL) as f32 / petals as f32;
    let (sin, cos) = ops::sin_cos(angle);
    let ahead = Vec2::new(cos, sin);
    HeadPoint {
        at: out * ahead + side * ahead.perp(),
        rise,
        petal: 1.0,
    }
}

/// Vertex of one that is seen from afar.
#[must_use]
pub fn head_far(number: u32, petals: u32) -> HeadPoint {
    if number >= MIDDLE {
        return HeadPoint {
            at: Vec2::ZERO,
            rise: 0.0,
            petal: 1.0,
        };
    }
    let middle = HEXAGON * MIDDLE_RADIUS * MIDDLE_RADIUS;
    let all = petals_area(petals as f32) + MIDDLE_ALONE * middle;
    HeadPoint {
        at: (all / HEXAGON).sqrt() * hexagon_corner(number),
        rise: 0.08,
        petal: 1.0 - middle / all,
    }
}

/// Axes of a head on a stem that ends in a direction: half up, half along the stem. `across` is that of the stem: x, z. No
/// stem ends downwards.
#[must_use]
pub fn head_frame(tangent: Vec3, across: Vec2) -> HeadFrame {
    let axis = (tangent / tangent.length().max(1e-9) + Vec3::new(0.0, 0.8, 0.0)).normalize();
    let side = Vec3::new(across.x, 0.0, across.y);
    let right = (side - axis * axis.dot(side)).normalize();
    HeadFrame {
        axis,
        right,
        ahead: axis.cross(right),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(count: u32, vertex: impl Fn(u32) -> HeadPoint) -> Vec<[HeadPoint; 3]> {
        (0..count / 3)
            .map(|k| [3 * k, 3 * k + 1, 3 * k + 2].map(&vertex))
            .collect()
    }

    /// Share of the square of side 2 about a head that its triangles cover, and of these the mean of `petal`: the last
    /// triangle lies on top.
    fn seen(triangles: &[[HeadPoint; 3]]) -> (f32, f32) {
        const SIDE: u32 = 400;
        let (mut covered, mut petal) = (0, 0.0);
        for k in 0..SIDE * SIDE {
            let p = Vec2::new((k % SIDE) as f32 + 0.5, (k / SIDE) as f32 + 0.5)
                / (SIDE as f32 / 2.0)
                - 1.0;
            let holds = |t: &&[HeadPoint; 3]| {
                let sides = [0, 1, 2].map(|k| {
                    let [a, b] = [t[k].at, t[(k + 1) % 3].at];
                    (b - a).perp_dot(p - a)
                });
                sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
            };
            if let Some(t) = triangles.iter().rev().find(holds) {
                covered += 1;
                petal += t[0].petal;
            }
        }
        let share = covered as f32 / (SIDE * SIDE) as f32;
        (share, petal / covered.max(1) as f32)
    }

    /// From afar a head covers as much as from near by, and as much of it is petals: within a tenth, which is what
    /// petals hide of each other and of the middle.
    #[test]
    fn far_heads_cover_the_same() {
        for petals in 3..=12 {
            let near = seen(&triangles(PETAL * petals + MIDDLE, |k| {
                head_near(k, petals)
            }));
            let far = seen(&triangles(MIDDLE, |k| head_far(k, petals)));
            assert!(
                (near.0 / far.0 - 1.0).abs() < 0.1,
                "{petals}: {near:?} {far:?}"
            );
            assert!((near.1 - far.1).abs() < 0.1, "{petals}: {near:?} {far:?}");
        }
    }

    #[test]
    fn nothing_is_beyond_the_radius() {
        for petals in 3..=12 {
            for number in 0..200 {
                for point in [head_near(number, petals), head_far(number, petals)] {
                    assert!(point.at.length() < 1.1, "{petals} {number}: {point:?}");
                }
            }
            assert_eq!(head_near(PETAL * petals + MIDDLE, petals).at, Vec2::ZERO);
        }
    }

    #[test]
    fn frames_are_at_right_angles() {
        for tangent in [Vec3::Y, Vec3::X, Vec3::new(0.3, 0.0, 0.2), Vec3::ZERO] {
            let HeadFrame { axis, right, ahead } = head_frame(tangent, Vec2::new(0.6, 0.8));
            for (a, b) in [(axis, right), (right, ahead), (ahead, axis)] {
                assert!(a.dot(b).abs() < 1e-6 && (a.length() - 1.0).abs() < 1e-6);
            }
            assert!(axis.y > 0.0);
        }
    }
}
