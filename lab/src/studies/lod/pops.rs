//! How far the drawn surface moves on the screen from one frame to the next.
//!
//! Frames k and k + 1 are drawn, each for its camera, once all blocks that it asks for are made. At every vertex of either mesh the drawn surfaces of
//! both are compared at the same place of the ground, and both heights are projected by the camera of frame
//! k + 1: what the eye would see move against still ground. Only places count that both cameras see;
//! those that one of them does not see are told apart.

use crate::scenes::camera::{Camera, View};
use crate::scenes::mesh::{Drawn, GroundMesh};
use crate::scenes::selection::{FINEST, blocks_of, bound, choose, detail_view, ground_mesh};
use crate::scenes::truth::Truth;
use bevy::math::{DVec2, DVec3};
use dolomite_ground::blocks::kept::KeptBlocks;
use dolomite_terrain::Terrain;
use dolomite_testkit::cores::on_all_cores;
use dolomite_testkit::metrics::ErrorStats;

/// Frames a second.
pub const RATE: f64 = 60.0;
/// Tolerance of every frame, pixels.
pub const TAU: f64 = 1.0;

/// How a camera moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Move {
    /// Ahead over the ground at 2 m/s, eyes 1.7 m above it.
    Walk,
    /// Ahead at 200 m/s, straight.
    Fly,
    /// On the spot, 180 degrees a second to the left.
    Turn,
}

/// All of them.
pub const MOVES: [Move; 3] = [Move::Walk, Move::Fly, Move::Turn];

impl Move {
    /// As it is named in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Walk => "walking, 2 m/s",
            Self::Fly => "flying, 200 m/s",
            Self::Turn => "turning, 180 degrees/s",
        }
    }

    /// The camera of a frame.
    #[must_use]
    pub fn camera(self, truth: &Truth, start: Camera, frame: usize) -> Camera {
        let seconds = frame as f64 / RATE;
        let ahead = start.view().forward.with_y(0.0).normalize_or_zero();
        match self {
            Self::Walk => {
                let eye = start.eye + ahead * (2.0 * seconds);
                let ground = truth.height(DVec2::new(eye.x, eye.z));
                Camera {
                    eye: eye.with_y(ground + 1.7),
                    ..start
                }
            }
            Self::Fly => Camera {
                eye: start.eye + ahead * (200.0 * seconds),
                ..start
            },
            Self::Turn => Camera {
                yaw: start.yaw + std::f64::consts::PI * seconds,
                ..start
            },
        }
    }
}

/// How far vertices moved, pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moved {
    /// Where both frames see the place.
    pub seen: ErrorStats,
    /// Share of these that moved by more than a quarter of a pixel.
    pub above: f64,
    /// How far from the eye the one that moved most is, metres.
    pub distance: f64,
    /// How far it is from the nearest border of either picture, pixels.
    pub border: f64,
    /// The largest of those farther than a tenth of the picture's height from every border.
    pub inside: f64,
    /// The largest where the place has just come into the picture, or is just leaving it.
    pub entering: f64,
}

struct Frame {
    view: View,
    ground: GroundMesh,
}

fn frame(blocks: &mut KeptBlocks, camera: Camera) -> Frame {
    let choice = choose(blocks, &detail_view(&camera, bound(TAU)));
    Frame {
        view: camera.view(),
        ground: ground_mesh(blocks, &choice, &camera),
    }
}

/// Moves over `frames` frames from `start`; `None` if nothing was seen twice.
#[must_use]
pub fn pops(terrain: &Terrain, way: Move, start: Camera, frames: usize) -> Option<Moved> {
    let truth = Truth::new(terrain);
    let mut blocks = blocks_of(terrain, FINEST);
    let mut before = frame(&mut blocks, way.camera(&truth, start, 0));
    let mut seen = Vec::new();
    let (mut worst, mut inside, mut entering) = (None::<Step>, 0.0_f64, 0.0_f64);
    for number in 1..=frames {
        let after = frame(&mut blocks, way.camera(&truth, start, number));
        for (own, other) in [(&before, &after), (&after, &before)] {
            let moved = on_all_cores(&own.ground.positions, |&place| {
                moved(place, &other.ground, &before.view, &after.view)
            });
            for step in moved.into_iter().flatten() {
                if step.border < 0.0 {
                    entering = entering.max(step.pixels);
                    continue;
                }
                seen.push(step.pixels);
                if step.border > before.view.half.y / 5.0 {
                    inside = inside.max(step.pixels);
                }
                if worst.is_none_or(|worst| step.pixels > worst.pixels) {
                    worst = Some(step);
                }
            }
        }
        before = after;
    }
    let above = seen.iter().filter(|&&pixels| pixels > 0.25).count();
    let above = above as f64 / seen.len().max(1) as f64;
    let worst = worst?;
    Some(Moved {
        above,
        seen: ErrorStats::of(seen)?,
        distance: worst.distance,
        border: worst.border,
        inside,
        entering,
    })
}

/// What becomes of a vertex.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// How far it lies from the other frame's surface, pixels of the later frame.
    pixels: f64,
    /// From the eye, metres.
    distance: f64,
    /// From the nearest border of both pictures, pixels; below 0 where one of them does not see it.
    border: f64,
}

/// A vertex of one of two frames; `None` if neither sees it.
fn moved(place: DVec3, other: &GroundMesh, before: &View, after: &View) -> Option<Step> {
    let height = other.height(DVec2::new(place.x, place.z))?;
    let there = place.with_y(height);
    let sees = |view: &View| view.sees(place) || view.sees(there);
    let (earlier, later) = (sees(before), sees(after));
    if !(earlier || later) {
        return None;
    }
    let inside = |view: &View| {
        let at = view.project(place).or_else(|| view.project(there))?;
        Some((view.half - at.abs()).min_element().max(0.0))
    };
    let border = if earlier && later {
        inside(before)?.min(inside(after)?)
    } else {
        -1.0
    };
    Some(Step {
        pixels: after.pixels_beyond_near(place, there)?,
        distance: place.distance(after.eye),
        border,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{cameras, terrains};
    use bevy::math::UVec2;

    #[test]
    fn a_still_camera_moves_nothing_and_a_walk_moves_less_than_the_tolerance() {
        let terrain = terrains::fbm(1);
        let start = Camera {
            size: UVec2::new(240, 135),
            ..cameras::ordinary(&terrain)[1]
        };
        let truth = Truth::new(&terrain);
        let mut blocks = blocks_of(&terrain, FINEST);
        let [one, same] = [(), ()].map(|()| frame(&mut blocks, start));
        for &place in &one.ground.positions {
            if let Some(step) = moved(place, &same.ground, &one.view, &same.view) {
                // Barycentric coordinates in f64.
                assert!(step.pixels < 1e-6, "{step:?}");
            }
        }
        let walk = pops(&terrain, Move::Walk, start, 2).unwrap();
        assert!(walk.seen.max > 0.0 && walk.seen.max < TAU, "{walk:?}");
        // A mesh that is lifted by half of the camera's height is seen to move.
        let lift = DVec3::Y * 75.0;
        let lifted: Vec<_> = one.ground.positions.iter().map(|p| *p + lift).collect();
        let lifted = GroundMesh::new(lifted, one.ground.triangles.clone(), &one.view);
        let far = one.ground.positions.iter();
        let far = far.filter_map(|&p| moved(p, &lifted, &one.view, &one.view));
        assert!(far.map(|step| step.pixels).fold(0.0, f64::max) > TAU);
        assert_eq!(
            Move::Turn.camera(&truth, start, 60).yaw,
            start.yaw + std::f64::consts::PI
        );
    }
}
