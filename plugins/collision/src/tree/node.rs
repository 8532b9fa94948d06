//! The nodes of a tree: boxes of up to eight children, side by side, so that one loop tests them all.

use bevy::math::Vec3;

/// No child.
pub const NONE: u32 = u32::MAX;

/// Boxes of up to eight children.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Node {
    /// Least and greatest x, y, z of each child: planes 2 · axis and 2 · axis + 1. A child that is none has its box
    /// turned inside out, so that nothing meets it.
    pub planes: [[f32; 8]; 6],
    /// The node of a child, or the first triangle of a leaf in the tree's order; [`NONE`].
    pub first: [u32; 8],
    /// Triangles of a leaf; 0 of a node.
    pub count: [u32; 8],
    /// Where the node's cell is divided, x, y, z.
    pub middle: [f32; 3],
}

impl Node {
    /// Without children.
    pub const EMPTY: Self = Self {
        planes: [
            [f32::INFINITY; 8],
            [f32::NEG_INFINITY; 8],
            [f32::INFINITY; 8],
            [f32::NEG_INFINITY; 8],
            [f32::INFINITY; 8],
            [f32::NEG_INFINITY; 8],
        ],
        first: [NONE; 8],
        count: [0; 8],
        middle: [0.0; 3],
    };

    /// Sets the box of a child.
    pub fn set_box(&mut self, child: usize, min: Vec3, max: Vec3) {
        for axis in 0..3 {
            self.planes[2 * axis][child] = min[axis];
            self.planes[2 * axis + 1][child] = max[axis];
        }
    }

    /// The box of a child.
    #[inline]
    pub fn child_box(&self, child: usize) -> (Vec3, Vec3) {
        let plane = |i: usize| self.planes[i][child];
        (
            Vec3::new(plane(0), plane(2), plane(4)),
            Vec3::new(plane(1), plane(3), plane(5)),
        )
    }

    /// The box around all children.
    pub fn whole_box(&self) -> (Vec3, Vec3) {
        let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for child in 0..8 {
            let (low, high) = self.child_box(child);
            (min, max) = (min.min(low), max.max(high));
        }
        (min, max)
    }

    /// Which children overlap a box, a bit each.
    #[inline]
    pub fn overlapping(&self, min: Vec3, max: Vec3) -> u32 {
        let mut apart = [false; 8];
        for axis in 0..3 {
            let (low, high) = (&self.planes[2 * axis], &self.planes[2 * axis + 1]);
            for i in 0..8 {
                apart[i] |= low[i] > max[axis] || high[i] < min[axis];
            }
        }
        let mut bits = 0;
        for (i, apart) in apart.into_iter().enumerate() {
            bits |= u32::from(!apart) << i;
        }
        bits
    }
}

/// Works out the boxes of the first `count` nodes from the triangles and from the nodes after them: a parent stands
/// before its children.
pub fn fit(nodes: &mut [Node], count: usize, corners: &[[Vec3; 3]]) {
    for index in (0..count).rev() {
        let mut node = nodes[index];
        for child in 0..8 {
            let (first, count) = (node.first[child], node.count[child]);
            let (min, max) = if count > 0 {
                around(&corners[first as usize..(first + count) as usize])
            } else if first == NONE {
                continue;
            } else {
                nodes[first as usize].whole_box()
            };
            node.set_box(child, min, max);
        }
        nodes[index] = node;
    }
}

fn around(corners: &[[Vec3; 3]]) -> (Vec3, Vec3) {
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for corner in corners.iter().flatten() {
        (min, max) = (min.min(*corner), max.max(*corner));
    }
    (min, max)
}
