//! Triangles that overlap a volume.

use super::TriangleTree;
use super::node::NONE;
use super::stack::{Entry, with};
use crate::volume::{Aabb, Volume};
use bevy::math::{DVec3, Vec3};

/// Rounded down and up, so that nothing is lost by f32.
fn outward(bounds: &Aabb, origin: DVec3) -> (Vec3, Vec3) {
    let (low, high) = (bounds.min - origin, bounds.max - origin);
    let down = |x: f64| (x as f32).next_down();
    let up = |x: f64| (x as f32).next_up();
    (
        Vec3::new(down(low.x), down(low.y), down(low.z)),
        Vec3::new(up(high.x), up(high.y), up(high.z)),
    )
}

impl TriangleTree {
    /// Triangles that overlap a volume, in the order of their numbers: those of
    /// [`Volume::overlaps_triangle`]. A volume that is not valid overlaps none.
    #[must_use]
    pub fn overlapping(&self, volume: &Volume) -> Vec<u32> {
        let mut found = Vec::new();
        if volume.is_valid() {
            self.for_each_near(&volume.bounds(), |triangle| {
                if volume.overlaps_triangle(self.mesh.corners(triangle)) {
                    found.push(triangle);
                }
            });
        }
        found.sort_unstable();
        found
    }

    /// Triangles in leaves that overlap a box, in no particular order: all that overlap the box, and others near it.
    pub fn for_each_near(&self, bounds: &Aabb, mut visit: impl FnMut(u32)) {
        if self.nodes.is_empty() || !bounds.is_valid() {
            return;
        }
        let (min, max) = outward(bounds, self.mesh.origin());
        with(|stack| {
            stack.push(Entry::ROOT);
            while let Some(entry) = stack.pop() {
                let node = &self.nodes[entry.first as usize];
                let mut bits = node.overlapping(min, max);
                while bits != 0 {
                    let child = bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    let (first, count) = (node.first[child], node.count[child]);
                    if count > 0 {
                        let range = first as usize..(first + count) as usize;
                        self.order[range]
                            .iter()
                            .for_each(|&triangle| visit(triangle));
                    } else if first != NONE {
                        stack.push(Entry {
                            first,
                            ..Entry::ROOT
                        });
                    }
                }
            }
        });
    }
}
