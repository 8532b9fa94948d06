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
use obvhs::ploc::PlocSearchDistance;
use obvhs::{Boundable, BvhBuildParams};
use std::time::Duration;

/// How much of its own size a box is made larger by at most before boxes are merged, and of the side of all at most where
/// it has next to none.
///
/// `obvhs` merges in a round whoever are each other's best neighbours. Of boxes of one size in a row, of many that are one
/// and the same or lie within each other, the best neighbour of each is the next one: a round then merges a single pair,
/// and time goes with the square of their number (16 000 in a row: 890 times that of as many at random places). Sizes that
/// differ by chance merge a fixed share in every round. The tree's own boxes are fitted to the triangles afterwards.
const UNEVEN: f32 = 0.03;
const LEAST_UNEVEN: f32 = 1e-6;

/// How often the surface of all is covered by boxes, from which on better neighbours are not looked for farther than at
/// the next one, nor better parents: all choices are equally bad there, and looking through them is what takes the time.
/// Meshes without much that is inside of each other have less than ten.
const CROWDED: f64 = 64.0;

#[derive(Clone, Copy)]
struct Bounds(Aabb);

impl Boundable for Bounds {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

fn bounds(min: Vec3, max: Vec3) -> Bounds {
    Bounds(Aabb::new(min.to_array().into(), max.to_array().into()))
}

/// A number of 0 to 1 by which boxes become uneven: a hash of 32 bits whose every bit depends on every one of `index`
/// (the finalizer of MurmurHash3, A. Appleby).
fn chance(index: u32) -> f32 {
    let mut bits = index.wrapping_mul(0x9e37_79b9);
    bits = (bits ^ (bits >> 16)).wrapping_mul(0x85eb_ca6b);
    bits = (bits ^ (bits >> 13)).wrapping_mul(0xc2b2_ae35);
    (bits ^ (bits >> 16)) as f32 / u32::MAX as f32
}

/// The boxes of triangles in a cube of side 1, each a little larger, and how often they cover the surface of all.
fn uneven_boxes(mesh: &TriangleMesh) -> (Vec<Bounds>, f64) {
    let boxes: Vec<(Vec3, Vec3)> = (0..mesh.triangles().len() as u32)
        .map(|triangle| {
            let [a, b, c] = mesh.local_corners(triangle);
            (a.min(b).min(c), a.max(b).max(c))
        })
        .collect();
    let least = boxes.iter().fold(Vec3::INFINITY, |l, b| l.min(b.0));
    let most = boxes.iter().fold(Vec3::NEG_INFINITY, |m, b| m.max(b.1));
    // Halves: the side of a mesh may be more than f32 holds.
    let side = 2.0 * (0.5 * most - 0.5 * least).max_element();
    let scale = if side > 0.0 { 1.0 / side } else { 1.0 };
    let mut covered = 0.0;
    let mut place = |(index, &(min, max)): (usize, &(Vec3, Vec3))| {
        let (min, max) = (scale * min - scale * least, scale * max - scale * least);
        let size = (max - min).max_element();
        let out = Vec3::splat(chance(index as u32) * (UNEVEN * size).max(LEAST_UNEVEN));
        let larger = bounds(min - out, max + out);
        covered += f64::from(larger.0.half_area());
        larger
    };
    let uneven: Vec<Bounds> = boxes.iter().enumerate().map(&mut place).collect();
    let all = uneven.iter().fold(Aabb::empty(), |all, b| all.union(&b.0));
    (uneven, covered / f64::from(all.half_area()))
}

/// Nodes, and which triangle stands where.
pub fn build(mesh: &TriangleMesh, settings: &TreeSettings) -> (Vec<Node>, Vec<u32>) {
    let (boxes, covered) = uneven_boxes(mesh);
    if boxes.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let mut parameters = BvhBuildParams {
        max_prims_per_leaf: settings.leaf_triangles.clamp(1, 255) as u32,
        ..BvhBuildParams::medium_build()
    };
    if covered > CROWDED {
        parameters.ploc_search_distance = PlocSearchDistance::Minimum;
        parameters.reinsertion_batch_ratio = 0.0;
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Instant;

    /// Triangles whose boxes are these.
    fn mesh(boxes: impl Iterator<Item = (Vec3, Vec3)>) -> TriangleMesh {
        let vertices: Vec<Vec3> = boxes
            .flat_map(|(min, max)| [min, max, Vec3::new(min.x, max.y, min.z)])
            .collect();
        let triangles = (0..vertices.len() as u32 / 3)
            .map(|k| [3 * k, 3 * k + 1, 3 * k + 2])
            .collect();
        TriangleMesh::new(bevy::math::DVec3::ZERO, vertices, triangles).unwrap()
    }

    /// Levels of nodes.
    fn depth(nodes: &[Node]) -> usize {
        let mut deepest = 0;
        let mut open = vec![(0, 1)];
        while let Some((node, level)) = open.pop() {
            deepest = deepest.max(level);
            let below = nodes[node].first.iter().zip(nodes[node].count);
            let nodes =
                below.filter(|&(&first, count)| count == 0 && first != super::super::node::NONE);
            open.extend(nodes.map(|(&first, _)| (first as usize, level + 1)));
        }
        deepest
    }

    /// Meshes in which everybody's best neighbour is the next one take the time of meshes in which it is anybody.
    #[test]
    fn rows_and_heaps_of_equal_triangles_are_divided_as_quickly_as_any() {
        const COUNT: u32 = 16_000;
        let at =
            |x: f32, y: f32, z: f32| (Vec3::new(x, y, z), Vec3::new(x + 1.0, y + 1.0, z + 1.0));
        let build_of = |boxes: &dyn Fn(u32) -> (Vec3, Vec3)| {
            let mesh = mesh((0..COUNT).map(boxes));
            let began = Instant::now();
            let (nodes, order) = build(&mesh, &TreeSettings::default());
            let time = began.elapsed().as_secs_f64();
            let mut all = order;
            all.sort_unstable();
            assert!(all.into_iter().eq(0..COUNT), "each triangle stands once");
            (time, depth(&nodes))
        };
        let by_chance = |k: u32| {
            at(
                300.0 * chance(3 * k),
                300.0 * chance(3 * k + 1),
                300.0 * chance(3 * k + 2),
            )
        };
        let (usual, depth) = build_of(&by_chance);
        assert!(depth < 12, "{depth}");
        let around = |half: f32| (Vec3::splat(-half), Vec3::splat(half));
        let cases: [(&str, &dyn Fn(u32) -> (Vec3, Vec3)); 6] = [
            ("the same", &|_| at(1.0, 2.0, 3.0)),
            ("a row", &|k| at(k as f32, 0.0, 0.0)),
            ("within each other", &|k| around(1.0 + k as f32)),
            ("five sizes about one centre", &|k| {
                around(1.0 + (k % 5) as f32)
            }),
            ("one place without a size", &|_| (Vec3::ONE, Vec3::ONE)),
            ("a row, and one far away", &|k| {
                at(if k == 0 { 1e12 } else { k as f32 }, 0.0, 0.0)
            }),
        ];
        for (name, boxes) in cases {
            let (time, depth) = build_of(boxes);
            // With what a machine does beside it. Before sizes were uneven 100 to 2000 times.
            assert!(
                time < 30.0 * usual + 0.05,
                "{name}: {time} s, by chance {usual} s"
            );
            // Sizes that grow by more than `UNEVEN` from one to the next are a chain, of which f32 holds less than 6000.
            assert!(depth < 1000, "{name}: {depth} levels");
        }
    }
}
