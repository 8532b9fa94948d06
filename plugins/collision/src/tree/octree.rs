//! Building an octree: triangles in the order of their cells, and nodes where that order branches.
//!
//! Centres of triangles are numbered by 21 bits an axis, and the bits taken in turns, z, y, x: sorted by that number,
//! the triangles of every cell of every depth lie together (G. M. Morton, 1966). A node divides its cell where
//! its triangles first part; child 4 z + 2 y + x is the octant on the far side of these axes. Cells are those of
//! centres: a triangle reaches over its cell by no more than its own size, and boxes are around whole triangles.
//!
//! The tree is the same for any number of threads.

use super::TreeSettings;
use super::node::{NONE, Node, fit};
use crate::mesh::TriangleMesh;
use bevy::math::{DVec3, Vec3};
use bevy::tasks::{ComputeTaskPool, ParallelSliceMut, TaskPool};
use std::ops::Range;

/// Bits of a centre along an axis.
const BITS: u32 = 21;

/// Parts that cores build for themselves are at most this part of the triangles.
const PARTS: usize = 64;

/// Triangles below which one core is quicker.
const FEW: usize = 4096;

/// A triangle and its cell.
type Keyed = (u64, u32);

/// Nodes, and which triangle stands where.
pub fn build(mesh: &TriangleMesh, settings: &TreeSettings) -> (Vec<Node>, Vec<u32>) {
    let count = mesh.triangles().len();
    let grid = Grid::around(mesh);
    let mut keys: Vec<Keyed> = vec![(0, 0); count];
    let number = |first: usize, part: &mut [Keyed]| {
        for (index, key) in (first as u32..).zip(part.iter_mut()) {
            *key = (grid.code(mesh.local_corners(index)), index);
        }
        part.sort_unstable();
    };
    if count < FEW {
        number(0, &mut keys);
    } else {
        let pool = ComputeTaskPool::get_or_init(TaskPool::default);
        let size = count.div_ceil(pool.thread_num().max(1));
        keys.par_chunk_map_mut(pool, size, |chunk, part| number(chunk * size, part));
        // Its parts are sorted: this merges them.
        keys.sort();
    }
    let order: Vec<u32> = keys.iter().map(|key| key.1).collect();
    let corners: Vec<[Vec3; 3]> = order.iter().map(|&i| mesh.local_corners(i)).collect();
    let builder = Builder {
        keys: &keys,
        grid: &grid,
        settings,
    };
    (builder.build(&corners), order)
}

/// Numbers for centres.
struct Grid {
    min: DVec3,
    /// Cells a metre.
    scale: f64,
}

fn center([a, b, c]: [Vec3; 3]) -> DVec3 {
    (a.as_dvec3() + b.as_dvec3() + c.as_dvec3()) * (1.0 / 3.0)
}

impl Grid {
    fn around(mesh: &TriangleMesh) -> Self {
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for triangle in 0..mesh.triangles().len() as u32 {
            let center = center(mesh.local_corners(triangle));
            (min, max) = (min.min(center), max.max(center));
        }
        let size = (max - min).max_element();
        let scale = f64::from(1 << BITS) / size;
        Self {
            min,
            scale: if scale.is_finite() { scale } else { 0.0 },
        }
    }

    fn code(&self, corners: [Vec3; 3]) -> u64 {
        let cell = ((center(corners) - self.min) * self.scale)
            .clamp(DVec3::ZERO, DVec3::splat(f64::from((1 << BITS) - 1)));
        spread(cell.z as u64) << 2 | spread(cell.y as u64) << 1 | spread(cell.x as u64)
    }

    /// The middle of the cell of `code` at a depth.
    fn middle(&self, code: u64, depth: u32) -> [f32; 3] {
        let half = f64::from(1 << (BITS - depth)) * 0.5;
        let kept = code >> (3 * (BITS - depth)) << (3 * (BITS - depth));
        let cell = DVec3::new(gather(kept), gather(kept >> 1), gather(kept >> 2)) + half;
        let scale = if self.scale > 0.0 {
            1.0 / self.scale
        } else {
            0.0
        };
        (self.min + cell * scale).as_vec3().to_array()
    }
}

/// Bit i to bit 3 i.
fn spread(x: u64) -> u64 {
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// Bit 3 i to bit i.
fn gather(x: u64) -> f64 {
    let x = x & 0x1249_2492_4924_9249;
    let x = (x | x >> 2) & 0x10c3_0c30_c30c_30c3;
    let x = (x | x >> 4) & 0x100f_00f0_0f00_f00f;
    let x = (x | x >> 8) & 0x001f_0000_ff00_00ff;
    let x = (x | x >> 16) & 0x001f_0000_0000_ffff;
    ((x | x >> 32) & 0x001f_ffff) as f64
}

struct Builder<'a> {
    keys: &'a [Keyed],
    grid: &'a Grid,
    settings: &'a TreeSettings,
}

/// Triangles that are to be hung below a child of a node.
struct Open {
    node: usize,
    child: usize,
    range: Range<usize>,
}

impl Builder<'_> {
    fn build(&self, corners: &[[Vec3; 3]]) -> Vec<Node> {
        if self.keys.is_empty() {
            return Vec::new();
        }
        let all = self.keys.len();
        // The uppermost nodes here, until parts are small enough for one core each.
        let mut top = vec![Node::EMPTY];
        let mut parts = Vec::new();
        let mut open = self.divide(&mut top, 0, 0..all);
        while let Some(next) = open.pop() {
            if next.range.len() <= FEW.max(all / PARTS) {
                parts.push(next);
            } else {
                let index = Self::hang(&mut top, &next);
                open.extend(self.divide(&mut top, index, next.range));
            }
        }
        let mut built: Vec<Vec<Node>> = Vec::new();
        let below = |range: Range<usize>| {
            let mut nodes = vec![Node::EMPTY];
            let mut open = self.divide(&mut nodes, 0, range);
            while let Some(next) = open.pop() {
                let index = Self::hang(&mut nodes, &next);
                open.extend(self.divide(&mut nodes, index, next.range));
            }
            let count = nodes.len();
            fit(&mut nodes, count, corners);
            nodes
        };
        if all < FEW {
            built.extend(parts.iter().map(|part| below(part.range.clone())));
        } else {
            let pool = ComputeTaskPool::get_or_init(TaskPool::default);
            built = pool.scope(|scope| {
                for part in &parts {
                    let range = part.range.clone();
                    let below = &below;
                    scope.spawn(async move { below(range) });
                }
            });
        }
        let uppermost = top.len();
        for (part, mut nodes) in parts.iter().zip(built) {
            let start = top.len() as u32;
            for node in &mut nodes {
                for child in 0..8 {
                    if node.count[child] == 0 && node.first[child] != NONE {
                        node.first[child] += start;
                    }
                }
            }
            top[part.node].first[part.child] = start;
            top.append(&mut nodes);
        }
        fit(&mut top, uppermost, corners);
        top
    }

    /// Makes the node of an open child.
    fn hang(nodes: &mut Vec<Node>, open: &Open) -> usize {
        let index = nodes.len();
        nodes.push(Node::EMPTY);
        nodes[open.node].first[open.child] = index as u32;
        index
    }

    /// Divides triangles into the children of a node: leaves are finished, the others come back.
    fn divide(&self, nodes: &mut [Node], node: usize, range: Range<usize>) -> Vec<Open> {
        let (first, last) = (self.keys[range.start].0, self.keys[range.end - 1].0);
        // The depth at which they part: that of the highest bit in which the first and the last differ.
        let same = (first ^ last).leading_zeros().saturating_sub(64 - 3 * BITS) / 3;
        let limit = self.settings.depth.clamp(1, BITS);
        let depth = same.min(limit - 1);
        nodes[node].middle = self.grid.middle(first, depth);
        let mut open = Vec::new();
        let mut start = range.start;
        for child in 0..8 {
            let octant = |key: &Keyed| (key.0 >> (3 * (BITS - 1 - depth)) & 7) as usize;
            let end =
                start + self.keys[start..range.end].partition_point(|key| octant(key) <= child);
            let part = start..end;
            start = end;
            if part.is_empty() {
                continue;
            }
            if part.len() <= self.settings.leaf_triangles.max(1) || depth + 1 >= limit {
                nodes[node].first[child] = part.start as u32;
                nodes[node].count[child] = part.len() as u32;
            } else {
                open.push(Open {
                    node,
                    child,
                    range: part,
                });
            }
        }
        // The last of them is taken first: the near side of the order comes first in memory.
        open.reverse();
        open
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_go_and_come_back() {
        for x in [0, 1, 2, 0x15_5555, 0x0a_aaaa, 0x1f_ffff, 0x10_0001] {
            let code = spread(x);
            assert_eq!(gather(code), x as f64);
            for bit in 0..21 {
                assert_eq!(code >> (3 * bit) & 1, x >> bit & 1);
            }
        }
    }
}
