//! A bounding volume hierarchy by the surface area heuristic over bins (Wald 2007).

use super::bounds::Bounds;

/// Bins an axis.
const BINS: usize = 16;
/// Not divided further.
const LEAF: usize = 4;
/// From here on by halves, so that no tree is deeper than this and the binary logarithm of its size.
const HALVES: usize = 40;
/// Deeper than any tree of 2²³ primitives.
pub(super) const DEEPEST: usize = 64;

/// A node: a leaf if `count` is not 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub bounds: Bounds,
    /// The first of its primitives, or its second child; the first child is the next node.
    pub first: u32,
    pub count: u32,
}

/// Orders `order`, indices into `bounds`, and returns the nodes, the root first.
pub(super) fn build(bounds: &[Bounds], order: &mut [u32]) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(2 * order.len());
    if !order.is_empty() {
        divide(bounds, order, 0, 0, &mut nodes);
    }
    nodes
}

fn divide(
    bounds: &[Bounds],
    order: &mut [u32],
    offset: usize,
    depth: usize,
    nodes: &mut Vec<Node>,
) {
    let of = |k: &u32| bounds[*k as usize];
    let all = order.iter().map(of).fold(Bounds::EMPTY, Bounds::join);
    let index = nodes.len();
    nodes.push(Node {
        bounds: all,
        first: offset as u32,
        count: order.len() as u32,
    });
    if order.len() <= LEAF {
        return;
    }
    let middle = if depth < HALVES {
        split(bounds, order)
    } else {
        order.len() / 2
    };
    nodes[index].count = 0;
    let (left, right) = order.split_at_mut(middle);
    divide(bounds, left, offset, depth + 1, nodes);
    nodes[index].first = nodes.len() as u32;
    divide(bounds, right, offset + middle, depth + 1, nodes);
}

/// Orders the primitives into two parts, neither of them empty, and returns where the second begins.
fn split(bounds: &[Bounds], order: &mut [u32]) -> usize {
    let middles: Vec<_> = order.iter().map(|k| bounds[*k as usize].middle()).collect();
    let span = Bounds::of(&middles);
    let mut best = (f64::INFINITY, 0, 0);
    let bin = |axis: usize, x: f64| {
        let share = (x - span.low[axis]) / (span.high[axis] - span.low[axis]);
        ((share * BINS as f64) as usize).min(BINS - 1)
    };
    for axis in 0..3 {
        if span.high[axis] <= span.low[axis] {
            continue;
        }
        let mut bins = [(Bounds::EMPTY, 0_usize); BINS];
        for (k, middle) in order.iter().zip(&middles) {
            let bin = &mut bins[bin(axis, middle[axis])];
            bin.0 = bin.0.join(bounds[*k as usize]);
            bin.1 += 1;
        }
        let mut above = [(Bounds::EMPTY, 0); BINS + 1];
        for k in (0..BINS).rev() {
            above[k] = (above[k + 1].0.join(bins[k].0), above[k + 1].1 + bins[k].1);
        }
        let mut below = (Bounds::EMPTY, 0);
        for k in 1..BINS {
            below = (below.0.join(bins[k - 1].0), below.1 + bins[k - 1].1);
            if below.1 == 0 || above[k].1 == 0 {
                continue;
            }
            let cost =
                below.0.half_area() * below.1 as f64 + above[k].0.half_area() * above[k].1 as f64;
            if cost < best.0 {
                best = (cost, axis, k);
            }
        }
    }
    let (cost, axis, at) = best;
    // All middles are one point, or the boxes are infinite: half and half.
    if cost == f64::INFINITY {
        return order.len() / 2;
    }
    let below = |k: &u32| bin(axis, bounds[*k as usize].middle()[axis]) < at;
    let (left, right): (Vec<u32>, Vec<u32>) = order.iter().partition(|k| below(k));
    order[..left.len()].copy_from_slice(&left);
    order[left.len()..].copy_from_slice(&right);
    left.len()
}
