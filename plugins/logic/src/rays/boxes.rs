//! Upright boxes in a grid.

use super::answer::{Rays, Stop};
use bevy::math::{Vec2, Vec3, Vec3Swizzles};

/// Upright boxes that do not move: houses, walls, blocks.
#[derive(Clone, Debug, Default)]
pub struct BoxRays {
    boxes: Vec<[Vec3; 2]>,
    origin: Vec2,
    cell: f32,
    size: [u32; 2],
    starts: Vec<u32>,
    /// Boxes of each cell; [`AGAIN`] is set where a box of the same row's cell before is met again.
    items: Vec<u32>,
}

/// Says that the cell before, in the same row, has this box too.
const AGAIN: u32 = 1 << 31;

/// Boxes near several ways from one place that are all looked at for each: more are asked by their cells.
const NEAR: usize = 64;

/// Boxes that are looked at at once.
const LANES: usize = 8;

/// When a way enters a box, as a part of it; nothing if it does not. 0 of one that starts inside.
#[inline]
#[must_use]
pub fn enter_box(from: Vec3, way: Vec3, corners: &[Vec3; 2]) -> Option<f32> {
    let inverse = way.recip();
    // Of an axis along which nothing moves both are infinite, of one sign outside; on the very face one is NaN, and
    // whoever goes along a face may or may not meet it.
    let a = (corners[0] - from) * inverse;
    let b = (corners[1] - from) * inverse;
    let enter = a.min(b).max_element().max(0.0);
    let leave = a.max(b).min_element().min(1.0);
    (enter <= leave).then_some(enter)
}

impl BoxRays {
    /// Of low and high corners; boxes that are not finite or inside out are left out. Cells are `cell` metres wide.
    #[must_use]
    pub fn new(boxes: impl IntoIterator<Item = [Vec3; 2]>, cell: f32) -> Self {
        let whole = |b: &[Vec3; 2]| b[0].is_finite() && b[1].is_finite() && b[0].cmple(b[1]).all();
        let boxes: Vec<_> = boxes.into_iter().filter(whole).collect();
        let mut rays = Self {
            boxes,
            ..Self::default()
        };
        let low = rays
            .boxes
            .iter()
            .fold(Vec2::INFINITY, |low, b| low.min(b[0].xz()));
        let high = rays
            .boxes
            .iter()
            .fold(Vec2::NEG_INFINITY, |high, b| high.max(b[1].xz()));
        if rays.boxes.is_empty() {
            return rays;
        }
        let span = (high - low).min(Vec2::splat(f32::MAX / 4.0));
        let mut cell = if cell > 0.0 && cell.is_finite() {
            cell
        } else {
            8.0
        };
        // Some hundred thousand cells, however far apart the boxes are.
        while (span.x / cell + 1.0) * (span.y / cell + 1.0) > 262_144.0 {
            cell *= 1.5;
        }
        rays.cell = cell;
        rays.origin = low;
        rays.size = [(span.x / cell) as u32 + 1, (span.y / cell) as u32 + 1];
        let total = (rays.size[0] * rays.size[1]) as usize;
        let mut lists: Vec<Vec<u32>> = vec![Vec::new(); total];
        for (number, corners) in rays.boxes.iter().enumerate() {
            let ([x0, y0], [x1, y1]) =
                (rays.cell_of(corners[0].xz()), rays.cell_of(corners[1].xz()));
            for y in y0..=y1 {
                for x in x0..=x1 {
                    let again = if x > x0 { AGAIN } else { 0 };
                    lists[(y * rays.size[0] + x) as usize].push(number as u32 | again);
                }
            }
        }
        for list in lists {
            rays.starts.push(rays.items.len() as u32);
            rays.items.extend(list);
        }
        rays.starts.push(rays.items.len() as u32);
        rays
    }

    fn cell_of(&self, place: Vec2) -> [u32; 2] {
        let at = (place - self.origin) / self.cell;
        [
            (at.x as u32).min(self.size[0] - 1),
            (at.y as u32).min(self.size[1] - 1),
        ]
    }

    /// The boxes.
    #[must_use]
    pub fn boxes(&self) -> &[[Vec3; 2]] {
        &self.boxes
    }

    /// What every box answers, one after the other: the reference of [`Rays::cast`].
    #[must_use]
    pub fn cast_all(&self, from: Vec3, to: Vec3) -> Option<Stop> {
        if !(from.is_finite() && to.is_finite()) {
            return None;
        }
        let mut first: Option<Stop> = None;
        for (number, corners) in self.boxes.iter().enumerate() {
            if let Some(time) = enter_box(from, to - from, corners)
                && first.is_none_or(|stop| time < stop.time)
            {
                first = Some(Stop {
                    time,
                    blocker: number as u64,
                });
            }
        }
        first
    }
}

impl BoxRays {
    /// The boxes that a box around all ways from a place meets, and how many; nothing if there is no room for them.
    fn near(&self, from: Vec3, to: &[Vec3], near: &mut [u32; NEAR]) -> Option<usize> {
        if self.boxes.is_empty() {
            return Some(0);
        }
        let whole = to.iter().filter(|to| to.is_finite());
        let (low, high) = whole.fold((from, from), |(low, high), to| {
            (low.min(*to), high.max(*to))
        });
        let ([x0, y0], [x1, y1]) = (self.cell_of(low.xz()), self.cell_of(high.xz()));
        let mut count = 0;
        for y in y0..=y1 {
            let row = (y * self.size[0]) as usize;
            let (first, last) = (row + x0 as usize, row + x1 as usize);
            let first_cell = self.starts[first + 1] as usize;
            for at in self.starts[first] as usize..self.starts[last + 1] as usize {
                let number = self.items[at] & !AGAIN;
                if at >= first_cell && self.items[at] != number {
                    continue;
                }
                let [least, greatest] = self.boxes[number as usize];
                let apart = least.cmpgt(high).any() || greatest.cmplt(low).any();
                // A box of several rows counts in the first of these that is looked at.
                let [_, own] = self.cell_of(least.xz());
                if apart || (own.max(y0) != y) {
                    continue;
                }
                *near.get_mut(count)? = number;
                count += 1;
            }
        }
        Some(count)
    }
}

/// Boxes from a place, by axes, so that several are looked at at once.
struct Wide {
    low: [[f32; NEAR]; 3],
    high: [[f32; NEAR]; 3],
    count: usize,
}

impl Wide {
    fn new(from: Vec3, boxes: &[[Vec3; 2]], near: &[u32]) -> Self {
        let mut wide = Self {
            low: [[0.0; NEAR]; 3],
            high: [[0.0; NEAR]; 3],
            count: near.len(),
        };
        for (at, &number) in near.iter().enumerate() {
            let [low, high] = boxes[number as usize];
            let (low, high) = (low - from, high - from);
            for axis in 0..3 {
                wide.low[axis][at] = low[axis];
                wide.high[axis][at] = high[axis];
            }
        }
        wide
    }

    /// The first of them that a way enters, by the inverse of the way, as [`enter_box`] has it.
    #[inline]
    fn first(&self, inverse: Vec3) -> Option<usize> {
        let lesser = |a: f32, b: f32| if a < b { a } else { b };
        let greater = |a: f32, b: f32| if a > b { a } else { b };
        let mut first = 0;
        while first < self.count {
            let (mut enter, mut leave) = ([0.0_f32; LANES], [1.0_f32; LANES]);
            for axis in 0..3 {
                let (low, high) = (
                    &self.low[axis][first..first + LANES],
                    &self.high[axis][first..first + LANES],
                );
                for lane in 0..LANES {
                    let (a, b) = (low[lane] * inverse[axis], high[lane] * inverse[axis]);
                    enter[lane] = greater(enter[lane], lesser(a, b));
                    leave[lane] = lesser(leave[lane], greater(a, b));
                }
            }
            let mut found = 0_u32;
            for lane in 0..LANES {
                found |= u32::from(enter[lane] <= leave[lane]) << lane;
            }
            let left = self.count - first;
            if left < LANES {
                found &= (1 << left) - 1;
            }
            if found != 0 {
                return Some(first + found.trailing_zeros() as usize);
            }
            first += LANES;
        }
        None
    }
}

impl Rays for BoxRays {
    /// Goes from cell to cell of the row or column that the way is in (J. Amanatides, A. Woo, A Fast Voxel Traversal
    /// Algorithm for Ray Tracing, Eurographics 1987), by whole spans of a row, so that rounding at a border of cells
    /// cannot skip one: the span of each row is widened by a thousandth of a cell.
    fn cast(&self, from: Vec3, to: Vec3) -> Option<Stop> {
        if self.boxes.is_empty() || !(from.is_finite() && to.is_finite()) {
            return None;
        }
        let way = to - from;
        let (a, b) = (
            (from.xz() - self.origin) / self.cell,
            (to.xz() - self.origin) / self.cell,
        );
        const SLACK: f32 = 1e-3;
        let (low, high) = (a.min(b) - SLACK, a.max(b) + SLACK);
        let (width, rows) = (self.size[0] as f32, self.size[1] as f32);
        if high.x < 0.0 || high.y < 0.0 || low.x > width || low.y > rows {
            return None;
        }
        let step = b - a;
        let row_of = |y: f32| (y.max(0.0) as u32).min(self.size[1] - 1);
        let (first_row, last_row) = (row_of(low.y), row_of(high.y));
        let mut first: Option<Stop> = None;
        let count = last_row - first_row + 1;
        for nth in 0..count {
            // Rows in the order in which the way goes.
            let row = if step.y >= 0.0 {
                first_row + nth
            } else {
                last_row - nth
            };
            // The part of the way within the row, x by x.
            let (mut enter, mut leave) = (0.0_f32, 1.0_f32);
            if step.y != 0.0 {
                let t0 = (row as f32 - SLACK - a.y) / step.y;
                let t1 = (row as f32 + 1.0 + SLACK - a.y) / step.y;
                // The outermost rows also hold what lies beyond them.
                let open = |t: f32, edge: u32| if row == edge { t } else { f32::NAN };
                let beyond = if step.y > 0.0 {
                    (open(0.0, 0), open(1.0, self.size[1] - 1))
                } else {
                    (open(0.0, self.size[1] - 1), open(1.0, 0))
                };
                let (near, far) = (t0.min(t1), t0.max(t1));
                enter = if beyond.0.is_nan() {
                    near.max(0.0)
                } else {
                    beyond.0
                };
                leave = if beyond.1.is_nan() {
                    far.min(1.0)
                } else {
                    beyond.1
                };
            }
            if first.is_some_and(|stop| stop.time < enter) {
                break;
            }
            let (x0, x1) = (a.x + step.x * enter, a.x + step.x * leave);
            let column = |x: f32| (x.max(0.0) as u32).min(self.size[0] - 1);
            let (from_x, to_x) = (column(x0.min(x1) - SLACK), column(x0.max(x1) + SLACK));
            let start = row * self.size[0];
            let (from_cell, to_cell) = ((start + from_x) as usize, (start + to_x) as usize);
            let first_cell = self.starts[from_cell + 1] as usize;
            let span = self.starts[from_cell] as usize..self.starts[to_cell + 1] as usize;
            for at in span {
                let number = self.items[at] & !AGAIN;
                if at >= first_cell && self.items[at] != number {
                    continue;
                }
                if let Some(time) = enter_box(from, way, &self.boxes[number as usize]) {
                    let number = u64::from(number);
                    let sooner = first.is_none_or(|stop| {
                        time < stop.time || (time == stop.time && number < stop.blocker)
                    });
                    if sooner {
                        first = Some(Stop {
                            time,
                            blocker: number,
                        });
                    }
                }
            }
        }
        first
    }

    /// Looks at the boxes near all of the ways, eight at once, where there are few.
    fn hide(&self, from: Vec3, to: &[Vec3], blockers: &mut [Option<u64>]) {
        let mut near = [0_u32; NEAR];
        let near = self.near(from, to, &mut near).map(|count| &near[..count]);
        let wide = near.map(|near| Wide::new(from, &self.boxes, near));
        for (to, blocker) in to.iter().zip(blockers) {
            if blocker.is_some() || !(from.is_finite() && to.is_finite()) {
                continue;
            }
            *blocker = match (&wide, near) {
                (Some(wide), Some(near)) => wide
                    .first((*to - from).recip())
                    .map(|at| u64::from(near[at])),
                _ => self.cast(from, *to).map(|stop| stop.blocker),
            };
        }
    }

    fn still_blocks(&self, blocker: u64, from: Vec3, to: Vec3) -> bool {
        let known = self.boxes.get(blocker as usize);
        known.is_some_and(|corners| enter_box(from, to - from, corners).is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn boxes(random: &mut Random, count: usize) -> Vec<[Vec3; 2]> {
        (0..count)
            .map(|_| {
                let low = Vec3::new(random.signed(100.0), -1.0, random.signed(100.0));
                let size = Vec3::new(
                    random.unit() * 12.0,
                    random.unit() * 8.0,
                    random.unit() * 12.0,
                );
                [low, low + size]
            })
            .collect()
    }

    #[test]
    fn a_grid_of_boxes_answers_as_the_list_of_all_does() {
        let mut random = Random::new(3);
        let rays = BoxRays::new(boxes(&mut random, 300), 7.0);
        let place = |random: &mut Random| {
            Vec3::new(
                random.signed(140.0),
                random.signed(4.0),
                random.signed(140.0),
            )
        };
        let mut hits = 0;
        for number in 0..20_000 {
            let from = place(&mut random);
            let mut to = place(&mut random);
            // Along a row, a column, and straight up.
            match number % 10 {
                0 => to.z = from.z,
                1 => to.x = from.x,
                2 => (to.x, to.z) = (from.x, from.z),
                _ => (),
            }
            let (ours, all) = (rays.cast(from, to), rays.cast_all(from, to));
            assert_eq!(ours.map(|s| s.time), all.map(|s| s.time), "{from} {to}");
            // Of several ways at once each is hidden where it is alone.
            let ways = [to, place(&mut random), to.lerp(from, 0.5), Vec3::NAN];
            let mut hidden = [None; 4];
            rays.hide(from, &ways, &mut hidden);
            for (to, hidden) in ways.into_iter().zip(hidden) {
                assert_eq!(hidden.is_some(), rays.cast_all(from, to).is_some());
                assert!(hidden.is_none_or(|by| rays.still_blocks(by, from, to)));
            }
            if let Some(stop) = ours {
                hits += 1;
                assert!(rays.still_blocks(stop.blocker, from, to));
            }
        }
        assert!((4000..16_000).contains(&hits), "{hits}");
    }
}
