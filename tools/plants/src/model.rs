//! Triangles with a normal and a colour at each vertex, and the parts that models are made of.

use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};

/// One vertex.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Vertex {
    /// Place, metres; +Y up.
    pub place: [f32; 3],
    /// Unit normal.
    pub normal: [f32; 3],
    /// Linear colour.
    pub colour: [f32; 3],
}

/// Triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Three a triangle, counter-clockwise from outside.
    pub indices: Vec<u32>,
}

/// A ring of a tube.
#[derive(Clone, Copy, Debug)]
pub struct Ring {
    /// Its middle.
    pub middle: Vec3,
    /// Its radius.
    pub radius: f32,
    /// Its colour.
    pub colour: Vec3,
}

/// A leaf: four corners, seen from both sides.
#[derive(Clone, Copy, Debug)]
pub struct Leaf {
    /// Where it is held.
    pub foot: Vec3,
    /// From the foot to the tip.
    pub along: Vec3,
    /// From its middle line to its border.
    pub across: Vec3,
    /// The normal that both sides are lit by.
    pub normal: Vec3,
    /// Colour at the foot and at the tip.
    pub colour: [Vec3; 2],
}

impl Model {
    fn push(&mut self, place: Vec3, normal: Vec3, colour: Vec3) -> u32 {
        self.vertices.push(Vertex {
            place: place.to_array(),
            normal: normal.to_array(),
            colour: colour.to_array(),
        });
        self.vertices.len() as u32 - 1
    }

    /// A tube through rings, without lids: its ends are inside of something, or thin.
    pub fn tube(&mut self, rings: &[Ring], sides: u32) {
        let [first, .., last] = rings else { return };
        let start = self.vertices.len() as u32;
        let mut heading = (rings[1].middle - first.middle).normalize_or(Vec3::Y);
        let mut side = heading.any_orthonormal_vector();
        for (k, ring) in rings.iter().enumerate() {
            let ahead = rings.get(k + 1).unwrap_or(last).middle;
            let behind = rings[k.saturating_sub(1)].middle;
            let next = (ahead - behind).normalize_or(heading);
            // The frame turns no more than the tube does.
            side = Quat::from_rotation_arc(heading, next) * side;
            heading = next;
            for n in 0..sides {
                let turn = std::f32::consts::TAU * n as f32 / sides as f32;
                let out = Quat::from_axis_angle(heading, turn) * side;
                self.push(ring.middle + out * ring.radius, out, ring.colour);
            }
        }
        for k in 0..rings.len() as u32 - 1 {
            for n in 0..sides {
                let next = (n + 1) % sides;
                let [a, b] = [n, next].map(|n| start + k * sides + n);
                let [c, d] = [a + sides, b + sides];
                self.indices.extend([a, b, c, b, d, c]);
            }
        }
    }

    /// A leaf, `scale` times as large about its middle.
    pub fn leaf(&mut self, leaf: &Leaf, scale: f32) {
        let middle = leaf.foot + 0.5 * leaf.along;
        let (along, across) = (leaf.along * scale, leaf.across * scale);
        let foot = middle - 0.5 * along;
        let [low, high] = leaf.colour;
        let a = self.push(foot, leaf.normal, low);
        let b = self.push(
            foot + 0.45 * along + across,
            leaf.normal,
            low.lerp(high, 0.45),
        );
        let c = self.push(foot + along, leaf.normal, high);
        let d = self.push(
            foot + 0.45 * along - across,
            leaf.normal,
            low.lerp(high, 0.45),
        );
        self.indices.extend([a, b, c, a, c, d, a, c, b, a, d, c]);
    }

    /// Adds all triangles of another model.
    pub fn append(&mut self, other: &Self) {
        let start = self.vertices.len() as u32;
        self.vertices.extend(&other.vertices);
        self.indices.extend(other.indices.iter().map(|k| k + start));
    }

    /// Height of the highest vertex.
    #[must_use]
    pub fn height(&self) -> f32 {
        self.vertices.iter().map(|v| v.place[1]).fold(0.0, f32::max)
    }
}
