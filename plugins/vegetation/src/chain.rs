//! Kelp: a chain of segments from its root towards the surface.
//!
//! Nodes are a function of the root, the depth of the water and the swell; a segment is a ribbon between two of them.
//! Segments that follow each other share their node, and so both the corners there: there is no gap at any sway.

use bevy::math::{Vec2, Vec3, ops};

use crate::blade::{number, word};
use crate::kind::Chain;
use crate::place::unit;
use crate::wind::WindField;

/// How much of a tilt is left after a segment: floats pull each one upright.
const UPRIGHT: f32 = 0.75;

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
}

impl ChainShape {
    /// Of a plant in water of some depth, metres. It has as many whole segments as reach its height.
    #[must_use]
    pub fn new(chain: &Chain, hash: u32, depth: f32) -> Self {
        let (low, high) = chain.rise;
        let rise = low + (high - low) * number(hash, 4);
        let wanted = (depth * rise).max(0.0);
        let count = (wanted / chain.segment).clamp(2.0, chain.segments.max(2) as f32);
        let segments = count as u32;
        Self {
            segments,
            // Shallow water holds two short ones.
            segment: chain.segment.min(wanted / segments as f32),
            twist: chain.twist,
            width: chain.width * (0.7 + 0.6 * number(hash, 7)),
            hash,
            depth,
        }
    }

    /// Node `number` at rest, 0 the root, relative to the root, and the unit vector of the segment that ends there.
    #[must_use]
    pub fn at_rest(&self, number: u32) -> (Vec3, Vec3) {
        let (mut place, mut along) = (Vec3::ZERO, Vec3::Y);
        let mut tilt = Vec2::ZERO;
        for k in 0..number.min(self.segments) {
            let word = word(self.hash, 16 + k);
            let turn = Vec2::new(unit(word), unit(word << 12)) - 0.5;
            tilt = tilt * UPRIGHT + turn * (self.twist * (1.0 / (2.0 - UPRIGHT)));
            let (sin_x, cos_x) = ops::sin_cos(tilt.x);
            let (sin_z, cos_z) = ops::sin_cos(tilt.y);
            along = Vec3::new(sin_x * cos_z, cos_x * cos_z, sin_z);
            place += self.segment * along;
        }
        (place, along)
    }

    /// Node `number`; `at` is the root relative to the field's anchor.
    ///
    /// Water moves the nodes: each by the water's own movement at its depth, the more the farther it is along the
    /// chain; the root stays.
    #[must_use]
    pub fn node(&self, number: u32, at: Vec2, field: &WindField) -> Vec3 {
        let (rest, _) = self.at_rest(number);
        let way = number.min(self.segments) as f32 / self.segments as f32;
        let below = self.depth - rest.y;
        let moved = field.in_water(at + Vec2::new(rest.x, rest.z), below);
        // Held at its foot: with the square of the way, so that the lowest segment hardly turns.
        rest + moved * (way * way)
    }

    /// Unit vector across the ribbon at a node: it turns on the way up.
    #[must_use]
    pub fn across(&self, node: u32) -> Vec3 {
        let turn = node as f32 * 0.5 * (number(self.hash, 8) - 0.5);
        let (sin, cos) = ops::sin_cos(std::f32::consts::TAU * number(self.hash, 5) + turn);
        Vec3::new(cos, 0.0, sin)
    }

    /// The width of the ribbon at a node: narrow at the root and at the end.
    #[inline]
    #[must_use]
    pub fn width_at(&self, number: u32) -> f32 {
        let along = number as f32 / self.segments as f32;
        self.width * (0.25 + 3.0 * along * (1.0 - along)).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wind::Wind;
    use dolomite_terrain::GroundPoint;

    fn chain() -> Chain {
        let kinds = crate::kind::Kinds::small_set();
        let crate::kind::Shape::Chain(chain) = kinds.find("kelp").expect("there").1.shape.clone()
        else {
            panic!("kelp is a chain");
        };
        chain
    }

    /// In 2 to 80 m of water: no node above the surface at rest, angles within the limit, nothing that is no number.
    #[test]
    fn chains_stay_under_water() {
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
                let shape = ChainShape::new(&chain(), word(k, 3), depth);
                let nodes: Vec<Vec3> = (0..=shape.segments)
                    .map(|k| shape.node(k, Vec2::ZERO, &still))
                    .collect();
                assert!(nodes.iter().all(|node| node.y <= depth && node.is_finite()));
                assert!(nodes[1].y > 0.0 && shape.segments <= 24);
                let ways: Vec<Vec3> = nodes.windows(2).map(|n| n[1] - n[0]).collect();
                for way in &ways {
                    assert!((way.length() / shape.segment - 1.0).abs() < 1e-4);
                }
                for pair in ways.windows(2) {
                    assert!(
                        pair[0].angle_between(pair[1]) < shape.twist,
                        "{}",
                        pair[0].angle_between(pair[1])
                    );
                }
            }
        }
    }

    /// The root stays, the end goes with the water.
    #[test]
    fn chains_follow_the_swell() {
        let shape = ChainShape::new(&chain(), 8, 6.0);
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
}
