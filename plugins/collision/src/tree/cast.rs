//! A box that moves in a straight line through a tree: rays are boxes of no size.

use super::TriangleTree;
use super::node::{NONE, Node};
use super::stack::{Entry, push_sorted, with};
use crate::sweep::{Contact, SweepError, UnitSpace, UnitTouch, sweep_unit, within_reach};
use crate::volume::Ellipsoid;
use bevy::math::{DVec3, Vec3};
use std::ops::Range;

/// A moving box against boxes that stand: when it meets each of eight.
///
/// Divisions of the planes' distances by the direction, done once. A direction of 0 becomes 10⁻³⁰: what lies
/// beside it is then never met, and what it starts between always.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    /// The plane of each axis that is met first.
    sides: [usize; 3],
    /// Where its own sides are that meet them.
    near: [f32; 3],
    far: [f32; 3],
    inverse: [f32; 3],
    begin: f32,
}

/// What the time of leaving a box is multiplied by, so that rounding never makes a box missed: 1 + 2 γ₃ (T. Ize,
/// Robust BVH Ray Traversal, 2013), γ₃ = 3 u / (1 − 3 u), u = 2⁻²⁴.
const LATER: f32 = 1.000_000_4;

impl Slabs {
    /// A box of this half size that starts at `origin` and meets nothing before `begin`.
    pub fn new(origin: Vec3, direction: Vec3, half: Vec3, begin: f32) -> Self {
        let mut slabs = Self {
            sides: [0; 3],
            near: [0.0; 3],
            far: [0.0; 3],
            inverse: [0.0; 3],
            begin,
        };
        for axis in 0..3 {
            let mut along = direction[axis];
            if along.abs() < 1e-30 {
                along = 1e-30_f32.copysign(along);
            }
            let reach = half[axis].copysign(along);
            slabs.sides[axis] = 2 * axis + usize::from(along < 0.0);
            slabs.near[axis] = origin[axis] + reach;
            slabs.far[axis] = origin[axis] - reach;
            slabs.inverse[axis] = along.recip();
        }
        slabs
    }

    /// The time before which nothing is met.
    pub const fn begin(&self) -> f32 {
        self.begin
    }

    /// When each child's box is met, and a bit for each that is met before `end`.
    #[inline(always)]
    pub fn meet(&self, node: &Node, end: f32) -> ([f32; 8], u32) {
        let mut enter = [self.begin; 8];
        let mut leave = [end; 8];
        for axis in 0..3 {
            let side = self.sides[axis];
            let (near, far) = (&node.planes[side], &node.planes[side ^ 1]);
            for i in 0..8 {
                let one = (near[i] - self.near[axis]) * self.inverse[axis];
                let two = (far[i] - self.far[axis]) * self.inverse[axis] * LATER;
                // Comparisons, not `max`: these are one instruction each.
                enter[i] = if one > enter[i] { one } else { enter[i] };
                leave[i] = if two < leave[i] { two } else { leave[i] };
            }
        }
        let mut bits = 0;
        for i in 0..8 {
            // A box that is none is met by nothing, but where numbers of f32 run over: ∞ − ∞ compares with nothing.
            bits |= u32::from((enter[i] <= leave[i]) & (node.first[i] != NONE)) << i;
        }
        (enter, bits)
    }
}

/// Leaves in the order in which the box meets them, until `end`; `visit` says when to end from then on.
#[inline(always)]
pub fn walk(
    nodes: &[Node],
    slabs: &Slabs,
    mut end: f32,
    mut visit: impl FnMut(Range<usize>) -> f32,
) {
    if nodes.is_empty() {
        return;
    }
    with(|stack| {
        stack.push(Entry::ROOT);
        while let Some(Entry { key, first, count }) = stack.pop() {
            if key > end {
                continue;
            }
            if count > 0 {
                end = visit(first as usize..(first + count) as usize);
                continue;
            }
            let node = &nodes[first as usize];
            let (enter, mut bits) = slabs.meet(node, end);
            let met = std::iter::from_fn(|| {
                (bits != 0).then(|| {
                    let child = (bits.trailing_zeros() & 7) as usize;
                    bits &= bits - 1;
                    Entry {
                        key: enter[child],
                        first: node.first[child],
                        count: node.count[child],
                    }
                })
            });
            push_sorted(stack, met);
        }
    });
}

/// How much wider than the ellipsoid the box is that is moved through the tree, as a part of all distances: f32
/// rounds them by 6e-8 each, and some are added.
const ROOM: f64 = 1e-6;

impl TriangleTree {
    /// The first triangle that an ellipsoid touches on its way: see [`sweep`](crate::sweep()).
    ///
    /// # Errors
    /// [`SweepError`].
    pub fn sweep(&self, ellipsoid: &Ellipsoid, way: DVec3) -> Result<Option<Contact>, SweepError> {
        let space = UnitSpace::new(ellipsoid)?;
        space.check_way(way)?;
        let touch = self.sweep_space(&space, way);
        Ok(touch.map(|(touch, triangle)| space.contact(&touch, triangle, way)))
    }

    /// The same in unit space, of numbers that were checked. A mesh that is more than [`FARTHEST`] radii away is not
    /// met, nor is anything on a longer way.
    ///
    /// [`FARTHEST`]: crate::sweep::FARTHEST
    #[must_use]
    pub fn sweep_space(&self, space: &UnitSpace, way: DVec3) -> Option<(UnitTouch, u32)> {
        let origin = space.center - self.mesh.origin();
        let unit_way = space.to_unit * way;
        if !(within_reach(space.to_unit * origin) && within_reach(unit_way)) {
            return None;
        }
        let half = space.half_size();
        let room = (origin.abs() + way.abs() + half).max_element() * ROOM;
        let slabs = Slabs::new(
            origin.as_vec3(),
            way.as_vec3(),
            (half + room).as_vec3(),
            0.0,
        );
        let local = UnitSpace {
            center: origin,
            ..*space
        };
        let mut best: Option<(UnitTouch, u32)> = None;
        walk(&self.nodes, &slabs, 1.0, |range| {
            for (corners, &triangle) in self.corners[range.clone()].iter().zip(&self.order[range]) {
                let unit = local.triangle(corners.map(|corner| corner.as_dvec3()));
                if let Some(touch) = sweep_unit(&unit, unit_way)
                    && best.is_none_or(|(known, index)| {
                        touch.time < known.time || (touch.time == known.time && triangle < index)
                    })
                {
                    best = Some((touch, triangle));
                }
            }
            // Rounded up: triangles at the same time are to be seen.
            best.map_or(1.0, |(touch, _)| {
                touch.time as f32 * LATER + f32::MIN_POSITIVE
            })
        });
        best
    }
}
