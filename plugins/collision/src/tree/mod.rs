//! Trees over triangles: an octree and a BVH behind one interface.
//!
//! | query | what it gives |
//! |---|---|
//! | [`TriangleTree::first_hit`], [`TriangleTree::blocked`], [`TriangleTree::first_hits`] | rays, watertight |
//! | [`TriangleTree::overlapping`] | triangles that overlap a volume |
//! | [`TriangleTree::nearest`] | the nearest point |
//! | [`TriangleTree::sweep`] | the first triangle that a moving ellipsoid touches |
//! | [`TriangleTree::front_to_back`] | leaves in the order of a viewer |
//!
//! All answers are those of testing every triangle; where two are the same, the triangle with the lower number
//! counts. Both trees have the same nodes and are traversed by the same code: they differ in who divides the
//! triangles.

mod bvh;
mod cast;
mod front;
mod near;
mod node;
mod octree;
mod overlap;
mod rays;
mod stack;

pub use near::Nearest;

use crate::mesh::{MeshError, TriangleMesh};
use crate::volume::Aabb;
use bevy::math::Vec3;
use node::Node;

/// Who divides the triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TreeKind {
    /// Cells of space, halved along all axes.
    Octree,
    /// Boxes of least surface, by the crate `obvhs`, taken together by eights. Slower to build.
    #[default]
    Bvh,
    /// No tree: every triangle is tested. Trees are held to it, and it is the quickest for a few triangles.
    List,
}

/// How a tree is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TreeSettings {
    /// Who divides the triangles.
    pub kind: TreeKind,
    /// Most triangles of a leaf, except where the depth ends; at least 1.
    pub leaf_triangles: usize,
    /// Deepest leaf of an octree, 1 to 21; triangles whose centres lie closer than that share a leaf.
    pub depth: u32,
}

impl Default for TreeSettings {
    fn default() -> Self {
        Self {
            kind: TreeKind::default(),
            // The quickest for rays over three meshes: `dolomite_lab rays`.
            leaf_triangles: 8,
            depth: 21,
        }
    }
}

/// Where a ray hits a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// When, in parts of the ray's direction.
    pub time: f64,
    /// Which triangle.
    pub triangle: u32,
    /// The weights of its corners at the hit; their sum is 1. Of the f32 ray: off by some 1e-7 of the distance over
    /// the triangle's size.
    pub barycentric: [f64; 3],
}

/// A mesh that can be asked.
#[derive(Clone, Debug)]
pub struct TriangleTree {
    mesh: TriangleMesh,
    settings: TreeSettings,
    nodes: Vec<Node>,
    /// Which triangle stands where in leaves.
    order: Vec<u32>,
    /// Their corners, in that order.
    corners: Vec<[Vec3; 3]>,
}

impl TriangleTree {
    /// Builds the tree of a mesh, an octree on all cores.
    #[must_use]
    pub fn new(mesh: TriangleMesh, settings: TreeSettings) -> Self {
        let (nodes, order) = match settings.kind {
            TreeKind::Octree => octree::build(&mesh, &settings),
            TreeKind::Bvh => bvh::build(&mesh, &settings),
            TreeKind::List => list(&mesh),
        };
        let corners = order.iter().map(|&i| mesh.local_corners(i)).collect();
        Self {
            mesh,
            settings,
            nodes,
            order,
            corners,
        }
    }

    /// Its triangles.
    #[must_use]
    pub const fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// How it was built.
    #[must_use]
    pub const fn settings(&self) -> TreeSettings {
        self.settings
    }

    /// Bytes that it holds, the mesh included.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
            + size_of_val(self.order.as_slice())
            + size_of_val(self.corners.as_slice())
            + size_of_val(self.mesh.vertices())
            + size_of_val(self.mesh.triangles())
    }

    /// Most triangles that one leaf holds.
    #[must_use]
    pub fn largest_leaf(&self) -> usize {
        let counts = self.nodes.iter().flat_map(|node| node.count);
        counts.max().unwrap_or(0) as usize
    }

    /// The box around it, tight; `None` of no triangles.
    #[must_use]
    pub fn bounds(&self) -> Option<Aabb> {
        let (min, max) = self.nodes.first()?.whole_box();
        Some(Aabb {
            min: self.mesh.origin() + min.as_dvec3(),
            max: self.mesh.origin() + max.as_dvec3(),
        })
    }

    /// Moves the vertices and fits the boxes to them, without dividing anew: answers stay right, and become slower
    /// the farther triangles move apart that were near.
    ///
    /// # Errors
    /// [`MeshError::Count`] and [`MeshError::Vertex`]; the tree is then as it was.
    pub fn refit(&mut self, vertices: &[Vec3]) -> Result<(), MeshError> {
        self.mesh.move_vertices(vertices)?;
        for (corners, &triangle) in self.corners.iter_mut().zip(&self.order) {
            *corners = self.mesh.local_corners(triangle);
        }
        let count = self.nodes.len();
        node::fit(&mut self.nodes, count, &self.corners);
        Ok(())
    }
}

/// One leaf.
fn list(mesh: &TriangleMesh) -> (Vec<Node>, Vec<u32>) {
    let count = mesh.triangles().len() as u32;
    if count == 0 {
        return (Vec::new(), Vec::new());
    }
    let order: Vec<u32> = (0..count).collect();
    let mut node = Node::EMPTY;
    (node.first[0], node.count[0]) = (0, count);
    let corners: Vec<_> = order.iter().map(|&i| mesh.local_corners(i)).collect();
    let mut nodes = vec![node];
    node::fit(&mut nodes, 1, &corners);
    (nodes, order)
}
