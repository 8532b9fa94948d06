//! The part of a level that is in memory: tiles about a place, in slots that come round again (F. Losasso, H. Hoppe 2004, by tiles).
//!
//! A tile's slot follows from its column and row alone, so that nothing moves in memory as the place does, and no table is looked
//! up. What may be read is a **window** of whole tiles, all of which are there; it shrinks before a slot is filled anew.

use dolomite_elevation::{TILE, TILE_COUNT, TileSamples};

/// Columns and rows of tiles, the last ones excluded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Window {
    pub low: [u32; 2],
    pub high: [u32; 2],
}

impl Window {
    pub fn is_empty(&self) -> bool {
        self.low[0] >= self.high[0] || self.low[1] >= self.high[1]
    }

    pub fn holds(&self, tile: [u32; 2]) -> bool {
        (0..2).all(|k| (self.low[k]..self.high[k]).contains(&tile[k]))
    }

    pub fn cut(&self, other: &Self) -> Self {
        Self {
            low: [0, 1].map(|k| self.low[k].max(other.low[k])),
            high: [0, 1].map(|k| self.high[k].min(other.high[k])),
        }
    }

    pub fn tiles(self) -> impl Iterator<Item = [u32; 2]> {
        (self.low[1]..self.high[1])
            .flat_map(move |row| (self.low[0]..self.high[0]).map(move |column| [column, row]))
    }
}

/// A level's tiles that are in memory.
#[derive(Debug)]
pub(super) struct ClipLevel {
    /// Columns and rows of the level's samples.
    pub samples: [u32; 2],
    /// Of its tiles.
    pub tiles: [u32; 2],
    /// Of tiles in memory.
    pub slots: [u32; 2],
    there: Vec<Option<[u32; 2]>>,
    pub heights: Vec<f32>,
    /// Empty on level 0, as `deviations`.
    pub slopes: Vec<u32>,
    pub deviations: Vec<f32>,
    /// What ought to be there.
    wanted: Window,
    /// What is, and may be read.
    pub window: Window,
    /// Tile of the place that all is about.
    focus: [f64; 2],
}

impl ClipLevel {
    /// Bytes of a level of so many tiles, of which no more than `most` a side are in memory.
    pub fn bytes(tiles: [u32; 2], most: u32, level: u32) -> u64 {
        let [columns, rows] = tiles.map(|n| u64::from(n.min(most)));
        let planes = if level == 0 { 1 } else { 3 };
        columns * rows * planes * 4 * TILE_COUNT as u64
    }

    pub fn new(samples: [u32; 2], tiles: [u32; 2], most: u32, level: u32) -> Self {
        let slots = tiles.map(|n| n.min(most));
        let count = slots[0] as usize * slots[1] as usize;
        let extra = if level == 0 { 0 } else { count * TILE_COUNT };
        Self {
            samples,
            tiles,
            slots,
            there: vec![None; count],
            heights: vec![0.0; count * TILE_COUNT],
            slopes: vec![0; extra],
            deviations: vec![0.0; extra],
            wanted: Window::default(),
            window: Window::default(),
            focus: [0.0; 2],
        }
    }

    /// Whether all of it fits into memory at once.
    pub fn is_whole(&self) -> bool {
        self.slots == self.tiles
    }

    /// The first sample of a tile's slot.
    pub fn slot(&self, tile: [u32; 2]) -> usize {
        let [column, row] = [0, 1].map(|k| (tile[k] % self.slots[k]) as usize);
        (row * self.slots[0] as usize + column) * TILE_COUNT
    }

    /// Where a sample of a tile that is there stands.
    pub fn at(&self, [column, row]: [u32; 2]) -> usize {
        const SIDE: u32 = TILE as u32;
        let slot = self.slot([column / SIDE, row / SIDE]);
        slot + (row % SIDE * SIDE + column % SIDE) as usize
    }

    /// First and last column and row of samples that may be read; `None`: none may.
    pub fn readable(&self) -> Option<[[u32; 2]; 2]> {
        if self.window.is_empty() {
            return None;
        }
        let low = self.window.low.map(|n| n * TILE as u32);
        let high = [0, 1].map(|k| (self.window.high[k] * TILE as u32).min(self.samples[k]) - 1);
        Some([low, high])
    }

    /// Whether all samples may be read from `low` to `high`, both cut to the map.
    pub fn holds(&self, low: [i64; 2], high: [i64; 2]) -> bool {
        let Some([first, last]) = self.readable() else {
            return false;
        };
        (0..2).all(|k| {
            let most = i64::from(self.samples[k]) - 1;
            low[k].clamp(0, most) >= first[k].into() && high[k].clamp(0, most) <= last[k].into()
        })
    }

    /// Wants what is about a place, in this level's samples. Whether the window changed.
    pub fn follow(&mut self, place: [f64; 2]) -> bool {
        self.focus = [0, 1].map(|k| {
            let most = f64::from(self.samples[k] - 1);
            place[k].clamp(0.0, most) / TILE as f64
        });
        let side = |k: usize| {
            let half = 0.5 * f64::from(self.slots[k]);
            let most = self.tiles[k] - self.slots[k];
            let centre = f64::from(self.wanted.low[k]) + half;
            // Who walks to and fro across a border of tiles reads nothing anew.
            if !self.wanted.is_empty() && (self.focus[k] - centre).abs() <= 1.0 {
                return self.wanted.low[k];
            }
            ((self.focus[k] - half).round().max(0.0) as u32).min(most)
        };
        let low = [side(0), side(1)];
        self.wanted = Window {
            low,
            high: [0, 1].map(|k| low[k] + self.slots[k]),
        };
        let before = self.window;
        self.window = self.window.cut(&self.wanted);
        if self.window.is_empty() {
            self.window = Window::default();
        }
        self.grow();
        self.window != before
    }

    /// What is wanted and not there, the nearest first.
    pub fn missing(&self) -> Vec<[u32; 2]> {
        let mut missing: Vec<_> = self
            .wanted
            .tiles()
            .filter(|&tile| !self.is_there(tile))
            .collect();
        let distance = |tile: &[u32; 2]| {
            let [x, z] = [0, 1].map(|k| f64::from(tile[k]) + 0.5 - self.focus[k]);
            x.abs().max(z.abs())
        };
        missing.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        missing
    }

    /// Whether something is wanted that is not there.
    pub fn is_awaited(&self) -> bool {
        // At rest the window is all that is wanted.
        self.window != self.wanted && !self.wanted.tiles().all(|tile| self.is_there(tile))
    }

    fn is_there(&self, tile: [u32; 2]) -> bool {
        self.there[self.slot(tile) / TILE_COUNT] == Some(tile)
    }

    /// Takes a tile, if it is still wanted.
    pub fn put(&mut self, tile: [u32; 2], samples: &TileSamples) -> bool {
        if !self.wanted.holds(tile) || samples.heights.len() != TILE_COUNT {
            return false;
        }
        let slot = self.slot(tile);
        self.heights[slot..slot + TILE_COUNT].copy_from_slice(&samples.heights);
        if !self.slopes.is_empty() && samples.slopes.len() == TILE_COUNT {
            self.slopes[slot..slot + TILE_COUNT].copy_from_slice(&samples.slopes);
            self.deviations[slot..slot + TILE_COUNT].copy_from_slice(&samples.deviations);
        }
        self.there[slot / TILE_COUNT] = Some(tile);
        self.grow();
        true
    }

    /// Makes the window as large as tiles are there, a row or column at a time from the place on.
    fn grow(&mut self) {
        let begin = [0, 1].map(|k| (self.focus[k] as u32).min(self.tiles[k] - 1));
        if self.window.is_empty() {
            if !(self.wanted.holds(begin) && self.is_there(begin)) {
                return;
            }
            self.window = Window {
                low: begin,
                high: begin.map(|n| n + 1),
            };
        }
        loop {
            let before = self.window;
            for axis in 0..2 {
                for up in [false, true] {
                    let mut more = self.window;
                    let mut strip = self.window;
                    if up && more.high[axis] < self.wanted.high[axis] {
                        strip.low[axis] = more.high[axis];
                        more.high[axis] += 1;
                        strip.high[axis] = more.high[axis];
                    } else if !up && more.low[axis] > self.wanted.low[axis] {
                        strip.high[axis] = more.low[axis];
                        more.low[axis] -= 1;
                        strip.low[axis] = more.low[axis];
                    } else {
                        continue;
                    }
                    if strip.tiles().all(|tile| self.is_there(tile)) {
                        self.window = more;
                    }
                }
            }
            if self.window == before {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tile whose samples are its own number.
    fn tile([column, row]: [u32; 2]) -> TileSamples {
        let number = (row * 1000 + column) as f32;
        TileSamples {
            heights: vec![number; TILE_COUNT],
            slopes: vec![column; TILE_COUNT],
            deviations: vec![number; TILE_COUNT],
        }
    }

    #[test]
    fn what_may_be_read_is_what_was_put_wherever_one_goes() {
        let mut level = ClipLevel::new([3000, 2000], [24, 16], 6, 1);
        assert!(!level.is_whole() && level.readable().is_none());
        let mut state = 7_u32;
        let mut random = |n: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % n
        };
        let mut place = [1500.0, 900.0];
        let mut read = 0;
        for round in 0..4000 {
            // Steps, and now and then a leap.
            place = if round % 211 == 0 {
                [
                    f64::from(random(3400)) - 200.0,
                    f64::from(random(2400)) - 200.0,
                ]
            } else {
                place.map(|n| n + f64::from(random(61)) - 30.0)
            };
            level.follow(place);
            let missing = level.missing();
            // Some arrive, late ones too.
            for k in 0..random(4) as usize {
                if let Some(&at) = missing.get(k * 3) {
                    assert!(level.put(at, &tile(at)));
                }
            }
            let late = [random(24), random(16)];
            level.put(late, &tile(late));
            let Some([low, high]) = level.readable() else {
                continue;
            };
            for at in [
                low,
                high,
                [low[0], high[1]],
                [(low[0] + high[0]) / 2, low[1]],
            ] {
                let expected = at[1] / 128 * 1000 + at[0] / 128;
                assert_eq!(level.heights[level.at(at)], expected as f32);
                assert_eq!(level.slopes[level.at(at)], at[0] / 128);
                read += 1;
            }
            let [low, high] = [low, high].map(|at| at.map(i64::from));
            assert!(level.holds(low, high));
            let outside = [high[0] + 1, high[1]];
            assert_eq!(level.holds(low, outside), high[0] == 2999, "cut to the map");
        }
        assert!(read > 4000, "{read}");
        // At rest all of it comes, and then nothing is missing.
        level.follow([1500.0, 900.0]);
        for at in level.missing() {
            level.put(at, &tile(at));
        }
        assert!(level.missing().is_empty());
        let window = level.window;
        assert_eq!([0, 1].map(|k| window.high[k] - window.low[k]), [6, 6]);
        // A step to and fro across a border reads nothing.
        level.follow([1500.0 + 100.0, 900.0]);
        assert!(level.missing().is_empty());
        level.follow([1500.0 + 300.0, 900.0]);
        assert_eq!(level.missing().len(), 12, "two columns");
    }

    #[test]
    fn a_small_level_is_there_as_a_whole() {
        let mut level = ClipLevel::new([300, 100], [3, 1], 6, 2);
        assert!(level.is_whole());
        level.follow([1e9, -1e9]);
        assert_eq!(level.missing(), [[2, 0], [1, 0], [0, 0]]);
        for at in [[1, 0], [0, 0], [2, 0]] {
            level.put(at, &tile(at));
        }
        assert_eq!(level.readable(), Some([[0, 0], [299, 99]]));
        level.follow([0.0, 0.0]);
        assert!(level.missing().is_empty());
        assert!(level.holds([-5, -5], [9999, 9999]));
        assert_eq!(ClipLevel::bytes([3, 1], 6, 2), 3 * 3 * 65_536);
    }
}
