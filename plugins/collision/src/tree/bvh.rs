//! Building a BVH: two children a node by `obvhs`, taken together by eights.
//!
//! `obvhs` merges neighbours along a space-filling curve bottom up (D. Meister, J. Bittner, Parallel
//! Locally-Ordered Clustering, 2018) and moves nodes to better parents. Here the child with the greatest surface
//! is opened until eight children are found.

use super::TreeSettings;
use super::node::{Node, fit};
use crate::mesh::TriangleMesh;
use bevy::math::Vec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::{Boundable, BvhBuildParams};
use std::time::Duration;

struct Bounds(Aabb);

impl Boundable for Bounds {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// Nodes, and which triangle stands where.
pub fn build(mesh: &TriangleMesh, settings: &TreeSettings) -> (Vec<Node>, Vec<u32>) {
    let boxes: Vec<Bounds> = (0..mesh.triangles().len() as u32)
        .map(|triangle| {
            let [a, b, c] = mesh.local_corners(triangle);
            let (min, max) = (a.min(b).min(c), a.max(b).max(c));
            Bounds(Aabb::new(min.to_array().into(), max.to_array().into()))
        })
        .collect();
    if boxes.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let parameters = BvhBuildParams {
        max_prims_per_leaf: settings.leaf_triangles.clamp(1, 255) as u32,
        ..BvhBuildParams::medium_build()
    };
    let mut time = Duration::ZERO;
    let two = build_bvh2(&boxes, parameters, &mut time);
    let order = two.primitive_indices.clone();
    let mut nodes = vec![Node::EMPTY];
    // What is left to be hung below a node, and the children of `obvhs` that become its own.
    let mut open = vec![(0, children(&two.nodes, &two.nodes[0]))];
    while let Some((node, kept)) = open.pop() {
        let mut middle = Vec3::ZERO;
        for (child, &index) in kept.iter().enumerate() {
            let two_node = &two.nodes[index];
            let bounds = two_node.aabb();
            middle +=
                Vec3::from_array(bounds.min.to_array()) + Vec3::from_array(bounds.max.to_array());
            if two_node.prim_count > 0 {
                nodes[node].first[child] = two_node.first_index;
                nodes[node].count[child] = two_node.prim_count;
            } else {
                nodes[node].first[child] = nodes.len() as u32;
                open.push((nodes.len(), children(&two.nodes, two_node)));
                nodes.push(Node::EMPTY);
            }
        }
        nodes[node].middle = (middle / (2.0 * kept.len() as f32)).to_array();
    }
    let corners: Vec<[Vec3; 3]> = order.iter().map(|&i| mesh.local_corners(i)).collect();
    let count = nodes.len();
    fit(&mut nodes, count, &corners);
    (nodes, order)
}

/// Up to eight nodes below one of two children, or it alone if it is a leaf.
fn children(nodes: &[Bvh2Node], of: &Bvh2Node) -> Vec<usize> {
    if of.prim_count > 0 {
        // Only the root is asked that.
        return vec![0];
    }
    let pair = |node: &Bvh2Node| [node.first_index as usize, node.first_index as usize + 1];
    let mut kept = pair(of).to_vec();
    while kept.len() < 8 {
        let surface = |&at: &usize| nodes[kept[at]].aabb().half_area();
        let widest = (0..kept.len())
            .filter(|&at| nodes[kept[at]].prim_count == 0)
            .max_by(|a, b| surface(a).total_cmp(&surface(b)).then(b.cmp(a)));
        let Some(widest) = widest else {
            break;
        };
        let [left, right] = pair(&nodes[kept[widest]]);
        kept[widest] = left;
        kept.push(right);
    }
    kept
}
