//! Which of many points on the ground lie near a place: a uniform grid, filled by counting.
//!
//! Points of a cell come in the order of their numbers, so that whatever goes over neighbours has the same order for
//! any number of threads. Places are x and z; metres.

use bevy::math::Vec2;

/// A uniform grid over points. Its lists are used again by the next build.
#[derive(Clone, Debug, Default)]
pub struct Grid {
    origin: Vec2,
    cell: f32,
    inverse: f32,
    size: [u32; 2],
    /// Where each cell begins in `items`, and one end more.
    starts: Vec<u32>,
    items: Vec<u32>,
    /// The cell of each point; once all are sorted, its place in `items`.
    cells: Vec<u32>,
}

/// Cells for each point, at most: more would be cleared for nothing.
const CELLS_A_POINT: usize = 4;

impl Grid {
    /// Sorts points into cells of `cell` metres, or larger ones where they are so far apart that most cells would be
    /// empty. Points that are not finite lie in the first cell.
    pub fn build(&mut self, places: &[Vec2], cell: f32) {
        let finite = || places.iter().filter(|place| place.is_finite());
        let low = finite().fold(Vec2::INFINITY, |low, place| low.min(*place));
        let high = finite().fold(Vec2::NEG_INFINITY, |high, place| high.max(*place));
        let (low, span) = if low.is_finite() {
            (low, high - low)
        } else {
            (Vec2::ZERO, Vec2::ZERO)
        };
        let most = (places.len() * CELLS_A_POINT + 64) as f32;
        // A span between floats may be infinite; a cell that is as large as it leaves one cell a side.
        let span = span.min(Vec2::splat(f32::MAX / 4.0));
        let mut cell = if cell > 0.0 && cell.is_finite() {
            cell
        } else {
            1.0
        };
        let count = |cell: f32| (span / cell).floor() + 1.0;
        while count(cell).x * count(cell).y > most {
            cell *= 1.5;
        }
        let size = count(cell);
        self.origin = low;
        self.cell = cell;
        self.inverse = 1.0 / cell;
        self.size = [size.x as u32, size.y as u32];
        let total = self.size[0] as usize * self.size[1] as usize;
        self.starts.clear();
        self.starts.resize(total + 1, 0);
        self.cells.clear();
        for place in places {
            let [x, y] = self.cell_of(*place);
            let cell = y * self.size[0] + x;
            self.cells.push(cell);
            self.starts[cell as usize + 1] += 1;
        }
        for cell in 0..total {
            self.starts[cell + 1] += self.starts[cell];
        }
        self.items.clear();
        self.items.resize(places.len(), 0);
        // Starts are moved on while cells fill, and are the ends then: each is the start of the next.
        for (point, cell) in self.cells.iter_mut().enumerate() {
            let at = &mut self.starts[*cell as usize];
            self.items[*at as usize] = point as u32;
            *cell = *at;
            *at += 1;
        }
        for cell in (1..=total).rev() {
            self.starts[cell] = self.starts[cell - 1];
        }
        self.starts[0] = 0;
    }

    /// The cell of a place, or the nearest one.
    #[inline]
    #[must_use]
    pub fn cell_of(&self, place: Vec2) -> [u32; 2] {
        // Negative numbers and NaN become 0.
        let at = (place - self.origin) * self.inverse;
        [
            (at.x as u32).min(self.size[0].saturating_sub(1)),
            (at.y as u32).min(self.size[1].saturating_sub(1)),
        ]
    }

    /// Points by cells, row by row: numbers that lie near each other here are near each other on the ground.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.items
    }

    /// Where each point stands in [`Self::order`].
    #[must_use]
    pub fn slots(&self) -> &[u32] {
        &self.cells
    }

    /// Metres of a cell.
    #[must_use]
    pub const fn cell(&self) -> f32 {
        self.cell
    }

    /// Where the points from cell `from` to cell `to` of a row lie in [`Self::order`].
    #[inline]
    #[must_use]
    pub fn span(&self, row: u32, from: u32, to: u32) -> std::ops::Range<usize> {
        let start = (row * self.size[0]) as usize;
        let (from, to) = (start + from as usize, start + to as usize);
        self.starts[from] as usize..self.starts[to + 1] as usize
    }

    /// Rows, and the cells of each, that a box meets.
    #[inline]
    pub fn rows(&self, low: Vec2, high: Vec2) -> impl Iterator<Item = std::ops::Range<usize>> {
        let ([x0, y0], [x1, y1]) = (self.cell_of(low), self.cell_of(high));
        let some = !self.items.is_empty();
        let rows = if some { y0..y1 + 1 } else { 0..0 };
        rows.map(move |row| self.span(row, x0, x1))
    }

    /// The numbers of points in cells that a box meets, row by row.
    #[inline]
    pub fn near(&self, low: Vec2, high: Vec2) -> impl Iterator<Item = u32> {
        self.rows(low, high)
            .flat_map(|span| self.items[span].iter().copied())
    }

    /// Bytes that it holds.
    #[must_use]
    pub fn bytes(&self) -> usize {
        4 * (self.starts.capacity() + self.items.capacity() + self.cells.capacity())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_points_are_those_of_a_list_of_all() {
        let mut random = crate::random::Random::new(7);
        let places: Vec<Vec2> = (0..500)
            .map(|_| Vec2::new(random.signed(40.0), random.signed(15.0)))
            .collect();
        let mut grid = Grid::default();
        grid.build(&places, 3.0);
        assert_eq!(grid.order().len(), 500);
        for (point, slot) in grid.slots().iter().enumerate() {
            assert_eq!(grid.order()[*slot as usize], point as u32);
        }
        for _ in 0..200 {
            let at = Vec2::new(random.signed(45.0), random.signed(20.0));
            let (low, high) = (at - 4.0, at + 4.0);
            let near: Vec<u32> = grid.near(low, high).collect();
            for (point, place) in places.iter().enumerate() {
                let is_in = place.cmpge(low).all() && place.cmple(high).all();
                assert!(!is_in || near.contains(&(point as u32)), "{place}");
            }
            assert!(near.len() < 300);
        }
    }

    #[test]
    fn points_of_no_place_and_far_apart_do_no_harm() {
        let mut grid = Grid::default();
        grid.build(&[], 1.0);
        assert_eq!(grid.near(Vec2::ZERO, Vec2::ONE).count(), 0);
        grid.build(
            &[Vec2::NAN, Vec2::splat(f32::MAX), Vec2::splat(f32::MIN)],
            0.1,
        );
        assert_eq!(grid.order().len(), 3);
        grid.build(&[Vec2::splat(f32::INFINITY)], f32::NAN);
        assert_eq!(grid.near(Vec2::NEG_INFINITY, Vec2::INFINITY).count(), 1);
        let one = vec![Vec2::new(5.0, 5.0); 1000];
        grid.build(&one, 0.5);
        assert_eq!(grid.near(Vec2::splat(4.0), Vec2::splat(6.0)).count(), 1000);
    }
}
