//! Triangles of cells, each in the frame of its own cell.
//!
//! Whatever holds the samples, one tile or another or the whole ground, a triangle has the same bits: its corners are
//! counted from the north-west corner of its cell and from a whole metre of height near it. Contacts with it are worked
//! out with coordinates of the size of a cell, wherever in the world it lies.

use crate::ground::Diagonals;
use bevy::math::{IVec2, Vec3};
use bevy_rapier3d::parry::shape::{Triangle, TrianglePseudoNormals};

/// How far apart samples are, and which way cells between them are cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lattice {
    /// Metres, a power of two.
    pub step: f32,
    pub diagonals: Diagonals,
}

/// What a side of a tile of `cells` has of samples with those of one step around it.
pub(super) const fn around(cells: i32) -> i32 {
    cells + 3
}

/// A triangle of a cell.
pub(super) struct Part {
    /// In the frame of its cell, front upwards.
    pub triangle: Triangle,
    /// What its normals lie between: half way to those of the triangles beside it.
    pub normals: TrianglePseudoNormals,
    /// How high the frame's origin is, metres.
    pub base: f32,
}

/// Which way the two neighbours of a triangle lie that are not of its cell: of a cell cut from north-west to south-east
/// the left triangle has the sides in the west and south, of another those in the west and north.
const fn neighbours(falls: bool, right: bool) -> [IVec2; 2] {
    match (falls, right) {
        (true, false) => [IVec2::NEG_X, IVec2::Y],
        (true, true) => [IVec2::X, IVec2::NEG_Y],
        (false, false) => [IVec2::NEG_X, IVec2::NEG_Y],
        (false, true) => [IVec2::X, IVec2::Y],
    }
}

impl Lattice {
    /// A triangle of a cell of the world, in the frame whose origin is the corner of the cell `origin`, `base` metres
    /// high.
    fn triangle(
        &self,
        cell: IVec2,
        right: bool,
        (origin, base): (IVec2, f32),
        height: &impl Fn(IVec2) -> f32,
    ) -> Triangle {
        let at = |x, z| {
            let at = cell + IVec2::new(x, z);
            let from = (at - origin).as_vec2() * self.step;
            Vec3::new(from.x, height(at) - base, from.y)
        };
        let (nw, ne, sw, se) = (at(0, 0), at(1, 0), at(0, 1), at(1, 1));
        match (self.diagonals.falls(cell), right) {
            (true, false) => Triangle::new(nw, sw, se),
            (true, true) => Triangle::new(nw, se, ne),
            (false, false) => Triangle::new(nw, sw, ne),
            (false, true) => Triangle::new(sw, se, ne),
        }
    }

    /// A triangle of a cell of the world, by the heights of the samples one step around the cell, metres.
    pub fn part(&self, cell: IVec2, right: bool, height: &impl Fn(IVec2) -> f32) -> Part {
        // Towards zero: what is left of a height near it is then exact in f32. Where a cell is steeper than a cliff of
        // some metres what is left may be rounded, by half a step of f32 at that size.
        let frame = (cell, height(cell).trunc());
        let triangle = self.triangle(cell, right, frame, height);
        let face = triangle.normal().unwrap_or(Vec3::Y);
        let halfway = |other: Triangle| {
            let normal = other.normal().unwrap_or(face);
            // Both point upwards: they are never opposite.
            (face + normal).normalize_or(face)
        };
        let falls = self.diagonals.falls(cell);
        let [one, two] = neighbours(falls, right).map(|by| {
            let there = cell + by;
            // West of an edge along Z is a right triangle, east of it a left one; north of one along X is the left one
            // of a cell that falls and the right one of another, south of it the other way round.
            let its_right = match by {
                IVec2::NEG_X => true,
                IVec2::X => false,
                IVec2::NEG_Y => !self.diagonals.falls(there),
                _ => self.diagonals.falls(there),
            };
            halfway(self.triangle(there, its_right, frame, height))
        });
        let across = halfway(self.triangle(cell, !right, frame, height));
        let normals = TrianglePseudoNormals {
            face,
            edges: [one, two, across],
        };
        Part {
            triangle,
            normals,
            base: frame.1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Heights without any order, some far from zero.
    fn rough(at: IVec2) -> f32 {
        let mixed = at.x.wrapping_mul(7919) ^ at.y.wrapping_mul(104_729);
        (mixed.rem_euclid(1000) as f32) * 1e-3 - 40.5
    }

    /// Every neighbour shares two corners with the triangle, and each of its edges has one.
    #[test]
    fn neighbours_share_an_edge() {
        for diagonals in [Diagonals::Alternating, Diagonals::Alike] {
            let lattice = Lattice {
                step: 0.5,
                diagonals,
            };
            for (cell, right) in (-4..4)
                .flat_map(|x| (-4..4).map(move |z| IVec2::new(x, z)))
                .flat_map(|cell| [(cell, false), (cell, true)])
            {
                let part = lattice.part(cell, right, &rough);
                let corners = [part.triangle.a, part.triangle.b, part.triangle.c];
                // The triangles around, by brute force: all that share two corners.
                let mut expected = Vec::new();
                for by in (-1..=1).flat_map(|x| (-1..=1).map(move |z| IVec2::new(x, z))) {
                    for its_right in [false, true] {
                        let frame = (cell, part.base);
                        let other = lattice.triangle(cell + by, its_right, frame, &rough);
                        let theirs = [other.a, other.b, other.c];
                        let shared = corners.iter().filter(|c| theirs.contains(c)).count();
                        if shared == 2 {
                            let normal = other.normal().expect("it has an area");
                            expected.push((part.normals.face + normal).normalize());
                        }
                    }
                }
                assert_eq!(expected.len(), 3, "{cell} {right}");
                let near = |a: &Vec3, b: &Vec3| a.distance(*b) < 1e-6;
                for edge in &part.normals.edges {
                    assert!(expected.iter().any(|e| near(e, edge)), "{cell} {right}");
                }
                for other in &expected {
                    let known = part.normals.edges.iter().any(|e| near(e, other));
                    assert!(known, "{cell} {right}");
                }
            }
        }
    }

    /// Ten thousand kilometres away, where f32 has steps of a metre, a triangle keeps its bits.
    #[test]
    fn a_triangle_is_the_same_anywhere() {
        let lattice = Lattice {
            step: 0.5,
            diagonals: Diagonals::Alternating,
        };
        let far = IVec2::new(16_000_000, -12_000_000);
        for right in [false, true] {
            let here = lattice.part(IVec2::ZERO, right, &rough);
            let there = lattice.part(far, right, &|at| rough(at - far));
            assert_eq!(here.triangle, there.triangle);
            assert_eq!(here.normals.edges, there.normals.edges);
            assert_eq!(here.base, -40.0);
        }
    }
}
