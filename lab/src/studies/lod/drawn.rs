//! The guarantee of [`super::guarantee`] for the triangles that the adapter drew: vertices and indices are read
//! back from the passes, placed in the world, and held against the f64 ground.
//!
//! Looked at are every vertex that is seen, the centres and middles of sides of triangles, random places on
//! them, and for holes every edge without a counterpart and random places of the ground before the camera.

use super::guarantee::{AT_A_PLACE, Count, errors, ground_of, merge, places, size_of};
use super::measure::Tally;
use crate::scenes::camera::{Camera, View};
use crate::scenes::cameras::{KINDS, Kind, around};
use crate::scenes::mesh::{Drawn, GroundMesh};
use crate::scenes::selection::{FINEST, bound, params};
use crate::scenes::truth::Truth;
use bevy::math::{DVec2, DVec3};
use dolomite_ground::detail::DetailCells;
use dolomite_ground::detail::layout::DetailParams;
use dolomite_terrain::GroundRect;
use dolomite_testkit::cores::on_all_cores;
use dolomite_testkit::detail::{DetailError, DetailRun, DetailStage};
use dolomite_testkit::gpu::Gpu;
use dolomite_testkit::mesh::edges;
use dolomite_testkit::random::Random;

/// Room for cells: some 50 MB.
pub const CAPACITY: u32 = 1 << 18;
/// Room for vertices and triangles.
pub const POOLS: [u32; 2] = [1 << 18, 1 << 19];
/// Of so many places on triangles one more is looked for holes in the ground before the camera.
const HOLES: usize = 8;
/// Places handed to a core at once.
const CHUNK: usize = 1 << 13;
const NO_PLACES: &[DVec3] = &[];
const NO_GROUND: &[DVec2] = &[];
/// A vertex of the border lies on it to f32, 16 km from the anchor: 2⁻¹¹ m, and once more of rounding.
const ON_BORDER: f64 = 2e-3;

/// What came back from the adapter, in the world.
#[derive(Debug, Clone)]
pub struct Surface {
    /// World metres.
    pub positions: Vec<DVec3>,
    /// As the index buffer has them.
    pub triangles: Vec<[u32; 3]>,
    /// What the choice left of the tolerance: 1 and less is all that was asked for.
    pub held: f64,
}

impl Surface {
    /// Of a run of the passes.
    #[must_use]
    pub fn of(params: &DetailParams, run: &DetailRun) -> Self {
        let held = run.left.max(run.coarsening);
        Self::new(params, &run.positions, run.triangles.clone(), held)
    }

    /// Of positions relative to the anchor, and triangles, that hold so much of the tolerance.
    #[must_use]
    pub fn new(
        params: &DetailParams,
        positions: &[[f32; 3]],
        triangles: Vec<[u32; 3]>,
        held: f32,
    ) -> Self {
        let [x, z] = params.view.anchor.map(f64::from);
        let anchor = DVec3::new(x, f64::from(params.anchor_height), z);
        Self {
            positions: positions
                .iter()
                .map(|at| anchor + DVec3::from_array(at.map(f64::from)))
                .collect(),
            triangles,
            held: f64::from(held),
        }
    }

    /// Corners of a triangle.
    #[must_use]
    pub fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|k| self.positions[k as usize])
    }
}

/// What the adapter draws for a camera at a tolerance.
///
/// # Errors
/// [`DetailError`].
pub fn drawn(
    stage: &mut DetailStage<'_>,
    cells: &DetailCells,
    camera: &Camera,
    tau: f64,
) -> Result<Surface, DetailError> {
    let params = params(cells, camera, bound(tau), POOLS);
    Ok(Surface::of(&params, &stage.run(params)?))
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

/// Measures the cameras of place `group`, all at every tolerance.
///
/// # Errors
/// [`DetailError`].
pub fn at_a_place(
    gpu: &Gpu,
    (group, cameras): (u32, usize),
    taus: &[f64],
    samples: usize,
    seed: u32,
) -> Result<Vec<Count>, DetailError> {
    let own = seed.wrapping_mul(1000).wrapping_add(group);
    let terrain = ground_of(group, own);
    let truth = Truth::new(&terrain);
    let cells = DetailCells::new(terrain.clone(), FINEST);
    let mut stage = DetailStage::new(gpu, &cells, CAPACITY)?;
    let mut counts = Vec::new();
    for (number, (kind, camera)) in around(&terrain, cameras, own).into_iter().enumerate() {
        let round = group as usize * AT_A_PLACE / KINDS.len() + number / KINDS.len();
        let camera = Camera {
            size: size_of(round),
            ..camera
        };
        for &tau in taus {
            let mut random = Random::new(own.wrapping_add(number as u32 * 7919));
            let surface = drawn(&mut stage, &cells, &camera, tau)?;
            let count = judge(&truth, &surface, (kind, camera), tau, samples, &mut random);
            merge(&mut counts, vec![count]);
        }
    }
    Ok(counts)
}
