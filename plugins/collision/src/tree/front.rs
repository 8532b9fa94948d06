//! Leaves from front to back, as a viewer sees them.

use super::node::NONE;
use super::{TreeKind, TriangleTree};
use crate::volume::Aabb;
use bevy::math::{DVec3, Vec3};

impl TriangleTree {
    /// Visits the triangles of one leaf after the other, from the viewer outwards; `keep` is asked of the box of each
    /// node and leaf, and what it does not keep is passed over with all below it (a frustum, say).
    ///
    /// In an octree, the children of a node are visited in the order of the octants by z, y and x as the viewer sees
    /// them: no leaf's cell is hidden by one that comes later, from any place. Triangles reach over their cells by
    /// their own size. In a BVH, whose boxes overlap, children are visited by the distance of their boxes.
    pub fn front_to_back(
        &self,
        viewer: DVec3,
        mut keep: impl FnMut(&Aabb) -> bool,
        mut visit: impl FnMut(&[u32]),
    ) {
        if self.nodes.is_empty() || viewer.is_nan() {
            return;
        }
        let origin = self.mesh.origin();
        let local = viewer - origin;
        let mut stack = vec![(0, 0)];
        while let Some((first, count)) = stack.pop() {
            if count > 0 {
                visit(&self.order[first as usize..(first + count) as usize]);
                continue;
            }
            let node = &self.nodes[first as usize];
            let mut order = [0, 1, 2, 3, 4, 5, 6, 7];
            if self.settings.kind == TreeKind::Octree {
                let far = |axis: usize| usize::from(local[axis] >= f64::from(node.middle[axis]));
                let octant = 4 * far(2) + 2 * far(1) + far(0);
                order = order.map(|child| child ^ octant);
            } else {
                let squares = order.map(|child| {
                    let (min, max) = node.child_box(child);
                    local.distance_squared(local.clamp(
                        min.as_dvec3().min(max.as_dvec3()),
                        max.as_dvec3().max(min.as_dvec3()),
                    ))
                });
                order.sort_by(|&a, &b| squares[a].total_cmp(&squares[b]));
            }
            // The first of them on top.
            for child in order.into_iter().rev() {
                if node.first[child] == NONE {
                    continue;
                }
                let (min, max): (Vec3, Vec3) = node.child_box(child);
                let bounds = Aabb {
                    min: origin + min.as_dvec3(),
                    max: origin + max.as_dvec3(),
                };
                if keep(&bounds) {
                    stack.push((node.first[child], node.count[child]));
                }
            }
        }
    }
}
