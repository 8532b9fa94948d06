//! How far cells are off the ground between their samples, beside what they state.
//!
//! No view is asked. A cell's error counts at most as much as what is finer in its parent (`select.rs`), so each is followed
//! down from its root and held to what counts: the two triangles of the cell, its four, and heights to its interval.

use std::collections::HashSet;

use super::*;
use bevy::math::IVec2;
use dolomite_testkit::random::Random;

/// Places along a side of a cell at which heights are looked for; they stand on no sample but the corners.
const FINE: usize = 24;
/// Of these as many of the worst are held to f64.
const EXACT: usize = 3;

/// What was found of the cells of a ground.
#[derive(Debug, Default)]
pub struct Found {
    cells: usize,
    /// The largest of what is off over what is stated, and the cell, its depth, what is off and what is stated, metres.
    pub error: (f64, Option<CellPlace>, u32, f64, f64),
    /// The largest of what is beyond the samples over what the interval is wider than they are, and the same.
    pub beyond: (f64, Option<CellPlace>, u32, f64, f64),
}

/// What counts of a cell.
struct Stated {
    whole: f64,
    sides: [f64; 4],
    finer: f64,
}

struct Search<'a> {
    cells: &'a mut DetailCells,
    seen: HashSet<UVec2>,
    found: Found,
    hints: &'a [DVec2],
}

impl Search<'_> {
    /// Height of the drawn surface, f64.
    fn truth(&self, at: GroundPoint) -> f64 {
        let height = self.cells.terrain.sample_f64(at.to_dvec2()).height;
        height.max(f64::from(self.cells.sea()))
    }

    /// Looks at every cell from the root to the finest in which a place lies.
    fn follow(&mut self, place: DVec2) {
        let lattice = self.cells.lattice;
        let at = lattice.coordinates(GroundPoint::new(place));
        let mut most = f64::INFINITY;
        let side = f64::from(2 * lattice.root_half());
        let root = (at / side).floor().as_uvec2().min(lattice.roots - 1);
        let mut next = Some(CellPlace {
            centre: (root * 2 + 1) * lattice.root_half(),
            half: lattice.root_half(),
        });
        while let Some(cell) = next {
            most = self.look(cell, most);
            let off = at - cell.centre.as_dvec2();
            next = cell.child(match (off.x >= 0.0, off.y >= 0.0) {
                (false, false) => 0,
                (true, false) => 1,
                (true, true) => 2,
                (false, true) => 3,
            });
        }
    }

    /// Looks at a cell; what counts of all that is finer in it.
    fn look(&mut self, place: CellPlace, most: f64) -> f64 {
        let lattice = self.cells.lattice;
        self.cells.make([place]);
        let cell = *self
            .cells
            .cell(self.cells.number(place).expect("just made"));
        let whole = f64::from(cell.error).min(most);
        let stated = Stated {
            whole,
            sides: cell.quarters.map(|side| f64::from(side).min(whole)),
            finer: f64::from(cell.finer).min(whole),
        };
        if !self.seen.insert(place.centre) {
            return stated.finer;
        }
        self.found.cells += 1;
        let depth = lattice.depth_of(place);
        let sea = self.cells.sea();
        let corners = [0, 1, 2, 3].map(|k| lattice.point(place.corner(k)));
        let all = [corners.as_slice(), &[lattice.point(place.centre)]].concat();
        let drawn: Vec<f64> = heights(&self.cells.terrain, &all)
            .iter()
            .map(|h| f64::from(h.value.max(sea)))
            .collect();
        let (low, high) = (corners[0].to_dvec2(), corners[2].to_dvec2());
        // Both triangles, and the four: what is off at a place, over what is stated, and both.
        let off = |at: DVec2, height: f64| {
            let uv = (at - low) / (high - low);
            let halves = height - on_halves(&drawn, place.quarter(), uv);
            let (side, quarters) = on_quarters(&drawn, uv);
            let quarters = height - quarters;
            let of = |off: f64, stated: f64| (off.abs() / stated, off.abs(), stated);
            let (a, b) = (of(halves, stated.whole), of(quarters, stated.sides[side]));
            if a.0 > b.0 { a } else { b }
        };
        let beyond = |height: f64| {
            let margin = f64::from(cell.error);
            let samples = [f64::from(cell.low) + margin, f64::from(cell.high) - margin];
            let out = (samples[0] - height).max(height - samples[1]);
            (out / margin, out, margin)
        };
        let step = (high - low) / (FINE as f64 - 0.37);
        let grid =
            (0..FINE * FINE).map(|k| low + step * DVec2::new((k % FINE) as f64, (k / FINE) as f64));
        let inside = |at: &DVec2| at.cmpge(low).all() && at.cmple(high).all();
        let points: Vec<GroundPoint> = grid
            .chain(self.hints.iter().copied().filter(inside))
            .map(GroundPoint::new)
            .collect();
        let near: Vec<f64> = heights(&self.cells.terrain, &points)
            .iter()
            .map(|h| f64::from(h.value.max(sea)))
            .collect();
        let worst = |measure: &dyn Fn(usize) -> f64| {
            let mut order: Vec<usize> = (0..points.len()).collect();
            order.sort_by(|&a, &b| measure(b).total_cmp(&measure(a)));
            order.truncate(EXACT);
            order
        };
        for k in worst(&|k| off(points[k].to_dvec2(), near[k]).0) {
            let (ratio, off, stated) = off(points[k].to_dvec2(), self.truth(points[k]));
            if ratio > self.found.error.0 {
                self.found.error = (ratio, Some(place), depth, off, stated);
            }
        }
        for k in worst(&|k| beyond(near[k]).0) {
            let (ratio, out, margin) = beyond(self.truth(points[k]));
            if ratio > self.found.beyond.0 {
                self.found.beyond = (ratio, Some(place), depth, out, margin);
            }
        }
        stated.finer
    }
}

/// The two triangles at a place from 0 to 1 in the cell.
fn on_halves(drawn: &[f64], outer: usize, uv: DVec2) -> f64 {
    let place = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    let ends = [outer, outer + 2].map(|k| k & 3);
    let apex = [outer + 1, outer + 3].map(|k| k & 3);
    let beside = |k: usize| {
        let (a, b) = (place[ends[0]], place[ends[1]]);
        (b - a).perp_dot(place[k] - a) * (b - a).perp_dot(uv - a) >= 0.0
    };
    let apex = if beside(apex[0]) { apex[0] } else { apex[1] };
    on_triangle([ends[0], ends[1], apex].map(|k| (place[k], drawn[k])), uv)
}

/// Of the four triangles: at which side, and the height.
fn on_quarters(drawn: &[f64], uv: DVec2) -> (usize, f64) {
    let place = [
        DVec2::ZERO,
        DVec2::X,
        DVec2::ONE,
        DVec2::Y,
        DVec2::splat(0.5),
    ];
    let off = uv - 0.5;
    let side = if off.x.abs() > off.y.abs() {
        if off.x < 0.0 { 0 } else { 2 }
    } else if off.y < 0.0 {
        1
    } else {
        3
    };
    let corners = [4, (side + 3) & 3, side].map(|k| (place[k], drawn[k]));
    (side, on_triangle(corners, uv))
}

fn on_triangle([a, b, c]: [(DVec2, f64); 3], at: DVec2) -> f64 {
    let area = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
    let all = area(a.0, b.0, c.0);
    (area(at, b.0, c.0) * a.1 + area(a.0, at, c.0) * b.1 + area(a.0, b.0, at) * c.1) / all
}

/// The places of a grid where the drawn surface is farthest from the mean of those around it.
fn summits(terrain: &Terrain, count: usize) -> Vec<DVec2> {
    const SIDE: usize = 300;
    let extent = terrain.extent();
    let step = extent.size() / SIDE as f64;
    let place =
        |k: usize| extent.min + step * (DVec2::new((k % SIDE) as f64, (k / SIDE) as f64) + 0.5);
    let points: Vec<GroundPoint> = (0..SIDE * SIDE)
        .map(|k| GroundPoint::new(place(k)))
        .collect();
    let sea = terrain.sea_level().unwrap_or(f32::MIN);
    let near: Vec<f32> = heights(terrain, &points)
        .iter()
        .map(|h| h.value.max(sea))
        .collect();
    let alone = |k: usize| {
        let around = IVec2::new((k % SIDE) as i32, (k / SIDE) as i32);
        let last = IVec2::splat(SIDE as i32 - 1);
        let at = |x: i32, z: i32| {
            let at = (around + IVec2::new(x, z)).clamp(IVec2::ZERO, last);
            near[(at.y * SIDE as i32 + at.x) as usize]
        };
        (near[k] - 0.25 * (at(-4, 0) + at(4, 0) + at(0, -4) + at(0, 4))).abs()
    };
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| alone(b).total_cmp(&alone(a)));
    order.into_iter().take(count).map(place).collect()
}

/// Follows `hints`, the summits of the ground, and places at random.
pub fn search(terrain: &Terrain, hints: &[DVec2]) -> Found {
    let mut cells = DetailCells::new(terrain.clone(), 0.125);
    let mut hints = hints.to_vec();
    hints.extend(summits(terrain, 40));
    let mut search = Search {
        cells: &mut cells,
        seen: HashSet::new(),
        found: Found::default(),
        hints: &hints,
    };
    for &hint in &hints {
        search.follow(hint);
    }
    let mut random = Random::new(3);
    let extent = terrain.extent();
    for _ in 0..40 {
        search.follow(extent.min + extent.size() * DVec2::new(random.unit(), random.unit()));
    }
    assert!(search.found.cells > 100, "{:?}", search.found);
    search.found
}
