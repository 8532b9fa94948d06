//! Ways for one: Theta* over the corners of cells.
//!
//! A. Nash, K. Daniel, S. Koenig, A. Felner, Theta*: any-angle path planning on grids, AAAI 2007: a search from corner
//! to corner, in which a corner is reached from the parent of its neighbour wherever a straight line leads there. The
//! shortest of all ways turns at corners of what is closed alone, so that corners are searched, not middles. What
//! comes out is pulled taut. The result is not always the shortest; the README says how near it is.

use super::ground::WalkGrid;
use super::sight_line::{UNITS, is_clear};
use bevy::math::{IVec2, Vec2};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Lists that searches use again.
#[derive(Clone, Debug, Default)]
pub struct PathScratch {
    nodes: Vec<Node>,
    /// Nodes of this number belong to this search.
    search: u32,
    /// By length so far and straight on from there; both in units, as bits of f64 that are not negative.
    front: BinaryHeap<Reverse<(u64, u32)>>,
    /// Corners that were looked at by the last search.
    pub expanded: u32,
}

#[derive(Clone, Copy, Debug, Default)]
struct Node {
    search: u32,
    parent: u32,
    length: f64,
    closed: bool,
}

type Units = [i64; 2];

fn distance(a: Units, b: Units) -> f64 {
    let (x, z) = ((b[0] - a[0]) as f64, (b[1] - a[1]) as f64);
    (x * x + z * z).sqrt()
}

/// The length of a way, metres.
#[must_use]
pub fn path_length(path: &[Vec2]) -> f64 {
    path.windows(2)
        .map(|pair| pair[0].as_dvec2().distance(pair[1].as_dvec2()))
        .sum()
}

/// One search.
struct Search<'a> {
    grid: &'a WalkGrid,
    scratch: &'a mut PathScratch,
    row: i64,
    corners: u32,
    start: Units,
    goal: Units,
    goal_cell: IVec2,
}

/// A way from one place to another: first, turns, last. Nothing if there is none, or an end cannot be walked on. Ends
/// are moved by up to 1/512 of a cell.
#[must_use]
pub fn find_path(
    grid: &WalkGrid,
    from: Vec2,
    to: Vec2,
    scratch: &mut PathScratch,
) -> Option<Vec<Vec2>> {
    scratch.expanded = 0;
    if !(grid.is_open(from) && grid.is_open(to)) {
        return None;
    }
    let units = |place: Vec2| {
        let cell = grid.cell_of(place);
        let at = ((place - grid.origin()) / grid.cell() - cell.as_vec2()) * UNITS as f32;
        let part = at
            .round()
            .as_i64vec2()
            .clamp(bevy::math::I64Vec2::ZERO, bevy::math::I64Vec2::splat(UNITS));
        [
            i64::from(cell.x) * UNITS + part.x,
            i64::from(cell.y) * UNITS + part.y,
        ]
    };
    let (start, goal) = (units(from), units(to));
    if is_clear(grid, start, goal) {
        return Some(vec![from, to]);
    }
    let size = grid.size();
    let corners = (size.x + 1) * (size.y + 1);
    let mut search = Search {
        grid,
        scratch,
        row: i64::from(size.x) + 1,
        corners,
        start,
        goal,
        goal_cell: grid.cell_of(to),
    };
    let turns = search.run(grid.cell_of(from))?;
    let place = |at: &Units| {
        grid.origin() + Vec2::new(at[0] as f32, at[1] as f32) * (grid.cell() / UNITS as f32)
    };
    let mut path = vec![from];
    path.extend(turns[1..turns.len() - 1].iter().map(place));
    path.push(to);
    Some(path)
}

impl Search<'_> {
    fn place(&self, node: u32) -> Units {
        match node.checked_sub(self.corners) {
            None => {
                let node = i64::from(node);
                [node % self.row * UNITS, node / self.row * UNITS]
            }
            Some(0) => self.start,
            Some(_) => self.goal,
        }
    }

    fn open(&self, x: i64, z: i64) -> bool {
        self.grid.is_walkable(IVec2::new(x as i32, z as i32))
    }

    /// Whether a corner can be gone through: one of its cells is open, and if two are, they meet in a side.
    fn passes(&self, x: i64, z: i64) -> bool {
        let [a, b, c, d] = [
            self.open(x - 1, z - 1),
            self.open(x, z - 1),
            self.open(x - 1, z),
            self.open(x, z),
        ];
        let pinched = (a && d && !b && !c) || (b && c && !a && !d);
        (a || b || c || d) && !pinched
    }

    fn node(&mut self, node: u32) -> &mut Node {
        let search = self.scratch.search;
        let kept = &mut self.scratch.nodes[node as usize];
        if kept.search != search {
            *kept = Node {
                search,
                parent: node,
                length: f64::INFINITY,
                closed: false,
            };
        }
        kept
    }

    fn run(&mut self, start_cell: IVec2) -> Option<Vec<Units>> {
        let count = self.corners as usize + 2;
        if self.scratch.nodes.len() < count || self.scratch.search == u32::MAX {
            self.scratch.nodes.clear();
            self.scratch.nodes.resize(count, Node::default());
            self.scratch.search = 0;
        }
        self.scratch.search += 1;
        self.scratch.front.clear();
        let (start, goal) = (self.corners, self.corners + 1);
        self.node(start).length = 0.0;
        self.node(start).closed = true;
        self.scratch.expanded = 1;
        for (x, z) in around(start_cell) {
            self.reach(start, x, z);
        }
        while let Some(Reverse((_, node))) = self.scratch.front.pop() {
            if std::mem::replace(&mut self.node(node).closed, true) {
                continue;
            }
            if node == goal {
                return Some(self.taut(goal));
            }
            self.scratch.expanded += 1;
            let (x, z) = (i64::from(node) % self.row, i64::from(node) / self.row);
            for dz in -1..=1 {
                for dx in -1..=1 {
                    if self.joined(x, z, dx, dz) {
                        self.reach(node, x + dx, z + dz);
                    }
                }
            }
            if around(self.goal_cell).contains(&(x, z)) {
                self.relax(node, goal);
            }
        }
        None
    }

    /// Whether a corner and one of the eight around it are joined.
    fn joined(&self, x: i64, z: i64, dx: i64, dz: i64) -> bool {
        match (dx, dz) {
            (0, 0) => false,
            (0, dz) => {
                let row = z + (dz - 1) / 2;
                self.open(x - 1, row) || self.open(x, row)
            }
            (dx, 0) => {
                let column = x + (dx - 1) / 2;
                self.open(column, z - 1) || self.open(column, z)
            }
            (dx, dz) => self.open(x + (dx - 1) / 2, z + (dz - 1) / 2),
        }
    }

    fn reach(&mut self, from: u32, x: i64, z: i64) {
        let inside = x >= 0 && z >= 0 && x < self.row && z <= i64::from(self.grid.size().y);
        if inside && self.passes(x, z) {
            self.relax(from, (z * self.row + x) as u32);
        }
    }

    /// A shorter way to a node, from a neighbour or from the neighbour's parent.
    fn relax(&mut self, from: u32, node: u32) {
        if self.node(node).closed {
            return;
        }
        let place = self.place(node);
        let parent = self.node(from).parent;
        let best = self.node(node).length;
        // The straight line from the parent is never longer than the turn, so that it alone is worth a look.
        let straight = self.node(parent).length + distance(self.place(parent), place);
        if straight >= best {
            return;
        }
        let (parent, length) = if is_clear(self.grid, self.place(parent), place) {
            (parent, straight)
        } else {
            let turn = self.node(from).length + distance(self.place(from), place);
            (from, turn)
        };
        if length >= best {
            return;
        }
        let kept = self.node(node);
        kept.parent = parent;
        kept.length = length;
        let whole = length + distance(place, self.goal);
        self.scratch.front.push(Reverse((whole.to_bits(), node)));
    }

    /// From the start to a node, without turns that can be left out.
    fn taut(&mut self, mut node: u32) -> Vec<Units> {
        let mut way = vec![self.place(node)];
        while node != self.corners {
            node = self.node(node).parent;
            way.push(self.place(node));
        }
        way.reverse();
        loop {
            let before = way.len();
            let mut at = 1;
            while at + 1 < way.len() {
                if is_clear(self.grid, way[at - 1], way[at + 1]) {
                    way.remove(at);
                } else {
                    at += 1;
                }
            }
            if way.len() == before {
                return way;
            }
        }
    }
}

/// The corners of a cell.
fn around(cell: IVec2) -> [(i64, i64); 4] {
    let (x, z) = (i64::from(cell.x), i64::from(cell.y));
    [(x, z), (x + 1, z), (x, z + 1), (x + 1, z + 1)]
}
