//! Flow fields: the way to a goal from everywhere, for many who go there.
//!
//! The time to the goal solves the eikonal equation |∇T| = 1, by fast marching (J. Sethian, A fast marching level set
//! method for monotonically advancing fronts, PNAS 93, 1996): cells are accepted in the order of their times, and a
//! cell's time comes from at most one accepted neighbour along each axis. The way is against the gradient, by the
//! same neighbours, so that it never leads into a wall, and the lengths of ways are those of straight lines rather
//! than of steps along axes.

use super::ground::WalkGrid;
use bevy::math::{IVec2, Vec2};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

/// The time of a cell from which no goal is reached.
pub const NEVER: f32 = f32::INFINITY;

/// The way to a goal from every cell of a grid.
#[derive(Clone, Debug)]
pub struct FlowField {
    grid: Arc<WalkGrid>,
    /// Metres to the nearest goal, by cell.
    times: Vec<f32>,
    /// Of length 1, or 0 at a goal and where none is reached.
    ways: Vec<Vec2>,
}

/// Floats that are not negative have the order of their bits.
const fn order(time: f32) -> u32 {
    time.to_bits()
}

impl FlowField {
    /// To the nearest of some places. One that is not on walkable ground is nobody's goal; with no goal nobody moves.
    #[must_use]
    pub fn new(grid: Arc<WalkGrid>, goals: &[Vec2]) -> Self {
        let size = grid.size();
        let count = size.x as usize * size.y as usize;
        let mut field = Self {
            grid,
            times: vec![NEVER; count],
            ways: vec![Vec2::ZERO; count],
        };
        let mut front = BinaryHeap::new();
        let mut accepted = vec![false; count];
        for goal in goals {
            let cell = field.grid.cell_of(*goal);
            if goal.is_finite() && field.grid.is_walkable(cell) {
                let at = field.number(cell);
                field.times[at] = 0.0;
                front.push(Reverse((order(0.0), at as u32)));
            }
        }
        while let Some(Reverse((_, at))) = front.pop() {
            if std::mem::replace(&mut accepted[at as usize], true) {
                continue;
            }
            let cell = IVec2::new((at % size.x) as i32, (at / size.x) as i32);
            for side in [IVec2::X, IVec2::NEG_X, IVec2::Y, IVec2::NEG_Y] {
                let next = cell + side;
                if !field.grid.is_walkable(next) {
                    continue;
                }
                let number = field.number(next);
                if accepted[number] {
                    continue;
                }
                let time = field.solve(next, &accepted);
                if time < field.times[number] {
                    field.times[number] = time;
                    front.push(Reverse((order(time), number as u32)));
                }
            }
        }
        for z in 0..size.y as i32 {
            for x in 0..size.x as i32 {
                let cell = IVec2::new(x, z);
                let number = field.number(cell);
                field.ways[number] = field.gradient(cell);
            }
        }
        field
    }

    fn number(&self, cell: IVec2) -> usize {
        cell.y as usize * self.grid.size().x as usize + cell.x as usize
    }

    fn time_of(&self, cell: IVec2) -> f32 {
        if self.grid.is_walkable(cell) {
            self.times[self.number(cell)]
        } else {
            NEVER
        }
    }

    /// The lesser time of two neighbours along an axis, and its side.
    fn lesser(&self, cell: IVec2, axis: IVec2) -> (f32, f32) {
        let (low, high) = (self.time_of(cell - axis), self.time_of(cell + axis));
        if low <= high {
            (low, -1.0)
        } else {
            (high, 1.0)
        }
    }

    /// The time of a cell from its accepted neighbours: the greater root of (T - a)² + (T - b)² = h², or one step
    /// from the lesser neighbour where the other is too late to count.
    fn solve(&self, cell: IVec2, accepted: &[bool]) -> f32 {
        let known = |cell: IVec2| {
            let time = self.time_of(cell);
            if time < NEVER && accepted[self.number(cell)] {
                time
            } else {
                NEVER
            }
        };
        let along = |axis: IVec2| known(cell - axis).min(known(cell + axis));
        let (a, b) = (along(IVec2::X), along(IVec2::Y));
        let (low, high) = (a.min(b), a.max(b));
        let h = self.grid.cell();
        if high - low < h {
            let apart = high - low;
            low + (apart + (2.0 * h * h - apart * apart).sqrt()) / 2.0
        } else {
            low + h
        }
    }

    fn gradient(&self, cell: IVec2) -> Vec2 {
        let time = self.time_of(cell);
        if time == NEVER || time == 0.0 {
            return Vec2::ZERO;
        }
        let along = |axis: IVec2| {
            let (lesser, side) = self.lesser(cell, axis);
            if lesser < time {
                (time - lesser) * side
            } else {
                0.0
            }
        };
        let way = Vec2::new(along(IVec2::X), along(IVec2::Y));
        // Between two cells that meet in a corner, both of whose others are walls, nobody walks: along one axis then.
        let corner = cell + way.signum().as_ivec2();
        let diagonal = way.x != 0.0 && way.y != 0.0;
        if diagonal && !self.grid.is_walkable(corner) {
            let (x, z) = (self.lesser(cell, IVec2::X).0, self.lesser(cell, IVec2::Y).0);
            let one = if x <= z {
                Vec2::new(way.x, 0.0)
            } else {
                Vec2::new(0.0, way.y)
            };
            return one.normalize_or_zero();
        }
        way.normalize_or_zero()
    }

    /// Metres to the goal from a place; [`NEVER`] if there is no way.
    #[must_use]
    pub fn distance(&self, place: Vec2) -> f32 {
        if !place.is_finite() {
            return NEVER;
        }
        self.time_of(self.grid.cell_of(place))
    }

    /// The way from a place: of length 1, or 0 at the goal and where there is none. Between the middles of cells ways
    /// are blended, where all four lead somewhere.
    #[inline]
    #[must_use]
    pub fn way(&self, place: Vec2) -> Vec2 {
        let own_cell = self.grid.cell_of(place);
        if !place.is_finite() || !self.grid.is_walkable(own_cell) {
            return Vec2::ZERO;
        }
        let own = self.ways[self.number(own_cell)];
        let at = (place - self.grid.origin()) / self.grid.cell() - 0.5;
        let low = at.floor();
        let (t, cell) = (at - low, low.as_ivec2());
        let mut sum = Vec2::ZERO;
        for (side, weight) in [
            (IVec2::ZERO, (1.0 - t.x) * (1.0 - t.y)),
            (IVec2::X, t.x * (1.0 - t.y)),
            (IVec2::Y, (1.0 - t.x) * t.y),
            (IVec2::ONE, t.x * t.y),
        ] {
            let next = cell + side;
            if !self.grid.is_walkable(next) {
                return own;
            }
            sum += self.ways[self.number(next)] * weight;
        }
        // Where ways part, as behind a pillar, each goes its own.
        if sum.length_squared() < 0.25 {
            return own;
        }
        sum.normalize()
    }

    /// The grid that it is of.
    #[must_use]
    pub const fn grid(&self) -> &Arc<WalkGrid> {
        &self.grid
    }

    /// Bytes, without the grid's.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.times.len() * 4 + self.ways.len() * 8
    }
}
