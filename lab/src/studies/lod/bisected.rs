//! Two methods on the bisection of triangles: sides of equal length on the screen, as most engines
//! refine, and least error, which knows the truth.

use super::baseline::{Baseline, Knob};
use super::bisection::{Bisection, Lattice, Node, Triangle};
use crate::scenes::camera::{Camera, View};
use crate::scenes::mesh::MOST_TRIANGLES;
use crate::scenes::mesh::{Drawn, GroundMesh};
use crate::scenes::truth::Truth;
use bevy::math::{DVec2, DVec3};
use bevy::platform::collections::HashMap;
use dolomite_testkit::cores::on_all_cores;
use std::sync::Mutex;

/// By what a triangle is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Priority {
    /// The length of its longest side, as long as it would look from straight ahead, pixels: the
    /// triangle knows nothing of the ground's shape.
    Edge,
    /// The largest error that is found on it, pixels: longest edge bisection by ROAM's queue, with
    /// the error itself in place of ROAM's bound. No other choice of triangles of this hierarchy
    /// keeps to a limit with fewer; it costs 42 heights a triangle, which no game would pay.
    Error,
}

/// A method on the bisection. It keeps what it measured for a camera until the next one.
#[derive(Debug)]
pub struct Bisected {
    priority: Priority,
    known: Mutex<Option<(Camera, HashMap<Triangle, f64>)>>,
}

impl Bisected {
    /// By a priority.
    #[must_use]
    pub fn new(priority: Priority) -> Self {
        Self {
            priority,
            known: Mutex::new(None),
        }
    }
}

impl Baseline for Bisected {
    fn name(&self) -> &'static str {
        match self.priority {
            Priority::Edge => "equal edges",
            Priority::Error => "greedy",
        }
    }

    fn knob(&self) -> Knob {
        match self.priority {
            Priority::Edge => Knob {
                name: "longest side, pixels",
                coarsest: 256.0,
                finest: 1.0 / 16.0,
            },
            Priority::Error => Knob {
                name: "error, pixels",
                coarsest: 16.0,
                finest: 1.0 / 64.0,
            },
        }
    }

    fn draw(&self, truth: &Truth, camera: &Camera, knob: f64) -> Option<Box<dyn Drawn>> {
        let view = camera.view();
        let ground = Ground {
            truth,
            view: &view,
            lattice: Lattice {
                extent: truth.terrain.extent(),
            },
        };
        // A poisoned lock holds measures of another thread that are right all the same.
        let mut known = self.known.lock().unwrap_or_else(|e| e.into_inner());
        let (_, known) = match &mut *known {
            Some(known) if known.0 == *camera => known,
            other => other.insert((*camera, HashMap::default())),
        };
        let leaves = Bisection::refine(knob, known, MOST_TRIANGLES, |triangle| {
            match self.priority {
                Priority::Edge => ground.edge(triangle),
                Priority::Error => ground.error(triangle),
            }
        })?;
        Some(Box::new(ground.mesh(&leaves)))
    }
}

/// Steps along a side of a triangle on which its error is looked for.
const STEPS: usize = 8;
/// Triangles longer than this are bounded by the terrain's own bounds, smaller ones by the heights
/// found on them, metres. The first never fail, but are wide and cost as much as many heights; the
/// second may miss a tip between samples, of which the measurement would tell.
const BOUNDED: f64 = 256.0;
/// What may lie between samples: this share of their range above and below.
const BETWEEN: f64 = 0.25;

struct Ground<'a> {
    truth: &'a Truth,
    view: &'a View,
    lattice: Lattice,
}

impl Ground<'_> {
    fn mesh(&self, leaves: &[Triangle]) -> GroundMesh {
        let mut index: HashMap<Node, u32> = HashMap::default();
        let mut nodes = Vec::new();
        let triangles = leaves.iter().map(|triangle| {
            triangle.corners().map(|node| {
                *index.entry(node).or_insert_with(|| {
                    nodes.push(self.lattice.place(node));
                    nodes.len() as u32 - 1
                })
            })
        });
        let triangles = triangles.collect();
        let positions = on_all_cores(&nodes, |&xz| self.truth.point(xz));
        GroundMesh::new(positions, triangles, self.view)
    }

    /// The triangle's box over these heights, if it may be seen and is not all below the sea.
    fn visible(&self, triangle: &Triangle, (low, high): (f64, f64)) -> bool {
        let rect = self.lattice.rect(triangle);
        high >= self.truth.sea()
            && self.view.may_see_box(
                DVec3::new(rect.min.x, low.max(self.truth.sea()), rect.min.y),
                DVec3::new(rect.max.x, high, rect.max.y),
            )
    }

    /// Least and greatest height of a triangle, from samples on it or from the terrain's bounds.
    fn range(&self, triangle: &Triangle, samples: impl Iterator<Item = f64>) -> (f64, f64) {
        if self.lattice.rect(triangle).size().max_element() > BOUNDED {
            return self.truth.bounds(&self.lattice.rect(triangle));
        }
        let (low, high) = samples.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| {
            (low.min(h), high.max(h))
        });
        let margin = BETWEEN * (high - low);
        (low - margin, high + margin)
    }

    /// Length of the longest side, metres of space, times the scale of its nearest end.
    fn edge(&self, triangle: &Triangle) -> f64 {
        let corners = triangle
            .corners()
            .map(|node| self.truth.point(self.lattice.place(node)));
        let range = self.range(triangle, corners.iter().map(|p| p.y));
        // Three samples say less of what lies between them than forty: as far again.
        let size = self.lattice.rect(triangle).size().max_element();
        if !self.visible(triangle, (range.0 - size / 4.0, range.1 + size / 4.0)) {
            return 0.0;
        }
        let [apex, left, right] = corners;
        let length = left
            .distance(right)
            .max(apex.distance(left))
            .max(apex.distance(right));
        match self.view.visible_height {
            Some(_) => length * self.view.scale,
            None => {
                let nearest = corners
                    .iter()
                    .fold(f64::INFINITY, |d, p| d.min(p.distance(self.view.eye)));
                length * self.view.scale / nearest.max(self.view.near)
            }
        }
    }

    /// The largest error on the triangle, pixels; infinite while it reaches across the near plane,
    /// unless it is small beside the distance of that.
    ///
    /// Of a triangle that lies across a side of the screen all errors count, those beyond the side
    /// too: else it might be cut nowhere because none of its samples is on the screen.
    fn error(&self, triangle: &Triangle) -> f64 {
        let corners = triangle.corners().map(|node| self.lattice.place(node));
        let heights = corners.map(|xz| self.truth.bed(xz));
        let mut places = Vec::with_capacity((STEPS + 1) * (STEPS + 2) / 2 - 3);
        let mut drawn = Vec::with_capacity(places.capacity());
        for i in 0..=STEPS {
            for j in 0..=STEPS - i {
                let weights = [i, j, STEPS - i - j].map(|n| n as f64 / STEPS as f64);
                if weights.contains(&1.0) {
                    continue;
                }
                let [u, v, w] = weights;
                places.push(corners[0] * u + corners[1] * v + corners[2] * w);
                drawn.push(heights[0] * u + heights[1] * v + heights[2] * w);
            }
        }
        // 1/50 of a pixel is less than the share by which any knob is tuned.
        let truth = self.truth.heights(self.view, &places, 0.02);
        let all = truth.iter().map(|t| t.0).chain(heights);
        if !self.visible(triangle, self.range(triangle, all)) {
            return 0.0;
        }
        let point = |xz: DVec2, y: f64| DVec3::new(xz.x, y.max(self.truth.sea()), xz.y);
        let mut largest = 0.0_f64;
        let mut behind = false;
        for ((&xz, &drawn), (truth, _)) in places.iter().zip(&drawn).zip(truth) {
            match self
                .view
                .pixels_beyond_near(point(xz, truth), point(xz, drawn))
            {
                Some(error) => largest = largest.max(error),
                None => behind = true,
            }
        }
        let longest = self.lattice.rect(triangle).size().max_element();
        if behind && longest > 0.25 * self.view.near {
            return f64::INFINITY;
        }
        largest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{cameras, terrains};

    #[test]
    fn finer_knobs_draw_more_and_keep_vertices_on_the_ground() {
        let truth = Truth::new(&terrains::fbm(3));
        let camera = cameras::camera(&truth.terrain, cameras::Kind::Flying, 3);
        for (priority, knobs) in [
            (Priority::Edge, [128.0, 64.0]),
            (Priority::Error, [16.0, 8.0]),
        ] {
            let baseline = Bisected::new(priority);
            let [coarse, fine] = knobs.map(|k| baseline.draw(&truth, &camera, k).unwrap());
            assert!(fine.vertices() > coarse.vertices(), "{priority:?}");
            let view = camera.view();
            let mut checked = 0;
            for k in 0..400 {
                let away = 1.0 + f64::from(k) * 5.0;
                let xz = camera.eye + view.forward.with_y(0.0).normalize() * away;
                let xz = DVec2::new(xz.x, xz.z);
                if let Some((corners, _)) = fine.triangle(xz) {
                    for corner in corners {
                        assert_eq!(corner.y, truth.bed(DVec2::new(corner.x, corner.z)));
                    }
                    checked += 1;
                }
            }
            assert!(checked > 50);
        }
    }
}
