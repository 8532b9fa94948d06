//! The geometry of a blade: a quadratic Bézier curve that keeps its length, and a strip of 15, 7 or 3 vertices.
//!
//! A blade is told by where its tip is: the *lean*, its horizontal offset as a share of its length. Wind, slope and
//! whoever walks by change the lean; the height of the tip follows, so that no blade becomes longer. The curve follows
//! K. Jahrmann and M. Wimmer, *Responsive Real-Time Grass Rendering for General 3D Scenes*, I3D 2017: a control point
//! above the root, and the length of a quadratic curve as (2 · chord + polygon) / 3.

use bevy::math::{Vec2, Vec3, ops};

use dolomite_terrain::noise::hash::pcg;

use crate::kind::Blade;
use crate::place::{Clump, Root, unit};

/// Greatest lean: a blade that lies flat still has 1/12 of its length in height.
pub const MOST_LEAN: f32 = 0.9965;

/// Segments of the strips of the three levels of detail: 15, 7 and 3 vertices.
pub const SEGMENTS: [u32; 3] = [7, 3, 1];

/// Seen from its edge a blade is still so wide, to each side, as a share of its width: it is folded.
pub const LEAST_SEEN: f32 = 0.17;

/// Normals at the two borders are turned by this much, radians: a flat strip is lit like a fold.
const ROUND: f32 = 0.5;

/// What is random about a plant that is drawn: what its record holds of the hashes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Own {
    /// The highest 16 bits of its root's hash.
    pub hash: u32,
    /// The highest 5 bits of its clump's hash; of its own where it grows in none.
    pub clump: u32,
}

impl Own {
    /// Of a candidate.
    #[must_use]
    pub fn new(root: Root, clump: Option<Clump>) -> Self {
        Self {
            hash: root.hash >> 16,
            clump: clump.map_or(root.hash, |clump| clump.hash) >> 27,
        }
    }

    /// Number `salt` of the plant's own, 0 up to 1.
    #[inline]
    #[must_use]
    pub fn number(self, salt: u32) -> f32 {
        number(self.hash, salt)
    }

    /// Number `salt` of all that stand in its clump, 0 up to 1.
    #[inline]
    #[must_use]
    pub fn of_clump(self, salt: u32) -> f32 {
        number(self.clump, salt)
    }
}

/// A random number of a hash, 0 up to 1.
#[inline]
#[must_use]
pub fn number(hash: u32, salt: u32) -> f32 {
    unit(word(hash, salt))
}

/// A random word of a hash.
#[inline]
#[must_use]
pub(crate) fn word(hash: u32, salt: u32) -> u32 {
    pcg(hash.wrapping_mul(747_796_405).wrapping_add(salt))
}

/// A blade at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BladeShape {
    /// Length of the curve, metres.
    pub length: f32,
    /// Width at the root, metres.
    pub width: f32,
    /// Offset of the tip as a share of the length: x, z.
    pub lean: Vec2,
    /// 0: straight; 1: straight up, then over.
    pub droop: f32,
    /// Unit vector across the blade at its root: x, z.
    pub across: Vec2,
    /// How far the tip moves in a wind of 1 m/s, as a share of the length.
    pub give: f32,
}

/// A point of a strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BladeVertex {
    /// Relative to the root, metres.
    pub place: Vec3,
    /// Unit normal of the front.
    pub normal: Vec3,
    /// 0 at the root, 1 at the tip.
    pub along: f32,
}

/// A curve of three control points, of which the first is the root, at 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    /// The middle control point.
    pub middle: Vec3,
    /// The tip.
    pub tip: Vec3,
}

/// The lean after a push, such that no blade leans more than [`MOST_LEAN`].
#[inline]
#[must_use]
pub fn pushed(lean: Vec2, by: Vec2) -> Vec2 {
    let sum = lean + by;
    // Smooth, so that a gust bends what stands up more than what lies: x / √(1 + x²) comes near to 1.
    let length = sum.length();
    sum * (MOST_LEAN / (1.0 + length * length).sqrt()).min(1.0)
}

impl BladeShape {
    /// Blades of a clump are as long and turned alike, as far as the clump is uneven, 0 to 1. `normal` is that of the
    /// ground.
    #[must_use]
    pub fn new(blade: &Blade, own: Own, uneven: f32, normal: Vec3) -> Self {
        let (short, long) = blade.length;
        let size = own.number(4) + (own.of_clump(4) - own.number(4)) * 0.5 * uneven;
        let length = short + (long - short) * size;
        let spread = 1.0 - 0.6 * uneven;
        let angle = std::f32::consts::TAU * (own.of_clump(5) + (own.number(5) - 0.5) * spread);
        let (sin, cos) = ops::sin_cos(angle);
        let lean = ops::sin(blade.lean) * own.number(6).sqrt();
        Self {
            length,
            width: blade.width * (0.75 + 0.5 * own.number(7)),
            // Up the slope's normal a little.
            lean: Vec2::new(cos, sin) * lean + 0.35 * Vec2::new(normal.x, normal.z),
            droop: blade.droop * (0.6 + 0.4 * own.number(8)),
            across: Vec2::new(-sin, cos),
            // Tall ones give way more.
            give: blade.look.sway * (0.6 + 0.4 * length / long.max(1e-3)),
        }
    }

    /// Its curve at a lean.
    #[must_use]
    pub fn curve(&self, lean: Vec2) -> Curve {
        let lean = if lean.length_squared() > MOST_LEAN * MOST_LEAN {
            lean * (MOST_LEAN / lean.length())
        } else {
            lean
        };
        let height = (1.0 - lean.length_squared()).max(0.0).sqrt();
        let tip = Vec3::new(lean.x, height, lean.y);
        let above = Vec3::new(0.0, height, 0.0);
        let middle = (0.5 * tip).lerp(above, self.droop);
        // The chord is 1.
        let polygon = middle.length() + (tip - middle).length();
        let scale = self.length / ((2.0 + polygon) / 3.0);
        Curve {
            middle: scale * middle,
            tip: scale * tip,
        }
    }

    /// The width at a place along the blade, as a strip of so many segments has it: 1 − t² of that at the root, where
    /// strips of fewer segments are wider by what their straight sides cut off, so that each covers the same area.
    #[inline]
    #[must_use]
    pub fn width_at(&self, along: f32, segments: u32) -> f32 {
        let four = 4.0 * (segments * segments) as f32;
        self.width * (1.0 - along * along) * (four / (four - 1.0))
    }

    /// Vertex `number` of a strip of so many segments: two a row from the root up, and the tip.
    #[must_use]
    pub fn vertex(&self, curve: Curve, segments: u32, number: u32) -> BladeVertex {
        let along = (number / 2) as f32 / segments as f32;
        let (place, tangent) = curve.row(number / 2, segments);
        let side = Vec3::new(self.across.x, 0.0, self.across.y);
        let face = tangent.cross(side).normalize_or(Vec3::Y);
        let left = if number >= 2 * segments {
            0.0
        } else if number.is_multiple_of(2) {
            -1.0
        } else {
            1.0
        };
        let (sin, cos) = ops::sin_cos(ROUND * left);
        BladeVertex {
            place: place + side * (0.5 * left * self.width_at(along, segments)),
            normal: cos * face + sin * side,
            along,
        }
    }
}

impl Curve {
    /// Where a strip of so many segments ends: such that its area, as a vector, is that of the curve. So it hides as much
    /// as the curve from every side from which no part of the blade turns its back.
    ///
    /// Of a width of 1 − t² the area is (m/3 + p/2) × across, with the control points m and p; that of the strip is the sum
    /// over its segments of mean width times step. It follows that the tip is off by (m − p/2)/(4n − 2).
    #[inline]
    #[must_use]
    pub fn drawn_tip(&self, segments: u32) -> Vec3 {
        self.tip + (self.middle - 0.5 * self.tip) / (4 * segments - 2) as f32
    }

    /// Middle of a row of a strip of so many segments, and the curve's derivative there.
    #[inline]
    #[must_use]
    pub fn row(&self, row: u32, segments: u32) -> (Vec3, Vec3) {
        let (place, tangent) = self.at(row as f32 / segments as f32);
        if row >= segments {
            (self.drawn_tip(segments), tangent)
        } else {
            (place, tangent)
        }
    }

    /// Place and derivative.
    #[inline]
    #[must_use]
    pub fn at(&self, along: f32) -> (Vec3, Vec3) {
        let rest = 1.0 - along;
        (
            self.middle * (2.0 * rest * along) + self.tip * (along * along),
            self.middle * (2.0 * (rest - along)) + self.tip * (2.0 * along),
        )
    }
}

/// What to add to a vertex so that a strip that is seen edge-on does not vanish: across the view, until half its width
/// is at least `least` there. `offset` is the vertex's place off the curve, `tangent` the curve's, `to_eye` where the
/// eye is from there.
#[must_use]
pub fn widened(offset: Vec3, tangent: Vec3, to_eye: Vec3, least: f32) -> Vec3 {
    let across = tangent.cross(to_eye).normalize_or_zero();
    let seen = offset.dot(across);
    let sign = if seen < 0.0 { -1.0 } else { 1.0 };
    let missing = least - seen.abs();
    if missing > 0.0 && offset != Vec3::ZERO {
        across * (sign * missing)
    } else {
        Vec3::ZERO
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::place::Lattice;

    fn shapes() -> impl Iterator<Item = BladeShape> {
        let blade = crate::kind::defaults::grass().0;
        let lattice = Lattice::of_density(3, 64.0);
        (0..500).map(move |k| {
            let own = Own::new(lattice.root([k, 7]), None);
            BladeShape::new(&blade, own, 0.0, Vec3::Y)
        })
    }

    /// The length of the curve is that of the blade whatever pushes it: within what the estimate allows.
    #[test]
    fn no_push_makes_a_blade_longer() {
        for (k, shape) in shapes().enumerate() {
            let angle = k as f32;
            let push = Vec2::new(ops::cos(angle), ops::sin(angle)) * (k as f32 * 0.01);
            let lean = pushed(shape.lean, push);
            assert!(lean.length() <= MOST_LEAN);
            let curve = shape.curve(lean);
            let points = (0..=256).map(|k| curve.at(k as f32 / 256.0).0);
            let length: f32 = points
                .clone()
                .zip(points.skip(1))
                .map(|(a, b)| a.distance(b))
                .sum();
            // Of a curve that turns by up to a right angle Gravesen's estimate is off by some 2 %.
            assert!(
                (length / shape.length - 1.0).abs() < 0.03,
                "{length} {}",
                shape.length
            );
            assert!(curve.tip.y > 0.0, "over the ground");
        }
    }

    /// Strips of all levels cover the same area: half the sum of rows, times the length.
    #[test]
    fn levels_cover_the_same() {
        let shape = shapes().next().expect("500");
        let straight = BladeShape {
            lean: Vec2::ZERO,
            droop: 0.0,
            ..shape
        };
        for segments in SEGMENTS {
            let curve = straight.curve(Vec2::ZERO);
            let vertices: Vec<_> = (0..=2 * segments)
                .map(|k| straight.vertex(curve, segments, k).place)
                .collect();
            let area: f32 = vertices
                .windows(3)
                .map(|t| 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).length())
                .sum();
            let expected = straight.width * straight.length * 2.0 / 3.0;
            assert!(
                (area / expected - 1.0).abs() < 1e-5,
                "{segments}: {area} {expected}"
            );
        }
    }

    /// Bent strips of all levels have the same area as a vector: they hide as much from every side.
    #[test]
    fn levels_hide_the_same_from_every_side() {
        for shape in shapes().take(50) {
            let curve = shape.curve(shape.lean);
            let areas = SEGMENTS.map(|segments| {
                let at: Vec<_> = (0..=2 * segments)
                    .map(|k| shape.vertex(curve, segments, k).place)
                    .collect();
                let mut area = Vec3::ZERO;
                for (k, t) in at.windows(3).enumerate() {
                    let sign = if k % 2 == 0 { 0.5 } else { -0.5 };
                    area += sign * (t[1] - t[0]).cross(t[2] - t[0]);
                }
                area
            });
            let whole = (curve.middle / 3.0 + curve.tip / 2.0).cross(Vec3::new(
                shape.across.x,
                0.0,
                shape.across.y,
            )) * shape.width;
            for area in areas {
                let off = area.distance(-whole).min(area.distance(whole));
                assert!(off < 1e-5 * whole.length().max(1e-3), "{area} {whole}");
            }
        }
    }

    /// Normals are unit vectors, and the two borders of a row are turned away from each other.
    #[test]
    fn normals_are_round() {
        for shape in shapes() {
            let curve = shape.curve(shape.lean);
            for row in 0..7 {
                let [a, b] = [2 * row, 2 * row + 1].map(|k| shape.vertex(curve, 7, k));
                assert!((a.normal.length() - 1.0).abs() < 1e-5);
                assert!((a.normal.dot(b.normal) - ops::cos(2.0 * ROUND)).abs() < 1e-4);
            }
        }
    }

    /// A strip that is seen exactly edge-on is as wide as asked.
    #[test]
    fn edges_are_seen() {
        let offset = Vec3::X * 0.005;
        let wide = widened(offset, Vec3::Y, Vec3::X, 0.002);
        assert!((wide.length() - 0.002).abs() < 1e-7 && wide.dot(Vec3::X).abs() < 1e-7);
        assert_eq!(widened(offset, Vec3::Y, Vec3::Z, 0.002), Vec3::ZERO);
        assert_eq!(
            widened(Vec3::ZERO, Vec3::Y, Vec3::X, 0.002),
            Vec3::ZERO,
            "the tip stays one point"
        );
    }
}
