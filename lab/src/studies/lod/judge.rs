//! A drawn surface against the ground: errors at many places, and holes.
//!
//! Looked at are every vertex that is seen, the centres and middles of sides of triangles, where the errors of smooth
//! ground are largest, and random places on them, so that places are as dense as triangles are. Holes are looked for at
//! every edge without a counterpart, and at random places of the ground before the camera.

use super::measure::{Measured, Sample, Tally};
use crate::scenes::camera::{Camera, View};
use crate::scenes::cameras::Kind;
use crate::scenes::mesh::{Drawn, GroundMesh};
use crate::scenes::selection::{drawn, positions, weld};
use crate::scenes::truth::Truth;
use bevy::math::{DVec2, DVec3};
use dolomite_ground::blocks::choose::Choice;
use dolomite_ground::blocks::kept::KeptBlocks;
use dolomite_ground::detail::layout::DetailParams;
use dolomite_terrain::GroundRect;
use dolomite_testkit::blocks::BlockRun;
use dolomite_testkit::cores::on_all_cores;
use dolomite_testkit::mesh::edges;
use dolomite_testkit::random::Random;
use std::sync::atomic::AtomicU64;

/// Of so many places on triangles one more is looked for holes in the ground before the camera.
const HOLES: usize = 8;
/// Places handed to a core at once.
const CHUNK: usize = 1 << 13;
const NO_PLACES: &[DVec3] = &[];
const NO_GROUND: &[DVec2] = &[];
/// A vertex of the border lies on it to f32, 16 km from the anchor: 2⁻¹¹ m, and once more of rounding.
const ON_BORDER: f64 = 2e-3;

/// Errors over one tolerance, and one kind of camera.
#[derive(Debug, Clone)]
pub struct Count {
    /// Pixels.
    pub tau: f64,
    /// What the camera is there for.
    pub kind: Kind,
    /// Whether the finest block was reached, or the room for them: the bound that holds is then the one that the choice
    /// reports.
    pub reached: bool,
    /// Views that were measured.
    pub views: u64,
    /// Errors over the bound: 1 is the bound itself.
    pub(super) tally: Tally,
    /// Where the largest is.
    pub worst: Option<(Camera, f64)>,
}

impl Count {
    /// Errors over the bound.
    #[must_use]
    pub fn measured(&self) -> Option<Measured> {
        self.tally.finish()
    }

    /// How many errors are above the bound.
    #[must_use]
    pub fn above(&self) -> u64 {
        self.tally.above
    }
}

/// What is drawn, in the world.
#[derive(Debug, Clone)]
pub struct Surface {
    /// World metres.
    pub positions: Vec<DVec3>,
    /// Counter-clockwise seen from above.
    pub triangles: Vec<[u32; 3]>,
    /// What the choice left of the tolerance: 1 and less is all that was asked for.
    pub held: f64,
}

impl Surface {
    /// What came back from the passes: each block has vertices of its own, of which those on its border have the bits of
    /// its neighbour's and are one here. Where bits differ an edge stays open, and counts as a hole.
    #[must_use]
    pub fn of_run(params: &DetailParams, run: &BlockRun) -> Self {
        let [x, z] = params.view.anchor.map(f64::from);
        let anchor = DVec3::new(x, f64::from(params.anchor_height), z);
        let welded = weld(run.positions.iter().map(|at| at.map(f32::to_bits)));
        let place = |at: [f32; 3]| anchor + DVec3::from_array(at.map(f64::from));
        Self {
            positions: welded
                .kept
                .iter()
                .map(|&k| place(run.positions[k]))
                .collect(),
            triangles: welded.triangles(&run.triangles),
            held: f64::from(run.left.max(run.coarsening)),
        }
    }

    /// What the CPU reference draws of a choice.
    #[must_use]
    pub fn of_choice(blocks: &KeptBlocks, choice: &Choice) -> Self {
        let mesh = drawn(blocks, choice);
        Self {
            positions: positions(blocks, &mesh),
            triangles: mesh.triangles,
            held: f64::from(choice.held),
        }
    }

    /// Corners of a triangle.
    #[must_use]
    pub fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|k| self.positions[k as usize])
    }
}

/// Holds a surface against the ground at some `samples` places.
#[must_use]
pub fn judge(
    truth: &Truth,
    surface: &Surface,
    (kind, camera): (Kind, Camera),
    tau: f64,
    samples: usize,
    random: &mut Random,
) -> Count {
    let reached = surface.held > 1.0;
    let limit = tau * surface.held.max(1.0);
    let view = camera.view();
    let triangles = surface.triangles.iter().map(|&t| surface.corners(t));
    let mut known = surface.positions.clone();
    places(triangles.collect(), &view, samples, random, |at| {
        known.push(at)
    });
    let ground = before(&camera, &truth.terrain.extent(), samples / HOLES, random);
    let mesh = GroundMesh::new(surface.positions.clone(), surface.triangles.clone(), &view);
    let chunks: Vec<(&[DVec3], &[DVec2])> = known
        .chunks(CHUNK)
        .map(|chunk| (chunk, NO_GROUND))
        .chain(ground.chunks(CHUNK).map(|chunk| (NO_PLACES, chunk)))
        .collect();
    let parts = on_all_cores(&chunks, |(known, ground)| {
        let mut all = errors(truth, &view, limit, known);
        let (covered, bare): (Vec<_>, Vec<_>) =
            ground.iter().partition(|xz| mesh.triangle(**xz).is_some());
        let covered: Vec<DVec3> = covered
            .into_iter()
            .filter_map(|&xz| Some(DVec3::new(xz.x, mesh.height(xz)?, xz.y)))
            .collect();
        all.merge(&errors(truth, &view, limit, &covered));
        for &xz in bare {
            all.hole(&view, DVec3::new(xz.x, truth.height(xz), xz.y));
        }
        all
    });
    let mut tally = Tally::counting_above(1.0);
    for part in &parts {
        tally.merge(part);
    }
    gaps(truth, surface, &view, &mut tally);
    Count {
        tau,
        kind,
        reached,
        views: 1,
        worst: Some((camera, limit)),
        tally,
    }
}

/// Edges that only one triangle has lie outside of the picture or on the border of the ground; others are
/// holes, counted at their middles.
fn gaps(truth: &Truth, surface: &Surface, view: &View, tally: &mut Tally) {
    let extent = truth.terrain.extent();
    let on_border = |a: DVec3, b: DVec3| {
        let on = |a: f64, b: f64, side: f64| (a - side).abs().max((b - side).abs()) < ON_BORDER;
        on(a.x, b.x, extent.min.x)
            || on(a.x, b.x, extent.max.x)
            || on(a.z, b.z, extent.min.y)
            || on(a.z, b.z, extent.max.y)
    };
    for (a, b) in edges(&surface.triangles).open {
        let [a, b] = [a, b].map(|k| surface.positions[k as usize]);
        if !on_border(a, b) {
            tally.hole(view, (a + b) / 2.0);
        }
    }
}

/// Places of the ground: half of them before a camera that looks ahead, as many from 1 to 2 m as from 8 to
/// 16 km, within its angle; the others anywhere about the point that it looks at, or the whole of the ground.
fn before(camera: &Camera, extent: &GroundRect, count: usize, random: &mut Random) -> Vec<DVec2> {
    let view = camera.view();
    let eye = DVec2::new(camera.eye.x, camera.eye.z);
    let aspect = f64::from(camera.size.x) / f64::from(camera.size.y);
    // Half of the horizontal angle; upside down is as wide.
    let half = ((camera.fov_y / 2.0).tan() * aspect).atan();
    let ahead = DVec2::new(view.forward.x, view.forward.z).normalize_or_zero();
    // Where its axis meets the height of the sea, or somewhere before it.
    let down = (-view.forward.y).max(0.05);
    let reach = camera.eye.y.max(1.0) / down;
    let focus = eye + DVec2::new(view.forward.x, view.forward.z) * reach;
    let wide = camera.orthographic.unwrap_or(2.0 * reach * half.tan()) * aspect;
    (0..count)
        .map(|k| match k % 4 {
            0 | 1 if ahead != DVec2::ZERO => {
                let turn = DVec2::from_angle(half * random.signed_unit());
                eye + ahead.rotate(turn) * (14.0 * random.unit()).exp2()
            }
            0..=2 => focus + DVec2::new(random.signed_unit(), random.signed_unit()) * wide,
            _ => extent.min + extent.size() * DVec2::new(random.unit(), random.unit()),
        })
        .filter(|&xz| extent.contains(xz))
        .collect()
}

/// Errors over the bound at places of the drawn surface: 1 is `limit` pixels.
fn errors(truth: &Truth, view: &View, limit: f64, drawn: &[DVec3]) -> Tally {
    // In units of the bound: as if a pixel were as large.
    let scaled = View {
        scale: view.scale / limit,
        half: view.half / limit,
        ..*view
    };
    let mut tally = Tally::counting_above(1.0);
    let best = AtomicU64::new(0);
    for part in drawn.chunks(1 << 13) {
        let xz: Vec<DVec2> = part.iter().map(|at| DVec2::new(at.x, at.z)).collect();
        // Of the bound: so much may the percentile be off, the maximum and the count are of f64.
        let heights = truth.heights(&scaled, &xz, 0.1);
        let with = part.iter().zip(xz).zip(heights);
        let with = with.map(|((at, xz), truth)| Sample {
            xz,
            truth,
            drawn: Some(at.y),
        });
        tally.add(truth, &scaled, with.collect(), &best);
    }
    tally
}

/// Calls `found` with some `count` places of triangles that may be seen: each triangle as often as another,
/// or every k-th if there are too many.
fn places(
    mut triangles: Vec<[DVec3; 3]>,
    view: &View,
    count: usize,
    random: &mut Random,
    mut found: impl FnMut(DVec3),
) {
    triangles.retain(|&[a, b, c]| {
        // What is drawn may lie beside what is there: by a quarter of the triangle.
        let lift = DVec3::Y * 0.25 * a.distance(b).max(b.distance(c)).max(c.distance(a));
        view.may_see(&[a + lift, b + lift, c + lift, a - lift, b - lift, c - lift])
    });
    // Four places a triangle at least.
    let every = (4 * triangles.len()).div_ceil(count.max(4)).max(1);
    let first = (random.unit() * every as f64) as usize;
    triangles = triangles.into_iter().skip(first).step_by(every).collect();
    let each = count / triangles.len().max(1);
    for [a, b, c] in triangles {
        let fixed = [
            (a + b + c) / 3.0,
            (a + b) / 2.0,
            (b + c) / 2.0,
            (c + a) / 2.0,
        ];
        for k in 0..each.max(fixed.len()) {
            let at = fixed.get(k).copied().unwrap_or_else(|| {
                let (mut u, mut v) = (random.unit(), random.unit());
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                a + (b - a) * u + (c - a) * v
            });
            found(at);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::cameras::around;
    use crate::scenes::selection::{FINEST, blocks_of, bound, choose, detail_view};
    use crate::scenes::terrains;

    #[test]
    fn a_hole_and_an_error_above_the_bound_are_seen() {
        let terrain = terrains::fbm(1);
        let truth = Truth::new(&terrain);
        let mut blocks = blocks_of(&terrain, FINEST);
        let with = around(&terrain, 2, 1)[1];
        let (_, camera) = with;
        let mut drawn = |tau: f64| {
            let choice = choose(&mut blocks, &detail_view(&camera, bound(tau)));
            Surface::of_choice(&blocks, &choice)
        };
        let of = |surface: &Surface, tau: f64| {
            let count = judge(&truth, surface, with, tau, 2000, &mut Random::new(1));
            (count.above(), count.measured().expect("seen").holes)
        };
        assert_eq!(of(&drawn(4.0), 4.0), (0, 0));
        // A mesh for 32 pixels is measured against 1.
        let coarse = drawn(32.0);
        let (above, holes) = of(&coarse, 1.0);
        assert!(above > 100 && holes == 0, "{above} {holes}");
        let view = camera.view();
        let mut bare = coarse.clone();
        bare.triangles
            .retain(|&t| !view.may_see(&coarse.corners(t)));
        assert!(bare.triangles.len() < coarse.triangles.len());
        // Of 2000 / 8 = 250 places that are looked at for holes, those that are in view.
        assert!(of(&bare, 32.0).1 >= 25);
    }
}
