//! Which patches cover the ground: the leaves of a quadtree around the focus.
//!
//! The choice is stateless: it depends on the extent, the settings and the focus alone, so that
//! looking away and back gives the same patches.
//!
//! Balance. A node of side s is split while d < c·s, d being the distance from the focus to the
//! node. Let a leaf A (side s, d(A) >= c·s) touch a split node Q of side s/2 (d(Q) < c·s/2). The
//! distance is 1-Lipschitz and Q's diameter at most s/√2, so d(A) <= d(Q) + s/√2, hence
//! c < c/2 + 1/√2, c < √2. With c >= 1.5 no leaf touches one that is more than one level finer.

use bevy::math::{DVec2, DVec3, UVec2};
use dolomite_terrain::GroundRect;

/// Deepest quadtree: 2²⁰ finest patches along a root's side.
const MAX_DEPTH: u32 = 20;

/// A quadtree node: its lower corner on the finest lattice, and its side in lattice steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Node {
    /// Lattice coordinates of the corner with the least x and z.
    pub corner: UVec2,
    /// Side in lattice steps, a power of two.
    pub side: u32,
}

/// The lattice of patch corners over an extent.
///
/// The extent is cut into `roots` near-square quadtree roots, each of 2^`depth` lattice steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    extent: GroundRect,
    roots: UVec2,
    depth: u32,
}

impl Lattice {
    /// A lattice whose steps are at most `finest` metres (as far as the greatest depth allows).
    pub fn new(extent: GroundRect, finest: f64) -> Self {
        let size = extent.max - extent.min;
        let shorter = size.min_element().max(f64::MIN_POSITIVE);
        let roots = (size / shorter)
            .round()
            .as_uvec2()
            .clamp(UVec2::ONE, UVec2::splat(256));
        let root = (size / roots.as_dvec2()).max_element();
        let mut depth = 0;
        while depth < MAX_DEPTH && root / f64::from(1_u32 << depth) > finest * 1.000_001 {
            depth += 1;
        }
        Self {
            extent,
            roots,
            depth,
        }
    }

    /// Lattice steps along x and z.
    pub fn steps(&self) -> UVec2 {
        self.roots << self.depth
    }

    /// Longer side of one lattice step, metres.
    pub fn step(&self) -> f64 {
        ((self.extent.max - self.extent.min) / self.steps().as_dvec2()).max_element()
    }

    /// World position (x, z) of a lattice point, metres. The extent's own corners are exact.
    pub fn position(&self, point: UVec2) -> DVec2 {
        let t = point.as_dvec2() / self.steps().as_dvec2();
        self.extent.min * (DVec2::ONE - t) + self.extent.max * t
    }

    /// The ground that a node covers.
    pub fn rect(&self, node: Node) -> GroundRect {
        GroundRect {
            min: self.position(node.corner),
            max: self.position(node.corner + node.side),
        }
    }

    /// The leaves for a focus at (x, z) and at `height` metres above the ground: from fine to coarse,
    /// each size in Morton order.
    pub fn leaves(&self, focus: DVec2, height: f64, split: f64) -> Vec<Node> {
        let side = 1_u32 << self.depth;
        let step = self.step();
        let mut stack = Vec::with_capacity(64);
        for z in (0..self.roots.y).rev() {
            for x in (0..self.roots.x).rev() {
                stack.push(Node {
                    corner: UVec2::new(x, z) * side,
                    side,
                });
            }
        }
        let mut leaves = Vec::with_capacity(1024);
        while let Some(node) = stack.pop() {
            let rect = self.rect(node);
            let outside = (rect.min - focus).max(focus - rect.max).max(DVec2::ZERO);
            let distance = (outside.length_squared() + height * height).sqrt();
            if node.side > 1 && distance < split * step * f64::from(node.side) {
                let half = node.side / 2;
                for child in [UVec2::ONE, UVec2::Y, UVec2::X, UVec2::ZERO] {
                    stack.push(Node {
                        corner: node.corner + child * half,
                        side: half,
                    });
                }
            } else {
                leaves.push(node);
            }
        }
        // Fine leaves are near leaves: drawn first, they hide what lies behind before it is shaded.
        leaves.sort_by_key(|leaf| leaf.side);
        leaves
    }
}

/// Height of the focus above the ground, clamped to what the selection can use.
pub(crate) fn selection_height(focus: DVec3, ground: f64) -> f64 {
    let height = focus.y - ground;
    if height.is_finite() {
        height.max(0.0)
    } else {
        0.0
    }
}
