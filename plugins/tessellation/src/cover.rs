//! Which patches cover the ground: a quadtree around the focus, its corners and its edges.
//!
//! The choice is stateless: it depends on the extent, the settings and the focus alone, so that
//! looking away and back gives the same patches. Patches on both sides of an edge share one
//! record of it, which owns the vertices on it: cracks cannot be expressed.
//!
//! Balance. A node of side s is split while d < c·s, d being the distance from the focus to the
//! node. Let a leaf A (side s, d(A) >= c·s) touch a split node Q of side s/2 (d(Q) < c·s/2). The
//! distance is 1-Lipschitz and Q's diameter at most s/√2, so d(A) <= d(Q) + s/√2, hence
//! c < c/2 + 1/√2, c < √2. With c >= 1.5 no leaf touches one that is more than one level finer.

use std::collections::HashMap;

use bevy::math::{DVec2, DVec3, UVec2};
use dolomite_terrain::{GroundPoint, GroundRect};

use crate::layout::{Corner, Edge, NONE, Patch};
use crate::settings::TerrainView;

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

/// The patches, edges and corners that cover a terrain for one focus.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cover {
    /// One a leaf, in the leaves' order.
    pub patches: Vec<Patch>,
    /// One a pair of neighbouring corners.
    pub edges: Vec<Edge>,
    /// One a distinct corner.
    pub corners: Vec<Corner>,
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

/// Settings with every field in its documented range.
pub(crate) fn clamped(view: &TerrainView) -> TerrainView {
    let finite = |value: f32, low: f32, high: f32, default: f32| {
        if value.is_finite() {
            value.clamp(low, high)
        } else {
            default
        }
    };
    TerrainView {
        pixels_per_edge: finite(view.pixels_per_edge, 1.0, 256.0, 8.0),
        finest_patch: finite(view.finest_patch, 1.0, 4096.0, 16.0),
        split_distance: finite(view.split_distance, 1.5, 16.0, 2.0),
        max_vertices: view.max_vertices.clamp(1 << 16, 1 << 23),
        max_triangles: view.max_triangles.clamp(1 << 17, 10_000_000),
        ..view.clone()
    }
}

impl Cover {
    /// Links the leaves of a balanced quadtree; `bounds` gives (least, greatest) height of a node.
    pub fn new(
        lattice: &Lattice,
        leaves: &[Node],
        mut bounds: impl FnMut(Node) -> (f32, f32),
    ) -> Self {
        let mut cover = Self::default();
        cover.patches.reserve(leaves.len());
        cover.edges.reserve(leaves.len() * 3);
        cover.corners.reserve(leaves.len() * 2);
        let mut corner_ids: HashMap<UVec2, u32> = HashMap::with_capacity(leaves.len() * 2);
        for (id, leaf) in (0_u32..).zip(leaves) {
            let corners = leaf_corners(*leaf).map(|point| {
                let corner = *corner_ids.entry(point).or_insert_with(|| {
                    cover.corners.push(new_corner(lattice.position(point)));
                    cover.corners.len() as u32 - 1
                });
                let around = &mut cover.corners[corner as usize].patches;
                if let Some(slot) = around.iter_mut().find(|slot| **slot == NONE) {
                    *slot = id;
                }
                corner
            });
            let (min_height, max_height) = bounds(*leaf);
            cover.patches.push(Patch {
                corners,
                edges: [NONE; 8],
                min_height,
                max_height,
                visible: 0,
                vertex: 0,
                triangle: 0,
                inner: 0,
                pad: [0; 2],
            });
        }
        let mut edge_ids: HashMap<[u32; 2], u32> = HashMap::with_capacity(leaves.len() * 3);
        for (id, leaf) in (0_u32..).zip(leaves) {
            let points = leaf_corners(*leaf);
            let ends = cover.patches[id as usize].corners;
            for (side, [from, to]) in SIDES.into_iter().enumerate() {
                let half = (points[to] - points[from]) / 2;
                let middle = (leaf.side > 1)
                    .then(|| corner_ids.get(&(points[from] + half)).copied())
                    .flatten();
                let pieces = match middle {
                    Some(middle) => [Some([ends[from], middle]), Some([middle, ends[to]])],
                    None => [Some([ends[from], ends[to]]), None],
                };
                for (piece, pair) in pieces.into_iter().enumerate() {
                    let Some(pair) = pair else { continue };
                    let edge = *edge_ids.entry(pair).or_insert_with(|| {
                        cover.edges.push(new_edge(pair));
                        cover.edges.len() as u32 - 1
                    });
                    let beside = &mut cover.edges[edge as usize].patches;
                    beside[usize::from(beside[0] != NONE)] = id;
                    cover.patches[id as usize].edges[side * 2 + piece] = edge;
                }
                // The corner in the middle of a side belongs to this patch's outline too.
                if let Some(middle) = middle {
                    let around = &mut cover.corners[middle as usize].patches;
                    if let Some(slot) = around.iter_mut().find(|slot| **slot == NONE) {
                        *slot = id;
                    }
                }
            }
        }
        cover
    }
}

/// The two corners of each side, in ascending x or z; see [`Patch`].
pub const SIDES: [[usize; 2]; 4] = [[0, 1], [2, 3], [0, 2], [1, 3]];

fn leaf_corners(leaf: Node) -> [UVec2; 4] {
    [UVec2::ZERO, UVec2::X, UVec2::Y, UVec2::ONE].map(|offset| leaf.corner + offset * leaf.side)
}

fn new_corner(position: DVec2) -> Corner {
    let GroundPoint { cell, frac } = GroundPoint::new(position);
    Corner {
        cell: cell.to_array(),
        frac: frac.to_array(),
        patches: [NONE; 4],
        vertex: NONE,
        pad: [0; 3],
    }
}

fn new_edge(corners: [u32; 2]) -> Edge {
    Edge {
        corners,
        patches: [NONE; 2],
        wanted: 0,
        level: 0,
        vertex: NONE,
        pad: 0,
    }
}
