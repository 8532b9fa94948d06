//! Whether a mesh of triangles is closed.

use crate::random::Random;
use bevy::math::Vec3;
use bevy::platform::collections::HashSet;

/// Edges that a mesh uses in one direction alone, and how often an edge is used twice in one direction.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Edges {
    /// (from, to), as a triangle goes round; without a triangle that goes the other way.
    pub open: Vec<(u32, u32)>,
    /// Edges that two triangles use in the same direction: one of them is turned, or there twice.
    pub doubled: usize,
}

/// The edges of triangles by the numbers of their vertices. A closed surface has no open edge and no
/// doubled one.
pub fn edges(triangles: &[[u32; 3]]) -> Edges {
    let mut known = HashSet::new();
    let mut found = Edges::default();
    for &[a, b, c] in triangles {
        for edge in [(a, b), (b, c), (c, a)] {
            found.doubled += usize::from(!known.insert(edge));
        }
    }
    found.open = known
        .iter()
        .filter(|&&(a, b)| !known.contains(&(b, a)))
        .copied()
        .collect();
    found.open.sort_unstable();
    found
}

/// A closed surface: a sphere whose vertices are pushed in and out, so that edges are ridges and valleys.
#[must_use]
pub fn bumpy_sphere(random: &mut Random, rings: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let sectors = 2 * rings;
    let mut vertices = vec![Vec3::Y * 2.0, Vec3::NEG_Y * 2.0];
    for ring in 1..rings {
        for sector in 0..sectors {
            let up = 1.0 - 2.0 * ring as f32 / rings as f32;
            let out = (1.0 - up * up).sqrt();
            // Around a square in place of a circle: no sine is needed.
            let turn = 4.0 * sector as f32 / sectors as f32;
            let (side, along) = (turn as u32, turn.fract());
            let (x, z) = [
                (1.0 - along, along),
                (-along, 1.0 - along),
                (along - 1.0, -along),
                (along, along - 1.0),
            ][side as usize % 4];
            let scale = 1.0 + 0.3 * random.unit_f32();
            vertices.push(Vec3::new(x * out, up, z * out) * scale);
        }
    }
    let at = |ring: u32, sector: u32| 2 + (ring - 1) * sectors + sector % sectors;
    let mut triangles = Vec::new();
    for sector in 0..sectors {
        triangles.push([0, at(1, sector + 1), at(1, sector)]);
        triangles.push([1, at(rings - 1, sector), at(rings - 1, sector + 1)]);
        for ring in 1..rings - 1 {
            let (a, b) = (at(ring, sector), at(ring, sector + 1));
            let (c, d) = (at(ring + 1, sector), at(ring + 1, sector + 1));
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    (vertices, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];

    #[test]
    fn a_tetrahedron_is_closed() {
        assert_eq!(edges(&TETRAHEDRON), Edges::default());
    }

    #[test]
    fn a_missing_triangle_leaves_three_edges_and_a_turned_one_doubles_three() {
        let open = edges(&TETRAHEDRON[1..]).open;
        assert_eq!(open, [(0, 2), (1, 0), (2, 1)]);
        let mut turned = TETRAHEDRON;
        turned[0].swap(1, 2);
        assert_eq!(edges(&turned).doubled, 3);
    }
}
