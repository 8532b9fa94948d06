//! Whether a mesh of triangles is closed.

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
