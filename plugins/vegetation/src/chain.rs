//! Kelp: a chain of segments from its root towards the surface.
//!
//! Nodes are a function of the root, the depth of the water and the swell; a segment is a ribbon between two of them.
//! Segments that follow each other share their node, and so both the corners there: there is no gap at any sway.
//!
//! What is longer than the water is deep *floats*, as the fronds of giant kelp do (*Macrocystis pyrifera*): its nodes lie
//! on the surface, and the chain winds to where the wind drives the water. There it has leaves. The surface that the ground
//! draws is level, so that what floats goes to and fro with the swell and not up and down.

use bevy::math::{Vec2, Vec3, ops};

use crate::blade::{number, word};
use crate::kind::Chain;
use crate::place::unit;
use crate::wind::WindField;

/// How high what floats lies above the surface, metres: it is seen from above, not through it.
pub const FLOAT: f32 = 0.03;

/// A leaf of what floats is so many times as wide as the ribbon under water; between two leaves it is [`STEM`] times.
pub const LEAF: f32 = 2.4;
/// See [`LEAF`].
pub const STEM: f32 = 0.5;

/// How much of a tilt is left after a segment: floats pull each one upright.
const UPRIGHT: f32 = 0.75;

/// How much what floats winds, by the tilt that it would have under water.
const WINDING: f32 = 3.0;

/// A chain at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainShape {
    /// Segments, 2 to 64.
    pub segments: u32,
    /// Length of each, metres.
    pub segment: f32,
    /// Greatest angle between two that follow each other, radians.
    pub twist: f32,
    /// Width of the ribbon, metres.
    pub width: f32,
    /// What is random about it: [`crate::blade::Own::hash`].
    pub hash: u32,
    /// Depth of the water at the root, metres.
    pub depth: f32,
    /// Where what floats goes, of length 1: x and z.
    pub ahead: Vec2,
}

/// A node of a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainNode {
    /// Relative to the root, metres.
    pub place: Vec3,
    /// Unit vector of the segment that ends there.
    pub along: Vec3,
    /// Whether it lies on the surface.
    pub floats: bool,
}

impl ChainShape {
    /// Of a plant in water of some depth, metres, where the wind blows towards `wind`. It has as many whole segments as make
    /// up its length.
    #[must_use]
    pub fn new(chain: &Chain, hash: u32, depth: f32, wind: Vec2) -> Self {
        let (low, high) = chain.rise;
        let rise = low + (high - low) * number(hash, 4);
        let wanted = (depth * rise).max(0.0);
        let count = (wanted / chain.segment).clamp(2.0, chain.segments.max(2) as f32);
        let segments = count as u32;
        let (sin, cos) = ops::sin_cos(std::f32::consts::TAU * number(hash, 9));
        let wind = wind.normalize_or_zero() + 0.45 * Vec2::new(cos, sin);
        Self {
            segments,
            // Shallow water holds two short ones.
            segment: chain.segment.min(wanted / segments as f32),
            twist: chain.twist,
            width: chain.width * (0.7 + 0.6 * number(hash, 7)),
            hash,
            depth,
            ahead: wind.normalize_or(Vec2::X),
        }
    }

    /// Node `number` at rest, 0 the root.
    #[must_use]
    pub fn at_rest(&self, number: u32) -> ChainNode {
        let (mut place, mut along) = (Vec3::ZERO, Vec3::Y);
        let mut tilt = Vec2::ZERO;
        let mut floats = false;
        for k in 0..number.min(self.segments) {
            let word = word(self.hash, 16 + k);
            let turn = Vec2::new(unit(word), unit(word << 12)) - 0.5;
            tilt = tilt * UPRIGHT + turn * (self.twist * (1.0 / (2.0 - UPRIGHT)));
            let (sin_x, cos_x) = ops::sin_cos(tilt.x);
            let (sin_z, cos_z) = ops::sin_cos(tilt.y);
            along = Vec3::new(sin_x * cos_z, cos_x * cos_z, sin_z);
            let left = self.depth - place.y;
            floats = self.segment * along.y >= left;
            if floats {
                // As far up as there is water, the rest of the segment along the surface; it winds as it does below.
                let up = (left / self.segment).clamp(0.0, 1.0);
                let winding = self.ahead + self.ahead.perp() * (WINDING * (tilt.x + tilt.y));
                let flat = winding.normalize_or(self.ahead) * (1.0 - up * up).max(0.0).sqrt();
                along = Vec3::new(flat.x, up, flat.y);
            }
            place += self.segment * along;
        }
        ChainNode {
            place,
            along,
            floats,
        }
    }

    /// Node `number`; `at` is the root relative to the field's anchor.
    ///
    /// Water moves the nodes: each by the water's own movement at its depth, the more the farther it is along the
    /// chain; the root stays.
    #[must_use]
    pub fn node(&self, number: u32, at: Vec2, field: &WindField) -> Vec3 {
        let rest = self.at_rest(number);
        let way = number.min(self.segments) as f32 / self.segments as f32;
        let below = self.depth - rest.place.y;
        let moved = field.in_water(at + Vec2::new(rest.place.x, rest.place.z), below);
        // Held at its foot: with the square of the way, so that the lowest segment hardly turns.
        let mut place = rest.place + moved * (way * way);
        place.y = if rest.floats {
            self.depth + FLOAT
        } else {
            place.y.min(self.depth)
        };
        place
    }

    /// Unit vector across the ribbon at a node: it turns on the way up, and lies flat where it floats.
    #[must_use]
    pub fn across(&self, node: u32, rest: &ChainNode) -> Vec3 {
        if rest.floats {
            let flat = Vec2::new(-rest.along.z, rest.along.x).normalize_or(Vec2::X);
            return Vec3::new(flat.x, 0.0, flat.y);
        }
        let turn = node as f32 * 0.5 * (number(self.hash, 8) - 0.5);
        let (sin, cos) = ops::sin_cos(std::f32::consts::TAU * number(self.hash, 5) + turn);
        Vec3::new(cos, 0.0, sin)
    }

    /// The width of the ribbon at a node: narrow at the root and at the end, and wide and narrow by turns where it floats,
    /// as leaves are on a stem. Where only each `step`-th node is drawn it has the mean of both.
    #[inline]
    #[must_use]
    pub fn width_at(&self, number: u32, floats: bool, step: u32) -> f32 {
        let along = number as f32 / self.segments as f32;
        let leaf = match (floats, step, number % 2) {
            (false, ..) => 1.0,
            (true, 1, 0) => STEM,
            (true, 1, _) => LEAF,
            _ => 0.5 * (STEM + LEAF),
        };
        self.width * leaf * (0.25 + 3.0 * along * (1.0 - along)).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wind::Wind;
    use bevy::math::Vec3Swizzles as _;
    use dolomite_terrain::GroundPoint;

    fn chain() -> Chain {
        let kinds = crate::kind::Kinds::small_set();
        let crate::kind::Shape::Chain(chain) = kinds.find("kelp").expect("there").1.shape.clone()
        else {
            panic!("kelp is a chain");
        };
        chain
    }

    /// In 2 to 80 m of water: no node above the surface at rest but what floats, segments that keep their length, angles under
    /// water within the limit, nothing that is no number; and some that floats.
    #[test]
    fn chains_reach_the_surface_and_no_farther() {
        let mut floating = 0;
        let still = WindField::new(
            &Wind {
                swell: 0.0,
                ..Wind::default()
            },
            GroundPoint::default(),
            0.0,
        );
        for depth in [2.0, 5.0, 20.0, 80.0] {
            for k in 0..100 {
                let shape = ChainShape::new(&chain(), word(k, 3), depth, Vec2::new(3.0, 1.0));
                let nodes: Vec<Vec3> = (0..=shape.segments)
                    .map(|k| shape.node(k, Vec2::ZERO, &still))
                    .collect();
                let rests: Vec<ChainNode> =
                    (0..=shape.segments).map(|k| shape.at_rest(k)).collect();
                let under = rests.iter().filter(|rest| !rest.floats).count();
                floating += rests.len() - under;
                assert!(nodes[..under].iter().all(|node| node.y <= depth));
                assert!(nodes[under..].iter().all(|node| node.y == depth + FLOAT));
                assert!(nodes.iter().all(|node| node.is_finite()));
                assert!(nodes[1].y > 0.0 && shape.segments <= chain().segments);
                for pair in rests.windows(2) {
                    let length = pair[0].place.distance(pair[1].place);
                    assert!((length / shape.segment - 1.0).abs() < 1e-3);
                }
                for pair in rests[1..under.max(1)].windows(2) {
                    let angle = pair[0].along.angle_between(pair[1].along);
                    assert!(angle < shape.twist, "{angle}");
                }
                // What floats goes on, to where the wind blows.
                let ahead =
                    nodes.last().expect("some").xz() - nodes[under.min(nodes.len() - 1)].xz();
                assert!(ahead.dot(shape.ahead) >= 0.0 && shape.ahead.x > 0.0);
            }
        }
        assert!(floating > 200, "{floating}");
    }

    /// The root stays, the end goes with the water.
    #[test]
    fn chains_follow_the_swell() {
        let shape = ChainShape::new(&chain(), 8, 6.0, Vec2::X);
        let (mut least, mut most) = (Vec3::MAX, Vec3::MIN);
        for k in 0..200 {
            let field =
                WindField::new(&Wind::default(), GroundPoint::default(), 0.1 * f64::from(k));
            assert_eq!(shape.node(0, Vec2::ONE, &field), Vec3::ZERO);
            let end = shape.node(shape.segments, Vec2::ONE, &field);
            (least, most) = (least.min(end), most.max(end));
        }
        assert!((most - least).length() > 0.15, "{}", most - least);
    }

    /// Leaves and stem by turns; of fewer nodes the mean.
    #[test]
    fn what_floats_has_leaves() {
        let shape = ChainShape::new(&chain(), 8, 6.0, Vec2::X);
        let middle = shape.segments / 2 / 2 * 2;
        let [stem, leaf] = [middle, middle + 1].map(|k| shape.width_at(k, true, 1));
        assert!(leaf > 4.0 * stem);
        let means = [2, 4].map(|step| shape.width_at(middle, true, step));
        assert!(means.iter().all(|mean| *mean > stem && *mean < leaf));
        let under = [1, 2].map(|step| shape.width_at(middle, false, step));
        assert!(under[0] == under[1] && under[0] > 0.98 * shape.width);
    }
}
