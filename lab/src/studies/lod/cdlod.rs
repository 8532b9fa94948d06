//! CDLOD (F. Strugar 2009, "Continuous Distance-Dependent Level of Detail for Rendering
//! Heightmaps"): a quadtree of grids, chosen by the distance in space; towards the end of its range a
//! grid's vertices move onto the next coarser grid.

use super::baseline::{Baseline, Knob};
use crate::scenes::camera::{Camera, View};
use crate::scenes::mesh::MOST_TRIANGLES;
use crate::scenes::mesh::{Drawn, GroundMesh};
use crate::scenes::truth::Truth;
use bevy::math::{DVec2, DVec3};
use bevy::platform::collections::HashMap;
use dolomite_terrain::GroundRect;
use dolomite_testkit::cores::on_all_cores;
use std::sync::Mutex;

/// Quads along a side of a node. Of 8, 16 and 32, the usual ones, the middle.
const GRID: u32 = 16;
/// Deepest level of the quadtree: nodes of 1 mm for a terrain of 16 km.
const DEEPEST: u32 = 24;
/// Share of the way from the next finer range to its own end at which a grid starts to move.
const MORPH_START: f64 = 0.66;

/// The method. It keeps the boxes of nodes, which are those of the terrain.
#[derive(Debug, Default)]
pub struct Cdlod {
    boxes: Mutex<Option<(Truth, HashMap<Node, (f64, f64)>)>>,
}

/// A node of the quadtree: depth, and column and row at that depth.
type Node = (u32, [u32; 2]);

impl Baseline for Cdlod {
    fn name(&self) -> &'static str {
        "CDLOD"
    }

    fn knob(&self) -> Knob {
        Knob {
            name: "range, sides of a node",
            // With r sides, a grid has to be at rest where the finer one ends: the diagonal of a node's
            // box, √(2 + rise²) sides, has to fit between r and 1.66 r. From 8 on it does for boxes up
            // to 5 times as high as wide; those of the terrain's bounds are higher than the ground.
            coarsest: 8.0,
            finest: 512.0,
        }
    }

    fn draw(&self, truth: &Truth, camera: &Camera, knob: f64) -> Option<Box<dyn Drawn>> {
        let mut boxes = self.boxes.lock().unwrap_or_else(|e| e.into_inner());
        let (_, boxes) = match &mut *boxes {
            Some(boxes) if boxes.0.terrain.same(&truth.terrain) => boxes,
            other => other.insert((truth.clone(), HashMap::default())),
        };
        let view = camera.view();
        let extent = truth.terrain.extent();
        let selection = Selection {
            truth,
            view: &view,
            extent,
            side: extent.size().max_element(),
            ranges: knob,
        };
        let (positions, triangles) = selection.draw(boxes)?;
        Some(Box::new(GroundMesh::new(positions, triangles, &view)))
    }
}

struct Selection<'a> {
    truth: &'a Truth,
    view: &'a View,
    extent: GroundRect,
    /// Longer side of the root, metres.
    side: f64,
    /// Range of a level, in sides of its nodes.
    ranges: f64,
}

/// A vertex: depth, and place on the grid of that depth.
type Vertex = (u32, [u32; 2]);

impl Selection<'_> {
    /// End of a level's range, metres; the coarsest has none.
    fn range(&self, depth: u32) -> f64 {
        match depth {
            0 => f64::INFINITY,
            _ if depth > DEEPEST => 0.0,
            _ => self.ranges * self.side / f64::from(1 << depth),
        }
    }

    fn rect(&self, (depth, at): Node) -> GroundRect {
        let size = self.extent.size() / f64::from(1 << depth);
        let min = self.extent.min + DVec2::new(f64::from(at[0]), f64::from(at[1])) * size;
        GroundRect::new(min, min + size)
    }

    /// Chooses level by level, so that the boxes of a level are found on all cores: quarters of
    /// nodes, as (node, column and row of the quarter).
    fn select(&self, boxes: &mut HashMap<Node, (f64, f64)>) -> Option<Vec<(Node, [u32; 2])>> {
        let mut chosen = Vec::new();
        let mut level: Vec<Node> = vec![(0, [0, 0])];
        let quarters = [[0, 0], [1, 0], [0, 1], [1, 1]];
        while !level.is_empty() {
            let children: Vec<(Node, [u32; 2], Node)> = level
                .iter()
                .flat_map(|&(depth, at)| {
                    quarters.map(|q| {
                        let child = [2 * at[0] + q[0], 2 * at[1] + q[1]];
                        ((depth, at), q, (depth + 1, child))
                    })
                })
                .collect();
            let new: Vec<_> = children.iter().map(|c| c.2).collect();
            let new: Vec<_> = new.into_iter().filter(|n| !boxes.contains_key(n)).collect();
            let found = on_all_cores(&new, |&node| self.truth.bounds(&self.rect(node)));
            boxes.extend(new.into_iter().zip(found));
            level = Vec::new();
            for (node, quarter, child) in children {
                let (rect, (low, high)) = (self.rect(child), boxes[&child]);
                // What lies below the sea is not drawn.
                if high < self.truth.sea() {
                    continue;
                }
                let low = DVec3::new(rect.min.x, low, rect.min.y);
                let high = DVec3::new(rect.max.x, high, rect.max.y);
                if !self.view.may_see_box(low, high) {
                    continue;
                }
                let nearest = self.view.distance(self.view.eye.clamp(low, high));
                if nearest < self.range(child.0) {
                    level.push(child);
                } else {
                    chosen.push((node, quarter));
                }
            }
            if (chosen.len() + level.len()) as u64 * u64::from(GRID * GRID / 2)
                > MOST_TRIANGLES as u64
            {
                return None;
            }
        }
        Some(chosen)
    }

    /// Vertices after their move, and triangles, those without area too.
    fn draw(&self, boxes: &mut HashMap<Node, (f64, f64)>) -> Option<(Vec<DVec3>, Vec<[u32; 3]>)> {
        let mut index: HashMap<Vertex, u32> = HashMap::default();
        let mut vertices = Vec::new();
        let mut triangles = Vec::new();
        for ((depth, at), quarter) in self.select(boxes)? {
            let half = GRID / 2;
            let first = [0, 1].map(|axis| at[axis] * GRID + quarter[axis] * half);
            let mut vertex = |column: u32, row: u32| {
                let key = (depth, [first[0] + column, first[1] + row]);
                *index.entry(key).or_insert_with(|| {
                    vertices.push(key);
                    vertices.len() as u32 - 1
                })
            };
            for row in 0..half {
                for column in 0..half {
                    let a = vertex(column, row);
                    let b = vertex(column + 1, row);
                    let c = vertex(column, row + 1);
                    let d = vertex(column + 1, row + 1);
                    triangles.extend([[a, c, d], [a, d, b]]);
                }
            }
        }
        let positions = on_all_cores(&vertices, |&vertex| self.position(vertex));
        Some((positions, triangles))
    }

    /// Place of a vertex after its move: odd ones to the even one before them, by how far their
    /// distance lies between start and end of the move.
    fn position(&self, (depth, at): Vertex) -> DVec3 {
        let step = self.extent.size() / f64::from(GRID) / f64::from(1 << depth);
        let place = |at: DVec2| self.extent.min + at * step;
        let at_rest = DVec2::new(f64::from(at[0]), f64::from(at[1]));
        let point = self.truth.point(place(at_rest));
        let odd = DVec2::new(f64::from(at[0] % 2), f64::from(at[1] % 2));
        if depth == 0 || odd == DVec2::ZERO {
            return point;
        }
        let (finer, end) = (self.range(depth + 1), self.range(depth));
        let start = finer + MORPH_START * (end - finer);
        let moved = ((self.view.distance(point) - start) / (end - start)).clamp(0.0, 1.0);
        if moved == 0.0 {
            return point;
        }
        self.truth.point(place(at_rest - odd * moved))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{cameras, terrains};
    use dolomite_testkit::random::Random;

    /// Sides that may be seen, away from the terrain's border, with a triangle on one hand only. Where
    /// two vertices have moved by different parts, triangles without area on the ground stand between
    /// their neighbours like a wall; with them, a surface without gaps has no such side.
    fn open_sides(selection: &Selection, ranges: f64) -> (usize, usize) {
        let selection = Selection {
            ranges,
            ..*selection
        };
        let (positions, triangles) = selection.draw(&mut HashMap::default()).unwrap();
        let bits = |k: u32| positions[k as usize].to_array().map(f64::to_bits);
        let mut sides: HashMap<_, i32> = HashMap::default();
        for &[a, b, c] in &triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let (from, to) = (bits(from), bits(to));
                if from != to {
                    *sides.entry((from.min(to), from.max(to))).or_default() +=
                        if from < to { 1 } else { -1 };
                }
            }
        }
        let seen = |p: [u64; 3]| {
            let p = DVec3::from_array(p.map(f64::from_bits));
            let inside = DVec2::new(p.x, p.z) - selection.extent.min;
            selection.view.sees(p)
                && inside.cmpgt(DVec2::ZERO).all()
                && inside.cmplt(selection.extent.size()).all()
        };
        let open = sides
            .iter()
            .filter(|&(&(a, b), &count)| count != 0 && seen(a) && seen(b));
        (open.count(), triangles.len())
    }

    #[test]
    fn neighbours_of_other_levels_meet_without_a_gap() {
        let truth = Truth::new(&terrains::fbm(1));
        for kind in [
            cameras::Kind::Flying,
            cameras::Kind::Standing,
            cameras::Kind::Wide,
        ] {
            let view = cameras::camera(&truth.terrain, kind, 2).view();
            let extent = truth.terrain.extent();
            let selection = Selection {
                truth: &truth,
                view: &view,
                extent,
                side: extent.size().max_element(),
                ranges: 0.0,
            };
            let (open, triangles) = open_sides(&selection, 8.0);
            assert!(triangles > 4000, "{triangles}");
            assert_eq!(open, 0, "{kind:?}");
            // Ranges too short for the move: the gaps are there, and seen.
            assert!(open_sides(&selection, 1.0).0 > 10, "{kind:?}");
        }
    }

    #[test]
    fn whatever_is_seen_is_covered() {
        let truth = Truth::new(&terrains::fbm(1));
        let camera = cameras::camera(&truth.terrain, cameras::Kind::Standing, 2);
        let drawn = Cdlod::default().draw(&truth, &camera, 8.0).unwrap();
        let mut random = Random::new(8);
        let (mut seen, view) = (0, camera.view());
        for _ in 0..40_000 {
            let away = 4000.0_f64.powf(random.unit());
            let xz = DVec2::new(camera.eye.x, camera.eye.z)
                + DVec2::from_angle(7.0 * random.unit()) * away;
            if truth.terrain.extent().contains(xz) && view.sees(truth.point(xz)) {
                seen += 1;
                assert!(drawn.height(xz).is_some(), "{xz}");
            }
        }
        assert!(seen > 500, "{seen}");
    }
}
