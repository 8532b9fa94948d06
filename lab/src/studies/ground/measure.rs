//! Answers of the pass against the triangles that were drawn, and against the true surface.

use crate::scenes::camera::Camera;
use crate::scenes::mesh::{Drawn, GroundMesh};
use crate::scenes::selection;
use crate::scenes::terrains;
use bevy::math::{DVec2, DVec3};
use dolomite_ground::detail::layout::DetailParams;
use dolomite_ground::detail::{DetailGround, Metric};
use dolomite_terrain::{GroundPoint, Source, Terrain, TerrainData};
use dolomite_testkit::blocks::{BlockAnswers, BlockRun};
use dolomite_testkit::random::Random;

/// Room for vertices and triangles.
const POOLS: [u32; 2] = [1 << 18, 1 << 19];
/// Slots of blocks.
pub const SLOTS: u32 = 1 << 13;
/// Blocks that a choice makes.
pub const BUDGET: u32 = 64;
/// Most choices until a view is settled.
pub const MOST: usize = 1000;

/// What the passes are told of a camera: heights relative to whole metres near the eye, as the stage has
/// them.
#[must_use]
pub fn params(ground: &DetailGround, camera: &Camera, metric: Metric) -> DetailParams {
    selection::params(ground, camera, metric, POOLS)
}

/// The island massif of the study `lod`, moved by so many metres: its hills are the same, its noise, and so its
/// ground, another one by the same rules.
#[must_use]
pub fn ground(seed: u32, moved: DVec2) -> Terrain {
    let mountain = terrains::mountain(seed);
    let mut data: TerrainData = mountain.data().clone();
    data.extent.min += moved;
    data.extent.max += moved;
    for layer in &mut data.layers {
        if let Source::Hill(hill) = &mut layer.source {
            hill.centre += moved;
        }
    }
    Terrain::new(data).expect("moved ground is as valid as it was")
}

/// Places where somebody may stand: half of them all over the ground, half before the camera, as many from
/// 1 to 2 m as from 512 to 1024 m, 45 degrees to either side.
#[must_use]
pub fn places(terrain: &Terrain, camera: &Camera, count: usize, seed: u32) -> Vec<GroundPoint> {
    let mut random = Random::new(seed);
    let (extent, eye) = (terrain.extent(), DVec2::new(camera.eye.x, camera.eye.z));
    (0..count)
        .map(|k| {
            let unit = DVec2::new(random.unit(), random.unit());
            if k % 2 == 0 {
                return GroundPoint::new(extent.min + extent.size() * unit);
            }
            let angle = camera.yaw + (unit.x - 0.5) * std::f64::consts::FRAC_PI_2;
            // Yaw 0 looks along -z and grows to the left.
            let ahead = DVec2::new(-angle.sin(), -angle.cos());
            let place = eye + ahead * (10.0 * unit.y).exp2();
            GroundPoint::new(place.clamp(extent.min, extent.max))
        })
        .collect()
}

/// A place that was answered.
#[derive(Debug, Clone, Copy)]
pub struct Checked {
    /// From the drawn triangle, metres.
    pub from_drawn: f64,
    /// The slope's difference from the triangle's, rise over run.
    pub slope: f64,
    /// From the true surface, metres.
    pub from_truth: f64,
    /// What the answer says that this is at most, metres.
    pub bound: f64,
}

/// All that was answered.
#[derive(Debug, Clone, Default)]
pub struct Verdict {
    /// Answers with a triangle.
    pub checked: Vec<Checked>,
    /// Places where nothing is drawn, and the answer says so; and those at the border of what is drawn,
    /// where either answer is right.
    pub nothing: usize,
    /// Places where the answer and the drawn mesh disagree on whether there is a triangle.
    pub wrong: usize,
}

/// Within a millimetre of the border of what is drawn either answer is right: positions 10 km away are
/// stored to half of that.
const BORDER: [(f64, f64); 4] = [(1e-3, 0.0), (-1e-3, 0.0), (0.0, 1e-3), (0.0, -1e-3)];

/// Compares answers with the mesh that came back from the GPU, in f64, and with the terrain.
#[must_use]
pub fn check(
    terrain: &Terrain,
    camera: &Camera,
    (params, run): (&DetailParams, &BlockRun),
    places: &[GroundPoint],
    answers: &BlockAnswers,
) -> Verdict {
    let positions = run.positions.iter().map(|&[x, y, z]| {
        DVec3::new(x.into(), y.into(), z.into()) + DVec3::Y * f64::from(params.anchor_height)
    });
    let mesh = GroundMesh::new(positions.collect(), run.triangles.clone(), &camera.view());
    let anchor = DVec2::new(params.view.anchor[0].into(), params.view.anchor[1].into());
    let sea = terrain.sea_level().map_or(f64::NEG_INFINITY, f64::from);
    let base = f64::from(answers.head.anchor_height);
    let mut verdict = Verdict::default();
    for (place, answer) in places.iter().zip(&answers.answers) {
        let xz = place.to_dvec2();
        let drawn = mesh.triangle(xz - anchor);
        let (Some(([a, b, c], [u, v, w])), true) = (drawn, answer.is_hit()) else {
            let at_the_border = BORDER.iter().any(|&(x, z)| {
                let beside = mesh.triangle(xz - anchor + DVec2::new(x, z));
                beside.is_some() == answer.is_hit()
            });
            if drawn.is_some() == answer.is_hit() || at_the_border {
                verdict.nothing += 1;
            } else {
                verdict.wrong += 1;
            }
            continue;
        };
        let height = base + f64::from(answer.height) + f64::from(answer.rise);
        let normal = (b - a).cross(c - a);
        let slope = DVec2::new(-normal.x, -normal.z) / normal.y;
        verdict.checked.push(Checked {
            from_drawn: (height - (a.y * u + b.y * v + c.y * w)).abs(),
            slope: (DVec2::from(answer.gradient.map(f64::from)) - slope).length(),
            from_truth: (height - terrain.sample_f64(xz).height.max(sea)).abs(),
            bound: f64::from(answer.bound),
        });
    }
    verdict
}
