//! Where one can walk: a grid of cells over the ground.
//!
//! Cell (x, z) covers the square from `origin + (x, z) · cell` on. A cell is walkable if the ground is neither too
//! steep nor under water there, and nothing stands on it. Places outside are not walkable.

use bevy::ecs::prelude::*;
use bevy::math::{IVec2, UVec2, Vec2, Vec3, Vec3Swizzles};
use std::sync::Arc;
use thiserror::Error;

/// Most cells of a grid.
pub const MOST_CELLS: u64 = 1 << 26;

/// Most cells of a side, so that lines over it are exact in 64 bits.
pub const MOST_SIDE: u32 = 1 << 20;

/// A grid that cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum GridError {
    /// A cell, or a place, that is none.
    #[error(
        "cells of {cell} m from {origin} on are none: both have to be finite, and cells above 0"
    )]
    Cell {
        /// Metres.
        cell: f32,
        /// Where the first cell begins.
        origin: Vec2,
    },
    /// No cell, or too many.
    #[error("{0} cells: there have to be some, at most {MOST_CELLS}, and {MOST_SIDE} a side")]
    Size(UVec2),
    /// The ground has no height somewhere.
    #[error("the ground at {0} has no height")]
    Height(Vec2),
}

/// What is walked on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkLimits {
    /// The steepest slope, height over way: 1 is 45°.
    pub slope: f32,
    /// Cells with ground lower than this are under water; −∞ for none.
    pub water: f32,
}

impl Default for WalkLimits {
    /// Slopes up to 45°, no water.
    fn default() -> Self {
        Self {
            slope: 1.0,
            water: f32::NEG_INFINITY,
        }
    }
}

/// The ground of walkers.
#[derive(Clone, Debug, PartialEq)]
pub struct WalkGrid {
    origin: Vec2,
    cell: f32,
    size: UVec2,
    walkable: Vec<bool>,
    /// At the corners of cells, one more a side; empty of flat ground at 0.
    heights: Vec<f32>,
    edition: u32,
}

impl WalkGrid {
    /// Flat ground at 0, all walkable.
    ///
    /// # Errors
    /// [`GridError`].
    pub fn flat(origin: Vec2, cell: f32, size: UVec2) -> Result<Self, GridError> {
        if !(origin.is_finite() && cell.is_finite() && cell > 0.0) {
            return Err(GridError::Cell { cell, origin });
        }
        let count = u64::from(size.x) * u64::from(size.y);
        if count == 0 || count > MOST_CELLS || size.max_element() > MOST_SIDE {
            return Err(GridError::Size(size));
        }
        Ok(Self {
            origin,
            cell,
            size,
            walkable: vec![true; count as usize],
            heights: Vec::new(),
            edition: 0,
        })
    }

    /// Over a ground that says its height at x and z.
    ///
    /// # Errors
    /// [`GridError`].
    pub fn over(
        origin: Vec2,
        cell: f32,
        size: UVec2,
        limits: WalkLimits,
        height: impl Fn(Vec2) -> f32,
    ) -> Result<Self, GridError> {
        let mut grid = Self::flat(origin, cell, size)?;
        for z in 0..=size.y {
            for x in 0..=size.x {
                let place = origin + Vec2::new(x as f32, z as f32) * cell;
                let height = height(place);
                if !height.is_finite() {
                    return Err(GridError::Height(place));
                }
                grid.heights.push(height);
            }
        }
        for z in 0..size.y {
            for x in 0..size.x {
                let [a, b, c, d] = grid.corners(UVec2::new(x, z));
                // The steepest of the four triangles of the corners: its gradient is that of two sides.
                let (left, right, low, high) = (c - a, d - b, b - a, d - c);
                let steepest = left
                    .abs()
                    .max(right.abs())
                    .hypot_of(low.abs().max(high.abs()));
                let lowest = a.min(b).min(c).min(d);
                grid.walkable[(z * size.x + x) as usize] =
                    steepest <= limits.slope * cell && lowest >= limits.water;
            }
        }
        Ok(grid)
    }

    /// Heights of a cell's corners: (0, 0), (1, 0), (0, 1), (1, 1).
    fn corners(&self, cell: UVec2) -> [f32; 4] {
        if self.heights.is_empty() {
            return [0.0; 4];
        }
        let row = self.size.x + 1;
        let at = (cell.y * row + cell.x) as usize;
        let next = at + row as usize;
        [
            self.heights[at],
            self.heights[at + 1],
            self.heights[next],
            self.heights[next + 1],
        ]
    }

    /// Cells a side.
    #[must_use]
    pub const fn size(&self) -> UVec2 {
        self.size
    }

    /// Metres of a cell.
    #[must_use]
    pub const fn cell(&self) -> f32 {
        self.cell
    }

    /// Where the first cell begins.
    #[must_use]
    pub const fn origin(&self) -> Vec2 {
        self.origin
    }

    /// Changes when cells do.
    #[must_use]
    pub const fn edition(&self) -> u32 {
        self.edition
    }

    /// Whether a cell can be walked on; not outside.
    #[inline]
    #[must_use]
    pub fn is_walkable(&self, cell: IVec2) -> bool {
        let inside = (cell.x as u32) < self.size.x && (cell.y as u32) < self.size.y;
        inside && self.walkable[cell.y as usize * self.size.x as usize + cell.x as usize]
    }

    /// The cell of a place. Far away it is one that is outside.
    #[inline]
    #[must_use]
    pub fn cell_of(&self, place: Vec2) -> IVec2 {
        // Floats beyond are cut to the ends of i32 and NaN to 0, which is caught by whoever moves there.
        ((place - self.origin) / self.cell).floor().as_ivec2()
    }

    /// Whether a place can be walked on.
    #[inline]
    #[must_use]
    pub fn is_open(&self, place: Vec2) -> bool {
        place.is_finite() && self.is_walkable(self.cell_of(place))
    }

    /// The middle of a cell.
    #[inline]
    #[must_use]
    pub fn middle(&self, cell: IVec2) -> Vec2 {
        self.origin + (cell.as_vec2() + 0.5) * self.cell
    }

    /// The height of the ground, between corners in lines; that of the border outside.
    #[must_use]
    pub fn height(&self, place: Vec2) -> f32 {
        if self.heights.is_empty() || !place.is_finite() {
            return 0.0;
        }
        let at = ((place - self.origin) / self.cell).clamp(Vec2::ZERO, self.size.as_vec2());
        let cell = at.as_uvec2().min(self.size - 1);
        let t = at - cell.as_vec2();
        let [a, b, c, d] = self.corners(cell);
        let (low, high) = (a + (b - a) * t.x, c + (d - c) * t.x);
        low + (high - low) * t.y
    }

    /// Opens or closes a cell; outside nothing is done.
    pub fn set(&mut self, cell: IVec2, walkable: bool) {
        let inside = (cell.x as u32) < self.size.x && (cell.y as u32) < self.size.y;
        if inside && self.is_walkable(cell) != walkable {
            self.walkable[cell.y as usize * self.size.x as usize + cell.x as usize] = walkable;
            self.edition = self.edition.wrapping_add(1);
        }
    }

    /// Closes every cell that a box touches, widened by `margin`, the radius of who walks.
    pub fn block(&mut self, low: Vec3, high: Vec3, margin: f32) {
        if !(low.is_finite() && high.is_finite() && margin.is_finite()) {
            return;
        }
        let last = self.size.as_ivec2() - 1;
        let from = self.cell_of(low.xz() - margin).clamp(IVec2::ZERO, last);
        let to = self.cell_of(high.xz() + margin).clamp(IVec2::ZERO, last);
        let (first, end) = (
            self.cell_of(low.xz() - margin),
            self.cell_of(high.xz() + margin),
        );
        if first.cmpgt(last).any() || end.cmplt(IVec2::ZERO).any() {
            return;
        }
        for z in from.y..=to.y {
            for x in from.x..=to.x {
                self.set(IVec2::new(x, z), false);
            }
        }
    }

    /// Where a step from an open place ends: at `to`, or as far along one axis as it goes, or where it began. A step
    /// is no longer than a cell, so that it passes no cell unseen; it never ends, nor cuts a corner, where one cannot
    /// walk.
    #[inline]
    #[must_use]
    pub fn step(&self, from: Vec2, to: Vec2) -> Vec2 {
        let (a, b) = (self.cell_of(from), self.cell_of(to));
        let opens = |place: Vec2| self.is_open(place);
        if a == b {
            return if to.is_finite() { to } else { from };
        }
        let (x, z) = (Vec2::new(to.x, from.y), Vec2::new(from.x, to.y));
        if opens(to) {
            let straight = a.x == b.x || a.y == b.y;
            // Between two cells that meet in a corner one of the others has to be open too.
            if straight || opens(x) || opens(z) {
                return to;
            }
        }
        // Along the longer part first.
        let way = (to - from).abs();
        let (first, second) = if way.x >= way.y { (x, z) } else { (z, x) };
        if opens(first) {
            first
        } else if opens(second) {
            second
        } else {
            from
        }
    }

    /// The open place that is nearest to a place, by rings of cells, within `rings` of them.
    #[must_use]
    pub fn nearest_open(&self, place: Vec2, rings: i32) -> Option<Vec2> {
        if !place.is_finite() {
            return None;
        }
        if self.is_open(place) {
            return Some(place);
        }
        let middle = self.cell_of(place);
        let mut best: Option<(f32, Vec2)> = None;
        for ring in 1..=rings.min(self.size.max_element() as i32) {
            // A cell of a ring is at least this far away.
            let least = (ring - 1) as f32 * self.cell;
            if best.is_some_and(|(distance, _)| distance <= least * least) {
                break;
            }
            let Some(end) = middle.x.checked_add(ring).zip(middle.y.checked_add(ring)) else {
                break;
            };
            for z in middle.y.saturating_sub(ring)..=end.1 {
                let edge = (z - middle.y).abs() == ring;
                let step = if edge { 1 } else { 2 * ring };
                for x in (middle.x.saturating_sub(ring)..=end.0).step_by(step as usize) {
                    let cell = IVec2::new(x, z);
                    if self.is_walkable(cell) {
                        let at = self.middle(cell);
                        let distance = at.distance_squared(place);
                        if best.is_none_or(|(least, _)| distance < least) {
                            best = Some((distance, at));
                        }
                    }
                }
            }
        }
        best.map(|(_, place)| place)
    }
}

trait Hypot {
    fn hypot_of(self, other: Self) -> Self;
}

impl Hypot for f32 {
    /// Square roots are the same everywhere, `hypot` is not.
    fn hypot_of(self, other: Self) -> Self {
        (self * self + other * other).sqrt()
    }
}

/// The grid that walkers of this world walk on.
#[derive(Resource, Clone, Debug)]
pub struct WalkGround(pub Arc<WalkGrid>);
