//! The nearest point of a mesh.

use super::TriangleTree;
use super::node::{NONE, Node};
use super::stack::{Entry, push_sorted, with};
use crate::geometry::{Feature, nearest_on_triangle};
use bevy::math::DVec3;

/// The nearest point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Where it is.
    pub point: DVec3,
    /// How far, metres.
    pub distance: f64,
    /// The triangle that it lies on; of several the one with the lowest number.
    pub triangle: u32,
    /// The part of it.
    pub feature: Feature,
}

impl TriangleTree {
    /// The point nearest to a place, if there is one within a distance. A place or a distance that is not a number
    /// is near nothing.
    #[must_use]
    pub fn nearest(&self, place: DVec3, within: f64) -> Option<Nearest> {
        if self.nodes.is_empty() || !place.is_finite() || within.is_nan() || within < 0.0 {
            return None;
        }
        let local = place - self.mesh.origin();
        let mut best: Option<Nearest> = None;
        let mut least = within * within;
        with(|stack| {
            stack.push(Entry::ROOT);
            while let Some(Entry { key, first, count }) = stack.pop() {
                if f64::from(key) > least {
                    continue;
                }
                if count > 0 {
                    for at in first as usize..(first + count) as usize {
                        let triangle = self.order[at];
                        let corners = self.corners[at].map(|corner| corner.as_dvec3());
                        let (point, feature) = nearest_on_triangle(local, corners);
                        let squared = point.distance_squared(local);
                        let tie =
                            best.is_some_and(|known| squared == least && triangle < known.triangle);
                        if squared < least || tie || (best.is_none() && squared <= least) {
                            least = squared;
                            best = Some(Nearest {
                                point: point + self.mesh.origin(),
                                distance: squared.sqrt(),
                                triangle,
                                feature,
                            });
                        }
                    }
                    continue;
                }
                let node = &self.nodes[first as usize];
                let squares = box_distances(node, local);
                let children = (0..8).filter(|&child| node.first[child] != NONE);
                let entries = children.map(|child| Entry {
                    // Rounded down, so that no box is passed over that may hold something as near.
                    key: (squares[child] as f32).next_down().max(0.0),
                    first: node.first[child],
                    count: node.count[child],
                });
                let limit = least;
                push_sorted(stack, entries.filter(|entry| f64::from(entry.key) <= limit));
            }
        });
        best
    }
}

/// The squares of the distances to the boxes of all children. Less than those to what is in them by rounding at
/// least: both are sums of three squares of differences, and the differences here are smaller.
#[inline]
fn box_distances(node: &Node, place: DVec3) -> [f64; 8] {
    let mut squares = [0.0; 8];
    for axis in 0..3 {
        let (low, high) = (&node.planes[2 * axis], &node.planes[2 * axis + 1]);
        for i in 0..8 {
            let below = f64::from(low[i]) - place[axis];
            let above = place[axis] - f64::from(high[i]);
            let out = below.max(above).max(0.0);
            squares[i] += out * out;
        }
    }
    squares
}
