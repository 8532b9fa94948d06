//! Longest edge bisection: a square of two right triangles, each cut from the middle of its longest
//! side to the opposite corner, without end (M. Rivara 1984; as terrain: P. Lindstrom et al. 1996,
//! M. Duchaineau et al. 1997).
//!
//! The mesh is the set of middles that are in it. Two triangles share a longest side and are cut
//! together; both are there if the corners opposite to that side are, which are middles themselves.
//! A set that holds with each middle those two corners is a mesh without T-junctions: that is what
//! ROAM's forced splits come to. Corners are integers on a lattice of 2²⁴ steps a side.

use bevy::math::DVec2;
use bevy::platform::collections::{HashMap, HashSet};
use dolomite_terrain::GroundRect;
use dolomite_testkit::cores::on_all_cores;

/// A corner, steps of the lattice along x and z.
pub type Node = [u32; 2];
/// Steps along a side of the square.
pub const SIDE: u32 = 1 << 24;

/// A right triangle of the hierarchy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Triangle {
    /// Where the two short sides meet.
    pub apex: Node,
    /// One end of the longest side.
    pub left: Node,
    /// Its other end.
    pub right: Node,
}

impl Triangle {
    /// The two that fill the square.
    pub const ROOTS: [Self; 2] = [
        Self {
            apex: [SIDE, 0],
            left: [0, 0],
            right: [SIDE, SIDE],
        },
        Self {
            apex: [0, SIDE],
            left: [SIDE, SIDE],
            right: [0, 0],
        },
    ];

    /// Middle of the longest side; `None` for the smallest triangles, whose sides are single steps.
    #[must_use]
    pub fn middle(&self) -> Option<Node> {
        let sum = [0, 1].map(|axis| self.left[axis] + self.right[axis]);
        (sum[0] % 2 == 0 && sum[1] % 2 == 0).then(|| sum.map(|s| s / 2))
    }

    /// The halves.
    #[must_use]
    pub fn children(&self, middle: Node) -> [Self; 2] {
        [
            Self {
                apex: middle,
                left: self.apex,
                right: self.left,
            },
            Self {
                apex: middle,
                left: self.right,
                right: self.apex,
            },
        ]
    }

    /// Its corners.
    #[must_use]
    pub const fn corners(&self) -> [Node; 3] {
        [self.apex, self.left, self.right]
    }
}

/// The corners opposite to the longest side that has `node` as its middle; none for corners of the
/// square, one at its border.
///
/// Let 2ᵗ be the largest step that divides both coordinates. Where it divides one of them twice, the
/// side runs along the other axis, and the corners are the middles of the squares beside it. Else the
/// node is the middle of a square, and the side is that of its diagonals that starts at the middle of
/// the larger square: the other one's ends are odd in one coordinate.
fn opposite(node: Node) -> impl Iterator<Item = Node> {
    let step = 1 << (node[0] | node[1]).trailing_zeros().min(24);
    let odd = [node[0] & step != 0, node[1] & step != 0];
    let at = move |dx: i64, dz: i64| {
        let moved = [(0, dx), (1, dz)].map(|(axis, d)| {
            u32::try_from(i64::from(node[axis]) + d * i64::from(step))
                .ok()
                .filter(|&c| c <= SIDE)
        });
        Some([moved[0]?, moved[1]?])
    };
    let ends = if step == SIDE {
        [None; 2]
    } else {
        match odd {
            [true, false] => [at(0, -1), at(0, 1)],
            [false, true] => [at(-1, 0), at(1, 0)],
            _ => {
                let corner = [node[0] - step, node[1] - step];
                let double = 2 * step;
                if (corner[0] & double != 0) == (corner[1] & double != 0) {
                    [at(1, -1), at(-1, 1)]
                } else {
                    [at(-1, -1), at(1, 1)]
                }
            }
        }
    };
    ends.into_iter().flatten()
}

/// How a square of the lattice lies on the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    /// What it covers.
    pub extent: GroundRect,
}

impl Lattice {
    /// The place of a corner, metres.
    #[must_use]
    pub fn place(&self, node: Node) -> DVec2 {
        let share = DVec2::new(f64::from(node[0]), f64::from(node[1])) / f64::from(SIDE);
        self.extent.min + self.extent.size() * share
    }

    /// The rectangle about a triangle.
    #[must_use]
    pub fn rect(&self, triangle: &Triangle) -> GroundRect {
        let [a, b, c] = triangle.corners().map(|node| self.place(node));
        GroundRect::new(a.min(b).min(c), a.max(b).max(c))
    }
}

/// A mesh of the hierarchy.
#[derive(Debug, Clone, Default)]
pub struct Bisection {
    middles: HashSet<Node>,
}

impl Bisection {
    /// Cuts at a middle, and wherever that forces a cut.
    pub fn cut(&mut self, middle: Node) {
        let mut open = vec![middle];
        while let Some(node) = open.pop() {
            if (node[0] | node[1]) & (SIDE - 1) != 0 && self.middles.insert(node) {
                open.extend(opposite(node));
            }
        }
    }

    /// The triangles that are not cut.
    #[must_use]
    pub fn leaves(&self) -> Vec<Triangle> {
        let mut leaves = Vec::new();
        let mut open = Triangle::ROOTS.to_vec();
        while let Some(triangle) = open.pop() {
            match triangle.middle().filter(|m| self.middles.contains(m)) {
                Some(middle) => open.extend(triangle.children(middle)),
                None => leaves.push(triangle),
            }
        }
        leaves
    }

    /// The coarsest mesh in which no triangle measures more than `limit`, but for the smallest of the
    /// lattice: ROAM's queue, run until its first entry is at the limit. Which triangle comes first
    /// makes no difference then, so all of a round are measured at once, on all cores. `known` keeps
    /// measures for the next limit. `None` beyond `most` triangles.
    pub fn refine(
        limit: f64,
        known: &mut HashMap<Triangle, f64>,
        most: usize,
        measure: impl Fn(&Triangle) -> f64 + Sync,
    ) -> Option<Vec<Triangle>> {
        /// Triangles handed to a core at once.
        const BATCH: usize = 64;
        let mut mesh = Self::default();
        loop {
            let leaves = mesh.leaves();
            if leaves.len() > most {
                return None;
            }
            let new: Vec<_> = leaves.iter().filter(|t| !known.contains_key(*t)).collect();
            let batches: Vec<_> = new.chunks(BATCH).collect();
            let measured = on_all_cores(&batches, |batch| {
                batch.iter().map(|t| measure(t)).collect::<Vec<_>>()
            });
            let new: Vec<Triangle> = new.into_iter().copied().collect();
            known.extend(new.into_iter().zip(measured.into_iter().flatten()));
            let before = mesh.middles.len();
            for triangle in &leaves {
                if known[triangle] > limit
                    && let Some(middle) = triangle.middle()
                {
                    mesh.cut(middle);
                }
            }
            if mesh.middles.len() == before {
                return Some(leaves);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dolomite_testkit::random::Random;

    /// Twice the area, steps².
    fn area(t: &Triangle) -> i128 {
        let [a, b, c] = t.corners().map(|n| n.map(i128::from));
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    /// Corners that lie inside of a side of some triangle.
    fn hanging(leaves: &[Triangle]) -> usize {
        let corners: HashSet<Node> = leaves.iter().flat_map(|t| t.corners()).collect();
        let mut hanging = 0;
        for t in leaves {
            // Sides are cut at their middles first; a corner elsewhere on one implies the middle.
            let [a, b, c] = t.corners();
            for (p, q) in [(a, b), (b, c), (c, a)] {
                let sum = [p[0] + q[0], p[1] + q[1]];
                let middle = (sum[0] % 2 == 0 && sum[1] % 2 == 0).then(|| sum.map(|s| s / 2));
                hanging += usize::from(middle.is_some_and(|m| corners.contains(&m)));
            }
        }
        hanging
    }

    #[test]
    fn any_cuts_give_a_mesh_without_hanging_corners_that_fills_the_square() {
        let mut random = Random::new(2);
        for _ in 0..20 {
            let mut mesh = Bisection::default();
            for _ in 0..60 {
                // The middle of a random leaf, near a random corner of the lattice more often.
                let leaves = mesh.leaves();
                let smallest = leaves.iter().min_by_key(|t| area(t).abs()).unwrap();
                let pick = leaves[random.next_u32() as usize % leaves.len()];
                let chosen = if random.next_u32().is_multiple_of(3) {
                    pick
                } else {
                    *smallest
                };
                mesh.cut(chosen.middle().unwrap());
            }
            let leaves = mesh.leaves();
            assert!(leaves.len() > 120);
            assert_eq!(hanging(&leaves), 0);
            // With +Z to the south, counter-clockwise from above.
            assert!(leaves.iter().all(|t| area(t) < 0), "one winding");
            let whole: i128 = leaves.iter().map(area).sum();
            assert_eq!(whole, -2 * i128::from(SIDE) * i128::from(SIDE));
        }
    }

    #[test]
    fn a_cut_without_its_forced_cuts_is_seen() {
        let mut mesh = Bisection::default();
        for _ in 0..8 {
            let leaves = mesh.leaves();
            let smallest = leaves.iter().min_by_key(|t| area(t).abs()).unwrap();
            mesh.middles.insert(smallest.middle().unwrap());
        }
        assert!(hanging(&mesh.leaves()) > 0);
    }

    #[test]
    fn refinement_stops_at_the_limit_and_no_sooner() {
        let lattice = Lattice {
            extent: GroundRect::square(DVec2::ZERO, 1024.0),
        };
        // Longest side over the distance to a place.
        let measure = |t: &Triangle| {
            let length = lattice.place(t.left).distance(lattice.place(t.right));
            length / (1.0 + lattice.rect(t).centre().distance(DVec2::new(300.0, -200.0)))
        };
        let mut known = HashMap::default();
        let coarse = Bisection::refine(0.5, &mut known, 1 << 20, measure).unwrap();
        let fine = Bisection::refine(0.1, &mut known, 1 << 20, measure).unwrap();
        assert!(coarse.iter().all(|t| measure(t) <= 0.5));
        assert!(fine.iter().all(|t| measure(t) <= 0.1));
        assert!(
            fine.len() > 10 * coarse.len(),
            "{} {}",
            fine.len(),
            coarse.len()
        );
        assert_eq!(hanging(&fine), 0);
        // The same without what is known already.
        let again = Bisection::refine(0.1, &mut HashMap::default(), 1 << 20, measure).unwrap();
        assert_eq!(again, fine);
        assert_eq!(Bisection::refine(0.1, &mut known, 100, measure), None);
    }
}
