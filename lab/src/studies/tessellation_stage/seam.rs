//! Whether the triangles on both sides of a common side meet there: as sets of edges between
//! positions, bit by bit.

use std::collections::{HashMap, HashSet};

/// A position, to the bit.
pub type Bits = [u32; 3];

/// What lies along a common side.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Seam {
    /// Positions on it that triangles use.
    pub vertices: usize,
    /// Edges of triangles on it that have no counterpart with the same bits on the other side.
    pub open: usize,
}

/// The edges of triangles along the common sides of some pairs.
#[derive(Debug, Default)]
pub struct Seams {
    edges: HashMap<(u32, Bits, Bits), bool>,
    vertices: HashSet<(u32, Bits)>,
}

impl Seams {
    /// Adds a triangle of a pair: the positions of its corners, and which of them lie on the pair's
    /// common side.
    pub fn add(&mut self, pair: u32, corners: [(Bits, bool); 3]) {
        for (k, (a, on)) in corners.into_iter().enumerate() {
            let (b, next_on) = corners[(k + 1) % 3];
            if !on {
                continue;
            }
            self.vertices.insert((pair, a));
            // Both ends of a segment of no length are one.
            if next_on && a != b {
                let odd = self.edges.entry((pair, a.min(b), a.max(b))).or_default();
                // An edge that an even number of triangles has is closed: whatever the directions
                // of both patches, and where mode `d3d` folds a side.
                *odd = !*odd;
            }
        }
    }

    /// What lies along the common side of each of so many pairs.
    #[must_use]
    pub fn found(&self, pairs: usize) -> Vec<Seam> {
        let mut found = vec![Seam::default(); pairs];
        for (pair, _) in &self.vertices {
            found[*pair as usize].vertices += 1;
        }
        for ((pair, ..), odd) in &self.edges {
            found[*pair as usize].open += usize::from(*odd);
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles over one edge, from (0, 0) to (0, 1), of which the second has its own end.
    fn two(end: u32) -> Seam {
        let [a, b, c, d] = [[0, 0, 0], [0, 1, 0], [1, 0, 0], [2, 0, 0]];
        let mut seams = Seams::default();
        seams.add(0, [(a, true), (b, true), (c, false)]);
        seams.add(0, [([0, end, 0], true), (a, true), (d, false)]);
        seams.found(1)[0]
    }

    #[test]
    fn a_bit_opens_the_seam() {
        assert_eq!(
            two(1),
            Seam {
                vertices: 2,
                open: 0
            }
        );
        assert_eq!(
            two(0x3f80_0001),
            Seam {
                vertices: 3,
                open: 2
            }
        );
    }

    #[test]
    fn a_vertex_on_one_side_alone_opens_the_seam() {
        let [a, m, b, c, d] = [[0; 3], [0, 1, 0], [0, 2, 0], [1, 0, 0], [2, 0, 0]];
        let mut seams = Seams::default();
        seams.add(0, [(a, true), (m, true), (c, false)]);
        seams.add(0, [(m, true), (b, true), (c, false)]);
        seams.add(0, [(b, true), (a, true), (d, false)]);
        assert_eq!(
            seams.found(1)[0],
            Seam {
                vertices: 3,
                open: 3
            }
        );
    }

    #[test]
    fn segments_of_no_length_are_none() {
        let (a, c) = ([0; 3], [1, 0, 0]);
        let mut seams = Seams::default();
        seams.add(0, [(a, true), (a, true), (c, false)]);
        assert_eq!(
            seams.found(1)[0],
            Seam {
                vertices: 1,
                open: 0
            }
        );
    }
}
