//! Where heights have become finer, for whoever keeps something that was made of them.

use super::clip::Window;
use dolomite_elevation::TILE;
use std::collections::VecDeque;

/// From a corner to the one across, in samples of the map.
type Rect = [[f64; 2]; 2];

/// Samples that no map has.
const BEYOND: f64 = 1e9;

/// As many are told one by one; of what is older all of the map is said to have changed.
const KEPT: usize = 1024;

/// Rectangles that became readable, numbered.
#[derive(Debug, Default)]
pub(super) struct Arrived {
    last: VecDeque<Rect>,
    count: u64,
}

impl Arrived {
    /// A level of so many tiles had one window and has another.
    pub fn add(&mut self, level: (usize, [u32; 2]), before: Window, now: Window) {
        // What is no longer there leaves what was made of it as true as it was.
        let before = now.cut(&before);
        let mut rest = now;
        if before.is_empty() {
            self.tell(level, rest);
            return;
        }
        for k in 0..2 {
            let mut strip = rest;
            strip.high[k] = before.low[k];
            self.tell(level, strip);
            strip = rest;
            strip.low[k] = before.high[k];
            self.tell(level, strip);
            (rest.low[k], rest.high[k]) = (before.low[k], before.high[k]);
        }
    }

    fn tell(&mut self, (level, tiles): (usize, [u32; 2]), window: Window) {
        if window.is_empty() {
            return;
        }
        let step = (1_u64 << level) as f64;
        // Cells take samples from one before to two after them; a cell that has them all now may lie that far off.
        let place = |tile: u32, by: f64| (f64::from(tile) * TILE as f64 + by) * step;
        // Beyond the map its border goes on.
        let low = |k: usize| match window.low[k] {
            0 => -BEYOND,
            n => place(n, -3.0),
        };
        let high = |k: usize| match window.high[k] {
            n if n >= tiles[k] => BEYOND,
            n => place(n, 3.0),
        };
        let rect = [[low(0), low(1)], [high(0), high(1)]];
        if self.last.len() == KEPT {
            self.last.pop_front();
        }
        self.last.push_back(rect);
        self.count += 1;
    }

    /// How many there were.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// Those after the first so many, up to so many; `None`: they are no longer known.
    pub fn between(&self, from: u64, to: u64) -> Option<Vec<Rect>> {
        let forgotten = self.count - self.last.len() as u64;
        let from = from.checked_sub(forgotten)? as usize;
        let to = (to.min(self.count) - forgotten) as usize;
        Some(self.last.range(from.min(to)..to).copied().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MANY: [u32; 2] = [5000; 2];

    fn window(low: [u32; 2], high: [u32; 2]) -> Window {
        Window { low, high }
    }

    #[test]
    fn what_is_new_is_told_and_nothing_else() {
        let mut arrived = Arrived::default();
        let nothing = Window::default();
        arrived.add((0, MANY), nothing, nothing);
        assert_eq!(arrived.count(), 0);
        arrived.add((1, MANY), nothing, window([2, 3], [4, 4]));
        let first = [[2.0 * 256.0 - 6.0, 3.0 * 256.0 - 6.0], [1030.0, 1030.0]];
        assert_eq!(arrived.between(0, 1), Some(vec![first]));
        // It moves: what is behind is not told, a column before and a row beside are.
        arrived.add((0, MANY), window([2, 3], [5, 6]), window([3, 3], [6, 7]));
        let rects = arrived.between(1, 3).expect("known");
        assert_eq!(rects.len(), 2);
        let holds = |x: f64, z: f64| {
            let inside = |[low, high]: &Rect| {
                (low[0]..=high[0]).contains(&x) && (low[1]..=high[1]).contains(&z)
            };
            rects.iter().any(inside)
        };
        for x in 3..6 {
            for z in 3..7 {
                let middle = |n: u32| f64::from(n) * 128.0 + 64.0;
                assert_eq!(holds(middle(x), middle(z)), x == 5 || z == 6, "{x}, {z}");
            }
        }
        assert_eq!(arrived.between(3, 3), Some(Vec::new()));
        for n in 0..KEPT as u32 + 5 {
            arrived.add((0, MANY), nothing, window([n, 0], [n + 1, 1]));
        }
        assert_eq!(arrived.between(0, 3), None, "too long ago");
        // The border of the map goes on.
        arrived.add((0, [9, 9]), nothing, window([0, 4], [2, 9]));
        let count = arrived.count();
        let border = [[-BEYOND, 4.0 * 128.0 - 3.0], [259.0, BEYOND]];
        assert_eq!(arrived.between(count - 1, count), Some(vec![border]));
        assert_eq!(arrived.between(count - 4, count).map(|r| r.len()), Some(4));
    }
}
