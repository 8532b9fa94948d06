//! The shortest way: over corners that stick out of walls, each seen by each. Slow and simple.

use bevy::math::{IVec2, Vec2};
use dolomite_logic::movement::{UNITS, WalkGrid, is_clear};

/// A place in units of a cell.
pub fn units(grid: &WalkGrid, at: Vec2) -> [i64; 2] {
    let at = ((at - grid.origin()) / grid.cell() * UNITS as f32).round();
    [at.x as i64, at.y as i64]
}

/// Corners at which exactly one of four cells is closed, since a shortest way turns nowhere else; and which of them see
/// each other.
pub struct Corners {
    places: Vec<[i64; 2]>,
    seen: Vec<Vec<u32>>,
}

fn apart(a: [i64; 2], b: [i64; 2]) -> f64 {
    let (x, z) = ((a[0] - b[0]) as f64, (a[1] - b[1]) as f64);
    (x * x + z * z).sqrt()
}

impl Corners {
    /// Of a grid.
    pub fn new(grid: &WalkGrid) -> Self {
        let mut places = Vec::new();
        let size = grid.size().as_ivec2();
        for z in 0..=size.y {
            for x in 0..=size.x {
                let cells = [(x - 1, z - 1), (x, z - 1), (x - 1, z), (x, z)];
                let closed = cells
                    .iter()
                    .filter(|(x, z)| !grid.is_walkable(IVec2::new(*x, *z)));
                if closed.count() == 1 {
                    places.push([i64::from(x) * UNITS, i64::from(z) * UNITS]);
                }
            }
        }
        let mut seen = vec![Vec::new(); places.len()];
        for a in 0..places.len() {
            for b in a + 1..places.len() {
                if is_clear(grid, places[a], places[b]) {
                    seen[a].push(b as u32);
                    seen[b].push(a as u32);
                }
            }
        }
        Self { places, seen }
    }

    /// The length of the shortest way, metres, by A*; nothing if there is none.
    pub fn shortest(&self, grid: &WalkGrid, from: Vec2, to: Vec2) -> Option<f64> {
        let (start, goal) = (units(grid, from), units(grid, to));
        let metres = f64::from(grid.cell()) / UNITS as f64;
        if is_clear(grid, start, goal) {
            return Some(apart(start, goal) * metres);
        }
        let count = self.places.len();
        let ends: Vec<bool> = self
            .places
            .iter()
            .map(|p| is_clear(grid, *p, goal))
            .collect();
        let mut lengths: Vec<f64> = self
            .places
            .iter()
            .map(|p| {
                if is_clear(grid, start, *p) {
                    apart(start, *p)
                } else {
                    f64::INFINITY
                }
            })
            .collect();
        let mut done = vec![false; count];
        let mut best = f64::INFINITY;
        loop {
            let key = |k: &usize| lengths[*k] + apart(self.places[*k], goal);
            let open = (0..count).filter(|k| !done[*k] && lengths[*k].is_finite());
            let Some(next) = open.min_by(|a, b| key(a).total_cmp(&key(b))) else {
                break;
            };
            if key(&next) >= best {
                break;
            }
            done[next] = true;
            if ends[next] {
                best = best.min(key(&next));
            }
            for other in &self.seen[next] {
                let other = *other as usize;
                let length = lengths[next] + apart(self.places[next], self.places[other]);
                lengths[other] = lengths[other].min(length);
            }
        }
        best.is_finite().then_some(best * metres)
    }
}
