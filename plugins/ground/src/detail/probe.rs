//! Height queries: the drawn triangle under a place.
//!
//! A place is followed from its root down to the cell whose quarter it lies in is no cell of its own; two
//! comparisons tell which of the cell's triangles it is. On the GPU that is `shaders/src/detail/locate.wgsl`
//! and `answer.wgsl`, which take the corners from the very vertices that are drawn; here is the CPU reference, from
//! a [`Selection`].
//!
//! **Bound.** Each cell knows how far its triangles are from the ground where their corners stand on it
//! (`cell.rs`). Corners that are geomorphing lie off the ground; in the triangle between them the surface is
//! off by the mean of that, weighted as the place lies. The sum of both does not depend on the metric, nor on
//! whether the pools were too small; it is as good as the cells' own bounds.

use bevy::math::{DVec2, DVec3, UVec2};
use bevy::prelude::*;
use bytemuck::{Pod, Zeroable};
use dolomite_terrain::GroundPoint;

use super::APPEARS;
use super::cell::DetailCells;
use super::lattice::CellPlace;
use super::mesh::Finder;
use super::select::{Selection, ViewCell};

/// File and entry of the pass.
pub const ANSWER_PASS: (&str, &str) = ("detail/answer.wgsl", "answer");
/// Threads of a workgroup of the pass.
pub const ANSWER_GROUP: u32 = 64;
/// Most places of one dispatch: 2²⁰, 16 MiB up and 20 MiB down.
pub const MOST_ASKED: u32 = 1 << 20;

/// How many ground probes are answered from what is drawn.
///
/// The view that answers is that of the active camera of least order with a [`TerrainView`](crate::TerrainView) and
/// without a [`PatchDetail`](crate::PatchDetail). Where there is none, the ground is drawn as patches or not at all,
/// and probes have their true answers alone.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Resource, Default)]
pub struct DrawnProbes {
    /// Most places that are asked for in a frame, at most [`MOST_ASKED`]; 0: none is. A larger crowd takes
    /// turns; whose turn it is not has its true answer meanwhile.
    pub per_frame: u32,
}

impl Default for DrawnProbes {
    fn default() -> Self {
        Self { per_frame: 1 << 16 }
    }
}

/// What the pass is told; byte for byte as `Asked` in `answer.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Asked {
    /// Number of the frame.
    pub frame: u32,
    /// How many places.
    pub count: u32,
    /// Fills up to 16 bytes.
    pub pad: [u32; 2],
}

/// What comes before the answers; byte for byte as `Answers` in `answer.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct AnswerHead {
    /// As they were asked.
    pub frame: u32,
    /// See `frame`.
    pub count: u32,
    /// Of the choice of vertices that was drawn.
    pub stamp: u32,
    /// What heights of answers are relative to, metres.
    pub anchor_height: f32,
}

/// A triangle that is drawn under a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Located {
    /// Its corners, counter-clockwise seen from above.
    pub corners: [UVec2; 3],
    /// How far it is from the ground at most where its corners stand on it, metres.
    pub error: f32,
}

/// A drawn triangle at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnPoint {
    /// Height, metres.
    pub height: f64,
    /// Slope along x and z.
    pub gradient: DVec2,
    /// How far it is from the true surface at most, metres.
    pub bound: f64,
}

/// The triangle that a view draws under a place; `None` where it draws none.
#[must_use]
pub fn locate(cells: &DetailCells, selection: &Selection, place: GroundPoint) -> Option<Located> {
    let lattice = &cells.lattice;
    let [x, z] = lattice.origin.to_fixed();
    let [px, pz] = place.to_fixed();
    // Without a sign: what lies before the origin wraps and lies beyond the far end.
    let local = [px.wrapping_sub(x) as u64, pz.wrapping_sub(z) as u64];
    let at = |axis: usize, steps: u32| lattice.step[axis].wrapping_mul(u64::from(steps));
    let size = lattice.roots << (lattice.depth + 1);
    if local[0] > at(0, size.x) || local[1] > at(1, size.y) {
        return None;
    }
    let root = |axis: usize, count: u32| {
        let begins = |root: &u32| at(axis, root << (lattice.depth + 1)) <= local[axis];
        (0..count).take_while(begins).last()
    };
    let half = lattice.root_half();
    let root = UVec2::new(root(0, lattice.roots.x)?, root(1, lattice.roots.y)?);
    let mut cell = CellPlace {
        centre: (root * 2 + 1) * half,
        half,
    };
    loop {
        let off = |axis: usize, centre: u32| {
            let metres = local[axis].wrapping_sub(at(axis, centre)) as i64 as f64;
            metres / at(axis, cell.half) as f64
        };
        let off = DVec2::new(off(0, cell.centre.x), off(1, cell.centre.y));
        let Some(drawn) = selection.find(lattice, cell) else {
            return of_root(cells, selection, cell, off);
        };
        let quarter = match (off.x >= 0.0, off.y >= 0.0) {
            (false, false) => 0,
            (true, false) => 1,
            (true, true) => 2,
            (false, true) => 3,
        };
        let child = cell.child(quarter);
        match child.filter(|child| selection.find(lattice, *child).is_some()) {
            Some(child) => cell = child,
            None => return of_cell(cells, drawn, quarter, off),
        }
    }
}

/// The triangle of a root that stays two; `off` is relative to its centre, in half sides.
fn of_root(
    cells: &DetailCells,
    selection: &Selection,
    root: CellPlace,
    off: DVec2,
) -> Option<Located> {
    let (_, seen) = selection
        .whole_roots
        .iter()
        .find(|(place, _)| *place == root)?;
    let outer = root.quarter();
    let corners = [0, 1, 2, 3].map(|k| root.corner(outer + k));
    let towards = |corner: UVec2| corner.as_dvec2() - root.centre.as_dvec2();
    let side = |of: DVec2| of.perp_dot(towards(corners[0]));
    let [a, b, c, d] = corners;
    seen.then(|| Located {
        corners: if side(off) * side(towards(b)) >= 0.0 {
            [c, b, a]
        } else {
            [a, d, c]
        },
        error: cells
            .number(root)
            .map_or(f32::INFINITY, |number| cells.cell(number).error),
    })
}

/// The triangle of a cell that is drawn, in a quarter that is no cell of its own.
fn of_cell(cells: &DetailCells, drawn: &ViewCell, quarter: usize, off: DVec2) -> Option<Located> {
    let (place, cell) = (drawn.place, cells.cell(drawn.number));
    // A quarter lies at the end of the side of its number and at the beginning of the next.
    let ends = (off.x.abs() > off.y.abs()) == quarter.is_multiple_of(2);
    let side = if ends { quarter } else { (quarter + 1) & 3 };
    let (centre, corner, mid) = (place.centre, place.corner(quarter), place.mid(side));
    drawn.seen.then(|| {
        if drawn.sides[side] <= APPEARS {
            return Located {
                corners: [centre, place.corner(side), place.corner(side + 3)],
                error: cell.quarters[side],
            };
        }
        // Half of it: one of the two triangles of the quarter as a cell.
        let child = place.child(quarter).and_then(|child| cells.number(child));
        Located {
            corners: if ends {
                [centre, corner, mid]
            } else {
                [centre, mid, corner]
            },
            error: child.map_or(cell.finer, |number| cells.cell(number).error),
        }
    })
}

/// What a view draws at a place; `None` where it draws nothing.
#[must_use]
pub fn drawn_at(
    cells: &DetailCells,
    selection: &Selection,
    place: GroundPoint,
) -> Option<DrawnPoint> {
    let found = locate(cells, selection, place)?;
    let finder = Finder { cells, selection };
    let lattice = &cells.lattice;
    let sea = cells.sea();
    // x, height, z relative to the place, and how far it is above the ground.
    let corner = |at: UVec2| {
        let [x, z] = lattice.point(at).to_fixed();
        let [px, pz] = place.to_fixed();
        let metres = |fixed: i64| fixed as f64 / (1_u64 << 32) as f64;
        let height = finder.height(at);
        let morphing = height - finder.vertex(at).ground.value.max(sea);
        let xz = DVec2::new(metres(x.wrapping_sub(px)), metres(z.wrapping_sub(pz)));
        (xz, f64::from(height), f64::from(morphing))
    };
    let [first, second, third] = found.corners.map(corner);
    let (a, b) = (second.0 - first.0, third.0 - first.0);
    let area = a.perp_dot(b);
    let weights = DVec2::new((-first.0).perp_dot(b), a.perp_dot(-first.0)) / area;
    let weights = DVec3::new(1.0 - weights.x - weights.y, weights.x, weights.y);
    let rise = DVec2::new(second.1 - first.1, third.1 - first.1);
    let gradient = DVec2::new(rise.x * b.y - rise.y * a.y, rise.y * a.x - rise.x * b.x) / area;
    let moved = weights.dot(DVec3::new(first.2, second.2, third.2)).abs();
    Some(DrawnPoint {
        height: first.1 - gradient.dot(first.0),
        gradient,
        bound: f64::from(found.error) + moved,
    })
}

#[cfg(test)]
mod tests;
